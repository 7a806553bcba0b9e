//! What was found out, in words.

use rdh::Profile;
use rdh_study::verify::Race;

use super::Verified;

/// A line for each proof.
pub(super) fn text(verified: &Verified, unseen: Option<&Profile>) -> String {
    let Verified { file, stats, faults, brute_force, races, .. } = verified;
    let mut lines = vec![format!("{file}: {} over {} triangles", stats.spec, stats.triangles)];
    match faults.len() {
        0 => lines.push(format!("well-formed: {} nodes, {} references", stats.nodes, stats.references)),
        _ => lines.extend(faults.iter().take(10).map(|fault| format!("fault: {fault}"))),
    }
    if let Some(agreement) = brute_force {
        lines.push(match &agreement.first {
            None => format!("right: {} rays agree with brute force bit for bit", agreement.rays),
            Some(first) => format!("wrong: {} of {} rays, the first: {first}", agreement.different, agreement.rays),
        });
    }
    match unseen {
        None => lines.push("not raced: there are no unseen rays".to_owned()),
        Some(_) if races.is_empty() => lines.push("not raced: it is built by areas itself".to_owned()),
        Some(_) => lines.extend(races.iter().map(race_line)),
    }
    lines.join("\n") + "\n"
}

fn race_line(race: &Race) -> String {
    let Race { base, rays, steps_ratio, tests_ratio, .. } = race;
    let verdict = if race.slower { "slower than" } else { "not slower than" };
    let time = match (race.time_ratio, race.time_ratio_ci95) {
        (Some(ratio), Some([low, high])) => format!(", time {ratio:.2} ({low:.2}–{high:.2})"),
        _ => String::new(),
    };
    format!("{verdict} {base} on {rays} unseen rays: steps {steps_ratio:.2}, tests {tests_ratio:.2}{time}")
}

/// Why the tree is refused.
pub(super) fn verdict(verified: &Verified) -> String {
    let file = &verified.file;
    if !verified.faults.is_empty() {
        return format!("{file} is not well-formed");
    }
    let wrong = verified.brute_force.as_ref().is_some_and(|b| b.different > 0);
    match verified.races.iter().find(|race| race.slower) {
        _ if wrong || verified.races.iter().any(|race| race.different > 0) => format!("{file} gives wrong answers"),
        Some(race) => format!("{file} is slower than {}", race.base),
        None => format!("{file} was not proved"),
    }
}
