//! Rays without end, from inside closed meshes, through every structure at every level: each must hit something, and all structures
//! must give the same hit, bit for bit; on small meshes that of brute force.
//!
//! ```text
//!  mod      the work, and what comes of it
//!  others   what other libraries miss
//!  batches  rays that are cast together
//!  aim      how rays are aimed
//!  closed   meshes, and where inside of them rays start
//!  solid    one of the meshes
//! ```

mod aim;
mod batches;
mod closed;
pub mod others;
mod solid;

use std::time::Instant;

use rayon::prelude::*;
use rdh::simd::Level;
use rdh::{Accel, BuildOptions, Hit, Mesh, Query, Ray, RayClass, RaySample, Spec, Training, naive};
use serde::{Deserialize, Serialize};

use crate::integrate::{Random, derived_seed};
pub use aim::Aim;
use aim::Range;
pub use batches::{Batches, Form, soak_batches};
pub use closed::{Ball, Closed, Detail, closed_meshes, is_closed, large_mesh, shares};

/// What is to be done.
#[derive(Debug, Clone)]
pub struct Plan {
    /// What is built over each mesh.
    pub specs: Vec<Spec>,
    /// How many rays are cast through a structure, in all; each ray is cast through all structures, by two queries or three.
    pub casts: u64,
    /// Other seeds make other rays.
    pub seed: u64,
    /// Whether brute force says what is right, and not the first structure.
    pub brute: bool,
}

/// What came of it on one mesh, or on several.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Different rays.
    pub rays: u64,
    /// Rays cast through a structure.
    pub casts: u64,
    /// Those that should have hit something.
    pub misses: u64,
    /// Those with another answer than brute force or the first structure.
    pub different: u64,
    /// For each structure, in the plan's order, and each aim: casts, misses, other answers.
    pub by_structure: Vec<[[u64; 3]; Aim::ALL.len()]>,
    /// Casts at each level of [`Level::available`].
    pub by_level: Vec<u64>,
    /// The first faults, a line each, with the rays' bits.
    pub faults: Vec<String>,
}

/// Rays that a thread makes and casts at a time, all at one level.
const CHUNK: u64 = 1024;

/// Every so manyth ray is asked for all its hits, which takes long.
const ALL_HITS: u64 = 8;

/// Of so many chunks all but one are cast at the best level, which takes the least time; the other levels share that one.
const BEST_LEVEL: u64 = 4;

/// More faults than this are only counted.
const FAULTS: usize = 20;

/// Casts a mesh's share of the rays, on all threads of rayon's current pool; the same rays and results on any number of them. A
/// share is at least four chunks. What has not begun `until` then is left out: then there are fewer rays, of the same ones.
///
/// # Errors
/// A structure that can't be built.
pub fn soak(
    closed: &Closed,
    number: usize,
    share: u64,
    until: Option<Instant>,
    plan: &Plan,
) -> Result<Tally, rdh::Error> {
    let structures = structures(closed, plan)?;
    let range = Range::new(closed, structures.iter());
    let levels: Vec<Vec<Accel>> = Level::available()
        .into_iter()
        .map(|level| structures.iter().map(|accel| accel.clone().with_level(level)).collect())
        .collect();
    let work = Work { closed, range, levels, plan, seed: derived_seed(plan.seed, number as u64) };
    let chunks = share.div_ceil(CHUNK * casts_per_ray(plan)).max(BEST_LEVEL * (work.levels.len() as u64 - 1).max(1));
    let in_time = |chunk: &u64| *chunk < BEST_LEVEL || until.is_none_or(|until| Instant::now() < until);
    let tallies = (0..chunks).into_par_iter().filter(in_time).map(|chunk| work.chunk(chunk));
    Ok(tallies.reduce(Tally::default, Tally::plus))
}

/// Which of some levels, the best of them last, casts a chunk.
fn level_of(chunk: u64, levels: usize) -> usize {
    match levels as u64 - 1 {
        0 => 0,
        others if chunk.is_multiple_of(BEST_LEVEL) => (chunk / BEST_LEVEL % others) as usize,
        best => best as usize,
    }
}

