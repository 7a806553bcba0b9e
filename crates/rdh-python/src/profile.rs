//! Profiles: the rays that a program really casts.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use numpy::{PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple, PyType};
use rdh::{Profile as Sample, RayClass, Recorder};

use crate::arrays::{refuse, zeros};
use crate::errors::{from_library, from_system};
use crate::scene::Scene;
use crate::world::Recording;

/// A fair sample of the rays that were cast while ``rdh.record`` was active: what ``Scene.tune`` and ``Scene.rebuild``
/// build for.
///
/// It has a length (how many different rays it keeps), is equal to a profile of the same rays, and can be pickled, so that
/// what several processes record can be brought together by ``Profile.merge``.
#[pyclass(frozen, module = "rdh")]
pub(crate) struct Profile(Mutex<Option<Arc<Sample>>>);

impl Profile {
    fn finished(sample: Sample) -> Self {
        Self(Mutex::new(Some(Arc::new(sample))))
    }

    /// The samples, once recording is over.
    ///
    /// # Errors
    /// `ValueError` before.
    pub(crate) fn sample(&self) -> PyResult<Arc<Sample>> {
        let sample = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        sample.ok_or_else(|| PyValueError::new_err("profile: it is complete only when its `with` block has ended"))
    }

    fn finish(&self, sample: Sample) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(sample));
    }
}

#[pymethods]
impl Profile {
    /// Reads a ``.rays`` file, as ``save`` or ``rdh record`` writes them.
    ///
    /// Raises ``OSError`` if it can't be read, ``ValueError`` with the byte if it is not a profile.
    #[classmethod]
    fn open(_class: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let bytes = std::fs::read(&path).map_err(|e| from_system(Some(&path), e))?;
        let sample = Sample::from_bytes(&bytes).map_err(|e| refuse(&path.display().to_string(), e))?;
        Ok(Self::finished(sample))
    }

    /// All profiles together: the same as if one recording had seen all their rays, in whatever order.
    ///
    /// Raises ``ValueError`` if they were recorded with different seeds.
    #[classmethod]
    fn merge(_class: &Bound<'_, PyType>, profiles: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut samples = Vec::new();
        // One by one: what is given may claim any length.
        for profile in profiles.try_iter().map_err(|_| refuse("profiles", "a list of profiles is needed"))? {
            let profile =
                profile?.cast_into::<Self>().map_err(|_| refuse("profiles", "a list of profiles is needed"))?;
            samples.push(Sample::clone(&*profile.get().sample()?));
        }
        let merged = Sample::merge(samples).map_err(from_library)?;
        Ok(Self::finished(merged))
    }

    /// Writes it as a ``.rays`` file, which ``Profile.open`` and the program ``rdh`` read. Raises ``OSError``.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        let bytes = self.sample()?.to_bytes();
        rdh_scene::files::write_whole(&path, &bytes).map_err(|e| from_system(Some(&path), e))
    }

    /// How many rays were cast while it was recorded.
    #[getter]
    fn seen(&self) -> PyResult<u64> {
        Ok(self.sample()?.seen())
    }

    /// The seed of the sampling.
    #[getter]
    fn seed(&self) -> PyResult<u64> {
        Ok(self.sample()?.seed())
    }

    /// The sampled rays: an ``(n, 8)`` float32 array of origin, direction, t_min and t_max, relative to the scene's
    /// ``origin``, in a random but repeatable order.
    #[getter]
    fn rays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let sample = self.sample()?;
        let array = zeros::<f32>(py, &[sample.len(), 8])?;
        let mut held = array.try_readwrite()?;
        for (row, s) in held.as_slice_mut()?.as_chunks_mut::<8>().0.iter_mut().zip(sample.samples()) {
            let ([ox, oy, oz], [dx, dy, dz]) = (s.ray.origin, s.ray.direction);
            *row = [ox, oy, oz, dx, dy, dz, s.ray.t_min, s.ray.t_max];
        }
        drop(held);
        Ok(array.cast_into()?)
    }

    fn __len__(&self) -> PyResult<usize> {
        Ok(self.sample()?.len())
    }

    fn __eq__(&self, other: &Self) -> PyResult<bool> {
        Ok(*self.sample()? == *other.sample()?)
    }

    fn __repr__(&self) -> String {
        match self.sample() {
            Ok(sample) => format!("<rdh.Profile: {} of {} rays>", sample.len(), sample.seen()),
            Err(_) => "<rdh.Profile: being recorded>".to_owned(),
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let bytes = PyBytes::new(py, &self.sample()?.to_bytes());
        Ok((py.get_type::<Self>().getattr("_from_bytes")?, (bytes,)))
    }

    #[classmethod]
    fn _from_bytes(_class: &Bound<'_, PyType>, data: &[u8]) -> PyResult<Self> {
        Sample::from_bytes(data).map(Self::finished).map_err(|e| refuse("data", e))
    }
}

