//! How it was measured, on what, and how to do it again.

use maud::{Markup, html};

use super::super::view::Study;
use super::super::words;
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter { id: "methods", title: "How it was measured", question: "", write };

fn write(study: &Study<'_>) -> Option<Section> {
    let body = html! {
        (rules())
        (facts(study))
        h3 { "To do it again" }
        @for command in &study.about.commands { pre tabindex="0" { code { (command) } } }
        p { "Counts come out the same from the same seed on any machine of one platform; times are those of the machine named above." }
    };
    Some(Section { findings: Vec::new(), body })
}

fn rules() -> Markup {
    html! {
        ul {
            li { "Steps are interior nodes and leaves visited, tests are triangles in the leaves visited; both are exact. They come from a counting copy of the very traversal that is timed." }
            li { "Time is CPU time of one thread. Structures take turns in every round; a pair’s time is the median over rounds." }
            li { "Every ray’s answer is compared with that of the base before any time counts." }
            li { "Training rays and test rays are different rays: other positions on the film, another seed, unless an experiment says otherwise." }
            li { "Ratios are paired on the same rays, and averaged geometrically. Intervals are percentile bootstraps of 2,000 resamples that draw whole scenes, because views of one scene are alike." }
            li { "The base is the tuned tree by areas, built by the same code with the same constants, unless a table names another." }
        }
    }
}

fn facts(study: &Study<'_>) -> Markup {
    let about = study.about;
    let seeds: std::collections::BTreeSet<u64> = study.records.iter().flat_map(|r| &r.rows).map(|r| r.seed).collect();
    let seeds = words::list(&seeds.iter().map(u64::to_string).collect::<Vec<_>>());
    let mut facts: Vec<(&str, String)> = vec![
        ("Machine", about.machine.clone()),
        ("Program", format!("rdh {}", about.version)),
        ("Seed", seeds),
        ("Report made", about.date.clone()),
        ("Scenes, views", format!("{}, {}", study.scenes().len(), study.views().len())),
        ("Jobs", words::grouped(study.records.len() as f64)),
    ];
    facts.extend(about.settings.iter().map(|(name, value)| (name.as_str(), value.clone())));
    html! {
        dl.facts { @for (name, value) in facts.iter().filter(|f| !f.1.is_empty()) { div { dt { (name) } dd { (value) } } } }
    }
}
