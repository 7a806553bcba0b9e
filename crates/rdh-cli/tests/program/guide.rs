//! The guide's commands, run as they stand there; its code is an example that another test runs.

use std::fs;
use std::path::Path;

use crate::run::program;

const GUIDE: &str = include_str!("../../../../docs/profile-guided.md");

/// The blocks in a language, each under its heading.
fn blocks(language: &str) -> Vec<(&'static str, &'static str)> {
    let mut blocks = Vec::new();
    let fence = format!("```{language}\n");
    for section in GUIDE.split("\n## ").skip(1) {
        let heading = section.lines().next().unwrap_or_default();
        let code = |part: &'static str| part.split("```").next().unwrap_or_default();
        blocks.extend(section.split(&fence).skip(1).map(|part| (heading, code(part))));
    }
    blocks
}

/// The words of a line of shell, of which only plain words and single quotes are known.
fn words(line: &str) -> Vec<String> {
    assert!(!line.contains(['"', '\\', '$', '|', '>', ';', '&']), "{line}");
    let quoted = |(i, part): (usize, &str)| match i % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    };
    line.split('\'').enumerate().flat_map(quoted).collect()
}

/// Runs the commands of a section in a folder of its own, one after the other; what they print, command by command.
fn run(heading: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let lines: Vec<&str> = blocks("sh").into_iter().filter(|b| b.0 == heading).flat_map(|b| b.1.lines()).collect();
    assert!(!lines.is_empty(), "no commands under {heading}");
    lines.into_iter().map(|line| run_line(line, folder.path())).collect()
}

fn run_line(line: &str, folder: &Path) -> String {
    let words = words(line);
    let (name, args) = words.split_first().unwrap();
    assert_eq!(name, "rdh", "{line}");
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let output = program(&args).current_dir(folder).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{line}: {}\n{out}{err}", output.status);
    let written = args.iter().skip_while(|arg| **arg != "-o").nth(1);
    assert!(written.is_none_or(|file| fs::metadata(folder.join(file)).is_ok_and(|about| about.len() > 0)), "{line}");
    out.into_owned()
}

#[test]
fn the_renderer_of_the_guide() {
    let said = run("A renderer").concat();
    for word in ["bvh8", "rdh takes", "right:", "not slower than", "other rays", "unseen rays"] {
        assert!(said.contains(word), "no '{word}' in {said}");
    }
}

#[test]
fn the_scanner_of_the_guide() {
    let said = run("A scanner");
    let drifts = said.iter().find(|text| text.contains("drift from")).unwrap();
    let drift = |file: &str| {
        let line = drifts.lines().rfind(|line| line.starts_with(file)).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap()
    };
    // It grows with the way, as the guide says.
    assert!(drift("sweep4.rays") < 0.5 * drift("sweep60.rays"), "{drifts}");
    assert!(said.concat().contains("not slower than"), "{said:?}");
}

#[test]
fn the_code_of_the_guide_is_the_example_that_is_tested() {
    let code: Vec<&str> = blocks("rust").into_iter().map(|b| b.1).collect();
    assert_eq!(code, [include_str!("../../../rdh-scene/examples/sunlight.rs")]);
}

#[test]
fn what_the_guide_links_to_is_there() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let links: Vec<&str> = GUIDE.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    assert!(links.len() > 10);
    for link in links {
        let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
        let text = if file.is_empty() { GUIDE.to_owned() } else { fs::read_to_string(docs.join(file)).expect(link) };
        let is_it = |line: &&str| line.starts_with('#') && slug(line) == anchor;
        assert!(anchor.is_empty() || text.lines().any(|line| is_it(&line)), "{link}");
    }
}

/// A heading as GitHub makes it an anchor.
fn slug(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    text.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-').collect::<String>().replace(' ', "-")
}
