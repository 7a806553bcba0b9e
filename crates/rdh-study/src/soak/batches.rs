//! The same aims for whole batches: every form in which rays are cast together, beside each of its rays alone.

use rayon::prelude::*;
use rdh::eye::{EyeForm, EyeOptions, EyeTree};
use rdh::simd::Level;
use rdh::{Accel, BuildOptions, Hit, Ray, Spec, Training, Vec3};
use serde::{Deserialize, Serialize};

use super::aim::{Aim, Range, between, start};
use super::closed::Closed;
use super::{FAULTS, bits, ray_bits};
use crate::integrate::{Random, derived_seed};

/// A form of batches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// 64 neighbours each, from one point or side by side, round a vertex or a point of an edge and exactly through it.
    Tiles,
    /// Rows of a picture, one of whose rays goes through a vertex.
    Rows,
    /// Any rays of [`Aim`], one after the other: some batches are large enough to be sorted.
    Shuffled,
    /// Tiles through trees around the point from which they start.
    EyeTiles,
    /// Rows through the same.
    EyeRows,
    /// Rays that end at a point inside: 64 neighbours each, through the same structures as tiles, too.
    Light,
}

impl Form {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 6] = [Self::Tiles, Self::Rows, Self::Shuffled, Self::EyeTiles, Self::EyeRows, Self::Light];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tiles => "tiles",
            Self::Rows => "rows",
            Self::Shuffled => "shuffled",
            Self::EyeTiles => "tiles from an eye",
            Self::EyeRows => "rows from an eye",
            Self::Light => "tiles to a light",
        }
    }
}

/// What came of the batches on one mesh, or on several.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Batches {
    /// For each form: rays cast through a structure, misses, answers other than those of single rays.
    pub by_form: [[u64; 3]; Form::ALL.len()],
    /// The first faults, a line each, with the rays' bits.
    pub faults: Vec<String>,
}

/// Rays of a batch.
const BATCH: usize = 1024;
/// Rays of a batch that is sorted, on up to eight threads: of few different ones, so that many start in one place.
const SORTED: usize = 32 * BATCH;
/// Rays of a tile.
const TILE: usize = 64;
/// Rays of a row.
const ROW: usize = 32;
/// What batches go through; the first one alone says what is right.
const SPECS: &str = "bvh8+sah,bvh8(compact)+sah,kd+sah";

/// Casts `share` rays of each form at a mesh, on all threads of rayon's current pool; the same rays and results on any number of them.
///
/// # Errors
/// A structure that can't be built.
pub fn soak_batches(closed: &Closed, number: usize, share: u64, seed: u64) -> Result<Batches, rdh::Error> {
    let specs = Spec::list(SPECS)?;
    let build = |spec| rdh::build(&closed.mesh, spec, &Training::none(), &BuildOptions::default());
    let structures: Vec<Accel> = specs.iter().map(build).collect::<Result<_, _>>()?;
    let eye = closed.inside[0].centre;
    let around = |form| -> Result<Accel, rdh::Error> {
        let options = EyeOptions { form, ..EyeOptions::default() };
        let world = structures[0].clone();
        Ok(EyeTree::build(world, eye, &Training::none(), &options, &BuildOptions::default())?.into())
    };
    let (from, to) = (around(EyeForm::From)?, around(EyeForm::Towards)?);
    let range = Range::new(closed, structures.iter());
    let at = |level| Cast {
        closed,
        range: &range,
        structures: structures.iter().map(|accel| accel.clone().with_level(level)).collect(),
        around: [&from, &to].map(|accel| accel.clone().with_level(level)),
        eye,
    };
    let levels: Vec<Cast<'_>> = Level::available().into_iter().map(at).collect();
    let seed = derived_seed(derived_seed(seed, number as u64), u64::from(b'B'));
    let rounds = share.div_ceil(BATCH as u64).max(levels.len() as u64);
    let round = |round: u64| {
        let mut batches = Batches::default();
        for (which, form) in Form::ALL.into_iter().enumerate() {
            let mut random = Random::new(seed, round * Form::ALL.len() as u64 + which as u64);
            levels[round as usize % levels.len()].batch(form, &mut random, &mut batches);
        }
        batches
    };
    Ok((0..rounds).into_par_iter().map(round).reduce(Batches::default, Batches::plus))
}

/// Everything at one level.
struct Cast<'a> {
    closed: &'a Closed,
    range: &'a Range<'a>,
    structures: Vec<Accel>,
    /// Trees around the eye, and the same point as a light.
    around: [Accel; 2],
    eye: Vec3,
}

