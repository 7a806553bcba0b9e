//! `rdh convert`: meshes into meshes, rays into rays.

use std::io::Write;
use std::path::Path;

use anyhow::{Context as _, Result};
use rdh::{Profile, RayClass, RaySample};
use rdh_scene::files::write_with;
use rdh_scene::formats::{WRITERS, write_file};
use serde_json::json;

use super::rays;
use crate::args::ConvertArgs;
use crate::context::Context;
use crate::exit::usage;
use crate::npy::{self, RayFile};
use crate::output::{print, print_json, write_file as write_bytes};
use crate::pick::Shelf;
use crate::staged::Staged;

/// Converts what the extensions say.
pub(crate) fn run(args: &ConvertArgs, context: &Context) -> Result<()> {
    let (input, output) = (Path::new(&args.input), args.output.as_path());
    let (count, what) = match (extension(input).as_str(), extension(output).as_str()) {
        ("rays", "npy") => (profile_to_array(input, output)?, "rays"),
        ("npy", "rays") => (array_to_profile(args, context.seed)?, "rays"),
        (_, "rdh") => return Err(usage("trees are made by `rdh build`")),
        (from, to) if WRITERS.iter().any(|w| w.name == to) && from != "rays" && from != "npy" => {
            (mesh_to_mesh(args, context)?, "triangles")
        }
        (from, to) => return Err(usage(format!("there is no way from '.{from}' to '.{to}'"))),
    };
    let file = output.display().to_string();
    if context.json {
        return print_json(&json!({ "version": 1, "file": file, what: count }));
    }
    print(&format!("{file}: {count} {what}\n"))
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn mesh_to_mesh(args: &ConvertArgs, context: &Context) -> Result<u64> {
    let target = Shelf::open(context.folder.as_deref())?.find(&args.input)?;
    let staged = Staged::load(&target)?;
    let mesh = staged.stage.mesh();
    for note in write_file(&args.output, mesh, staged.setting.origin)? {
        tracing::warn!("{}: {} {}", args.output.display(), note.count, note.what);
    }
    Ok(mesh.len() as u64)
}

/// The rays, eight numbers each; each once, whatever its weight.
fn profile_to_array(input: &Path, output: &Path) -> Result<u64> {
    let profile = rays::read(input)?;
    write_with(output, |out| {
        npy::write_header(out, "'<f4'", &[profile.len() as u64, 8])?;
        profile.samples().iter().try_for_each(|sample| {
            let ray = &sample.ray;
            let numbers = [ray.origin, ray.direction].concat().into_iter().chain([ray.t_min, ray.t_max]);
            numbers.map(f32::to_le_bytes).try_for_each(|bytes| out.write_all(&bytes))
        })
    })
    .with_context(|| format!("{} can't be written", output.display()))?;
    Ok(profile.len() as u64)
}

/// Rays read together.
const BLOCK: u64 = 1 << 16;

fn array_to_profile(args: &ConvertArgs, seed: u64) -> Result<u64> {
    let mut file = RayFile::open(Path::new(&args.input), [0.0; 3])?;
    let (mut samples, mut block, mut left) = (Vec::new(), Vec::new(), file.len);
    while left > 0 {
        let now = left.min(BLOCK);
        file.read(now as usize, &mut block)?;
        samples.extend(block.iter().map(|ray| RaySample::new(*ray, None, args.query, RayClass::Other)));
        left -= now;
    }
    let profile = Profile::from_samples(samples, seed);
    if profile.invalid() > 0 {
        tracing::warn!("{}: {} invalid rays", args.input, profile.invalid());
    }
    write_bytes(&args.output, &profile.to_bytes())?;
    Ok(profile.len() as u64)
}
