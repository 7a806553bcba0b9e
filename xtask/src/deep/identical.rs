//! All kinds of trees, built in all ways for all scenes, and their answers at every level, compared in every bit.

use anyhow::Result;

use super::{Arguments, Outcome, example, outcome};

pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    outcome(&mut example("identical", arguments), Some("in all:"))
}
