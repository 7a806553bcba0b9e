//! Casts files of rays through Embree 4 and says how long it took: a competitor of `rdh`, as a program of its own.
//!
//! ```text
//! rdh-engine-embree --mesh FILE [--lib DIR] [--quality high|medium] [--robust] [--isa NAME]
//! ```
//! It builds first and prints a line of JSON: engine, version, triangles, `build_nanos` (CPU time), `bytes`. Then it
//! answers requests on standard input, each by a line of JSON, until the input ends:
//!
//! ```text
//! cast FILE closest|occluded REPS  ->  {"nanos": [CPU time of each repetition], "hits": …, "t_sum": …}
//! ```
//! What goes wrong is a line `{"error": "…"}`. The files' format is in `files.rs`; `engines/README.md` says the rest.

mod api;
mod clock;
mod files;
mod library;
mod options;
mod scene;

use std::collections::BTreeMap;
use std::io::{BufRead, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use api::Query;
use files::Rays;
use library::Embree;
use options::Options;
use scene::Scene;

fn main() -> ExitCode {
    match serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            answer(&json!({"error": format!("{error:#}")})).ok();
            ExitCode::FAILURE
        }
    }
}

fn serve() -> Result<()> {
    let options = Options::parse(std::env::args_os().skip(1))?;
    let mesh = files::read_mesh(&options.mesh)?;
    let embree = Embree::load(&options.lib)?;
    let scene = Scene::build(&embree, &mesh, &options)?;
    answer(&json!({
        "engine": "embree",
        "version": scene.version(),
        "triangles": mesh.triangles.len(),
        "build_nanos": scene.build_nanos(),
        "bytes": scene.bytes(),
    }))?;
    // Files that were read once stay in memory: reading is not what is measured, but it would disturb the caches.
    let mut known = BTreeMap::new();
    for line in std::io::stdin().lock().lines() {
        let reply = request(&line?, &scene, &mut known).unwrap_or_else(|e| json!({"error": format!("{e:#}")}));
        answer(&reply)?;
    }
    Ok(())
}

fn request(line: &str, scene: &Scene<'_>, known: &mut BTreeMap<PathBuf, Rays>) -> Result<Value> {
    // From the right, since a path may hold spaces.
    let words = line.strip_prefix("cast ").and_then(|rest| {
        let (rest, reps) = rest.rsplit_once(' ')?;
        let (path, query) = rest.rsplit_once(' ')?;
        Some((PathBuf::from(path), query, reps))
    });
    let Some((path, query, reps)) = words else {
        bail!("'{line}' is not understood; known: cast FILE closest|occluded REPS");
    };
    let query = match query {
        "closest" => Query::Closest,
        "occluded" => Query::Occluded,
        _ => bail!("unknown query '{query}'; known: closest, occluded"),
    };
    let reps: u32 = reps.parse().with_context(|| format!("'{reps}' repetitions"))?;
    if !known.contains_key(&path) {
        known.insert(path.clone(), files::read_rays(&path)?);
    }
    let rays = &known[&path];
    let mut nanos = Vec::new();
    let mut last = scene::Cast::default();
    for _ in 0..reps {
        last = scene.cast(&rays.0, query);
        nanos.push(last.nanos);
    }
    Ok(json!({"nanos": nanos, "hits": last.hits, "t_sum": last.t_sum}))
}

fn answer(value: &Value) -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{value}")?;
    Ok(out.flush()?)
}
