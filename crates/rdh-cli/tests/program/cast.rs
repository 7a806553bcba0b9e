//! `rdh cast` and `rdh convert`.

use std::fs;
use std::path::Path;

use crate::run::{json, rdh};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

/// An array file of some numbers.
fn write_npy(file: &str, descr: &str, shape: &str, numbers: &[u8]) {
    let text = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': ({shape})}}\n");
    let length = (text.len() as u16).to_le_bytes();
    fs::write(file, [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), numbers].concat()).unwrap();
}

/// The header's text and the numbers of an array file.
fn read_npy(file: &str) -> (String, Vec<u8>) {
    let bytes = fs::read(file).unwrap();
    let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00") && end % 64 == 0);
    (String::from_utf8(bytes[10..end].to_vec()).unwrap(), bytes[end..].to_vec())
}

fn f64s(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Two triangles one above the other, far from zero: the scene gets an origin.
fn far_scene(folder: &Path) -> String {
    let file = path(folder, "far.obj");
    let corners = |z: u32| format!("v 500000 800000 {z}\nv 500001 800000 {z}\nv 500000 800001 {z}\n");
    fs::write(&file, corners(1) + &corners(3) + "f 1 2 3\nf 4 5 6\n").unwrap();
    file
}

#[test]
fn rays_are_given_in_the_world_whether_a_tree_was_saved_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, tree) = (far_scene(folder.path()), path(folder.path(), "far.rdh"));
    rdh(&["build", &scene, "-o", &tree]).succeeded();
    let (rays, out) = (path(folder.path(), "r.npy"), path(folder.path(), "h.npy"));
    let up = |x: f64, t_min: f64, t_max: f64| [x, 800_000.25, 0.0, 0.0, 0.0, 1.0, t_min, t_max];
    let inf = f64::INFINITY;
    let numbers =
        [up(500_000.125, 0.0, inf), up(500_000.125, 2.0, inf), up(499_999.5, 0.0, inf), up(500_000.125, 0.0, 0.5)];
    write_npy(&rays, "'<f8'", "2, 2, 8", &f64s(numbers.as_flattened()));
    for tree in [&scene, &tree] {
        let report = json(&["cast", tree, "--rays", &rays, "-o", &out, "--json"]);
        assert_eq!((report["rays"].as_u64(), report["hits"].as_u64()), (Some(4), Some(2)));
        let (header, answers) = read_npy(&out);
        assert!(header.contains("'shape': (2, 2,)") && header.contains("'primitive_ids', '<u4'"), "{header}");
        let words: Vec<u32> = answers.chunks(4).map(|w| u32::from_le_bytes(w.try_into().unwrap())).collect();
        let f = f32::to_bits;
        assert_eq!(words[..4], [f(1.0), f(0.125), f(0.25), 0]);
        assert_eq!(words[4..8], [f(3.0), f(0.125), f(0.25), 1]);
        assert_eq!(words[8..12], [f(f32::INFINITY), 0, 0, u32::MAX]);
        assert_eq!((words[12], words.len()), (f(f32::INFINITY), 16));
        rdh(&["cast", tree, "--rays", &rays, "-o", &out, "--any"]).succeeded();
        let (header, answers) = read_npy(&out);
        assert!(header.contains("'|b1'") && answers == [1, 1, 0, 0], "{header} {answers:?}");
        rdh(&["cast", tree, "--rays", &rays, "-o", &out, "--count"]).succeeded();
        assert_eq!(read_npy(&out).1, [2u32, 1, 0, 0].map(u32::to_le_bytes).concat());
    }
}

#[test]
fn ranges_together_are_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let name = |n: &str| path(folder.path(), n);
    rdh(&["record", "tetra5", "--size", "40x40", "-o", &name("a.rays")]).succeeded();
    rdh(&["convert", &name("a.rays"), &name("a.npy")]).succeeded();
    rdh(&["build", "tetra5", "-o", &name("a.rdh")]).succeeded();
    let cast = |out: &str, range: &[&str]| {
        rdh(&[&["cast", &name("a.rdh"), "--rays", &name("a.npy"), "-o", &name(out)], range].concat()).succeeded();
        read_npy(&name(out))
    };
    let whole = cast("all.npy", &[]);
    let parts = [":700", "700:701", "701:701", "701:"].map(|range| cast("part.npy", &["--range", range]).1);
    assert_eq!(parts.concat(), whole.1);
    assert_eq!(whole.1.len(), 16 * 1600);
    assert_eq!(cast("one.npy", &["--threads", "1"]).1, whole.1);
    let far = ["cast", "tetra5", "--rays", &name("a.npy"), "-o", &name("x.npy"), "--range", "5:9999"];
    rdh(&far).failed(2, &["5:9999", "1600"]);
    assert!(!Path::new(&name("x.npy")).exists());
}

