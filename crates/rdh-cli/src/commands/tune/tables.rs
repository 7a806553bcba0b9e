//! The tables that `rdh tune` prints: all that was tried, for a single case; a line each, for many.

use rdh::tune::{Comparison, Evidence, Measure, Outcome, Trial};

use super::Document;
use super::case::Case;
use crate::context::Styles;
use crate::summary::ratio_cell;
use crate::table::{Cell, Table};

/// What was found, and what it means.
pub(super) fn text(document: &Document, styles: &Styles) -> String {
    match document.cases.as_slice() {
        [] => "nothing was chosen\n".to_owned(),
        [case] if document.failures.is_empty() => single(case, styles),
        cases => many(cases, styles),
    }
}

fn single(case: &Case, styles: &Styles) -> String {
    let evidence = &case.evidence;
    let mut table = Table::new(&[
        "spec",
        ">build s",
        ">MB",
        ">steps",
        ">tests",
        ">counted ns",
        ">timed ns",
        ">ratio",
        "interval",
        ">gap",
        ">pays after",
        "  ",
    ]);
    for trial in &evidence.trials {
        table.push(trial_cells(trial, evidence, styles));
    }
    let rays = evidence.rays;
    let head = format!(
        "{}:{}, {} triangles, {} rays: {} to learn from, {} held out\n\n",
        case.scene, case.view, case.triangles, case.rays, rays.training, rays.held_out
    );
    format!("{head}{}\n{}.\n{}", table.text(styles.head), evidence.reason, unseen_text(case))
}

fn trial_cells(trial: &Trial, evidence: &Evidence, styles: &Styles) -> Vec<Cell> {
    let number = |x: Option<f64>, digits: usize| Cell::from(x.map_or_else(String::new, |x| format!("{x:.digits$}")));
    let last = trial.comparison.as_ref();
    vec![
        trial.spec.to_string().into(),
        number(trial.build_secs, 3),
        number(trial.bytes.map(|b| b as f64 / 1e6), 1),
        number(trial.steps_per_ray, 1),
        number(trial.tests_per_ray, 1),
        number(trial.nanos_per_ray(Measure::Counts), 0),
        number(trial.nanos_per_ray(Measure::Time), 0),
        last.map_or_else(|| "".into(), |c| ratio_cell(c.ratio, styles)),
        last.map_or_else(String::new, interval).into(),
        number(trial.gap, 3),
        number(trial.break_even_rays, 0),
        note(trial, evidence).into(),
    ]
}

/// What became of it.
fn note(trial: &Trial, evidence: &Evidence) -> String {
    if let Some(error) = &trial.error {
        return error.clone();
    }
    let last = trial.rungs.last().map(|rung| (rung.kept, rung.measure));
    match last {
        _ if trial.spec == evidence.spec => "taken".to_owned(),
        _ if trial.spec == evidence.base => "best by areas".to_owned(),
        Some((false, Measure::Counts)) => "out by counts".to_owned(),
        Some((false, Measure::Time)) => "out by time".to_owned(),
        _ => String::new(),
    }
}

fn interval(comparison: &Comparison) -> String {
    comparison.interval.map_or_else(|| "no bound".to_owned(), |[low, high]| format!("{low:.3} to {high:.3}"))
}

fn unseen_text(case: &Case) -> String {
    let Some(unseen) = &case.unseen else { return String::new() };
    let shown = |c: &Comparison| format!("{:.3} ({})", c.ratio, interval(c));
    let time = unseen.time.as_ref().map_or_else(String::new, |time| format!(", {} of the time", shown(time)));
    let counts = shown(&unseen.counts);
    let judgement = if case.slower { "; surely slower" } else { "" };
    format!("On {} unseen rays: {counts} of the cost in steps and tests{time}{judgement}.\n", unseen.rays)
}

fn many(cases: &[Case], styles: &Styles) -> String {
    let mut table = Table::new(&[
        "scene:view",
        "rays",
        "taken",
        "best by areas",
        ">held out",
        "interval",
        ">unseen: cost",
        "interval",
        ">time",
        "interval",
        "  ",
    ]);
    for case in cases {
        table.push(case_cells(case, styles));
    }
    let count = |outcome: Outcome| cases.iter().filter(|c| c.evidence.outcome == outcome).count();
    let slower = cases.iter().filter(|c| c.slower).count();
    format!(
        "{}\n{} cases: {} for the rays, {} by areas, {} with too few rays; {slower} surely slower on unseen rays.\n",
        table.text(styles.head),
        cases.len(),
        count(Outcome::Rays),
        count(Outcome::Areas),
        count(Outcome::TooFewRays),
    )
}

fn case_cells(case: &Case, styles: &Styles) -> Vec<Cell> {
    let evidence = &case.evidence;
    let pair = |c: Option<&Comparison>| match c {
        Some(c) => [ratio_cell(c.ratio, styles), interval(c).into()],
        None => ["".into(), "".into()],
    };
    let held_out = evidence.taken().and_then(|trial| trial.comparison.as_ref());
    let unseen = case.unseen.as_ref();
    let mut cells: Vec<Cell> = vec![
        format!("{}:{}", case.scene, case.view).into(),
        case.rays.clone().into(),
        evidence.spec.to_string().into(),
        evidence.base.to_string().into(),
    ];
    cells.extend(pair(held_out));
    cells.extend(pair(unseen.map(|u| &u.counts)));
    cells.extend(pair(unseen.and_then(|u| u.time.as_ref())));
    cells.push(if case.slower { "slower".into() } else { "".into() });
    cells
}
