//! The race: our structures and other libraries' on the same rays, answers compared before times.
//!
//! ```text
//!  summary      ours against each base, over all scenes; builds
//!  log          what is found out, appended to a file as it comes
//!  race         one scene, group by group
//!  track        its rays and our structures
//!  heat         one column, one group: answers, then rounds
//!  lanes        who races: the running engines, in groups that fit into memory, and ours
//!  verify       answers compared ray by ray
//!  process      an engine that runs: requests and answers
//!  memory       how much of it engines may use
//!  registry     the competitors that are known, and their modes
//!  plan         what is raced, as plain data
//!  rows         what is found out, as plain data
//!  columns      the kinds of rays
//!  files        meshes, rays and answers, as engines/README.md has them
//! ```

mod columns;
pub(crate) mod files;
mod heat;
mod lanes;
mod log;
mod memory;
mod plan;
pub(crate) mod process;
mod race;
mod registry;
mod rows;
mod summary;
mod track;
mod verify;

use crate::error::{Error, Result};
use race::Race;

pub use columns::Column;
pub(crate) use columns::{Film, Frame};
pub use log::Log;
pub use plan::BenchPlan;
pub use registry::{Form, Pace, Queries, Registration, known_engines};
pub use rows::{
    BenchDocument, BenchFailure, BenchRow, BenchSummary, BuildSummary, Profile, Record, SameRays, Settings, Skipped,
};

/// What happens while a race runs.
#[derive(Debug)]
#[non_exhaustive]
pub enum BenchEvent<'a> {
    /// A scene is loaded; so many are done.
    Scene {
        /// Scene and view, as `koala:front`.
        place: &'a str,
        /// How many triangles it has.
        triangles: usize,
        /// Scenes that are through.
        done: usize,
        /// All scenes.
        total: usize,
    },
    /// A structure is built.
    Built {
        /// Scene and view.
        place: &'a str,
        /// Its name in tables.
        engine: &'a str,
        /// One thread's CPU time.
        secs: f64,
        /// Bytes of the structure and the triangles that it needs.
        bytes: u64,
    },
    /// A competitor is not there.
    Skipped(&'a Skipped),
    /// Something could not be measured.
    Failed(&'a BenchFailure),
    /// A column of a scene is through.
    Done(&'a Record),
}

/// Races what is planned; what is recorded already is taken from there.
///
/// # Errors
/// A plan that asks for nothing or for nonsense, or no place for the files. What goes wrong with one scene or one engine is
/// in the document, and the others go on.
pub fn bench(plan: &BenchPlan, recorded: &[Record], see: &mut dyn FnMut(&BenchEvent<'_>)) -> Result<BenchDocument> {
    plan.check()?;
    let folder = tempfile::tempdir().map_err(|e| Error::Plan(format!("there is no place for the rays' files: {e}")))?;
    let mut document = BenchDocument::new(plan, recorded);
    for (done, target) in plan.targets.iter().enumerate() {
        let (failures, skipped) = (Vec::new(), Vec::new());
        let mut race = Race {
            plan,
            target,
            folder: folder.path(),
            done,
            document: &mut document,
            see: &mut *see,
            failures,
            skipped,
        };
        race.run(recorded);
    }
    document.summarise();
    Ok(document)
}
