//! `rdh cast`: the rays of a NumPy file through a tree, the answers into another one.

use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use rayon::prelude::*;
use rdh::{Accel, Hit, Ray, Spec, Training};
use rdh_scene::files::write_with;
use rdh_scene::saved::{self, Setting};
use serde::Serialize;

use crate::args::{CastArgs, Rows};
use crate::context::Context;
use crate::exit::usage;
use crate::npy::{self, RayFile};
use crate::output::{print, print_json};
use crate::pick::Shelf;
use crate::staged::Staged;

/// Casts block by block, so that rays and answers may be larger than memory.
pub(crate) fn run(args: &CastArgs, context: &Context) -> Result<()> {
    let (accel, origin) = open(args, context)?;
    let mut rays = RayFile::open(&args.rays, origin)?;
    let range = range(args.range, rays.len)?;
    let shape = if args.range.is_some() { vec![range.end - range.start] } else { rays.shape.clone() };
    rays.seek(range.start)?;
    let answer = Answer::of(args);
    let bar = context.bar(range.end - range.start);
    let written = write_with(&args.output, |out| {
        npy::write_header(out, answer.descr(), &shape)?;
        let count = range.end - range.start;
        cast_all(&accel, &mut rays, count, answer, out, &bar).map_err(std::io::Error::other)
    });
    bar.finish_and_clear();
    let cast = written.with_context(|| format!("{} can't be written", args.output.display()))?;
    report(args, &accel, &range, &cast, context)
}

/// A saved tree, mapped; or one that is built for a scene. With the origin of its coordinates.
fn open(args: &CastArgs, context: &Context) -> Result<(Accel, [f64; 3])> {
    let path = Path::new(&args.tree);
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("rdh")) {
        if args.spec.is_some() {
            return Err(usage("a saved tree has been built: --spec goes with a scene"));
        }
        let accel = saved::open(path)?;
        let setting = Setting::from_settings(&accel.provenance().settings);
        return Ok((accel, setting.map_or([0.0; 3], |setting| setting.origin)));
    }
    let spec: Spec = args.spec.map_or_else(|| "bvh8+sah".parse(), Ok)?;
    if spec.needs_rays() {
        return Err(usage(format!("{spec} needs a profile: build the tree by `rdh build --rays F.rays`")));
    }
    let target = Shelf::open(context.folder.as_deref())?.find(&args.tree)?;
    let staged = Staged::load(&target)?;
    Ok((staged.build(&spec, &Training::none())?, staged.setting.origin))
}

fn range(rows: Option<Rows>, len: u64) -> Result<std::ops::Range<u64>> {
    let range = rows.map_or(0..len, |rows| rows.first.unwrap_or(0)..rows.end.unwrap_or(len));
    if range.start > range.end || range.end > len {
        return Err(usage(format!("--range {}:{} of {len} rays", range.start, range.end)));
    }
    Ok(range)
}

/// What is asked of each ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    Closest,
    Any,
    Count,
}

impl Answer {
    fn of(args: &CastArgs) -> Self {
        match (args.any, args.count) {
            (true, _) => Self::Any,
            (_, true) => Self::Count,
            _ => Self::Closest,
        }
    }

    /// The type of an answer, as NumPy writes it.
    fn descr(self) -> &'static str {
        match self {
            Self::Closest => "[('t_hit', '<f4'), ('primitive_uvs', '<f4', (2,)), ('primitive_ids', '<u4')]",
            Self::Any => "'|b1'",
            Self::Count => "'<u4'",
        }
    }

    /// Appends the answers to some rays; returns how many hit something.
    fn cast(self, accel: &Accel, rays: &[Ray], out: &mut Vec<u8>) -> u64 {
        let mut all = Vec::new();
        let hits = rays.iter().filter(|ray| match self {
            Self::Closest => {
                let hit = accel.closest(ray);
                out.extend(closest_bytes(hit));
                hit.is_some()
            }
            Self::Any => {
                let hit = accel.occluded(ray);
                out.push(u8::from(hit));
                hit
            }
            Self::Count => {
                accel.all_hits(ray, &mut all);
                out.extend((all.len() as u32).to_le_bytes());
                !all.is_empty()
            }
        });
        hits.count() as u64
    }
}

/// Distance, u, v, id; a miss is Open3D's.
fn closest_bytes(hit: Option<Hit>) -> [u8; 16] {
    let (t, u, v, id) = hit.map_or((f32::INFINITY, 0.0, 0.0, u32::MAX), |hit| (hit.t, hit.u, hit.v, hit.tri.0));
    let words = [t.to_bits(), u.to_bits(), v.to_bits(), id].map(u32::to_le_bytes);
    std::array::from_fn(|i| words[i / 4][i % 4])
}

/// What was cast.
struct Cast {
    hits: u64,
    /// Elapsed, without reading and writing.
    casting: Duration,
}

/// Rays that are in memory together.
const BLOCK: u64 = 1 << 18;
/// Rays of one task.
const CHUNK: usize = 4096;

fn cast_all(
    accel: &Accel,
    rays: &mut RayFile,
    count: u64,
    answer: Answer,
    out: &mut impl Write,
    bar: &ProgressBar,
) -> Result<Cast> {
    let mut cast = Cast { hits: 0, casting: Duration::ZERO };
    let (mut block, mut left) = (Vec::new(), count);
    while left > 0 {
        let now = left.min(BLOCK);
        rays.read(now as usize, &mut block)?;
        let start = Instant::now();
        let chunk = |rays: &[Ray]| {
            let mut bytes = Vec::with_capacity(16 * rays.len());
            (answer.cast(accel, rays, &mut bytes), bytes)
        };
        let answers: Vec<(u64, Vec<u8>)> = block.par_chunks(CHUNK).map(chunk).collect();
        cast.casting += start.elapsed();
        for (hits, bytes) in &answers {
            cast.hits += hits;
            out.write_all(bytes)?;
        }
        left -= now;
        bar.inc(now);
    }
    Ok(cast)
}

#[derive(Serialize)]
struct Report {
    version: u32,
    tree: String,
    spec: String,
    output: String,
    range: [u64; 2],
    rays: u64,
    hits: u64,
    cast_secs: f64,
    mrays_per_sec: f64,
    threads: usize,
}

fn report(args: &CastArgs, accel: &Accel, range: &std::ops::Range<u64>, cast: &Cast, context: &Context) -> Result<()> {
    let (rays, cast_secs) = (range.end - range.start, cast.casting.as_secs_f64());
    let report = Report {
        version: 1,
        tree: args.tree.clone(),
        spec: accel.stats().spec.to_string(),
        output: args.output.display().to_string(),
        range: [range.start, range.end],
        rays,
        hits: cast.hits,
        cast_secs,
        mrays_per_sec: rays as f64 * 1e-6 / cast_secs.max(1e-9),
        threads: rayon::current_num_threads(),
    };
    if context.json {
        return print_json(&report);
    }
    let Report { output, hits, mrays_per_sec, threads, .. } = report;
    print(&format!("{output}: {hits} of {rays} rays hit, {mrays_per_sec:.2} Mrays/s on {threads} threads\n"))
}