#[test]
fn arrays_that_hold_no_rays_are_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let (rays, out) = (path(folder.path(), "r.npy"), path(folder.path(), "h.npy"));
    let cast = || rdh(&["cast", "tetra5", "--rays", &rays, "-o", &out]);
    write_npy(&rays, "'<f4'", "2, 7", &[0; 56]);
    cast().failed(1, &["r.npy", "(n, 6) or (n, 8)"]);
    write_npy(&rays, "'<f4'", "2, 8", &[0; 63]);
    cast().failed(1, &["r.npy", "bytes"]);
    write_npy(&rays, "'<i8'", "1, 8", &[0; 64]);
    cast().failed(1, &["r.npy", "<i8"]);
    fs::write(&rays, "no array").unwrap();
    cast().failed(1, &["r.npy", "no .npy file"]);
    rdh(&["cast", "tetra5", "--rays", "none.npy", "-o", &out]).failed(1, &["none.npy"]);
    rdh(&["cast", "tetra5", "--rays", &rays, "-o", &out, "--spec", "kd+rdh"]).failed(2, &["kd+rdh", "build"]);
    rdh(&["cast", "tetra5", "--rays", &rays, "-o", &out, "--any", "--count"]).failed(2, &["--count"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn invalid_rays_are_misses() {
    let folder = tempfile::tempdir().unwrap();
    let (rays, out) = (path(folder.path(), "r.npy"), path(folder.path(), "h.npy"));
    write_npy(&rays, "'<f8'", "2, 6", &f64s(&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    assert_eq!(json(&["cast", "tetra5", "--rays", &rays, "-o", &out, "--json"])["hits"], 0);
}

#[test]
fn meshes_are_converted_to_meshes_and_rays_to_rays() {
    let folder = tempfile::tempdir().unwrap();
    let name = |n: &str| path(folder.path(), n);
    rdh(&["build", "tetra5", "-o", &name("a.rdh")]).succeeded();
    let mut last = name("a.rdh");
    for format in ["obj", "ply", "glb", "stl"] {
        let next = name(&format!("b.{format}"));
        rdh(&["convert", &last, &next]).succeeded();
        last = next;
    }
    let fingerprint = |scene: &str| json(&["build", scene, "-o", &name("x.rdh"), "--json"])["fingerprint"].take();
    assert_eq!(fingerprint(&last), fingerprint("tetra5"));
    rdh(&["record", "tetra5", "--size", "20x20", "-o", &name("a.rays")]).succeeded();
    rdh(&["convert", &name("a.rays"), &name("a.npy")]).succeeded();
    let found = json(&["convert", &name("a.npy"), &name("b.rays"), "--query", "occluded", "--json"]);
    assert_eq!(found["rays"].as_u64(), Some(400));
    let group = json(&["rays", &name("b.rays"), "--json"])["files"][0]["groups"][0].take();
    assert_eq!((group["query"].as_str(), group["samples"].as_u64()), (Some("occluded"), Some(400)));
    rdh(&["convert", "tetra5", &name("c.rdh")]).failed(2, &["rdh build"]);
    rdh(&["convert", &name("a.rays"), &name("c.obj")]).failed(2, &[".rays", ".obj"]);
    rdh(&["convert", "tetra5", &name("c.fbx")]).failed(2, &[".fbx"]);
}

#[test]
fn completions_and_manual_pages_know_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let text = rdh(&["completions", shell]).succeeded().stdout;
        assert!(["compare", "verify", "counts-only"].iter().all(|word| text.contains(word)), "{shell}");
    }
    rdh(&["completions", "cmd"]).failed(2, &["cmd", "bash"]);
    let page = rdh(&["man"]).succeeded().stdout;
    assert!(page.starts_with(".ie") && page.contains("rdh\\-verify(1)"), "{page}");
    let pages = path(folder.path(), "man");
    rdh(&["man", "-o", &pages]).succeeded();
    assert!(fs::read_to_string(format!("{pages}/rdh-cast.1")).unwrap().contains("range"));
}
