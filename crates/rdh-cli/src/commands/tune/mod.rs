//! `rdh tune`: the structure that suits the rays, with the evidence.

mod case;
mod tables;

use anyhow::{Error, Result};
use rdh::Spec;
use rdh::tune::CANDIDATES;
use rdh_study::Target;
use serde::Serialize;
use serde_json::{Value, json};

use self::case::{Case, Source};
use crate::args::TuneArgs;
use crate::context::Context;
use crate::exit::{Disagreement, usage};
use crate::output::{print, print_json};
use crate::pick::Shelf;
use crate::staged::Staged;

/// What could not be chosen.
#[derive(Debug, Serialize)]
struct Failure {
    scene: String,
    view: Option<String>,
    mode: Option<String>,
    reason: String,
}

/// What all cases found.
#[derive(Debug, Default, Serialize)]
struct Document {
    version: u32,
    cases: Vec<Case>,
    failures: Vec<Failure>,
}

/// Tunes each view and mode, and prints what was found.
pub(crate) fn run(args: &TuneArgs, context: &Context) -> Result<()> {
    if args.list {
        return list(context);
    }
    let candidates = candidates(args)?;
    let sources = sources(args)?;
    let targets = targets(args, context)?;
    let mut document = Document { version: 1, ..Document::default() };
    let views =
        |target: &Target| if target.views.is_empty() { target.entry.views.len().max(1) } else { target.views.len() };
    let bar = context.bar((targets.iter().map(views).sum::<usize>() * sources.len()) as u64);
    for target in &targets {
        bar.set_message(target.entry.id.clone());
        let staged = match Staged::load_all(target) {
            Ok(staged) => staged,
            // One scene that was asked for by name fails as every command does.
            Err(error) if targets.len() == 1 => return Err(error),
            Err(error) => {
                document.failures.push(failure(&target.entry.id, None, None, &error));
                continue;
            }
        };
        for staged in &staged {
            for source in &sources {
                bar.set_message(format!("{} {}", staged.name(), source.name()));
                match case::tune(staged, source, &candidates, args, context) {
                    Ok(case) => document.cases.push(case),
                    Err(error) if targets.len() * sources.len() == 1 => return Err(error),
                    Err(error) => {
                        let view = Some(staged.view.name.clone());
                        document.failures.push(failure(&staged.scene, view, Some(source.name()), &error));
                    }
                }
                bar.inc(1);
            }
        }
    }
    bar.finish_and_clear();
    let risk = rdh::TuneOptions::default().risk / document.cases.len().max(1) as f64;
    document.cases.iter_mut().for_each(|case| case.judge(risk));
    if context.json {
        print_json(&document)?;
    } else {
        print(&tables::text(&document, &context.styles))?;
    }
    verdict(&document)
}

fn candidates(args: &TuneArgs) -> Result<Vec<Spec>> {
    let given = args.candidates.as_deref().map(Spec::list).transpose().map_err(|e| usage(e.to_string()))?;
    let candidates = given.unwrap_or_else(Spec::candidates);
    // What the library would say, too, but only after the rays are recorded.
    if candidates.contains(&Spec::AUTO) {
        return Err(usage("'auto' is the choice itself, not a candidate"));
    }
    if candidates.iter().all(Spec::needs_rays) {
        return Err(usage("a candidate is needed that needs no rays, such as bvh8+sah, to be compared with"));
    }
    Ok(candidates)
}

fn sources(args: &TuneArgs) -> Result<Vec<Source>> {
    match &args.rays {
        Some(file) => {
            let profile = super::rays::read(file)?;
            let settings: Value = serde_json::from_str(profile.settings())?;
            // A part of a split would be split again, into one part and two empty ones; and unseen rays must stay unseen.
            if let Some(set) = settings["set"]["name"].as_str() {
                let name = file.display();
                return Err(usage(format!("{name} is the {set} set of a split; tune splits the whole profile itself")));
            }
            Ok(vec![Source::File(file.clone(), Box::new(profile))])
        }
        None => Ok(args.mode.iter().map(|&mode| Source::Mode(mode)).collect()),
    }
}

fn targets(args: &TuneArgs, context: &Context) -> Result<Vec<Target>> {
    let shelf = Shelf::open(context.folder.as_deref())?;
    let single = args.rays.is_some() || args.output.is_some();
    match args.names.as_slice() {
        _ if args.output.is_some() && args.mode.len() != 1 => Err(usage("--output is for one mode")),
        [name] if single => Ok(vec![shelf.find_view(name, None)?]),
        _ if single => Err(usage("--rays and --output are for one scene: name it")),
        [] => Ok(shelf.usual()),
        names => names.iter().map(|name| shelf.find(name)).collect(),
    }
}

fn failure(scene: &str, view: Option<String>, mode: Option<String>, error: &Error) -> Failure {
    let reason = format!("{error:#}");
    tracing::error!("{scene}: {reason}");
    Failure { scene: scene.to_owned(), view, mode, reason }
}

/// Wrong choices are worse than cases that could not be run.
fn verdict(document: &Document) -> Result<()> {
    let slower = document.cases.iter().filter(|case| case.slower).count();
    match (slower, document.failures.len()) {
        (0, 0) => Ok(()),
        (0, failed) => Err(anyhow::anyhow!("{failed} of the cases could not be run")),
        (slower, _) => Err(Error::new(Disagreement(format!(
            "in {slower} of {} cases what was chosen is surely slower on unseen rays than without rays",
            document.cases.len()
        )))),
    }
}

fn list(context: &Context) -> Result<()> {
    if context.json {
        let all: Vec<_> = CANDIDATES.iter().map(|c| json!({ "spec": c.spec, "why": c.why })).collect();
        return print_json(&json!({ "version": 1, "candidates": all }));
    }
    print(&CANDIDATES.iter().map(|c| format!("{:16}  {}\n", c.spec, c.why)).collect::<String>())
}
