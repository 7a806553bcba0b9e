//! What other libraries miss, of rays that are aimed as ours.

use std::path::Path;
use std::time::Duration;

use rdh::{Query, Ray};
use serde::{Deserialize, Serialize};

use super::{Aim, Closed, aimed_from_inside};
use crate::bench::files::{write_mesh, write_rays};
use crate::bench::process::{Process, Trouble};
use crate::bench::{Form, known_engines};

/// What a library misses of some rays, each of which should hit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Other {
    /// Library and mode.
    pub engine: String,
    /// Which mesh the rays are in.
    pub mesh: String,
    /// How they are aimed.
    pub aim: String,
    /// How many there are.
    pub rays: u64,
    /// How many find no nearest hit.
    pub missed: u64,
}

/// The meshes that others are asked about.
const MESHES: [&str; 6] = ["icosphere", "box", "needles", "solid", "icosphere × 1e-12", "icosphere × 1e12"];

/// One mode each: the others differ in how much work goes into their builds, or in instructions.
const MODES: [&str; 8] = [
    "embree4(high-avx2)",
    "embree4-robust(medium-robust-avx2)",
    "embree3(high-avx2)",
    "obvhs(cwbvh-medium)",
    "tinybvh(bvh8)",
    "parry3d(default)",
    "bvh(default)",
    "kdtree-ray(default)",
];

/// Casts rays of each aim in some of the meshes through the engines whose programs are in a folder. Absent ones are left out, with a
/// word on standard error, and so are those that fail or take minutes.
///
/// # Errors
/// A structure that can't be built, or a file that can't be written.
pub fn others(meshes: &[Closed], folder: &Path, count: usize, seed: u64) -> Result<Vec<Other>, String> {
    let place = tempfile::tempdir().map_err(|e| e.to_string())?;
    let mut found = Vec::new();
    for closed in meshes.iter().filter(|closed| MESHES.contains(&&closed.name[..])) {
        let mesh = place.path().join("mesh");
        write_mesh(&mesh, &closed.mesh).map_err(|e| e.to_string())?;
        let aimed = Aim::ALL.map(|aim| aimed_from_inside(closed, aim, count, seed).map(|rays| (aim, rays)));
        let aimed: Vec<(Aim, Vec<Ray>)> = aimed.into_iter().collect::<Result<_, _>>().map_err(|e| e.to_string())?;
        for (engine, mode) in known_engines().iter().flat_map(|e| e.modes.iter().map(move |mode| (e, mode))) {
            let label = engine.label(mode);
            if !MODES.contains(&&label[..]) {
                continue;
            }
            let program = folder.join(format!("{}{}", engine.program, std::env::consts::EXE_SUFFIX));
            match ask(&program, mode, &mesh, &aimed, place.path()) {
                Ok(missed) => found.extend(aimed.iter().zip(missed).map(|((aim, rays), missed)| Other {
                    engine: label.clone(),
                    mesh: closed.name.clone(),
                    aim: aim.name().to_owned(),
                    rays: rays.len() as u64,
                    missed,
                })),
                Err(Trouble::Absent(why) | Trouble::Failed(why)) => {
                    eprintln!("{label}, {}: left out: {why}", closed.name)
                }
            }
        }
    }
    Ok(found)
}

/// Some builders hang on degenerate meshes: then, or where one is so slow, its program is killed.
const PATIENCE: Duration = Duration::from_secs(120);

/// How many of the rays of each aim a program misses.
fn ask(program: &Path, mode: &str, mesh: &Path, aimed: &[(Aim, Vec<Ray>)], place: &Path) -> Result<Vec<u64>, Trouble> {
    let mut process = Process::start(program, mode, mesh, place.join("answers"), Some(PATIENCE))?;
    let missed = |(aim, rays): &(Aim, Vec<Ray>)| {
        // A name each: engines keep the file that they cast last.
        let file = place.join(format!("rays.{}", *aim as usize));
        write_rays(&file, rays).map_err(|e| Trouble::Failed(e.to_string()))?;
        let answers = process.answers(Form::Single, Query::Closest, &file)?;
        Ok(answers.iter().filter(|t| !t.is_finite()).count() as u64)
    };
    aimed.iter().map(missed).collect()
}
