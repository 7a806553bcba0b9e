//! What a scene is made of, without Python: a structure over a mesh, where it lies, and who records.

use std::path::PathBuf;
use std::sync::{Arc, PoisonError, RwLock};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::ThreadPool;
use rdh::{Accel, BuildOptions, Hit, Mesh, Query, Ray, RayClass, Recorder, Spec, Training};

use crate::batch::supervise;
use crate::errors::from_library;

/// A structure over a mesh; the structure may be replaced by another one over the same mesh.
pub(crate) struct World {
    /// What `[0, 0, 0]` of the mesh is in world coordinates.
    pub(crate) origin: [f64; 3],
    current: RwLock<Current>,
    recording: RwLock<Option<Arc<Recording>>>,
}

#[derive(Clone)]
struct Current {
    accel: Arc<Accel>,
    /// Where it lies, if it is used there.
    file: Option<SavedFile>,
}

/// A file that holds a structure, and what tells it from any other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SavedFile {
    pub(crate) path: PathBuf,
    pub(crate) checksum: u64,
}

/// A recorder, and what its rays are for.
pub(crate) struct Recording {
    pub(crate) recorder: Recorder,
    pub(crate) class: RayClass,
}

/// What a batch of rays is cast through: it stays the same while the batch lasts, whatever others do to the scene.
pub(crate) struct Caster {
    pub(crate) accel: Arc<Accel>,
    recording: Option<Arc<Recording>>,
}

impl World {
    /// Over a finished structure, that of a file if one is named.
    pub(crate) fn new(accel: Accel, origin: [f64; 3], file: Option<SavedFile>) -> Self {
        let current = Current { accel: Arc::new(accel), file };
        Self { origin, current: RwLock::new(current), recording: RwLock::new(None) }
    }

    /// The structure as it is now.
    pub(crate) fn accel(&self) -> Arc<Accel> {
        self.current.read().unwrap_or_else(PoisonError::into_inner).accel.clone()
    }

    /// The file that the structure lies in, if it does.
    pub(crate) fn file(&self) -> Option<SavedFile> {
        self.current.read().unwrap_or_else(PoisonError::into_inner).file.clone()
    }

    /// Puts another structure over the same mesh in its place.
    pub(crate) fn replace(&self, accel: Accel) {
        *self.current.write().unwrap_or_else(PoisonError::into_inner) = Current { accel: Arc::new(accel), file: None };
    }

    /// What the next batch is cast through.
    pub(crate) fn caster(&self) -> Caster {
        let recording = self.recording.read().unwrap_or_else(PoisonError::into_inner).clone();
        Caster { accel: self.accel(), recording }
    }

    /// From now on all rays are recorded.
    ///
    /// # Errors
    /// `ValueError` if they are already.
    pub(crate) fn start_recording(&self, recording: Arc<Recording>) -> PyResult<()> {
        let mut current = self.recording.write().unwrap_or_else(PoisonError::into_inner);
        if current.is_some() {
            return Err(PyValueError::new_err("scene: its rays are being recorded already"));
        }
        *current = Some(recording);
        Ok(())
    }

    /// From now on no rays are recorded.
    pub(crate) fn stop_recording(&self) {
        *self.recording.write().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

/// Builds a structure, as [`supervise`] does its work.
///
/// # Errors
/// What the library says, or the signal's handler.
pub(crate) fn build(py: Python<'_>, pool: &ThreadPool, mesh: &Mesh, spec: &Spec, rays: &Training) -> PyResult<Accel> {
    let built = supervise(py, pool, |cancel| {
        let cancelled = || cancel.is_wanted();
        rdh::build(mesh, spec, rays, &BuildOptions { cancel: Some(&cancelled), ..BuildOptions::default() })
    })?;
    built.map_err(from_library)
}

impl Caster {
    /// The nearest hit of each ray.
    pub(crate) fn closest_many(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.ends(rays, hits, Query::Closest);
    }

    /// Whether each ray hits anything. While it is recorded, where the rays end is found out too: structures are built by that.
    pub(crate) fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        if self.recording.is_none() {
            return self.accel.occluded_many(rays, occluded);
        }
        let mut hits = Vec::new();
        self.ends(rays, &mut hits, Query::Occluded);
        occluded.iter_mut().zip(&hits).for_each(|(occluded, hit)| *occluded = hit.is_some());
    }

    /// Where rays end that are cast for a query.
    fn ends(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>, query: Query) {
        hits.clear();
        hits.resize(rays.len(), None);
        self.accel.closest_many(rays, hits);
        if let Some(recording) = &self.recording {
            rays.iter().zip(hits).for_each(|(ray, hit)| recording.note(ray, *hit, query));
        }
    }

    /// All hits, nearest first.
    #[inline(always)]
    pub(crate) fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        self.accel.all_hits(ray, hits);
        if let Some(recording) = &self.recording {
            recording.note(ray, hits.first().copied(), Query::All);
        }
    }
}

impl Recording {
    #[cold]
    fn note(&self, ray: &Ray, hit: Option<Hit>, query: Query) {
        self.recorder.record(ray, hit, query, self.class);
    }
}
