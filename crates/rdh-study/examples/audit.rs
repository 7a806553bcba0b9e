//! Asks `tune` for a choice on all scenes, for each class of rays and for profiles that make no sense, and judges it on unseen rays:
//! `cargo run --release -p rdh-study --example audit -- [--scenes DIR] [--times] [--views N] [--size N] [--up-to TRIANGLES] [SCENE…]`
//!
//! Without names: the embedded scenes and those of the folder, up to so many triangles. Exit code 3 if a choice was wrong.
//! `cargo xtask deep audit` runs it.

use std::path::PathBuf;
use std::process::ExitCode;

use rdh::tune::{Comparison, Outcome};
use rdh_scene::{Entry, catalog};
use rdh_study::audit::{Audit, Finding, audit, each_risk};
use rdh_study::stats::geometric_mean;

/// Of one wrong verdict in the whole audit.
const RISK: f64 = 0.05;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(3),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether all choices were right.
fn run() -> Result<bool, String> {
    let wanted = Wanted::parse(std::env::args().skip(1))?;
    let mut findings = Vec::new();
    println!("| scene:view | rays | judged by | taken | held out | unseen, of the best by areas | |");
    println!("|---|---|---|---|---|---|---|");
    for entry in wanted.entries()? {
        audit(&entry, &wanted.audit, &mut |finding| {
            println!("{}", row(&finding));
            findings.push(finding);
        })
        .map_err(|e| format!("{}: {e}", entry.id))?;
    }
    println!("\n{}", summary(&findings));
    let risk = each_risk(&findings, RISK);
    let mut violations = Vec::new();
    for finding in &findings {
        let named = |violation| format!("{}, {}: {violation}", finding.place, finding.rays);
        violations.extend(finding.violations(risk).into_iter().map(named));
    }
    violations.iter().for_each(|violation| println!("VIOLATION: {violation}"));
    Ok(violations.is_empty())
}

fn row(finding: &Finding) -> String {
    let Finding { place, rays, sets, taken, held_out, warned, faults, .. } = finding;
    let taken = taken.map_or_else(|| "nothing".to_owned(), |(spec, outcome)| format!("`{spec}`{}", mark(outcome)));
    let ratio = |c: &Comparison| match c.interval {
        Some([low, high]) => format!("{:.3} ({low:.3}–{high:.3})", c.ratio),
        None => format!("{:.3}", c.ratio),
    };
    let promised = held_out.as_ref().map_or_else(String::new, ratio);
    let found = finding.hardest().map_or_else(String::new, |c| format!("{} `{}`", ratio(c), c.base));
    let warned = warned.map_or_else(String::new, |drift| format!("drift {drift:.2} "));
    format!("| {place} | {rays} | {} | {taken} | {promised} | {found} | {warned}{} |", sets[2], faults.join("; "))
}

fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::TooFewRays => ", too few rays",
        Outcome::Rays | Outcome::Areas => "",
    }
}

fn summary(findings: &[Finding]) -> String {
    let ended = |wanted| findings.iter().filter(move |f| f.taken.is_some_and(|(_, outcome)| outcome == wanted));
    let unseen: Vec<f64> = ended(Outcome::Rays).filter(|f| f.warned.is_none()).filter_map(ratio).collect();
    let comparisons: usize = findings.iter().map(|f| f.unseen.len()).sum();
    let worst = unseen.iter().copied().fold(0.0, f64::max);
    format!(
        "in all: {} choices, {} for the rays (on unseen ones {:.3} of the best by areas in the geometric mean, {worst:.3} at worst), {} by \
         areas, {} with too few rays; {comparisons} comparisons, each at a risk of {:.1e}",
        findings.len(),
        ended(Outcome::Rays).count(),
        geometric_mean(&unseen),
        ended(Outcome::Areas).count(),
        ended(Outcome::TooFewRays).count(),
        each_risk(findings, RISK),
    )
}

fn ratio(finding: &Finding) -> Option<f64> {
    finding.hardest().map(|comparison| comparison.ratio)
}

struct Wanted {
    scenes: Option<PathBuf>,
    names: Vec<String>,
    up_to: usize,
    audit: Audit,
}

impl Wanted {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut wanted = Self { scenes: None, names: Vec::new(), up_to: 1_000_000, audit: Audit::default() };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            let number = |text: String| text.parse::<usize>().map_err(|e| format!("{argument} {text}: {e}"));
            match &argument[..] {
                "--scenes" => wanted.scenes = Some(value()?.into()),
                "--times" => wanted.audit.by_time = true,
                "--views" => wanted.audit.views = number(value()?)?,
                "--size" => wanted.audit.size = number(value()?)?.clamp(16, 4096),
                "--up-to" => wanted.up_to = number(value()?)?,
                name if name.starts_with('-') => return Err(format!("{name} is unknown")),
                name => wanted.names.push(name.to_owned()),
            }
        }
        Ok(wanted)
    }

    fn entries(&self) -> Result<Vec<Entry>, String> {
        let indexed = self.scenes.as_deref().map(catalog::indexed).transpose().map_err(|e| e.to_string())?;
        let indexed = indexed.unwrap_or_default();
        if self.names.is_empty() {
            let embedded = catalog::embedded().map_err(|e| e.to_string())?;
            return Ok(embedded.into_iter().chain(indexed).filter(|entry| entry.triangles <= self.up_to).collect());
        }
        self.names.iter().map(|name| catalog::find(name, &indexed).map_err(|e| e.to_string())).collect()
    }
}
