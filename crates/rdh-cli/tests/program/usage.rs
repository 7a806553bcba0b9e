//! Usage errors help; colours and pipes behave.

use std::io::Read;
use std::process::Stdio;

use crate::run::{program, rdh};

#[test]
fn help_and_version_are_no_failure() {
    let help = rdh(&["--help"]).succeeded();
    for command in ["bench", "build", "cast", "compare", "convert", "rays", "record", "render", "scenes", "verify"] {
        assert!(help.stdout.contains(command), "{}", help.stdout);
    }
    assert!(rdh(&["--version"]).succeeded().stdout.starts_with("rdh "));
    rdh(&["compare", "--help"]).succeeded();
}

#[test]
fn nothing_unknown_is_accepted() {
    rdh(&["compere"]).failed(2, &["compere", "compare"]);
    rdh(&["compare", "--rays", "9"]).failed(2, &["--rays"]);
    rdh(&["compare", "--size", "12"]).failed(2, &["WIDTHxHEIGHT", "512x512"]);
    rdh(&["compare", "--size", "0x4"]).failed(2, &["WIDTHxHEIGHT"]);
    rdh(&["compare", "--mode", "photons"]).failed(2, &["photons", "whitted"]);
    rdh(&["compare", "--protocol", "cheat"]).failed(2, &["cheat", "unseen, paper, same"]);
    rdh(&["compare", "--threads", "0"]).failed(2, &["from 1"]);
    rdh(&["compare", "--rounds", "0"]).failed(2, &["from 1"]);
}

#[test]
fn an_unknown_scene_names_its_neighbours() {
    rdh(&["compare", "sombrer"]).failed(2, &["no scene `sombrer`", "sombrero1"]);
    rdh(&["render", "tetra55", "-o", "a.png"]).failed(2, &["tetra5"]);
    rdh(&["compare", "sombrero1:nowhere"]).failed(2, &["no view 'nowhere'", "known: "]);
    rdh(&["compare", "not/there.obj"]).failed(2, &["not/there.obj", "no such file"]);
}

#[test]
fn an_unknown_spec_names_the_known_ones() {
    rdh(&["compare", "sombrero1", "--spec", "octree+sah"]).failed(2, &["octree", "kd", "sah, rdh"]);
    rdh(&["compare", "sombrero1", "--spec", "kd(leaves=8)"]).failed(2, &["leaves", "leaf=1|8"]);
    rdh(&["compare", "sombrero1", "--spec", "kd+sah,kd+sah"]).failed(2, &["twice"]);
}

#[test]
fn a_folder_without_an_index_is_named() {
    rdh(&["scenes", "--scenes", "no-such-folder"]).failed(1, &["no-such-folder"]);
}

#[test]
fn backtraces_are_not_for_users() {
    let output = program(&["compare", "sombrer"]).env("RUST_BACKTRACE", "1").output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), text.lines().count()), (Some(2), 1), "{text}");
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let mut child = program(&["scenes", "--json"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Closing the pipe before anything is read: the program meets a broken pipe, or is through already.
    drop(child.stdout.take());
    let mut errors = String::new();
    child.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
    assert_eq!((child.wait().unwrap().code(), errors.as_str()), (Some(0), ""));
}

#[test]
fn colours_come_when_they_are_asked_for_and_only_then() {
    let coloured = |args: &[&str]| rdh(args).succeeded().stdout.contains('\u{1b}');
    assert!(!coloured(&["scenes"]));
    assert!(!coloured(&["scenes", "--color", "never"]));
    assert!(coloured(&["scenes", "--color", "always"]));
}
