//! Progress of a comparison, on standard error.

use indicatif::ProgressBar;
use rdh_study::{Event, Plan};

use crate::context::Context;

/// A bar with a step a case, and the log.
#[derive(Debug)]
pub(super) struct Watch {
    bar: ProgressBar,
}

impl Watch {
    pub(super) fn new(plan: &Plan, context: &Context) -> Self {
        Self { bar: context.bar(plan.cases().len() as u64) }
    }

    pub(super) fn see(&mut self, event: &Event<'_>) {
        match event {
            Event::Loaded { scene, triangles, notes, .. } => {
                self.bar.set_message((*scene).to_owned());
                tracing::info!("{scene}: {triangles} triangles");
                for note in *notes {
                    tracing::info!("{scene}: {} {}", note.count, note.what);
                }
            }
            Event::Started { case, done, total } => {
                self.bar.set_length(*total as u64);
                self.bar.set_position(*done as u64);
                self.bar.set_message(format!("{}:{} {}", case.scene, case.view, case.mode));
            }
            Event::Built { scene, spec, secs } => tracing::info!("{scene}: {spec} built in {secs:.2} s"),
            Event::Row(row) => tracing::debug!(
                "{}:{} {} {}: {:.1} steps, {:.1} tests, {:.0} ns",
                row.scene,
                row.view,
                row.class.name(),
                row.spec,
                row.steps_per_ray,
                row.tests_per_ray,
                row.nanos_per_ray
            ),
            Event::Failed(failure) => {
                let view = failure.view.as_ref().map_or_else(String::new, |v| format!(":{v}"));
                let spec = failure.spec.map_or_else(String::new, |s| format!(" {s}"));
                tracing::error!("{}{view}{spec}: {}", failure.scene, failure.reason);
            }
            Event::Mismatch(mismatch) => tracing::error!(
                "{}:{} {}: {} and {} give {} rays different answers, first ray {} ({:?}, t_max {:?}): {:?}, {:?}",
                mismatch.scene,
                mismatch.view,
                mismatch.class.name(),
                mismatch.spec,
                mismatch.base,
                mismatch.rays,
                mismatch.first_ray,
                mismatch.ray,
                mismatch.t_max,
                mismatch.answer,
                mismatch.base_answer
            ),
            _ => {}
        }
    }

    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}