/// Records the rays that are cast through a scene while a ``with`` block runs, whoever casts them.
///
/// ``scene`` is an ``rdh.Scene``, or has one as its ``scene`` (``rdh.trimesh.RayMeshIntersector``). Of all different rays a
/// fair sample of at most ``capacity`` is kept; the same rays give the same sample in any order and on any number of threads.
/// ``ray_class`` says what they are for: primary, shadow, reflection, refraction, bounce, ao, lidar or other.
/// While recording, occlusion tests take as long as closest hits, since it matters where a ray would have ended.
///
/// Raises ``ValueError`` if the scene is being recorded already.
///
/// >>> import numpy as np, rdh
/// >>> scene = rdh.load("balls4")
/// >>> rays = np.random.default_rng(1).normal(size=(1000, 6))
/// >>> with rdh.record(scene) as profile:
/// ...     hits = scene.test_occlusions(rays)
/// >>> profile.seen, len(profile)
/// (1000, 1000)
/// >>> scene.rebuild("bvh8+rdh", profile)
/// >>> bool((scene.test_occlusions(rays) == hits).all())
/// True
#[pyfunction]
#[pyo3(signature = (scene, *, capacity = 65_536, seed = 1, ray_class = "other"))]
pub(crate) fn record(scene: &Bound<'_, PyAny>, capacity: i64, seed: u64, ray_class: &str) -> PyResult<Record> {
    let scene = match scene.cast::<Scene>() {
        Ok(scene) => scene.clone(),
        // What stands before a scene, such as `rdh.trimesh.RayMeshIntersector`.
        Err(_) => {
            let inner = scene.getattr("scene").and_then(|inner| Ok(inner.cast_into::<Scene>()?));
            inner.map_err(|_| refuse("scene", "an rdh.Scene is needed, or something with a `scene`"))?
        }
    };
    let capacity = usize::try_from(capacity).ok().filter(|n| (1..=1 << 28).contains(n));
    let capacity = capacity.ok_or_else(|| refuse("capacity", "1 to 2**28 rays can be kept"))?;
    let class = RayClass::ALL.into_iter().find(|class| class.name() == ray_class).ok_or_else(|| {
        let known: Vec<_> = RayClass::ALL.iter().map(|class| class.name()).collect();
        refuse("ray_class", format_args!("'{ray_class}' is none of {}", known.join(", ")))
    })?;
    Ok(Record { scene: scene.unbind(), capacity, seed, class, entered: Mutex::new(None) })
}

/// The context manager that ``rdh.record`` returns.
#[pyclass(frozen, module = "rdh")]
pub(crate) struct Record {
    scene: Py<Scene>,
    capacity: usize,
    seed: u64,
    class: RayClass,
    entered: Mutex<Option<(Py<Profile>, Arc<Recording>)>>,
}

#[pymethods]
impl Record {
    /// Starts recording; returns the ``Profile``, which is complete when the block ends.
    fn __enter__(&self, py: Python<'_>) -> PyResult<Py<Profile>> {
        let recording = Arc::new(Recording { recorder: Recorder::new(self.capacity, self.seed), class: self.class });
        self.scene.get().world().start_recording(Arc::clone(&recording))?;
        let profile = Py::new(py, Profile(Mutex::new(None)))?;
        *self.entered.lock().unwrap_or_else(PoisonError::into_inner) = Some((profile.clone_ref(py), recording));
        Ok(profile)
    }

    /// Ends recording. Waits for batches that other threads began within the block.
    #[pyo3(signature = (*exception))]
    fn __exit__(&self, py: Python<'_>, exception: &Bound<'_, PyTuple>) -> PyResult<()> {
        // Whatever went wrong in the block goes on from here.
        let _ = exception;
        let entered = self.entered.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (profile, mut recording) = entered.ok_or_else(|| PyValueError::new_err("record: it was not entered"))?;
        self.scene.get().world().stop_recording();
        loop {
            match Arc::try_unwrap(recording) {
                Ok(all) => break profile.get().finish(all.recorder.into_profile()),
                Err(in_use) => recording = in_use,
            }
            py.check_signals()?;
            py.detach(|| std::thread::sleep(Duration::from_millis(1)));
        }
        Ok(())
    }
}
