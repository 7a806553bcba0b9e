//! `cargo xtask study`: a study in parts side by side, and its page and tables in `docs/study`.

use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use anyhow::{Context, Result, ensure};

/// Run a study in parts side by side, and put its page and tables into docs/study.
///
/// Goes on with what target/study/NAME holds; remove that folder to measure anew. Every part works on one thread, so that there should be
/// no more parts than cores.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// What the files are called: docs/study/NAME.md and, unless --no-page is given, NAME.html
    name: String,
    /// How many parts run at the same time
    #[arg(long, default_value_t = 2)]
    parts: usize,
    /// Make the tables alone: of scenes whose pictures may not be given away
    #[arg(long)]
    no_page: bool,
    /// Arguments of `rdh study`: scenes, --scenes DIR, --experiment NAME, …
    #[arg(last = true)]
    rest: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("the tasks have no place")?;
    let target = crate::target()?;
    let folder = target.join("study").join(&arguments.name);
    let rdh = build(root, &target)?;
    let parts = (1..=arguments.parts).map(|part| start(&rdh, arguments, part, &folder));
    // All are started before one is waited for.
    for (i, mut part) in parts.collect::<Result<Vec<Child>>>()?.into_iter().enumerate() {
        let status = part.wait()?;
        ensure!(status.success(), "part {}: {status}", i + 1);
    }
    let output = root.join("docs/study");
    std::fs::create_dir_all(&output)?;
    let page =
        if arguments.no_page { folder.join("report.html") } else { output.join(format!("{}.html", arguments.name)) };
    let mut report = Command::new(&rdh);
    report.arg("report").arg(&folder).arg("-o").arg(page);
    report.arg("--markdown").arg(output.join(format!("{}.md", arguments.name)));
    let scenes = arguments.rest.iter().position(|a| a == "--scenes").and_then(|i| arguments.rest.get(i + 1));
    report.args(scenes.iter().flat_map(|dir| ["--scenes", dir]));
    if arguments.no_page {
        report.arg("--no-pictures");
    }
    let status = report.status()?;
    ensure!(status.success(), "rdh report: {status}");
    Ok(())
}

/// The program, built as users build it.
fn build(root: &Path, target: &Path) -> Result<PathBuf> {
    let status = Command::new("cargo").args(["build", "--release", "-p", "rdh-cli"]).current_dir(root).status()?;
    ensure!(status.success(), "cargo build: {status}");
    Ok(target.join("release/rdh"))
}

fn start(rdh: &Path, arguments: &Arguments, part: usize, folder: &Path) -> Result<Child> {
    let mut command = Command::new(rdh);
    command.args(["study", "--resume", "--threads", "1", "--shard", &format!("{part}/{}", arguments.parts)]);
    command.arg("--out").arg(folder).args(&arguments.rest);
    command.spawn().with_context(|| rdh.display().to_string())
}
