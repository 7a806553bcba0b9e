//! A whole study: experiments over scenes, views and modes, as jobs that can be interrupted and shared out.
//!
//! ```text
//!  experiment   the questions, one file each: which jobs, and how one is done
//!  lab          a scene made ready, its rays, its structures, the instruments
//!  scope        which scenes, views and modes there are
//!  record       what one job found: a line of the log
//! ```

pub mod experiment;
pub mod lab;
pub mod record;
pub mod scope;

pub use experiment::{EXPERIMENTS, Experiment};
pub use lab::{Entrant, Lab, Setting};
pub use record::{Curve, Job, Record};
pub use scope::{Sample, Scope};
