//! `rdh study` and `rdh merge`: killed, resumed, shared out.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::run::{json, program, rdh};

/// A study of a second or two.
const SMALL: [&str; 11] = [
    "study",
    "sombrero1",
    "teapot12",
    "--size=24x24",
    "--training=200",
    "--rounds=2",
    "--experiment=modes,aa,spd,how-many",
    "--mode=primary,whitted",
    "--quick",
    "--threads=2",
    "--seed=3",
];

fn study<'a>(folder: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&SMALL[..], &["--out", folder], more].concat()
}

/// All that a study counted.
fn counts(folders: &[&str]) -> Value {
    json(&[&["merge", "--json", "--counts-only"], folders].concat())
}

fn within(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

#[test]
fn a_study_killed_at_any_moment_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let whole = within(folder.path(), "whole");
    let printed = rdh(&study(&whole, &[])).succeeded().stdout;
    assert!(printed.contains("modes: What does") && printed.contains("kd+rdh"), "{printed}");
    let expected = counts(&[&whole]);
    assert!(expected["rows"].as_array().unwrap().len() > 40);
    // More than a run takes would kill nothing; the moments are spread over the first part of it.
    let kills: u64 = std::env::var("RDH_KILLS").map_or(4, |n| n.parse().unwrap());
    let killed = within(folder.path(), "killed");
    for i in 0..kills {
        let more: &[&str] = if i == 0 { &[] } else { &["--resume"] };
        let mut child = program(&study(&killed, more)).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(20 + i * 7919 % 150));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    rdh(&study(&killed, &["--resume"])).succeeded();
    assert_eq!(counts(&[&killed]), expected);
}

#[test]
fn parts_make_the_whole_and_a_missing_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, first, second, joined] = ["whole", "1", "2", "joined"].map(|name| within(folder.path(), name));
    rdh(&study(&whole, &[])).succeeded();
    rdh(&study(&first, &["--shard", "1/2"])).succeeded();
    let missing = rdh(&["merge", &first]);
    assert_eq!(missing.code, Some(3));
    assert!(missing.stderr.contains("jobs are missing, the first is"), "{}", missing.stderr);
    rdh(&study(&second, &["--shard", "2/2"])).succeeded();
    assert_eq!(counts(&[&second, &first]), counts(&[&whole]));
    // The same part twice is no harm.
    assert_eq!(counts(&[&first, &second, &first]), counts(&[&whole]));
    rdh(&["merge", &first, &second, "-o", &joined]).succeeded();
    assert_eq!(counts(&[&joined]), counts(&[&whole]));
}

#[test]
fn folders_that_hold_something_else_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let place = within(folder.path(), "study");
    rdh(&study(&place, &["--experiment=aa"])).failed(2, &["experiment 'aa' is given twice"]);
    let aa = ["study", "sombrero1", "--quick", "--experiment=aa", "--size=8x8", "--out", &place];
    rdh(&aa).succeeded();
    rdh(&aa).failed(2, &["holds this study already", "--resume"]);
    let again = [&aa[..], &["--resume"]].concat();
    rdh(&again).succeeded();
    rdh(&[&again[..], &["--seed=9"]].concat()).failed(2, &["another study", "seed: 1 here, 9 there"]);
    rdh(&["merge", &within(folder.path(), "nothing")]).failed(1, &["holds no study"]);
    let other = within(folder.path(), "other");
    rdh(&["study", "sombrero1", "--quick", "--experiment=aa", "--size=9x8", "--out", &other]).succeeded();
    rdh(&["merge", &place, &other]).failed(1, &["different studies", "size: [8,8] here, [9,8] there"]);
}

#[test]
fn a_damaged_log_is_an_error_and_a_torn_one_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let place = within(folder.path(), "study");
    let run = ["study", "sombrero1", "teapot4", "--quick", "--experiment=aa", "--size=8x8", "--out", &place];
    rdh(&run).succeeded();
    let expected = counts(&[&place]);
    let log = Path::new(&place).join("jobs.log");
    let whole = fs::read(&log).unwrap();
    fs::write(&log, &whole[..whole.len() - 9]).unwrap();
    assert_eq!(rdh(&["merge", &place]).code, Some(3));
    rdh(&[&run[..], &["--resume"]].concat()).succeeded();
    assert_eq!(counts(&[&place]), expected);
    let mut damaged = whole;
    damaged[30] ^= 1;
    fs::write(&log, &damaged).unwrap();
    for refused in [&["merge", &place][..], &[&run[..], &["--resume"]].concat()] {
        rdh(refused).failed(1, &["jobs.log: line 1, byte 0: the checksum is wrong"]);
    }
}

#[test]
fn what_is_not_there_is_said_with_what_is() {
    rdh(&["study", "--experiment=alchemy"]).failed(2, &["unknown experiment 'alchemy'", "modes", "occlusion"]);
    rdh(&["study", "--shard=3/2"]).failed(2, &["I/N is needed"]);
    rdh(&["study", "sombrero1:rim"]).failed(2, &["a study takes scenes"]);
}