/// Through each structure the nearest hit and any; all of some.
fn casts_per_ray(plan: &Plan) -> u64 {
    2 * plan.specs.len().max(1) as u64
}

fn structures(closed: &Closed, plan: &Plan) -> Result<Vec<Accel>, rdh::Error> {
    let training = training(closed, plan.seed)?;
    plan.specs.iter().map(|spec| rdh::build(&closed.mesh, spec, &training, &BuildOptions::default())).collect()
}

/// Rays as they are cast later, of another seed.
fn training(closed: &Closed, seed: u64) -> Result<Training, rdh::Error> {
    let accel = rdh::build(&closed.mesh, &Spec::default(), &Training::none(), &BuildOptions::default())?;
    let (range, mut random) =
        (Range::new(closed, std::iter::once(&accel)), Random::new(derived_seed(seed, u64::MAX), 0));
    let sample = |i: usize| {
        let ray = range.ray(Aim::ALL[i % Aim::ALL.len()], &mut random);
        let query = if i.is_multiple_of(4) { Query::Occluded } else { Query::Closest };
        RaySample::new(ray, accel.closest(&ray), query, RayClass::Other)
    };
    Ok(Training::from_samples((0..4000).map(sample).collect()))
}

struct Work<'a> {
    closed: &'a Closed,
    range: Range<'a>,
    /// The structures at each level.
    levels: Vec<Vec<Accel>>,
    plan: &'a Plan,
    seed: u64,
}

impl Work<'_> {
    fn chunk(&self, chunk: u64) -> Tally {
        let level = level_of(chunk, self.levels.len());
        let structures = &self.levels[level];
        let mut random = Random::new(self.seed, chunk);
        let mut tally = Tally { by_level: vec![0; self.levels.len()], ..Tally::of(structures.len()) };
        let mut hits = Vec::new();
        for i in 0..CHUNK {
            let number = (i % Aim::ALL.len() as u64) as usize;
            let ray = self.range.ray(Aim::ALL[number], &mut random);
            let truth = self.truth(&ray, &structures[0]);
            let all = i.is_multiple_of(ALL_HITS).then(|| self.all(&ray, &structures[0]));
            tally.rays += 1;
            for (which, accel) in structures.iter().enumerate() {
                let verdict = cast(accel, &ray, truth, all.as_deref(), &mut hits);
                let casts = 2 + u64::from(all.is_some());
                tally.count(which, number, casts, verdict);
                tally.by_level[level] += casts;
                if verdict.is_fault() {
                    tally.note(|| self.fault(level, which, number, &ray, accel.closest(&ray), truth));
                }
            }
        }
        tally
    }

    fn truth(&self, ray: &Ray, first: &Accel) -> Option<Hit> {
        if self.plan.brute { naive::closest(&self.closed.mesh, ray) } else { first.closest(ray) }
    }

    fn all(&self, ray: &Ray, first: &Accel) -> Vec<Hit> {
        if self.plan.brute {
            return naive::all_hits(&self.closed.mesh, ray);
        }
        let mut hits = Vec::new();
        first.all_hits(ray, &mut hits);
        hits
    }

    fn fault(
        &self,
        level: usize,
        which: usize,
        aim: usize,
        ray: &Ray,
        found: Option<Hit>,
        truth: Option<Hit>,
    ) -> String {
        let (name, spec, aim) = (&self.closed.name, self.plan.specs[which], Aim::ALL[aim].name());
        let level = Level::available()[level].name();
        format!("{name}, {spec}, {level}, {aim}: {found:?}, expected {truth:?}; ray {}", ray_bits(ray))
    }
}

