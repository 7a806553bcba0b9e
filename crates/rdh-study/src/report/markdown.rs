//! The effects of every experiment as tables in Markdown, for documents.

use super::effect::Effect;
use super::pairs::Metric;
use super::table::{Group, Key, group};
use super::view::Study;
use super::words::digits;

const KEYS: [Key; 5] = [Key::Mode, Key::Class, Key::Setting, Key::Spec, Key::Base];
const METRICS: [Metric; 7] =
    [Metric::Steps, Metric::Tests, Metric::Time, Metric::Worst, Metric::Build, Metric::BuildAndRays, Metric::Bytes];

/// One table an experiment.
pub(super) fn tables(study: &Study<'_>) -> String {
    let mut text = String::new();
    for experiment in study.experiments() {
        // A mode of one class is its own total.
        let pairs = study.pairs(experiment);
        let pairs: Vec<_> = pairs.into_iter().filter(|p| p.class.is_none() || p.job.mode.classes().len() > 1).collect();
        if !pairs.is_empty() {
            text += &format!(
                "## {experiment}\n\n{}{}\n",
                heads(),
                group(&pairs, &KEYS).iter().map(line).collect::<String>()
            );
        }
    }
    text
}

fn heads() -> String {
    let names = ["rays", "class", "setting", "spec", "base", "pairs"].into_iter().chain(METRICS.map(Metric::name));
    let names: Vec<&str> = names.chain(["slower"]).collect();
    let rules: Vec<&str> = (0..names.len()).map(|i| if i < KEYS.len() { "---" } else { "--:" }).collect();
    format!("| {} |\n|{}|\n", names.join(" | "), rules.join("|"))
}

fn line(g: &Group<'_, '_>) -> String {
    let effect = |m: Metric| Effect::of(g.pairs.iter().copied(), m);
    let mut cells: Vec<String> = g.labels.iter().map(|l| l.replace('|', "\\|")).collect();
    cells.push(g.pairs.len().to_string());
    cells.extend(METRICS.map(|m| effect(m).map_or_else(|| "–".to_owned(), |e| cell(&e))));
    cells.push(effect(Metric::Time).map_or(0, |e| e.losses).to_string());
    format!("| {} |\n", cells.join(" | "))
}

fn cell(effect: &Effect) -> String {
    let [low, high] = effect.interval.map(digits);
    if effect.n > 1 { format!("{} ({low}–{high})", digits(effect.mean)) } else { digits(effect.mean) }
}
