//! A whole study: experiments over scenes, views and modes, as jobs that can be interrupted and shared out.

pub mod bound;
pub mod record;

pub use record::{Curve, Job, Record};
