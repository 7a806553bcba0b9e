//! Scenes from files and by name.

use std::io::Read;
use std::path::{Path, PathBuf};

use numpy::PyArrayMethods;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rdh::{Accel, Spec, Training};
use rdh_scene::saved::{self, Setting};
use rdh_scene::{Camera, CameraPath, View, catalog, formats};
use serde_json::json;

use crate::arrays::{refuse, zeros};
use crate::batch::supervise;
use crate::errors::{from_library, from_scene, from_system};
use crate::pool::pool;
use crate::scene::Scene;
use crate::world::{self, SavedFile, World};

/// What else is known of a scene.
pub(crate) struct About {
    setting: Setting,
    pub(crate) notes: Vec<String>,
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
    Ok(Scene::of(World::new(accel, scene.origin, None), About::of(&scene, paths)))
}

/// Opens a structure that ``Scene.save``, ``rdh build`` or ``rdh tune`` has written. The file is mapped and used where it lies, once it
/// has been checked in full: all processes of a machine that open it share one copy in memory, and a scene that was opened
/// is pickled as the file's path and checksum. The file must not be changed while it is open; to replace it is fine.
///
/// Raises ``OSError`` for a file that can't be opened; ``ValueError`` naming the byte for one that is damaged or none of ours.
///
/// >>> import pathlib, pickle, tempfile, rdh
/// >>> path = pathlib.Path(tempfile.mkdtemp()) / "balls.rdh"
/// >>> rdh.load("balls4").save(path)
/// >>> scene = rdh.open(path)
/// >>> len(pickle.dumps(scene)) < 200
/// True
#[pyfunction]
pub(crate) fn open(py: Python<'_>, path: PathBuf) -> PyResult<Scene> {
    // Another process may have another current folder.
    let path = path.canonicalize().map_err(|e| from_system(Some(&path), e))?;
    let pool = pool(py, Some(1))?;
    let checksum = checksum_of(&path).map_err(|e| from_system(Some(&path), e))?;
    let accel = supervise(py, &pool, |_| saved::open(&path))?.map_err(from_scene)?;
    let about = About::of_saved(&accel);
    let origin = about.setting.origin;
    Ok(Scene::of(World::new(accel, origin, Some(SavedFile { path, checksum })), about))
}

/// Opens what a pickled scene names.
#[pyfunction]
pub(crate) fn _reopen(py: Python<'_>, path: PathBuf, checksum: u64) -> PyResult<Scene> {
    let found = checksum_of(&path).map_err(|e| from_system(Some(&path), e))?;
    if found != checksum {
        return Err(refuse("path", format_args!("{} is no longer the file that was pickled", path.display())));
    }
    open(py, path)
}

/// A scene out of a pickle that holds all of it.
#[pyfunction]
pub(crate) fn _from_bytes(data: &[u8]) -> PyResult<Scene> {
    let accel = Accel::from_bytes(data).map_err(|e| refuse("data", e))?;
    let about = About::of_saved(&accel);
    let origin = about.setting.origin;
    Ok(Scene::of(World::new(accel, origin, None), about))
}

/// The checksum that a saved tree's header states; 0 of a file that is too short to be one.
fn checksum_of(path: &Path) -> std::io::Result<u64> {
    let mut header = [0; 24];
    match std::fs::File::open(path)?.read_exact(&mut header) {
        Err(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => Err(e),
        _ => Ok(u64::from_le_bytes(std::array::from_fn(|k| header[16 + k]))),
    }
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
    /// Of a scene with its camera paths.
    pub(crate) fn of(scene: &rdh_scene::Scene, paths: Vec<CameraPath>) -> Self {
        let notes = scene.notes.iter().map(|note| format!("{} {}", note.count, note.what)).collect();
        Self { setting: Setting::of(scene), notes, paths }
    }

    /// Of what a file says of its scene; of nothing, if it says nothing.
    fn of_saved(accel: &Accel) -> Self {
        let setting = Setting::from_settings(&accel.provenance().settings);
        let setting = setting.unwrap_or_else(|| Setting::of(&rdh_scene::Scene::default()));
        Self { setting, notes: Vec::new(), paths: Vec::new() }
    }

    /// The structure, with this as what is known of its scene.
    pub(crate) fn described(&self, accel: &Accel) -> Accel {
        let mut provenance = accel.provenance().clone();
        let mut settings = provenance.settings.as_object().cloned().unwrap_or_default();
        settings.insert("scene".to_owned(), json!(self.setting));
        provenance.settings = settings.into();
        accel.clone().with_provenance(provenance)
    }

    /// The scene's name, or nothing.
    pub(crate) fn name(&self) -> &str {
        &self.setting.id
    }

    /// Views by name.
    pub(crate) fn views<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let result = PyDict::new(py);
        for view in &self.setting.views {
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
            Some(name) => self.setting.views.iter().find(|v| v.name == name),
            None => self.setting.views.first(),
        };
        let view = view.ok_or_else(|| {
            let known: Vec<_> = self.setting.views.iter().map(|v| v.name.as_str()).collect();
            refuse(
                "view",
                format_args!(
                    "the scene has these: {}",
                    if known.is_empty() { "none".into() } else { known.join(", ") }
                ),
            )
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
