//! Builds all kinds of trees for scenes in all ways, and compares them and their answers in every bit:
//! `cargo run --release -p rdh-study --example identical -- [--scenes DIR] [--specs LIST] [SCENE…]`
//!
//! Without names: the embedded scenes and those of the folder. Large scenes get fewer kinds of trees. `cargo xtask deep identical` runs it.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use rdh::Spec;
use rdh_scene::{Entry, catalog};
use rdh_study::identical::{Comparison, FAMILIES, LARGE_FAMILIES, compare};

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

/// Whether everything was the same.
fn run() -> Result<bool, String> {
    let wanted = Wanted::parse(std::env::args().skip(1))?;
    let (mut same, mut scenes, mut trees, mut answers) = (true, 0, 0, 0);
    for entry in wanted.entries()? {
        let start = Instant::now();
        let compared = compare(&entry, wanted.comparison(&entry)).map_err(|e| format!("{}: {e}", entry.id))?;
        println!(
            "{}: {} triangles, {} trees, {} rays, {} by brute force, {} answers, {:.1} s: {}",
            entry.id,
            entry.triangles,
            compared.trees,
            compared.rays,
            compared.by_brute_force,
            compared.answers,
            start.elapsed().as_secs_f64(),
            if compared.faults.is_empty() { "the same" } else { "NOT THE SAME" },
        );
        compared.faults.iter().for_each(|fault| println!("  {fault}"));
        same &= compared.faults.is_empty();
        (scenes, trees, answers) = (scenes + 1, trees + compared.trees, answers + compared.answers);
    }
    println!("in all: {trees} trees and {answers} answers of {scenes} scenes");
    Ok(same)
}

struct Wanted {
    scenes: Option<PathBuf>,
    names: Vec<String>,
    comparison: Comparison,
    large: Comparison,
}

/// From so many triangles on a scene is large.
const LARGE: usize = 1_000_000;

impl Wanted {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let list = |text: &str| Spec::list(text).map_err(|e| e.to_string());
        let comparison = Comparison { specs: list(FAMILIES)?, threads: vec![1, 2, 7, 16], size: 64, pairs: 50_000_000 };
        let large = Comparison { specs: list(LARGE_FAMILIES)?, ..comparison.clone() };
        let mut wanted = Self { scenes: None, names: Vec::new(), comparison, large };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            match &argument[..] {
                "--scenes" => wanted.scenes = Some(value()?.into()),
                "--specs" => {
                    wanted.comparison.specs = list(&value()?)?;
                    wanted.large.specs = wanted.comparison.specs.clone();
                }
                name if name.starts_with('-') => return Err(format!("{name} is unknown")),
                name => wanted.names.push(name.to_owned()),
            }
        }
        Ok(wanted)
    }

    fn comparison(&self, entry: &Entry) -> &Comparison {
        if entry.triangles < LARGE { &self.comparison } else { &self.large }
    }

    fn entries(&self) -> Result<Vec<Entry>, String> {
        let indexed = self.scenes.as_deref().map(catalog::indexed).transpose().map_err(|e| e.to_string())?;
        let indexed = indexed.unwrap_or_default();
        if self.names.is_empty() {
            let embedded = catalog::embedded().map_err(|e| e.to_string())?;
            return Ok(embedded.into_iter().chain(indexed).collect());
        }
        self.names.iter().map(|name| catalog::find(name, &indexed).map_err(|e| e.to_string())).collect()
    }
}
