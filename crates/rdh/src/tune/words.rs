//! Why one was taken, in a sentence.

use super::evidence::{Comparison, Evidence, Measure, Outcome, Trial};
use crate::spec::Spec;

/// Why `evidence.spec` was taken. `best` is what the cheapest structure for the rays has to show, if any reached the last rung.
pub(super) fn verdict(evidence: &Evidence, best: Option<&Trial>) -> String {
    let what = match evidence.measure {
        Measure::Counts => "cost in steps and tests",
        Measure::Time => "time",
    };
    let held = format!("{:.0} % sure over {} tried", 100.0 * (1.0 - evidence.risk), evidence.tried);
    let shown = |c: &Comparison| match c.interval {
        Some([low, high]) => format!("{:.3} ({low:.3} to {high:.3}, {held})", c.ratio),
        None => format!("{:.3} (without a bound)", c.ratio),
    };
    let (spec, base) = (evidence.spec, evidence.base);
    if evidence.outcome == Outcome::Rays {
        let comparison = evidence.taken().and_then(|trial| trial.comparison.as_ref());
        let ratio = comparison.map_or_else(String::new, shown);
        return format!("{spec} takes {ratio} of the {what} of {base}, the best by areas, on rays it wasn't built for");
    }
    let least = if evidence.margin > 0.0 {
        format!("surely below {:.2}", 1.0 - evidence.margin)
    } else {
        "surely below 1".to_owned()
    };
    match best.and_then(|trial| Some((trial.spec, trial.comparison.as_ref()?))) {
        Some((other, comparison)) => {
            format!("{base} is kept: {other} would take {} of its {what}, which is not {least}", shown(comparison))
        }
        None if evidence.tried == 0 => format!("{base} is the best by areas; no structure for rays was to be tried"),
        None => format!("{base} is kept: no structure for rays could be built"),
    }
}

/// Why nothing was chosen.
pub(super) fn too_few(doubt: &str, spec: &Spec) -> String {
    format!("{doubt}; {spec} is kept")
}
