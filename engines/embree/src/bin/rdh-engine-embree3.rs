//! Embree 3 as a competitor.

use std::process::ExitCode;

fn main() -> ExitCode {
    rdh_engine_embree::serve_embree3()
}
