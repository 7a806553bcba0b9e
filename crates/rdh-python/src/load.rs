//! Scenes from files and by name.

use std::path::{Path, PathBuf};

use numpy::PyArrayMethods;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rdh::{Spec, Training};
use rdh_scene::{Camera, CameraPath, View, catalog, formats};

use crate::arrays::{refuse, zeros};
use crate::batch::supervise;
use crate::errors::{from_library, from_scene};
use crate::pool::pool;
use crate::scene::Scene;
use crate::world::{self, World};

/// What else is known of a scene.
#[derive(Default)]
pub(crate) struct About {
    pub(crate) name: String,
    pub(crate) notes: Vec<String>,
    views: Vec<View>,
    paths: Vec<CameraPath>,
}

/// Loads a scene: a mesh file (OBJ, PLY, STL, glTF, GLB; far away ones are moved near an ``origin``), or a generated scene by
/// its id (``quarter``), with parameters if it has some (``building(floors=6,seed=3)``); or, with ``scenes``, one of a folder
/// that has a ``scenes.toml``. ``rdh scenes`` lists them. Instances become triangles, in order; materials are not kept.
///
/// Raises ``OSError`` for a file that can't be opened; ``ValueError`` for one that can't be understood, saying where, and for
/// an unknown name, listing near ones.
///
/// >>> import rdh
/// >>> rdh.load("quarter", "bvh8+sah")
/// <rdh.Scene: 139772 triangles, bvh8+sah>
#[pyfunction]
#[pyo3(signature = (path, spec = "bvh8+sah", *, scenes = None, threads = None))]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    spec: &str,
    scenes: Option<PathBuf>,
    threads: Option<i64>,
) -> PyResult<Scene> {
    let (spec, pool): (Spec, _) = (spec.parse().map_err(from_library)?, pool(py, threads)?);
    let (scene, paths) = supervise(py, &pool, |_| read(&path, scenes.as_deref()))?.map_err(from_scene)?;
    let mesh = scene.flatten().map_err(from_library)?.mesh;
    let accel = world::build(py, &pool, &mesh, &spec, &Training::none())?;
    let notes = scene.notes.iter().map(|note| format!("{} {}", note.count, note.what)).collect();
    let about = About { name: scene.name, notes, views: scene.views, paths };
    Ok(Scene::of(World::new(mesh.into(), scene.origin, accel), about))
}

fn read(path: &Path, folder: Option<&Path>) -> rdh_scene::Result<(rdh_scene::Scene, Vec<CameraPath>)> {
    if formats::format_of(path).is_ok() {
        return Ok((formats::read_file(path)?, Vec::new()));
    }
    let others = folder.map(catalog::indexed).transpose()?.unwrap_or_default();
    let entry = catalog::find(&path.to_string_lossy(), &others)?;
    Ok((entry.load(0)?, entry.paths()?))
}

impl About {
    /// Views by name.
    pub(crate) fn views<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let result = PyDict::new(py);
        for view in &self.views {
            result.set_item(&view.name, as_dict(py, view)?)?;
        }
        Ok(result)
    }

    /// Paths by name, as lists of views.
    pub(crate) fn paths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let result = PyDict::new(py);
        for path in &self.paths {
            let views = (0..path.frames).filter_map(|frame| path.at(frame));
            let views = views.map(|view| as_dict(py, &view)).collect::<PyResult<Vec<_>>>()?;
            result.set_item(&path.name, PyList::new(py, views)?)?;
        }
        Ok(result)
    }

    /// Rays through the middles of pixels, in world coordinates.
    pub(crate) fn camera_rays<'py>(
        &self,
        py: Python<'py>,
        origin: [f64; 3],
        width: u32,
        height: u32,
        view: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let view = match view {
            Some(name) => self.views.iter().find(|v| v.name == name),
            None => self.views.first(),
        };
        let view = view.ok_or_else(|| {
            let known: Vec<_> = self.views.iter().map(|v| v.name.as_str()).collect();
            refuse("view", format_args!("the scene has these: {}", if known.is_empty() { "none".into() } else { known.join(", ") }))
        })?;
        let camera = Camera::new(view, origin, f64::from(width) / f64::from(height.max(1)));
        let array = zeros::<f64>(py, &[height as usize, width as usize, 6])?;
        let mut held = array.try_readwrite()?;
        for (pixel, row) in held.as_slice_mut()?.as_chunks_mut::<6>().0.iter_mut().enumerate() {
            let [x, y] = [pixel % width as usize, pixel / width as usize].map(|n| n as f64);
            let ray = camera.ray((x + 0.5) / f64::from(width), (y + 0.5) / f64::from(height));
            let eye = [0, 1, 2].map(|a| f64::from(ray.origin[a]) + origin[a]);
            let [dx, dy, dz] = ray.direction.map(f64::from);
            *row = [eye[0], eye[1], eye[2], dx, dy, dz];
        }
        drop(held);
        Ok(array.into_any())
    }
}

fn as_dict<'py>(py: Python<'py>, view: &View) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    for (name, point) in [("eye", view.eye), ("target", view.target), ("up", view.up)] {
        result.set_item(name, <(f64, f64, f64)>::from(point))?;
    }
    result.set_item("fov_y", view.fov_y_degrees)?;
    Ok(result)
}
