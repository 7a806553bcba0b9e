//! What a choice may cost, and what it is for.

use crate::error::{Error, Result};
use crate::options::BuildOptions;
use crate::rays::RayClass;

/// Says the time in nanoseconds, from an arbitrary start. CPU time of the calling thread is best for times of rays; builds on
/// several threads are timed right only by a clock of the whole process, or of the wall.
pub type Clock<'a> = &'a (dyn Fn() -> u64 + Sync);

/// Limits and aims of [`tune`](crate::tune()).
#[derive(Clone, Copy)]
pub struct TuneOptions<'a> {
    /// What each candidate's build may use. `max_bytes` is the memory limit: a candidate that needs more is out, a kd-tree gets by
    /// with larger leaves.
    pub build: BuildOptions<'a>,
    /// At most so many seconds for each build, by the clock, without which there can't be such a limit. `None`: no limit.
    pub max_build_secs: Option<f64>,
    /// What a ray of each class counts, in the order of [`RayClass::ALL`]; 1 for all: as often as they are cast. A class of
    /// weight 0 decides nothing.
    pub class_weights: [f64; 8],
    /// The chance to take a structure that is slower than the best one by areas, over all that are tried together: 0.05.
    pub risk: f64,
    /// By so much the winner must be faster, at least, where time decides: what no interval can see, such as the luck of where
    /// memory lies. 0.02 is what times of equal trees scatter by (docs/measurements.md).
    pub margin: f64,
    /// How often the last ones are timed, in turn; the best time of each run of rays counts. 15.
    pub rounds: usize,
}

impl Default for TuneOptions<'_> {
    fn default() -> Self {
        Self {
            build: BuildOptions::default(),
            max_build_secs: None,
            class_weights: [1.0; 8],
            risk: 0.05,
            margin: 0.02,
            rounds: 15,
        }
    }
}

impl std::fmt::Debug for TuneOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { max_build_secs, class_weights, risk, margin, rounds, .. } = self;
        write!(
            f,
            "TuneOptions({max_build_secs:?} s, weights {class_weights:?}, risk {risk}, margin {margin}, {rounds} rounds)"
        )
    }
}

impl TuneOptions<'_> {
    /// Refuses what makes no sense.
    pub(super) fn check(&self, clock: bool) -> Result<()> {
        let fail = |reason: String| Err(Error::Tuning { reason });
        if let Some(i) = self.class_weights.iter().position(|w| !(0.0..=1e9).contains(w)) {
            let (class, weight) = (RayClass::ALL[i].name(), self.class_weights[i]);
            return fail(format!("class weight {class}={weight}: a number from 0 to 1e9 is needed"));
        }
        if self.class_weights.iter().all(|&w| w == 0.0) {
            return fail("all class weights are 0".to_owned());
        }
        if !(1e-6..=0.5).contains(&self.risk) {
            return fail(format!("risk {}: a number from 1e-6 to 0.5 is needed", self.risk));
        }
        if !(0.0..=0.5).contains(&self.margin) {
            return fail(format!("margin {}: a number from 0 to 0.5 is needed", self.margin));
        }
        if !(1..=1000).contains(&self.rounds) {
            return fail(format!("{} rounds: 1 to 1000 are possible", self.rounds));
        }
        match self.max_build_secs {
            Some(secs) if !(secs >= 0.0) => fail(format!("a limit of {secs} build seconds: 0 or more are needed")),
            Some(_) if !clock => fail("a limit of build seconds needs a clock".to_owned()),
            _ => Ok(()),
        }
    }
}
