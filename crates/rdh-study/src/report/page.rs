//! The page around the sections: head, title, summary, contents.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::sections::{CHAPTERS, Chapter, Section, glance};
use super::table::{legend, table};
use super::view::Study;
use super::words;
use crate::rows::{Failure, Mismatch};

/// The whole document. No script, nothing from elsewhere: the one style sheet is inside.
pub(super) fn page(study: &Study<'_>) -> String {
    let written: Vec<(&Chapter, Option<Section>)> = CHAPTERS.iter().map(|c| (c, (c.write)(study))).collect();
    let there: Vec<(&Chapter, &Section)> = written.iter().filter_map(|(c, s)| Some((*c, s.as_ref()?))).collect();
    let missing: Vec<String> =
        written.iter().filter(|w| w.1.is_none() && !w.0.question.is_empty()).map(|w| w.0.title.to_owned()).collect();
    let document = html! {
        (DOCTYPE)
        html lang="en" {
            (head())
            body {
                main {
                    (title(study))
                    (faults(study))
                    (question())
                    (summary(study, &there))
                    (contents(&there, &missing))
                    @for (i, (chapter, section)) in there.iter().enumerate() { (write(i + 1, chapter, section)) }
                    (foot(study))
                }
            }
        }
    };
    document.into_string()
}

const TITLE: &str = "What does a tree gain that knows the rays?";

fn head() -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta name="viewport" content="width=device-width, initial-scale=1";
            meta name="color-scheme" content="light dark";
            title { (TITLE) }
            link rel="icon" href="data:,";
            style { (PreEscaped(include_str!("style.css"))) }
        }
    }
}

fn title(study: &Study<'_>) -> Markup {
    let about = study.about;
    html! {
        header {
            h1 { (TITLE) }
            p.subtitle { "Kd-trees by surface areas and by sampled rays, measured" }
            p.meta {
                (words::count(study.scenes().len(), "scene")) " · " (words::count(study.views().len(), "view")) " · "
                (words::count(study.records.len(), "job"))
                @if !about.version.is_empty() { " · rdh " (about.version) }
                @if !about.date.is_empty() { " · " (about.date) }
            }
        }
    }
}

/// Wrong answers and failures come before all results.
fn faults(study: &Study<'_>) -> Markup {
    let mismatches: Vec<&Mismatch> = study.records.iter().flat_map(|r| &r.mismatches).collect();
    let failures: Vec<&Failure> = study.records.iter().flat_map(|r| &r.failures).collect();
    let mismatch_row = |m: &&Mismatch| {
        vec![
            html! { (m.scene) ":" (m.view) },
            html! { (m.mode) " " (m.class.name()) },
            html! { code { (m.spec) } },
            html! { (m.rays) },
        ]
    };
    let failure_row = |f: &&Failure| {
        let spec = f.spec.map(|s| s.to_string()).unwrap_or_default();
        vec![
            html! { (f.scene) @if let Some(view) = &f.view { ":" (view) } },
            html! { code { (spec) } },
            html! { (f.reason) },
        ]
    };
    html! {
        @if study.about.missing > 0 {
            div.fault role="alert" { strong { "The study is not complete: " (words::count(study.about.missing, "job")) " of it are missing." } }
        }
        @if !mismatches.is_empty() {
            div.fault role="alert" {
                strong { "Structures disagree in " (words::count(mismatches.len(), "case")) ": none of their times count." }
                (table("Answers that differ", &["view", "rays", "spec", ">rays that differ"], &mismatches.iter().take(20).map(mismatch_row).collect::<Vec<_>>()))
            }
        }
        @if !failures.is_empty() {
            div.fault role="alert" {
                strong { (words::count(failures.len(), "case")) " could not be run." }
                (table("What could not be run", &["view", "spec", "why"], &failures.iter().take(20).map(failure_row).collect::<Vec<_>>()))
            }
        }
    }
}

fn question() -> Markup {
    html! {
        section #question {
            h2 { "What was asked" }
            p {
                "A kd-tree finds what a ray hits by visiting boxes. How it is split decides how many. The " em { "surface area heuristic" }
                " (SAH) takes the area of a box for the chance that a ray visits it. That is right for rays which are spread evenly over all lines, "
                "and which nothing stops. Real rays begin at a camera or on a surface, go where a picture needs them, and end at the first thing in "
                "their way."
            }
            p {
                "The " em { "ray distribution heuristic" } " (RDH; J. Bittner and V. Havran, SCCG 2009) counts a sample of the rays that are really cast "
                "instead. It costs something to have such a sample and to count with it. This study asks what it gives: how many steps, tests and "
                "nanoseconds a ray, against a base that was tuned with the same care, on rays that the builder has not seen."
            }
        }
    }
}

/// A picture of the main result, and the first finding of every section that asks something.
fn summary(study: &Study<'_>, sections: &[(&Chapter, &Section)]) -> Markup {
    let found: Vec<_> = sections.iter().filter_map(|(c, s)| Some((c, s.findings.first()?))).collect();
    html! {
        @if !found.is_empty() {
            section #summary.summary {
                h2 { "In short" }
                (glance(study))
                (legend())
                ul { @for (chapter, finding) in found { li { a href=(format!("#{}", chapter.id)) { (chapter.title) } (finding) "." } } }
            }
        }
    }
}

fn contents(sections: &[(&Chapter, &Section)], missing: &[String]) -> Markup {
    html! {
        nav aria-label="Contents" {
            h2 { "Contents" }
            ol { @for (chapter, _) in sections { li { a href=(format!("#{}", chapter.id)) { (chapter.title) } } } }
            @if !missing.is_empty() { p.note { "Not in these data, so left out: " (words::list(missing)) "." } }
        }
    }
}

fn write(number: usize, chapter: &Chapter, section: &Section) -> Markup {
    html! {
        section id=(chapter.id) {
            h2 { span.number { (number) } " " (chapter.title) }
            @if !chapter.question.is_empty() { p.question { (chapter.question) } }
            @match section.findings.as_slice() {
                [] => {}
                [one] => p.finding { (one) "." }
                many => ul.finding { @for finding in many { li { (finding) "." } } }
            }
            (section.body)
        }
    }
}

fn foot(study: &Study<'_>) -> Markup {
    html! {
        footer {
            p { "Made by " code { "rdh report" } @if !study.about.date.is_empty() { " on " (study.about.date) } ". Everything on this page is in this file." }
        }
    }
}
