//! The class `Scene`.

use std::path::PathBuf;

use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use rdh::{Spec, Training};
use rdh_rows::RayRows;
use rdh_scene::saved;

use crate::arrays::{Floats, read_faces, refuse, reserve, zeros};
use crate::batch;
use crate::cast::{self, Wanted};
use crate::errors::{from_library, from_scene};
use crate::load::About;
use crate::pool::pool;
use crate::profile::Profile;
use crate::tune::{self, Measure};
use crate::world::{self, SavedFile, World};

/// Triangles, and a structure that finds where rays hit them.
///
/// ``vertices`` is an ``(n, 3)`` array of finite numbers in any unit, ``faces`` an ``(m, 3)`` array of vertex indices: of any
/// dtype, strides, byte order and alignment. ``spec`` says what is built over them (see the README: ``bvh8+sah`` by default,
/// ``bvh8(high)+sah`` builds slower and traces faster), ``threads`` on how many threads (``None`` and 0: all cores).
///
/// Rays are ``(..., 6)`` arrays ``ox oy oz dx dy dz`` or ``(..., 8)`` arrays with ``t_min t_max`` behind, as in Open3D: ``t``
/// is in units of the direction's length, which need not be 1; intervals are closed; results have the shape of the rays
/// without its last axis. A ray with a NaN, an infinite origin or direction, no direction or ``t_min > t_max`` is a miss.
/// Everything is traced in 32-bit floats, but relative to ``origin``: far away scenes don't lose precision if their
/// vertices and rays come as float64. Casting releases the interpreter's lock and can be stopped by Ctrl-C.
///
/// Raises ``ValueError`` naming the argument and the row for what is no mesh, ``MemoryError``.
///
/// >>> import numpy as np, rdh
/// >>> scene = rdh.Scene([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
/// >>> hits = scene.cast_rays([[0.25, 0.25, 1, 0, 0, -1], [2, 2, 1, 0, 0, -1]])
/// >>> hits["t_hit"]
/// array([ 1., inf], dtype=float32)
/// >>> hits["primitive_ids"] == rdh.INVALID_ID
/// array([False,  True])
#[pyclass(frozen, weakref, module = "rdh")]
pub(crate) struct Scene {
    world: World,
    about: About,
}

impl Scene {
    /// Over a mesh with a finished structure.
    pub(crate) fn of(world: World, about: About) -> Self {
        Self { world, about }
    }

