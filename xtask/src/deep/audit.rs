//! What `tune` chooses for all scenes and classes of rays, and for profiles that make no sense, judged on unseen rays: by counts, and by
//! time where that is asked for.

use anyhow::Result;

use super::{Arguments, Outcome, example, outcome};

pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let by_counts = outcome(&mut example("audit", arguments), None)?;
    match by_counts {
        Outcome::Fine(_) if arguments.times => outcome(example("audit", arguments).arg("--times"), None),
        other => Ok(other),
    }
}
