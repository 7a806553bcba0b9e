//! The report says what the records say, in one file that needs nothing else.

#[path = "report_parts/records.rs"]
mod records;

use rdh::RayClass;
use rdh_study::report::{About, Panel, Picture, Scale, html, markdown, views_to_show};
use rdh_study::study::Record;
use rdh_study::summary::summarise_settings;
use rdh_study::{Mode, Over};
use records::{SCENES, job, record, row, simple, study};

fn about() -> About {
    About {
        date: "2026-01-02".into(),
        version: "0.0.0".into(),
        machine: "a machine".into(),
        commands: vec!["rdh study --out a".into()],
        ..About::default()
    }
}

/// What eyes read: the page without tags and style, spaces of all kinds joined.
fn words(page: &str) -> String {
    let body = page.split_once("</style>").expect("a style sheet").1;
    let mut text = String::new();
    let mut inside = false;
    for c in body.chars() {
        match c {
            '<' => inside = true,
            '>' => {
                inside = false;
                text.push(' ');
            }
            // Keeps a line from breaking after a dash; nobody sees it.
            '\u{2060}' => {}
            c if !inside => text.push(c),
            _ => {}
        }
    }
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    [",", ".", ";", ":"].iter().fold(text, |t, mark| t.replace(&format!(" {mark}"), mark))
}

fn of_ratio(ratio: f64) -> Vec<Record> {
    let specs = [("kd+sah", 1.0), ("kd+rdh", ratio)];
    SCENES.iter().map(|s| simple(job("modes", s, "front", Mode::Primary), &specs)).collect()
}

#[test]
fn sentences_follow_the_data() {
    let said = |ratio| words(&html(&of_ratio(ratio), &about()));
    assert!(said(0.8).contains("Primary rays, kd+rdh against kd+sah: 20 % fewer steps (0.80, 0.80–0.80)"));
    assert!(said(0.8).contains("surely faster in 12 of them, surely slower in 0"));
    assert!(said(0.8).contains("None of 12 pairs is surely slower"));
    assert!(said(1.25).contains("Primary rays, kd+rdh against kd+sah: 25 % more steps"));
    assert!(said(1.25).contains("12 of 12 pairs are surely slower"));
    assert!(said(1.0).contains("kd+rdh against kd+sah: the same steps to within 1 %"));
}

