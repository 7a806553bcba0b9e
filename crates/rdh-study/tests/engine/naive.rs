//! A competitor for the tests of the race: brute force, by the library's own triangle test, or something wrong.
//!
//! Modes: `exact`; `far` adds 1 to each distance; `blind` sees nothing; `liar` has one hit more when it is timed;
//! `sudden` ends when it is to cast; `absent` says that it isn't there; `mad` answers nonsense.

use std::io::{BufRead, Write};

use rdh::{Mesh, Ray, naive};

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let at = args.iter().position(|arg| arg == name).unwrap_or_else(|| panic!("{name} is needed"));
        args[at + 1].clone()
    };
    let (mode, answers) = (value("--mode"), value("--answers"));
    match mode.as_str() {
        "absent" => return say(r#"{"absent": "its library is missing"}"#),
        "mad" => return say("quack"),
        _ => {}
    }
    let mesh = read_mesh(&value("--mesh"));
    let triangles = mesh.len();
    say(&format!(
        r#"{{"engine": "naive", "version": "1.2.3", "triangles": {triangles}, "build_nanos": 5000, "bytes": 77}}"#
    ));
    for line in std::io::stdin().lock().lines() {
        let line = line.unwrap();
        let words: Vec<_> = line.splitn(if line.starts_with("cast") { 5 } else { 4 }, ' ').collect();
        let distances: Vec<f32> =
            read_rays(words[words.len() - 1]).iter().map(|ray| answer(&mesh, ray, words[2], &mode)).collect();
        if words[0] == "answers" {
            std::fs::write(&answers, distances.iter().flat_map(|t| t.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
            say(&format!(r#"{{"rays": {}}}"#, distances.len()));
            continue;
        }
        if mode == "sudden" {
            return;
        }
        let found: Vec<f32> = distances.into_iter().filter(|t| t.is_finite()).collect();
        let hits = found.len() + usize::from(mode == "liar");
        let t_sum: f64 = found.iter().map(|&t| f64::from(t)).sum();
        say(&format!(r#"{{"nanos": [{}], "hits": {hits}, "t_sum": {t_sum}}}"#, 1_000_000));
    }
}

fn answer(mesh: &Mesh, ray: &Ray, query: &str, mode: &str) -> f32 {
    let t = match naive::closest(mesh, ray) {
        Some(_) if query == "occluded" => 0.0,
        Some(hit) => hit.t,
        None => f32::INFINITY,
    };
    match mode {
        "far" if query == "closest" => t + 1.0,
        "blind" => f32::INFINITY,
        _ => t,
    }
}

fn say(line: &str) {
    println!("{line}");
    std::io::stdout().flush().unwrap();
}

fn read_mesh(path: &str) -> Mesh {
    let bytes = std::fs::read(path).unwrap();
    assert!(bytes.starts_with(b"RDH-MESH"));
    let body = words(&bytes[24..]);
    let vertices = u64::from_le_bytes(bytes[8..16].try_into().unwrap()) as usize;
    let (positions, triangles) = body.split_at(3 * vertices);
    let positions = positions.as_chunks::<3>().0.iter().map(|p| p.map(f32::from_bits)).collect();
    Mesh::new(positions, triangles.as_chunks::<3>().0.to_vec()).unwrap()
}

fn read_rays(path: &str) -> Vec<Ray> {
    let bytes = std::fs::read(path).unwrap();
    assert!(bytes.starts_with(b"RDH-CAST"));
    words(&bytes[16..]).as_chunks::<8>().0.iter().map(|r| Ray::from(r.map(f32::from_bits))).collect()
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect()
}
