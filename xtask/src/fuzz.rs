//! Runs the fuzz targets of `fuzz/`, some side by side, and says how far each came.

use std::process::{Command, Stdio};
use std::sync::Mutex;

use anyhow::{Context, Result, bail};
use serde_json::json;

use crate::reliability::{Verdict, found, grouped, keep_found};

/// Fuzz everything that reads or builds.
#[derive(Debug, clap::Parser)]
pub(crate) struct Arguments {
    /// Targets; all of them if none is named.
    targets: Vec<String>,
    /// Seconds a target.
    #[arg(long, default_value_t = 60)]
    secs: u64,
    /// How many targets run side by side, on a core each.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
}

/// What one target came to.
struct Outcome {
    target: String,
    runs: u64,
    is_clean: bool,
}

/// Whether there is what it takes.
pub(crate) fn is_possible() -> bool {
    answers("cargo", &["+nightly", "fuzz", "--version"])
}

/// Whether no target found anything.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    if !is_possible() {
        bail!("nightly Rust and cargo-fuzz are needed: rustup toolchain install nightly; cargo install cargo-fuzz");
    }
    build()?;
    let mut targets = if arguments.targets.is_empty() { all()? } else { arguments.targets.clone() };
    targets.reverse();
    println!("| target | runs | result |\n|---|---|---|");
    let mut outcomes = side_by_side(Mutex::new(targets), arguments)?;
    outcomes.sort_by(|a, b| a.target.cmp(&b.target));
    let is_clean = outcomes.iter().all(|outcome| outcome.is_clean);
    keep_sums(&outcomes, arguments.secs)?;
    Ok(is_clean)
}

/// Adds to what was tried before, target by target; where something was found, all was tried in vain.
fn keep_sums(outcomes: &[Outcome], secs: u64) -> Result<()> {
    let mut sums = found("fuzz")?.unwrap_or_default();
    for Outcome { target, runs, is_clean } in outcomes {
        let before = |key: &str| sums[target][key].as_u64().filter(|_| sums[target]["is_clean"] == true).unwrap_or(0);
        sums[target] = json!({ "secs": before("secs") + secs, "runs": before("runs") + runs, "is_clean": is_clean });
    }
    let all = || sums.as_object().into_iter().flat_map(|targets| targets.values());
    let sum = |key: &str| all().filter_map(|came| came[key].as_u64()).sum::<u64>();
    let hours = sum("secs") as f64 / 3600.0;
    let count = format!("{} targets, {hours:.1} hours, {} inputs, as below", all().count(), grouped(sum("runs")));
    let is_clean = all().all(|came| came["is_clean"] == true);
    let verdict = if is_clean { Verdict::Fine } else { Verdict::Failed("see fuzz/artifacts") };
    keep_found("fuzz", &count, &verdict, sums)
}

/// All targets together first, so that those side by side do not wait for each other's compiling.
fn build() -> Result<()> {
    let status = Command::new("cargo").args(["+nightly", "fuzz", "build"]).status()?;
    if !status.success() {
        bail!("cargo fuzz build failed");
    }
    Ok(())
}

/// Takes targets from the end of the list until none is left.
fn side_by_side(targets: Mutex<Vec<String>>, arguments: &Arguments) -> Result<Vec<Outcome>> {
    let work = || -> Result<Vec<Outcome>> {
        let mut outcomes = Vec::new();
        loop {
            let Some(target) = targets.lock().expect("no thread panics with the list").pop() else {
                return Ok(outcomes);
            };
            let outcome = fuzz(target, arguments.secs)?;
            let verdict = if outcome.is_clean { "nothing found" } else { "FAILED: see fuzz/artifacts" };
            println!("| {} | {} | {verdict} |", outcome.target, outcome.runs);
            outcomes.push(outcome);
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..arguments.jobs.max(1)).map(|_| scope.spawn(work)).collect();
        let results: Result<Vec<Vec<Outcome>>> =
            workers.into_iter().map(|worker| worker.join().expect("a worker does not panic")).collect();
        Ok(results?.into_iter().flatten().collect())
    })
}

fn all() -> Result<Vec<String>> {
    let output = Command::new("cargo").args(["+nightly", "fuzz", "list"]).stderr(Stdio::inherit()).output()?;
    if !output.status.success() {
        bail!("cargo fuzz list failed: run this in the repository");
    }
    Ok(String::from_utf8(output.stdout)?.lines().map(str::to_owned).collect())
}

/// How many inputs were tried, and whether none was bad. An input may take 10 s, by a clock that runs on where the
/// target waits for its core: a target that starves finds hangs which are none.
fn fuzz(target: String, secs: u64) -> Result<Outcome> {
    let time = format!("-max_total_time={secs}");
    let output = Command::new("cargo")
        .args([
            "+nightly",
            "fuzz",
            "run",
            &target,
            "--",
            &time,
            "-timeout=10",
            "-rss_limit_mb=2048",
            "-print_final_stats=1",
        ])
        .output()
        .with_context(|| format!("fuzzing {target}"))?;
    let log = String::from_utf8_lossy(&output.stderr);
    let runs = log.lines().find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
    let Some(runs) = runs.and_then(|n| n.trim().parse().ok()) else {
        bail!("{target} did not run:\n{log}");
    };
    if !output.status.success() {
        eprintln!("{log}");
    }
    Ok(Outcome { target, runs, is_clean: output.status.success() })
}

/// Whether a program is there and content.
fn answers(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}
