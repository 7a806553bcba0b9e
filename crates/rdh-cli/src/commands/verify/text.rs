//! What was found out, in words.

use rdh::Profile;
use rdh::tune::Comparison;

use super::{Race, Verified};

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
    lines.extend(verified.drift.iter().map(|d| d.text("the rays that it was made for")));
    match unseen {
        None => lines.push("not raced: there are no unseen rays".to_owned()),
        Some(_) if races.is_empty() => lines.push("not raced: it is built by areas itself".to_owned()),
        Some(_) => lines.extend(races.iter().map(race_line)),
    }
    lines.join("\n") + "\n"
}

fn race_line(race: &Race) -> String {
    let base = &race.base;
    let Some(found) = &race.found else { return format!("not raced against {base}: there are too few unseen rays") };
    let verdict = if race.slower { "slower than" } else { "not slower than" };
    let shown = |c: &Comparison| {
        let interval = c.interval.map_or_else(|| "no bound".to_owned(), |[low, high]| format!("{low:.2} to {high:.2}"));
        format!("{:.2} ({interval})", c.ratio)
    };
    let time = found.time.as_ref().map_or_else(String::new, |time| format!(", {} of the time", shown(time)));
    let counts = shown(&found.counts);
    format!("{verdict} {base} on {} unseen rays: {counts} of the cost in steps and tests{time}", found.rays)
}

/// Why the tree is refused.
pub(super) fn verdict(verified: &Verified) -> String {
    let file = &verified.file;
    if !verified.faults.is_empty() {
        return format!("{file} is not well-formed");
    }
    let wrong = verified.brute_force.as_ref().is_some_and(|b| b.different > 0);
    match verified.races.iter().find(|race| race.slower) {
        _ if wrong => format!("{file} gives wrong answers"),
        Some(race) => format!("{file} is slower than {}", race.base),
        None => format!("{file} was not proved"),
    }
}
