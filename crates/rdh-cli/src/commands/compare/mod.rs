//! `rdh compare`: the same rays through every spec's structure.

mod tables;
mod watch;

use anyhow::{Error, Result};
use rdh::Spec;
use rdh_study::{Document, Plan, Target, Verdict, run as run_plan};

use self::watch::Watch;
use crate::args::CompareArgs;
use crate::context::Context;
use crate::exit::{Disagreement, usage};
use crate::output::{print, print_json};
use crate::pick::Shelf;

/// Runs the comparison and prints it, as a table or as JSON.
pub(crate) fn run(args: &CompareArgs, context: &Context) -> Result<()> {
    let plan = plan(args, context)?;
    plan.check().map_err(|e| usage(e.to_string()))?;
    check_subset(&args.subset, &plan, context)?;
    let mut watch = Watch::new(&plan, context);
    let document = run_plan(&plan, &mut |event| watch.see(event))?;
    watch.finish();
    if context.json {
        print_json(&document)?;
    } else {
        print(&tables::text(&document, &plan, &args.subset, &context.styles))?;
    }
    verdict(&document)
}

/// What is meant by the arguments.
fn plan(args: &CompareArgs, context: &Context) -> Result<Plan> {
    let shelf = Shelf::open(context.folder.as_deref())?;
    let mut plan = Plan {
        targets: args.names.iter().map(|name| shelf.find(name)).collect::<Result<_>>()?,
        modes: args.mode.clone(),
        protocol: args.protocol,
        rrs: args.rrs.clone(),
        seed: context.seed,
        threads: context.threads,
        ..Plan::default()
    };
    if plan.targets.is_empty() {
        plan.targets = shelf.usual();
    }
    if args.first {
        plan.targets = plan.targets.into_iter().map(first_view).collect();
    }
    if let Some(specs) = &args.spec {
        plan.specs = Spec::list(specs).map_err(|e| usage(e.to_string()))?;
    }
    if let Some(size) = args.size {
        plan.size = [size.width, size.height];
    }
    if let Some(rounds) = args.rounds {
        (plan.rounds, plan.small_rounds) = (rounds, rounds);
    }
    plan.training = args.training.unwrap_or(plan.training);
    Ok(plan)
}

/// A scene without views in its index has one alone: an overview.
fn first_view(mut target: Target) -> Target {
    if target.views.is_empty() {
        target.views.extend(target.entry.views.first().map(|view| view.name.clone()));
    }
    target
}

/// The table has it, and each of its scenes is run.
fn check_subset(subset: &[String], plan: &Plan, context: &Context) -> Result<()> {
    if context.json && !subset.is_empty() {
        return Err(usage(
            "--subset sums up rows of the table; with --json they are there to be chosen from".to_owned(),
        ));
    }
    match subset.iter().find(|id| plan.targets.iter().all(|target| target.entry.id != **id)) {
        Some(id) => Err(usage(format!("--subset: '{id}' is none of the scenes"))),
        None => Ok(()),
    }
}

/// Nothing is worse than wrong answers; then comes what could not be run.
fn verdict(document: &Document) -> Result<()> {
    match document.verdict() {
        Verdict::Fine => Ok(()),
        Verdict::Failed => Err(anyhow::anyhow!("{} of the cases could not be run", document.failures.len())),
        Verdict::Mismatch => {
            let count = document.mismatches.len();
            Err(Error::new(Disagreement(format!("structures disagree in {count} cases: none of their times count"))))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exit;

    fn code(failures: &str, mismatches: &str) -> std::process::ExitCode {
        let text = format!(r#"{{"version":1,"rows":[],"summary":[],"failures":{failures},"mismatches":{mismatches}}}"#);
        exit::code(verdict(&serde_json::from_str(&text).unwrap()))
    }

    #[test]
    fn wrong_answers_are_worse_than_failures_and_both_are_told_by_the_exit_code() {
        let failure = r#"[{"scene":"s","view":null,"spec":null,"reason":"unreadable"}]"#;
        let mismatch = r#"[{"scene":"s","view":"v","mode":"primary","class":"primary","spec":"kd+rdh","base":"kd+sah",
            "rays":1,"first_ray":0,"ray":[0,0,0,0,0,1],"t_max":null,"answer":[1.0,3],"base_answer":null}]"#;
        assert_eq!(code("[]", "[]"), std::process::ExitCode::SUCCESS);
        assert_eq!(code(failure, "[]"), 1.into());
        assert_eq!(code("[]", mismatch), 3.into());
        assert_eq!(code(failure, mismatch), 3.into());
    }
}
