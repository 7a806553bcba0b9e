//! Studies: which rays an application casts, what they cost in each structure, and whether a difference is one.
//!
//! ```text
//!  report       records as one page of HTML
//!  bench        our structures and other libraries' side by side
//!  builds       what builds cost on one thread and two
//!  audit        choices of tune, judged on unseen rays
//!  identical    the same bits from all structures, levels and numbers of threads
//!  soak         rays without end from inside closed meshes
//!  study        experiments as jobs, interrupted and shared out
//!  verify       a finished structure beside brute force
//!  summary      ratios to a base, with intervals
//!  stats        means, medians, bootstrap
//!  run          all cases of a plan, row by row
//!  measure      counts and times of finished structures
//!  plan         what is to be run, as plain data
//!  integrate    scenes and views -> rays of each class; pictures
//! ```
//! Each layer uses only those below it.

pub mod audit;
pub mod bench;
pub mod builds;
pub mod clock;
pub mod error;
pub mod identical;
pub mod integrate;
pub mod measure;
pub mod plan;
pub mod report;
pub mod rows;
pub mod run;
pub mod soak;
pub mod stats;
pub mod study;
pub mod summary;
pub mod verify;

pub use error::{Error, Result};
pub use integrate::{Lens, Mode, RayBatch, Shoot, Stage, path_counts, radiance};
pub use plan::{Case, Plan, Protocol, Source, Target};
pub use rows::{Curve, Document, Failure, Mismatch, Over, Row, Summary, Verdict};
pub use run::{Event, run, run_loading};
pub use summary::{summarise, summarise_settings};
