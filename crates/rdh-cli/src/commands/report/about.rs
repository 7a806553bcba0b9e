//! What a page says of its figures' origin: machine, date, commands, settings.

use std::collections::BTreeSet;
use std::time::{SystemTime, UNIX_EPOCH};

use rdh_scene::Entry;
use rdh_study::Mode;
use rdh_study::report::About;
use rdh_study::study::{EXPERIMENTS, Merged, StudyPlan};
use time::OffsetDateTime;

use crate::args::ReportArgs;
use crate::machine;

/// Everything but the pictures.
pub(super) fn about(args: &ReportArgs, merged: &Merged, embedded: &[Entry]) -> About {
    let plan = &merged.plan;
    About {
        date: SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or_else(|_| String::new(), |t| date(t.as_secs() / 86_400)),
        version: plan.program.clone(),
        machine: args.machine.clone().unwrap_or_else(|| machines(merged)),
        commands: vec![study_command(plan, embedded), "rdh report study".to_owned()],
        settings: settings(plan),
        missing: merged.missing.len(),
        pictures: Vec::new(),
    }
}

/// Those that measured; this one if the records don't say.
fn machines(merged: &Merged) -> String {
    let names: BTreeSet<&str> = merged.records.iter().filter_map(|r| r.machine.as_deref()).collect();
    if names.is_empty() { machine::name() } else { names.into_iter().collect::<Vec<_>>().join("; ") }
}

/// The command that makes the study again; what is usual is left out.
fn study_command(plan: &StudyPlan, embedded: &[Entry]) -> String {
    let [width, height] = plan.size;
    let usual = StudyPlan::usual(plan.quick);
    let modes = plan.modes.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
    let parts = [
        (true, scene_arguments(plan, embedded)),
        (plan.quick, " --quick".to_owned()),
        (plan.experiments.len() < EXPERIMENTS.len(), format!(" --experiment {}", plan.experiments.join(","))),
        (plan.modes.len() < Mode::ALL.len(), format!(" --mode {modes}")),
        (plan.size != usual.size, format!(" --size {width}x{height}")),
        (plan.training != usual.training, format!(" --training {}", plan.training)),
        (plan.rounds[0] != usual.rounds, format!(" --rounds {}", plan.rounds[0])),
        (true, format!(" --seed {} --out study", plan.seed)),
    ];
    "rdh study".to_owned() + &parts.into_iter().filter(|p| p.0).map(|p| p.1).collect::<String>()
}

/// Nothing for all embedded scenes, a folder if others are there too, else their names.
fn scene_arguments(plan: &StudyPlan, embedded: &[Entry]) -> String {
    let has = |id: &str| plan.scenes.iter().any(|(scene, _)| scene == id);
    match (embedded.iter().all(|e| has(&e.id)), plan.scenes.len() > embedded.len()) {
        (true, false) => String::new(),
        (true, true) => " --scenes DIR".to_owned(),
        (false, _) => {
            let others = plan.scenes.iter().any(|(id, _)| embedded.iter().all(|e| e.id != *id));
            // Parameters stand in brackets, which shells take for something else.
            let quoted = |id: &String| if id.contains('(') { format!(" '{id}'") } else { format!(" {id}") };
            let names: String = plan.scenes.iter().map(|(id, _)| quoted(id)).collect();
            if others { format!("{names} --scenes DIR") } else { names }
        }
    }
}

fn settings(plan: &StudyPlan) -> Vec<(String, String)> {
    let [width, height] = plan.size;
    let [large, small] = plan.rounds;
    let rounds = if large == small { large.to_string() } else { format!("{large}, {small} in small scenes") };
    let modes = plan.modes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let facts = [
        ("Film", format!("{width} × {height} test rays a view and mode")),
        ("Training rays a view", plan.training.to_string()),
        ("Timing rounds", rounds),
        ("Experiments", plan.experiments.join(", ")),
        ("Rays", modes),
    ];
    facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// The date, from the days since 1970-01-01; nothing beyond the year 9999.
fn date(days: u64) -> String {
    let secs = i64::try_from(days.saturating_mul(86_400)).unwrap_or(i64::MAX);
    OffsetDateTime::from_unix_timestamp(secs).map_or_else(|_| String::new(), |time| time.date().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        let dates = [0, 59, 60, 11_016, 11_017, 19_782, 20_454].map(date);
        let expected =
            ["1970-01-01", "1970-03-01", "1970-03-02", "2000-02-29", "2000-03-01", "2024-02-29", "2026-01-01"];
        assert_eq!(dates, expected);
    }
}