/// All numbers of a ray, as bits: origin, direction, interval.
pub fn ray_bits(ray: &Ray) -> String {
    let numbers = [&ray.origin[..], &ray.direction, &[ray.t_min, ray.t_max]].concat();
    numbers.iter().map(|x| format!("{:08x}", x.to_bits())).collect::<Vec<_>>().join(" ")
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Verdict {
    missed: bool,
    different: bool,
}

impl Verdict {
    fn is_fault(self) -> bool {
        self.missed || self.different
    }
}

/// Asks a structure, each query by itself: one must not hide what another misses.
fn cast(accel: &Accel, ray: &Ray, truth: Option<Hit>, all: Option<&[Hit]>, hits: &mut Vec<Hit>) -> Verdict {
    let (closest, occluded) = (accel.closest(ray), accel.occluded(ray));
    let mut verdict = Verdict {
        missed: closest.is_none() || !occluded,
        different: closest.as_ref().map(bits) != truth.as_ref().map(bits),
    };
    if let Some(all) = all {
        accel.all_hits(ray, hits);
        // From inside to outside the surface is crossed an odd number of times.
        verdict.missed |= hits.len().is_multiple_of(2);
        verdict.different |= hits.iter().map(bits).ne(all.iter().map(bits));
    }
    verdict
}

fn bits(hit: &Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.tri.0]
}

impl Tally {
    fn of(structures: usize) -> Self {
        Self { by_structure: vec![Default::default(); structures], ..Self::default() }
    }

    fn count(&mut self, structure: usize, aim: usize, casts: u64, verdict: Verdict) {
        let [all, misses, different] = &mut self.by_structure[structure][aim];
        let [missed, differs] = [verdict.missed, verdict.different].map(u64::from);
        (*all, *misses, *different) = (*all + casts, *misses + missed, *different + differs);
        (self.casts, self.misses, self.different) =
            (self.casts + casts, self.misses + missed, self.different + differs);
    }

    fn note(&mut self, fault: impl FnOnce() -> String) {
        if self.faults.len() < FAULTS {
            self.faults.push(fault());
        }
    }

    /// Both together.
    #[must_use]
    pub fn plus(mut self, other: Self) -> Self {
        self.rays += other.rays;
        self.casts += other.casts;
        self.misses += other.misses;
        self.different += other.different;
        self.by_structure.resize(self.by_structure.len().max(other.by_structure.len()), Default::default());
        for (mine, theirs) in self.by_structure.iter_mut().zip(&other.by_structure) {
            mine.as_flattened_mut().iter_mut().zip(theirs.as_flattened()).for_each(|(mine, theirs)| *mine += theirs);
        }
        self.by_level.resize(self.by_level.len().max(other.by_level.len()), 0);
        self.by_level.iter_mut().zip(&other.by_level).for_each(|(mine, theirs)| *mine += theirs);
        self.faults.extend(other.faults);
        self.faults.truncate(FAULTS);
        self
    }

    /// Whether nothing was missed, and nothing differed.
    pub fn is_clean(&self) -> bool {
        self.misses == 0 && self.different == 0
    }
}

/// Rays of one aim from inside a mesh, for other programs; the planes are those of our default structure.
///
/// # Errors
/// A structure that can't be built.
pub fn aimed_from_inside(closed: &Closed, aim: Aim, count: usize, seed: u64) -> Result<Vec<Ray>, rdh::Error> {
    let accel = rdh::build(&closed.mesh, &Spec::default(), &Training::none(), &BuildOptions::default())?;
    let (range, mut random) = (Range::new(closed, std::iter::once(&accel)), Random::new(seed, aim as u64));
    Ok((0..count).map(|_| range.ray(aim, &mut random)).collect())
}

/// A mesh that was read, if it is closed: with balls inside that are found by rays from a grid of points.
pub fn closed_model(name: &str, mesh: &Mesh) -> Option<Closed> {
    let inside = if is_closed(mesh) { closed::find_inside(mesh) } else { Vec::new() };
    (!inside.is_empty()).then(|| Closed { name: name.to_owned(), mesh: mesh.clone(), inside, weight: 1.0 })
}
