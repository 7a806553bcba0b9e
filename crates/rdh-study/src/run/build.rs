//! Builds of a scene's structures, timed.

use rdh::{BuildOptions, Spec, Training};

use super::{Event, Prepared, Study};
use crate::clock::time_process;
use crate::stats::median;

/// A finished structure and what it took.
pub(super) struct Built {
    pub(super) spec: Spec,
    pub(super) accel: rdh::Accel,
    pub(super) build_secs: f64,
}

impl Study<'_, '_> {
    /// Builds some specs, several times and interleaved in small scenes. Those that fail are told and left out.
    pub(super) fn build_all(
        &mut self,
        on: &Prepared<'_>,
        view: Option<&str>,
        specs: &[Spec],
        training: &Training,
    ) -> Vec<Built> {
        let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
        let mut accels: Vec<Option<rdh::Accel>> = specs.iter().map(|_| None).collect();
        let mut secs = vec![Vec::new(); specs.len()];
        let mut failed = vec![false; specs.len()];
        for round in 0..self.plan.builds_for(on.stage.mesh().len()) {
            for turn in 0..specs.len() {
                let i = (turn + round) % specs.len();
                if failed[i] {
                    continue;
                }
                // The old one goes first: two of a large scene's trees would not fit.
                accels[i] = None;
                match time_process(|| rdh::build(on.stage.mesh(), &specs[i], training, &options)) {
                    (Ok(accel), time) => {
                        accels[i] = Some(accel);
                        secs[i].push(time);
                    }
                    (Err(error), _) => {
                        failed[i] = true;
                        self.fail_case(on, view, Some(specs[i]), error.to_string());
                    }
                }
            }
        }
        let finished = specs
            .iter()
            .zip(accels)
            .zip(&secs)
            .filter_map(|((&spec, accel), secs)| Some(Built { spec, accel: accel?, build_secs: median(secs) }));
        let finished: Vec<Built> = finished.collect();
        for built in &finished {
            let scene = &on.target.entry.id;
            (self.observer)(&Event::Built { scene, spec: built.spec, secs: built.build_secs });
        }
        finished
    }
}
