//! `rdh render`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::run::{json, rdh};

fn picture(folder: &Path, name: &str, more: &[&str]) -> PathBuf {
    let file = folder.join(name);
    let args = ["render", "tetra5", "--size", "48x32", "--training", "256", "-o", file.to_str().unwrap()];
    rdh(&[&args, more].concat()).succeeded();
    file
}

/// Width and height of a PNG.
fn png_size(file: &Path) -> (u32, u32) {
    let bytes = fs::read(file).unwrap();
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn a_shaded_picture_has_the_size_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    for mode in ["primary", "whitted", "path", "ao", "lidar"] {
        assert_eq!(png_size(&picture(folder.path(), "a.png", &["--mode", mode])), (48, 32), "{mode}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn pictures_are_repeatable() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |name, threads| picture(folder.path(), name, &["--mode", "path", "--threads", threads]);
    assert_eq!(fs::read(draw("a.png", "1")).unwrap(), fs::read(draw("b.png", "3")).unwrap());
}

#[test]
fn every_spec_has_its_panel() {
    let folder = tempfile::tempdir().unwrap();
    let width = |heat, specs| png_size(&picture(folder.path(), "a.png", &["--heat", heat, "--spec", specs])).0;
    let two = width("steps", "kd+sah,kd+rdh");
    let three = width("tests", "kd+sah,kd+rdh(paper),kd+rdh");
    let difference = width("diff", "kd+sah,kd+rdh");
    assert!(two > 640 && three > two + 320 && difference > two + 320, "{two} {three} {difference}");
}

#[test]
fn an_exr_is_an_exr() {
    let folder = tempfile::tempdir().unwrap();
    for more in [&[][..], &["--heat", "diff"]] {
        let bytes = fs::read(picture(folder.path(), "a.exr", more)).unwrap();
        assert!(bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]));
    }
}

#[test]
fn slices_are_drawn_by_position_part_and_eye() {
    let folder = tempfile::tempdir().unwrap();
    for place in ["x:0", "y:-0.25", "z:50%"] {
        let (width, height) = png_size(&picture(folder.path(), "a.png", &["--slice", place]));
        assert!(width > 2 * 320 && height > 200, "{place}: {width} x {height}");
    }
    let out = folder.path().join("b.png");
    rdh(&["render", "tetra5", "--slice", "x:99", "-o", out.to_str().unwrap()]).failed(2, &["99", "misses"]);
    assert!(!out.exists());
}

#[test]
fn json_says_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.png");
    let written = json(&["render", "tetra5", "--size", "8x6", "--json", "-o", file.to_str().unwrap()]);
    assert_eq!((&written["size"][0], &written["size"][1]), (&8.into(), &6.into()));
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    rdh(&["render", "tetra5"]).failed(2, &["--output"]);
    rdh(&["render", "tetra5", "-o", "a.jpg"]).failed(2, &[".png or .exr"]);
    rdh(&["render", "tetra5", "-o", "a.png", "--heat", "warmth"]).failed(2, &["steps", "tests", "diff"]);
    rdh(&["render", "tetra5", "-o", "a.png", "--heat", "diff", "--spec", "kd+sah"]).failed(2, &["two specs"]);
    rdh(&["render", "tetra5", "-o", "a.png", "--spec", "kd+sah,kd+rdh"]).failed(2, &["one"]);
    rdh(&["render", "tetra5", "-o", "a.exr", "--slice", "x:0"]).failed(2, &[".png"]);
    rdh(&["render", "tetra5", "-o", "a.png", "--slice", "w:0"]).failed(2, &["AXIS:POSITION"]);
}
