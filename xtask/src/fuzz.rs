//! Runs the fuzz targets of `fuzz/` one after another, and says how far each came.

use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::reliability::{Verdict, grouped, keep};

/// Fuzz everything that reads or builds.
#[derive(Debug, clap::Parser)]
pub(crate) struct Arguments {
    /// Targets; all of them if none is named.
    targets: Vec<String>,
    /// Seconds a target.
    #[arg(long, default_value_t = 60)]
    secs: u64,
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
    let targets = if arguments.targets.is_empty() { all()? } else { arguments.targets.clone() };
    println!("| target | runs | result |\n|---|---|---|");
    let (mut clean, mut counts) = (true, Vec::new());
    for target in targets {
        let (runs, passed) = fuzz(&target, arguments.secs)?;
        counts.push(format!("{target} {}", grouped(runs)));
        println!("| {target} | {runs} | {} |", if passed { "nothing found" } else { "FAILED: see fuzz/artifacts" });
        clean &= passed;
    }
    let count = format!("{} s each; runs: {}", arguments.secs, counts.join(", "));
    keep("fuzz", &count, &if clean { Verdict::Fine } else { Verdict::Failed("see fuzz/artifacts") })?;
    Ok(clean)
}

fn all() -> Result<Vec<String>> {
    let output = Command::new("cargo").args(["+nightly", "fuzz", "list"]).stderr(Stdio::inherit()).output()?;
    if !output.status.success() {
        bail!("cargo fuzz list failed: run this in the repository");
    }
    Ok(String::from_utf8(output.stdout)?.lines().map(str::to_owned).collect())
}

/// How many inputs were tried, and whether none was bad.
fn fuzz(target: &str, secs: u64) -> Result<(u64, bool)> {
    let time = format!("-max_total_time={secs}");
    let output = Command::new("cargo")
        .args([
            "+nightly",
            "fuzz",
            "run",
            target,
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
    Ok((runs, output.status.success()))
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