    /// What rays are cast through.
    pub(crate) fn world(&self) -> &World {
        &self.world
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (vertices, faces, spec = "bvh8+sah", *, threads = None))]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        spec: &str,
        threads: Option<i64>,
    ) -> PyResult<Self> {
        let (spec, pool) = (spec.parse().map_err(from_library)?, pool(py, threads)?);
        let positions = read_positions(vertices)?;
        let triangles = read_faces("faces", faces)?;
        if let Some(row) = triangles.iter().position(|t| t.iter().any(|&i| i as usize >= positions.len())) {
            let reason =
                format_args!("row {row}: {:?} refers to more than the {} vertices", triangles[row], positions.len());
            return Err(refuse("faces", reason));
        }
        let placed = rdh_scene::Scene::from_triangles(positions, triangles).map_err(from_scene)?;
        let mesh = placed.flatten().map_err(from_library)?.mesh;
        let accel = world::build(py, &pool, &mesh, &spec, &Training::none())?;
        Ok(Self::of(World::new(accel, placed.origin, None), About::of(&placed, Vec::new())))
    }

    /// Casts rays for their nearest hits; of equally near ones that with the smallest id.
    ///
    /// Returns a dictionary of arrays, all of them or those in ``fields``: ``t_hit`` float32, ``inf`` for a miss;
    /// ``geometry_ids`` uint32, 0; ``primitive_ids`` uint32, rows of ``faces``; both ``rdh.INVALID_ID`` for a miss;
    /// ``primitive_uvs`` ``(..., 2)`` float32, the weights of a face's second and third corner; ``primitive_normals``
    /// ``(..., 3)`` float32 of length 1, on the side from which the corners run counter-clockwise.
    ///
    /// Raises ``ValueError`` naming the argument that is wrong, ``MemoryError``.
    ///
    /// >>> import rdh
    /// >>> rdh.load("balls4").cast_rays([[9, 0, 0, -1, 0, 0]], fields=["t_hit", "primitive_ids"], threads=1).keys()
    /// dict_keys(['t_hit', 'primitive_ids'])
    #[pyo3(signature = (rays, threads = None, *, fields = None))]
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        threads: Option<i64>,
        fields: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wanted = fields.map_or(Ok(Wanted::ALL), Wanted::read)?;
        let (floats, shape, columns) = read_rays(rays)?;
        let rays = RayRows::rows(floats.numbers()?, columns, self.world.origin);
        cast::closest(py, pool(py, threads)?.as_ref(), &self.world, &rays, &shape, wanted)
    }

    /// Whether rays hit anything between ``tnear`` and ``tfar`` (closed; rays of eight columns have their own interval): an
    /// array of bool. Faster than asking for the nearest hit.
    ///
    /// Raises as ``cast_rays`` does.
    ///
    /// >>> import rdh
    /// >>> scene = rdh.Scene([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    /// >>> bool(scene.test_occlusions([0.25, 0.25, 1, 0, 0, -1], tfar=0.5))
    /// False
    #[pyo3(signature = (rays, tnear = 0.0, tfar = f32::INFINITY, threads = None))]
    fn test_occlusions<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        tnear: f32,
        tfar: f32,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (floats, shape, columns) = read_rays(rays)?;
        let rays = RayRows::rows(floats.numbers()?, columns, self.world.origin).within(tnear, tfar);
        cast::many(py, pool(py, threads)?.as_ref(), &self.world, &rays, &shape, "rays", |caster, rays, occluded| {
            caster.occluded_many(rays, occluded);
        })
    }

    /// How many triangles rays go through: an array of int32. An edge that triangles share counts for one of them only, so
    /// that lines through closed meshes have even numbers.
    ///
    /// Raises as ``cast_rays`` does.
    #[pyo3(signature = (rays, threads = None))]
    fn count_intersections<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (floats, shape, columns) = read_rays(rays)?;
        let rays = RayRows::rows(floats.numbers()?, columns, self.world.origin);
        cast::each(py, pool(py, threads)?.as_ref(), &self.world, &rays, &shape, "rays", |caster, ray, hits| {
            caster.all_hits(ray, hits);
            hits.len() as i32
        })
    }

    /// All triangles that rays go through, ray after ray, each nearest first.
    ///
    /// Returns a dictionary of arrays: ``ray_splits`` int64, one longer than there are rays, so that the hits of ray ``i`` (in
    /// the order of C) are those from ``ray_splits[i]`` to before ``ray_splits[i + 1]``; and for each hit ``ray_ids`` int64,
    /// ``t_hit``, ``geometry_ids``, ``primitive_ids`` and ``primitive_uvs`` as in ``cast_rays``.
    ///
    /// Raises as ``cast_rays`` does.
    ///
    /// >>> import rdh
    /// >>> scene = rdh.Scene([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2], [3, 4, 5]])
    /// >>> scene.list_intersections([[0.25, 0.25, 2, 0, 0, -1]])["primitive_ids"]
    /// array([1, 0], dtype=uint32)
    #[pyo3(signature = (rays, threads = None))]
    fn list_intersections<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (floats, _, columns) = read_rays(rays)?;
        let rays = RayRows::rows(floats.numbers()?, columns, self.world.origin);
        cast::list(py, pool(py, threads)?.as_ref(), &self.world, &rays)
    }

    /// Builds another structure over the same triangles, in place of the present one: by any spec; those with ``rdh`` need a
    /// ``profile``. Answers stay the same, bit for bit; only times change.
    ///
    /// Raises ``ValueError`` for a spec that can't be understood or lacks a profile; the scene then stays as it was.
    #[pyo3(signature = (spec, profile = None, *, threads = None))]
    fn rebuild(&self, py: Python<'_>, spec: &str, profile: Option<&Profile>, threads: Option<i64>) -> PyResult<()> {
        let spec: Spec = spec.parse().map_err(from_library)?;
        let training = match profile {
            Some(profile) => Training::from_samples(profile.sample()?.samples().to_vec()),
            None => Training::none(),
        };
        self.world.replace(world::build(py, pool(py, threads)?.as_ref(), self.world.accel().mesh(), &spec, &training)?);
        Ok(())
    }

    /// Chooses a structure for the rays of a profile, and builds it in place of the present one: candidates are built from a half of
    /// the profile, raced on a quarter, and one that knows the rays is taken only if it is surely (95 %) not slower than the best
    /// one that needs no rays; else that one is. Answers stay the same, bit for bit. Takes as long as building and casting with
    /// all candidates. The last quarter of the profile is saved with the scene, so that ``rdh verify`` can judge it.
    ///
    /// ``candidates`` lists specs, some without ``rdh``; by default the library's own. ``by`` is ``"time"``, or ``"counts"`` of steps and
    /// tests, by which the choice is the same on every machine. ``seed`` divides the profile. ``threads`` build; times are taken on one.
    ///
    /// Returns the evidence, a dictionary: ``spec``, ``base`` (the best one without rays), ``outcome`` (``rays``, ``areas``,
    /// ``too_few_rays``), ``reason`` in words, and ``trials`` with times, counts, ratios and intervals of each candidate.
    ///
    /// Raises ``ValueError`` for candidates that make no sense or ``by``; the scene then stays as it was.
    ///
    /// >>> import rdh
    /// >>> scene = rdh.load("balls4")
    /// >>> with rdh.record(scene) as profile:
    /// ...     hits = scene.cast_rays(scene.camera_rays(100, 100))
    /// >>> evidence = scene.tune(profile, by="counts")
    /// >>> scene.spec == evidence["spec"]
    /// True
    #[pyo3(signature = (profile, *, candidates = None, by = "time", seed = 1, threads = None))]
    fn tune<'py>(
        &self,
        py: Python<'py>,
        profile: &Profile,
        candidates: Option<&str>,
        by: &str,
        seed: u64,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let candidates = candidates.map_or_else(|| Ok(Spec::candidates()), Spec::list).map_err(from_library)?;
        let measure = Measure::read(by)?;
        let (profile, accel) = (profile.sample()?, self.world.accel());
        let chosen = tune::choose(py, &*pool(py, threads)?, accel.mesh(), &candidates, &profile, measure, seed)?;
        self.world.replace(chosen);
        self.evidence(py)
    }

    /// Why this structure was chosen and no other, as ``tune`` returned it; ``None`` if it was not chosen.
    #[getter]
    fn evidence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text =
            self.world.accel().provenance().evidence.as_ref().map_or_else(|| "null".to_owned(), ToString::to_string);
        py.import("json")?.call_method1("loads", (text,))
    }

    /// What was built: spec, numbers of triangles, nodes, leaves and references, depth, bytes, and training rays.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let accel = self.world.accel();
        let stats = accel.stats();
        let result = PyDict::new(py);
        result.set_item("spec", stats.spec.to_string())?;
        for (name, number) in [
            ("triangles", stats.triangles),
            ("nodes", stats.nodes),
            ("leaves", stats.leaves),
            ("references", stats.references),
            ("depth", stats.depth),
            ("bytes", stats.bytes),
            ("trained_on", stats.trained_on),
        ] {
            result.set_item(name, number)?;
        }
        Ok(result)
    }

    /// What was built, as a spec.
    #[getter]
    fn spec(&self) -> String {
        self.world.accel().stats().spec.to_string()
    }

    /// The vertices: a new ``(n, 3)`` float64 array, in world coordinates.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let accel = self.world.accel();
        let positions = accel.mesh().positions();
        let array = zeros::<f64>(py, &[positions.len(), 3])?;
        let mut held = array.try_readwrite()?;
        for (row, p) in held.as_slice_mut()?.as_chunks_mut::<3>().0.iter_mut().zip(positions) {
            *row = [0, 1, 2].map(|a| f64::from(p[a]) + self.world.origin[a]);
        }
        drop(held);
        Ok(array.cast_into()?)
    }

    /// The faces: a new ``(m, 3)`` uint32 array of vertex indices.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let accel = self.world.accel();
        let triangles = accel.mesh().triangles();
        let array = zeros::<u32>(py, &[triangles.len(), 3])?;
        array.try_readwrite()?.as_slice_mut()?.copy_from_slice(triangles.as_flattened());
        Ok(array.cast_into()?)
    }

    /// The smallest box around all triangles, ``(2, 3)`` float64 in world coordinates; inverted if there are none.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let bounds = self.world.accel().mesh().bounds();
        let corners = [bounds.min, bounds.max].map(|p| [0, 1, 2].map(|a| f64::from(p[a]) + self.world.origin[a]));
        let array = zeros::<f64>(py, &[2, 3])?;
        array.try_readwrite()?.as_slice_mut()?.copy_from_slice(corners.as_flattened());
        Ok(array.cast_into()?)
    }

    /// The point of the world that is traced as ``(0, 0, 0)``: not zero only if the scene is far away for its size.
    #[getter]
    fn origin(&self) -> (f64, f64, f64) {
        self.world.origin.into()
    }

    /// Its name, if it was loaded.
    #[getter]
    fn name(&self) -> &str {
        self.about.name()
    }

    /// What was dropped or repaired when it was loaded, in words.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.about.notes.clone()
    }

    /// Named views: for each its ``eye``, ``target`` and ``up``, each three numbers in world coordinates, and ``fov_y``, the
    /// vertical angle of view in degrees.
    #[getter]
    fn views<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.about.views(py)
    }

    /// Camera paths: for each its views, frame by frame, as in ``views``.
    #[getter]
    fn paths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.about.paths(py)
    }

    /// Rays of a pinhole camera through the middles of pixels, row by row from the top left one: ``(height, width, 6)`` float64,
    /// directions of length 1. ``view`` names one of ``views``; the first one by default.
    ///
    /// Raises ``ValueError`` for an unknown view.
    ///
    /// >>> import rdh
    /// >>> rdh.load("quarter").camera_rays(32, 24).shape
    /// (24, 32, 6)
    #[pyo3(signature = (width, height, view = None))]
    fn camera_rays<'py>(
        &self,
        py: Python<'py>,
        width: u32,
        height: u32,
        view: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.about.camera_rays(py, self.world.origin, width, height, view)
    }

    /// Writes the structure with its triangles as a ``.rdh`` file, which ``rdh.open`` and the program ``rdh`` read. A file that was
    /// there is replaced as a whole, and stays what it was for those who have it open. Raises ``OSError``.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let accel = self.about.described(&self.world.accel());
        let saved = batch::supervise(py, pool(py, Some(1))?.as_ref(), |_| saved::save(&accel, &path))?;
        saved.map_err(from_scene)
    }

    /// A scene that was opened is sent as its path and checksum, any other with all its triangles.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let module = py.import("rdh._rdh")?;
        match self.world.file() {
            Some(SavedFile { path, checksum }) => Ok((module.getattr("_reopen")?, (path, checksum).into_pyobject(py)?)),
            None => {
                let bytes = self.about.described(&self.world.accel()).to_bytes().map_err(from_library)?;
                Ok((module.getattr("_from_bytes")?, (PyBytes::new(py, &bytes),).into_pyobject(py)?))
            }
        }
    }

    fn __len__(&self) -> usize {
        self.world.accel().mesh().len()
    }

    fn __repr__(&self) -> String {
        format!("<rdh.Scene: {} triangles, {}>", self.world.accel().mesh().len(), self.spec())
    }
}

/// Rays, their shape without the last axis, and how many numbers each has.
fn read_rays<'py>(rays: &Bound<'py, PyAny>) -> PyResult<(Floats<'py>, Vec<usize>, usize)> {
    let floats = Floats::read("rays", rays)?;
    let shape = floats.leading_shape("rays", &[6, 8])?;
    let columns = floats.shape()[shape.len()];
    Ok((floats, shape, columns))
}

/// Vertices that can be placed near an origin.
fn read_positions(vertices: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 3]>> {
    let floats = Floats::read("vertices", vertices)?;
    let count = floats.row_count("vertices", 3)?;
    let numbers = floats.numbers()?;
    let mut positions = reserve("vertices", count)?;
    for row in 0..count {
        let position = numbers.triple(3 * row);
        if let Some(bad) = position.iter().find(|x| x.abs() > f64::from(f32::MAX) || x.is_nan()) {
            return Err(refuse("vertices", format_args!("row {row}: {bad} is not a finite 32-bit float")));
        }
        positions.push(position);
    }
    Ok(positions)
}
