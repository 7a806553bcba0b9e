//! `rdh report`: a page of a study.

use std::fs;
use std::path::Path;

use crate::run::{json, rdh};

/// Runs a study of a second in a folder, and returns the folder's name.
fn study(folder: &Path) -> String {
    let out = folder.join("study").to_str().unwrap().to_owned();
    let args =
        ["study", "tetra5", "--size=16x16", "--training=100", "--rounds=2", "--quick", "--mode=primary", "--seed=7"];
    rdh(&[&args[..], &["--experiment=modes,aa", "--out", &out]].concat()).succeeded();
    out
}

#[test]
fn a_page_with_pictures_is_written_beside_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path());
    let said = json(&["report", &study, "--machine", "an abacus <2>", "--json"]);
    let page = fs::read_to_string(Path::new(&study).join("report.html")).unwrap();
    assert_eq!((said["jobs"].as_u64(), said["missing"].as_u64()), (Some(2), Some(0)));
    assert_eq!(said["bytes"].as_u64(), Some(page.len() as u64));
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("an abacus &lt;2&gt;"));
    assert!(page.contains(
        "rdh study tetra5 --quick --experiment modes,aa --mode primary --size 16x16 --training 100 --rounds 2 --seed 7"
    ));
    // The view, two slices; steps and tests by both and their differences.
    assert_eq!(page.matches("data:image/png;base64,").count(), 9);
    assert!(page.len() < 2 << 20);
}

#[test]
fn pictures_can_be_left_out_and_tables_written_too() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path());
    let [page, tables] = ["a.html", "a.md"].map(|name| folder.path().join(name));
    let (page_name, tables_name) = (page.to_str().unwrap(), tables.to_str().unwrap());
    rdh(&["report", &study, "--no-pictures", "-o", page_name, "--markdown", tables_name]).succeeded();
    assert!(!fs::read_to_string(&page).unwrap().contains("data:image"));
    let tables = fs::read_to_string(tables).unwrap();
    assert!(tables.contains("## modes") && tables.contains("| primary | all |"), "{tables}");
}

#[test]
fn an_unfinished_study_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path());
    let log = Path::new(&study).join("jobs.log");
    let text = fs::read_to_string(&log).unwrap();
    fs::write(&log, text.lines().next().unwrap().to_owned() + "\n").unwrap();
    let printed = rdh(&["report", &study, "--no-pictures"]).succeeded().stdout;
    assert!(printed.contains("1 jobs; 1 are missing"), "{printed}");
    let page = fs::read_to_string(Path::new(&study).join("report.html")).unwrap();
    assert!(page.contains("The study is not complete"));
}

#[test]
fn a_folder_without_a_study_is_named() {
    let folder = tempfile::tempdir().unwrap();
    rdh(&["report", folder.path().to_str().unwrap()]).failed(1, &["holds no study"]);
}