impl Cast<'_> {
    fn batch(&self, form: Form, random: &mut Random, batches: &mut Batches) {
        let rays = self.rays(form, random);
        let (world, around) = (self.structures.iter(), self.around.iter());
        let through: Vec<&Accel> = match form {
            Form::Tiles | Form::Rows | Form::Shuffled => world.collect(),
            Form::EyeTiles | Form::EyeRows => around.collect(),
            Form::Light => around.skip(1).chain(world).collect(),
        };
        let alone: Vec<Option<Hit>> = rays.iter().map(|ray| self.structures[0].closest(ray)).collect();
        for (which, accel) in through.iter().enumerate() {
            let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
            accel.occluded_many(&rays, &mut occluded);
            accel.closest_many(&rays, &mut hits);
            let [casts, misses, different] = &mut batches.by_form[form as usize];
            *casts += 2 * rays.len() as u64;
            for (i, ray) in rays.iter().enumerate() {
                let missed = hits[i].is_none() || !occluded[i];
                let differs = hits[i].as_ref().map(bits) != alone[i].as_ref().map(bits);
                *misses += u64::from(missed);
                *different += u64::from(differs);
                if (missed || differs) && batches.faults.len() < FAULTS {
                    let (name, form) = (&self.closed.name, form.name());
                    let (found, expected) = (&hits[i], &alone[i]);
                    let answer = format!("{found:?} and {}, expected {expected:?}", occluded[i]);
                    batches
                        .faults
                        .push(format!("{name}, {form}, structure {which}, {i}: {answer}; ray {}", ray_bits(ray)));
                }
            }
        }
    }

    fn rays(&self, form: Form, random: &mut Random) -> Vec<Ray> {
        match form {
            Form::Shuffled => {
                let rays: Vec<Ray> = (0..BATCH).map(|i| self.range.ray(Aim::ALL[i % Aim::ALL.len()], random)).collect();
                if random.below(8) > 0 { rays } else { (0..SORTED).map(|_| rays[random.below(BATCH)]).collect() }
            }
            Form::Tiles | Form::EyeTiles => {
                (0..BATCH / TILE).flat_map(|_| self.tile(form == Form::EyeTiles, random)).collect()
            }
            Form::Rows | Form::EyeRows => self.rows(form == Form::EyeRows, random),
            Form::Light => (0..BATCH / TILE).flat_map(|_| self.towards(random)).collect(),
        }
    }

    fn origin(&self, at_eye: bool, random: &mut Random) -> Vec3 {
        let ball = random.below(self.closed.inside.len());
        if at_eye { self.eye } else { start(&self.closed.inside[ball], random) }
    }

    fn target(&self, random: &mut Random) -> Vec3 {
        if random.below(2) == 0 { self.range.vertex(random) } else { self.range.point_of_edge(random) }
    }

    /// Neighbours round a target, and a fourth of them exactly at it.
    fn tile(&self, at_eye: bool, random: &mut Random) -> Vec<Ray> {
        let (from, at) = (self.origin(at_eye, random), self.target(random));
        let (direction, width) = (difference(at, from), 0.5f32.powi(3 + random.below(28) as i32));
        let ball = &self.closed.inside[0];
        // Some start side by side instead; the ball's points are all inside.
        let beside = !at_eye && from == ball.centre && random.below(2) == 0;
        let one = |_| {
            let exact = random.below(4) == 0;
            let size = if exact { 0.0 } else { width * largest(direction) };
            if beside {
                let shift = if exact { 0.0 } else { 0.5 * width * ball.radius };
                Ray::new(from.map(|x| x + between(-shift, shift, random)), direction)
            } else {
                Ray::new(from, direction.map(|x| x + between(-size, size, random)))
            }
        };
        (0..TILE).map(one).collect()
    }

    /// Rows of a picture.
    fn rows(&self, at_eye: bool, random: &mut Random) -> Vec<Ray> {
        let (from, at) = (self.origin(at_eye, random), self.target(random));
        let direction = difference(at, from);
        let step = 0.5f32.powi(6 + random.below(16) as i32) * largest(direction);
        let across = (0..3).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap_or(0);
        let (right, down) = ((across + 1) % 3, (across + 2) % 3);
        let ray = |i: usize| {
            let mut pixel = direction;
            pixel[right] += ((i % ROW) as f32 - 7.0) * step;
            pixel[down] += ((i / ROW) as f32 - 5.0) * step;
            Ray::new(from, pixel)
        };
        (0..BATCH).map(ray).collect()
    }

    /// Neighbours that end at the eye and start outside, behind a target.
    fn towards(&self, random: &mut Random) -> Vec<Ray> {
        let (at, bounds) = (self.target(random), self.closed.mesh.bounds());
        let out = difference(at, self.eye);
        let far = bounds.diagonal() / length(out).max(f32::MIN_POSITIVE);
        let width = 0.5f32.powi(3 + random.below(28) as i32);
        let is_outside = |p: Vec3| (0..3).any(|a| p[a] < bounds.min[a] || p[a] > bounds.max[a]);
        let mut one = || {
            let size = if random.below(4) == 0 { 0.0 } else { width * largest(out) };
            let aside = out.map(|x| x + between(-size, size, random));
            // Near the box, if that is outside of it.
            let from = [0.55, 0.8, 1.5].map(|part| [0, 1, 2].map(|a| self.eye[a] + part * far * aside[a]));
            let from = from.into_iter().find(|&p| is_outside(p)).unwrap_or(from[2]);
            Ray::new(from, difference(self.eye, from)).within(0.0, 1.0)
        };
        (0..TILE).map(|_| one()).collect()
    }
}

impl Batches {
    /// Both together.
    #[must_use]
    pub fn plus(mut self, other: Self) -> Self {
        let mine = self.by_form.as_flattened_mut().iter_mut();
        mine.zip(other.by_form.as_flattened()).for_each(|(mine, theirs)| *mine += theirs);
        self.faults.extend(other.faults);
        self.faults.truncate(FAULTS);
        self
    }

    /// Whether nothing was missed, and nothing differed.
    pub fn is_clean(&self) -> bool {
        self.by_form.iter().all(|[_, misses, different]| misses + different == 0)
    }
}

fn difference(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn largest(x: Vec3) -> f32 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

fn length(x: Vec3) -> f32 {
    x.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt() as f32
}
