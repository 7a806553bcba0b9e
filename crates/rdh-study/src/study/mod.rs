//! A whole study: experiments over scenes, views and modes, as jobs that can be interrupted and shared out.
//!
//! ```text
//!  merge        the parts of a study, joined and checked
//!  runner       jobs one by one, each safe in the log before the next begins
//!  log          one checksummed record a line
//!  plan, shard  what a study is made of, and which part of it is whose
//!  experiment   the questions, one file each: which jobs, and how one is done
//!  bound        optimal trees, and searches for better ones
//!  coverage     how much of where new rays go is known
//!  skeleton     a kd-tree taken apart
//!  lines        uniform lines
//!  lab          a scene made ready, its rays, its structures, the instruments
//!  scope        which scenes, views and modes there are
//!  record       what one job found: a line of the log
//! ```

pub mod bound;
pub mod choice;
pub mod coverage;
pub mod experiment;
pub mod lab;
pub mod lines;
pub mod log;
pub mod merge;
pub mod plan;
pub mod record;
pub mod runner;
pub mod scope;
pub mod shard;
pub mod skeleton;

pub use experiment::{EXPERIMENTS, Experiment};
pub use lab::{Entrant, Lab, Setting};
pub use merge::{Merged, merge};
pub use plan::StudyPlan;
pub use record::{Job, Record};
pub use runner::{Course, Progress, run};
pub use scope::{Sample, Scope};
pub use shard::Shard;
