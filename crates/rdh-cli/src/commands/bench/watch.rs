//! Progress of a race, on standard error.

use indicatif::ProgressBar;
use rdh_study::bench::{BenchEvent, BenchPlan};

use crate::context::Context;

/// A bar with a step a column of a scene, and the log.
#[derive(Debug)]
pub(super) struct Watch {
    bar: ProgressBar,
    columns: usize,
}

impl Watch {
    pub(super) fn new(plan: &BenchPlan, context: &Context) -> Self {
        let columns = plan.columns.len();
        Self { bar: context.bar((plan.targets.len() * columns) as u64), columns }
    }

    pub(super) fn see(&mut self, event: &BenchEvent<'_>) {
        match event {
            BenchEvent::Scene { place, triangles, done, .. } => {
                self.bar.set_position((done * self.columns) as u64);
                self.bar.set_message((*place).to_owned());
                tracing::info!("{place}: {triangles} triangles");
            }
            BenchEvent::Built { place, engine, secs, bytes } => {
                self.bar.set_message(format!("{place} {engine}"));
                tracing::info!("{place}: {engine} built in {secs:.2} s, {:.1} MB", *bytes as f64 / 1e6);
            }
            BenchEvent::Skipped(skipped) => tracing::warn!("{}: skipped: {}", skipped.engine, skipped.reason),
            BenchEvent::Failed(failure) => {
                let engine = failure.engine.as_ref().map_or_else(String::new, |e| format!(" {e}"));
                tracing::error!("{}{engine}: {}", failure.scene, failure.reason);
            }
            BenchEvent::Done(record) => {
                self.bar.inc(1);
                for row in record.rows.iter().filter(|row| !row.agrees) {
                    tracing::error!(
                        "{}:{} {}: {} loses {} hits, has {} too many, and {} elsewhere: its times don't count",
                        row.scene,
                        row.view,
                        row.column.name(),
                        row.engine,
                        row.lost,
                        row.extra,
                        row.differ
                    );
                }
            }
            _ => {}
        }
    }

    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}
