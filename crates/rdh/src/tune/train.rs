//! Building candidates, one after the other; what can't be built is told.

use std::sync::atomic::{AtomicBool, Ordering};

use super::options::{Clock, TuneOptions};
use crate::accel::{self, Accel};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::rays::Training;
use crate::spec::Spec;

/// What candidates are built from.
#[derive(Clone, Copy)]
pub(super) struct Workshop<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) candidates: &'a [Spec],
    pub(super) training: &'a Training,
    pub(super) options: &'a TuneOptions<'a>,
    pub(super) clock: Option<Clock<'a>>,
}

/// What became of a build.
pub(super) struct Build {
    /// The structure, or why there is none.
    pub(super) accel: Result<Accel>,
    /// How long it took, if there is a clock.
    pub(super) secs: Option<f64>,
}

impl Workshop<'_> {
    /// Builds a candidate within the limits.
    ///
    /// # Errors
    /// Only that the caller has cancelled everything; what else goes wrong is part of the outcome.
    pub(super) fn build(&self, spec: &Spec) -> Result<Build> {
        let late = AtomicBool::new(false);
        let start = self.clock.map(|clock| clock());
        let secs = || Some(self.clock?().saturating_sub(start?) as f64 * 1e-9);
        let given = self.options.build.cancel;
        let cancel = || {
            if self.options.max_build_secs.zip(secs()).is_some_and(|(most, secs)| secs > most) {
                late.store(true, Ordering::Relaxed);
            }
            late.load(Ordering::Relaxed) || given.is_some_and(|cancel| cancel())
        };
        let options = BuildOptions { cancel: Some(&cancel), ..self.options.build };
        let accel = match accel::build(self.mesh, spec, self.training, &options) {
            Err(Error::Cancelled) if late.load(Ordering::Relaxed) => {
                Err(Error::TooSlow { spec: spec.to_string(), secs: self.options.max_build_secs.unwrap_or_default() })
            }
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            other => other,
        };
        Ok(Build { accel, secs: secs() })
    }
}