#[test]
fn every_experiment_has_its_section_and_what_is_missing_is_said() {
    let page = html(&study(), &about());
    for id in [
        "paper",
        "rays",
        "kinds",
        "occlusion",
        "assumptions",
        "how-many",
        "which-rays",
        "blend",
        "termination",
        "controls",
        "bound",
        "costs",
        "aa",
        "losses",
        "scenes",
        "methods",
    ] {
        assert!(page.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
    let few = words(&html(&of_ratio(0.9), &about()));
    assert!(
        few.contains(
            "Not in these data, so left out: The paper’s rows, and ours, What it looks like, Gain against occlusion"
        ),
        "{few}"
    );
    assert!(words(&html(&[], &about())).contains("0 scenes · 0 views"));
}

#[test]
fn the_page_needs_nothing_from_elsewhere_and_is_small() {
    let page = html(&study(), &about());
    for foreign in ["<script", "http:", "https:", "url(", "@import", "src=\"/", "onload"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    for nonsense in ["NaN", "inf<", ">inf", "Some("] {
        assert!(!page.contains(nonsense), "{nonsense}");
    }
    assert!(page.len() < 2 << 20, "{} bytes", page.len());
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/report.html"), page).unwrap();
}

#[test]
fn every_plot_and_picture_says_what_it_shows() {
    let panel = Panel {
        title: "kd+sah".into(),
        says: "steps by areas".into(),
        png: vec![1, 2, 3],
        size: [4, 5],
        scale: Some(Scale { label: "steps".into(), ends: [0.0, 9.0], colours: vec![[0, 0, 0], [255, 255, 255]] }),
        ..Panel::default()
    };
    let picture = Picture { place: "balls4:front".into(), why: "the largest gain".into(), rows: vec![vec![panel]] };
    let page = html(&study(), &About { pictures: vec![picture], ..about() });
    assert_eq!(page.matches("<svg class=\"plot\"").count(), page.matches("role=\"img\" aria-label=").count());
    assert!(page.contains("src=\"data:image/png;base64,AQID\" width=\"4\" height=\"5\" alt=\"steps by areas\""));
}

#[test]
fn the_same_records_give_the_same_page() {
    assert_eq!(html(&study(), &about()), html(&study(), &about()));
}

#[test]
fn losses_are_listed_by_name() {
    let mut records = of_ratio(0.9);
    records.push(simple(job("modes", "rings7", "behind", Mode::Primary), &[("kd+sah", 1.0), ("kd+rdh", 1.2)]));
    let said = words(&html(&records, &about()));
    assert!(said.contains("1 of 13 pairs are surely slower"), "{said}");
    assert!(said.contains("rings7:behind interior primary kd+rdh 1.20"), "{said}");
}

#[test]
fn text_from_outside_is_escaped() {
    let hostile =
        simple(job("modes", "<script>alert(1)</script>", "\"v&", Mode::Primary), &[("kd+sah", 1.0), ("kd+rdh", 0.9)]);
    let page = html(&[hostile], &About { machine: "<b>".into(), ..about() });
    assert!(!page.contains("<script") && page.contains("&lt;script&gt;") && page.contains("&lt;b&gt;"));
}

#[test]
fn a_structure_twice_is_a_run_against_itself() {
    let at = job("aa", "balls4", "front", Mode::Primary);
    let rows = vec![row(&at, RayClass::Primary, "kd+sah", 1.0), row(&at, RayClass::Primary, "kd+sah", 1.0)];
    assert!(words(&html(&[record(at, rows)], &about())).contains("No difference, as it must be"));
}

#[test]
fn views_are_shown_for_their_gains_and_the_worst_one_too() {
    let shown = views_to_show(&study());
    let why: Vec<&str> = shown.iter().map(|s| s.why.split(':').next().unwrap()).collect();
    let largest = "the largest gain in steps among";
    let expected =
        [format!("{largest} dense scenes"), format!("{largest} interior scenes"), format!("{largest} open scenes")];
    assert_eq!(why[..3], expected);
    assert_eq!(why[3..], ["the least gain of all"]);
    assert!(["rooms", "quarter"].contains(&shown[0].scene.as_str()));
    assert!(views_to_show(&[]).is_empty());
}

#[test]
fn settings_have_bases_of_their_own() {
    let at = job("controls", "balls4", "front", Mode::Primary);
    let setting = |name: &str, base: f64, ratio: f64| {
        let rows = simple(at.clone(), &[("kd+sah", base), ("kd+rdh", base * ratio)]).rows;
        rows.into_iter().map(|r| rdh_study::Row { setting: Some(name.into()), ..r }).collect::<Vec<_>>()
    };
    let rows = [setting("once", 1.0, 0.9), setting("again", 2.0, 0.8)].concat();
    let tables = markdown(&[record(at, rows)]);
    assert!(tables.contains("| primary | all | once | kd+rdh | kd+sah | 1 | 0.90 |"), "{tables}");
    assert!(tables.contains("| primary | all | again | kd+rdh | kd+sah | 1 | 0.80 |"), "{tables}");
}

#[test]
fn kinds_of_scene_can_count_alike() {
    let specs = |ratio| [("kd+sah", 1.0), ("kd+rdh", ratio)];
    let of = |scene, ratio| simple(job("modes", scene, "front", Mode::Primary), &specs(ratio));
    // Three open scenes without a gain, a dense one at a half: the mean of all is 0.84, that of the kinds √0.5.
    let records = [of("balls4", 1.0), of("gears4", 1.0), of("tree11", 1.0), of("rooms", 0.5)];
    let said = words(&html(&records, &about()));
    assert!(said.contains("16 % fewer steps (0.84") || said.contains("no clear difference in steps (0.84"), "{said}");
    assert!(said.contains("each kind alike 4 0.71"), "{said}");
}

#[test]
fn the_reports_figures_are_those_of_the_summaries() {
    let records = study();
    let rows: Vec<_> = records.iter().flat_map(|r| r.rows.clone()).collect();
    let tables = markdown(&records);
    let mut compared = 0;
    for s in
        summarise_settings(&rows).iter().filter(|s| s.over == Over::Pairs && s.experiment.as_deref() == Some("modes"))
    {
        let class = s.class.filter(|_| s.mode.classes().len() > 1).map_or("all", RayClass::name);
        let start = format!("| {} | {class} |  | {} | {} | {} | ", s.mode, s.spec, s.base, s.n);
        let line = tables.lines().find(|l| l.starts_with(&start)).unwrap_or_else(|| panic!("no line {start}"));
        let cells: Vec<&str> = line[start.len()..].split(" | ").collect();
        let numbers = |cell: &str| -> Vec<f64> {
            cell.split(|c: char| !c.is_ascii_digit() && c != '.').filter_map(|n| n.parse().ok()).collect()
        };
        let [low, high] = s.time_ratio_ci95;
        let expected = [s.time_ratio, low, high];
        assert!(numbers(cells[2]).iter().zip(expected).all(|(a, b)| (a - b).abs() <= 0.0051), "{line}: {expected:?}");
        assert!(
            (numbers(cells[0])[0] - s.steps_ratio).abs() <= 0.0051
                && (numbers(cells[1])[0] - s.tests_ratio).abs() <= 0.0051
        );
        compared += 1;
    }
    assert!(compared >= 20, "{compared}");
}
