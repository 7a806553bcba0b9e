//! A part of a batch, as one thread casts it: runs of rays that are the eye's walk together where that is cheaper, all others are the
//! other structure's.

use std::ops::RangeInclusive;

use super::EyeTree;
use super::effort::Budget;
use super::spec::EyeForm;
use super::{shadow, tile};
use crate::geom::{Hit, Ray};
use crate::tile::Windows;

/// Fewer rays of a kind in a row go one by one: others may make something of more.
const FEWEST: usize = 16;
/// Rays of which three tell whether they are towards the eye.
const GROUP: usize = 64;
/// So many windows of a part tell what its rays cost, …
const TOLD_BY: usize = 8;
/// … or one in so many: fewer of a small part, and none of one that is smaller.
const ONE_IN: RangeInclusive<usize> = 32..=128;

impl EyeTree {
    /// The nearest hit of each ray; `width` is how many rays a row has, if they are whole rows of a picture.
    pub(crate) fn closest_part(&self, rays: &[Ray], hits: &mut [Option<Hit>], width: Option<usize>) {
        let mut from = 0;
        for run in rays.chunk_by(|a, b| self.starts_at_eye(a) == self.starts_at_eye(b)) {
            let hits = &mut hits[from..from + run.len()];
            let width = width.filter(|_| run.len() == rays.len());
            from += run.len();
            if run.len() < FEWEST {
                run.iter().zip(hits).for_each(|(ray, hit)| *hit = self.closest(ray));
                continue;
            }
            let is_own = self.starts_at_eye(&run[0]);
            match is_own.then(|| budget(run, width, |some| self.closest_efforts(some))).flatten() {
                Some(budget) => _ = self.level.run(tile::Closest { tree: self, rays: run, width, budget, hits }),
                None => self.world.closest_part(run, hits, width),
            }
        }
    }

    /// What some rays from the eye cost here, and together in the other structure.
    fn closest_efforts(&self, rays: &[Ray]) -> Option<[u64; 2]> {
        let mut hits = [None; tile::TILE];
        let hits = &mut hits[..rays.len()];
        let others = self.world.closest_effort(rays, hits)?;
        let budget = Budget::of(others, rays.len());
        let own = self.level.run(tile::Closest { tree: self, rays, width: None, budget, hits });
        Some([own.cycles(), others])
    }

    /// The same for rays towards it.
    fn occluded_efforts(&self, rays: &[Ray]) -> Option<[u64; 2]> {
        let mut found = [false; tile::TILE];
        let found = &mut found[..rays.len()];
        let others = self.world.occluded_effort(rays, found)?;
        let budget = Budget::of(others, rays.len());
        let own = self.level.run(shadow::Occluded { tree: self, rays, budget, found });
        Some([own.cycles(), others])
    }

    /// Whether each ray hits anything.
    pub(crate) fn occluded_part(&self, rays: &[Ray], found: &mut [bool], width: Option<usize>) {
        let mut from = 0;
        while from < rays.len() {
            let is_for = self.is_for(first_group(&rays[from..]));
            let mut to = from;
            while to < rays.len() && self.is_for(first_group(&rays[to..])) == is_for {
                to = (to + GROUP).min(rays.len());
            }
            let (run, found) = (&rays[from..to], &mut found[from..to]);
            match is_for.then(|| budget(run, None, |some| self.occluded_efforts(some))).flatten() {
                Some(budget) => _ = self.level.run(shadow::Occluded { tree: self, rays: run, budget, found }),
                None => self.world.occluded_part(run, found, width.filter(|_| run.len() == rays.len())),
            }
            from = to;
        }
    }

    /// Whether a ray starts at the eye, bit for bit: that of −0 and 0 would make zeros of other signs.
    #[inline(always)]
    pub(super) fn starts_at_eye(&self, ray: &Ray) -> bool {
        ray.origin.map(f32::to_bits) == self.eye().map(f32::to_bits)
    }

    /// Whether some rays are probably the eye's, by the first, the last and one in between.
    fn is_for(&self, group: &[Ray]) -> bool {
        let last = group.len() - 1;
        [0, last / 2, last].iter().any(|&i| {
            let ray = &group[i];
            self.starts_at_eye(ray) || self.form == EyeForm::Towards && self.approaching(ray).is_some()
        })
    }
}

/// What rays may cost here, if they don't cost more than in the other structure, as some of them tell whose costs are `efforts`: where
/// triangles are smaller than what is between two rays, each is looked at for few of them.
fn budget(rays: &[Ray], width: Option<usize>, efforts: impl Fn(&[Ray]) -> Option<[u64; 2]>) -> Option<Budget> {
    let every = (rays.len() / tile::TILE / TOLD_BY).clamp(*ONE_IN.start(), *ONE_IN.end());
    if rays.len() < every * tile::TILE {
        return Some(Budget::USUAL);
    }
    let (mut sums, mut count, mut next) = ([0, 0], 0, 0);
    let mut windows = Windows::new(rays.len(), width);
    for i in 0.. {
        // One of so many, each time elsewhere among them: the first ones would be a column of the picture.
        let place = i * every + (every * (158 * (i + 1) % 256)) / 256;
        let choice = windows.nth(place - next);
        next = place + 1;
        if choice.rays().is_empty() {
            break;
        }
        let mut some = [rays[0]; tile::TILE];
        some.iter_mut().zip(choice.rays()).for_each(|(ray, &i)| *ray = rays[i as usize]);
        let Some([own, others]) = efforts(&some[..choice.rays().len()]) else { break };
        (sums, count) = ([sums[0] + own, sums[1] + others], count + choice.rays().len());
    }
    if count == 0 {
        return Some(Budget::USUAL);
    }
    let [own, others] = sums;
    (own <= others).then(|| Budget::of(others, count))
}

fn first_group(rays: &[Ray]) -> &[Ray] {
    &rays[..rays.len().min(GROUP)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::EyeOptions;
    use crate::geom::Vec3;
    use crate::simd::Level;
    use crate::soup::{numbers, soup};
    use crate::{BuildOptions, Mesh, Spec, Training, build};

    /// Rays through the pixels of a picture, from a corner of the box [-1, 1]³.
    fn picture(width: usize) -> Vec<Ray> {
        let at = |i: usize| (i as f32 + 0.5) / width as f32 - 0.5;
        (0..width * width).map(|i| Ray::new([-1.0; 3], [1.0, 1.0 + at(i % width), 1.0 + at(i / width)])).collect()
    }

    /// A wavy sheet that fills the picture, of so many squares each way.
    fn sheet(squares: u32) -> Mesh {
        let (side, at) = (squares + 1, |i: u32| 2.0 * i as f32 / squares as f32 - 0.9);
        let height = |i: u32| 0.02 * (0.7 * i as f32).sin();
        let positions = (0..side * side).map(|i| [0.8 + height(i), at(i % side), at(i / side)]).collect();
        let square = |i: u32| [[i, i + 1, i + side], [i + 1, i + side + 1, i + side]];
        let corners = (0..side * side).filter(|i| i % side < squares && i / side < squares);
        Mesh::new(positions, corners.flat_map(square).collect()).expect("a valid mesh")
    }

    fn around(mesh: &Mesh, eye: Vec3, form: EyeForm) -> EyeTree {
        let spec = "bvh8+sah".parse::<Spec>().expect("a spec");
        let world = build(mesh, &spec, &Training::none(), &BuildOptions::default()).expect("it builds");
        let options = (EyeOptions { form, ..EyeOptions::default() }, BuildOptions::default());
        EyeTree::build(world, eye, &Training::none(), &options.0, &options.1).expect("it builds")
    }

    #[test]
    fn triangles_smaller_than_what_is_between_rays_are_left_to_the_other_structure() {
        let rays = picture(128);
        // Of many large triangles most are hidden, and not looked at.
        for (mesh, is_dearer) in [(sheet(150), true), (soup(3_000, 0.6), false)] {
            let tree = around(&mesh, [-1.0; 3], EyeForm::From);
            let efforts = |some: &[Ray]| tree.closest_efforts(some);
            assert_eq!(budget(&rays, Some(128), efforts).is_none(), is_dearer);
            assert_eq!(budget(&rays[..31 * GROUP], None, efforts), Some(Budget::USUAL), "too few rays to try");
            let mut hits = vec![None; rays.len()];
            tree.closest_part(&rays, &mut hits, Some(128));
            let alone: Vec<Option<Hit>> = rays.iter().map(|ray| tree.world().closest(ray)).collect();
            assert!(hits == alone && hits.iter().flatten().count() > 1000);
        }
    }
    /// Rays that start here and there and end at a point, those of each 64 more or less side by side.
    fn rays_to(eye: Vec3) -> Vec<Ray> {
        let mut number = numbers(5);
        let mut rays = Vec::new();
        for spread in [0.01, 0.1, 1.0].repeat(12) {
            let center = [number(), number(), number()];
            rays.extend((0..60).map(|_| {
                let origin = [0, 1, 2].map(|a| (1.0 - spread) * center[a] + spread * number());
                Ray::new(origin, [0, 1, 2].map(|a| eye[a] - origin[a])).within(0.0, 1.0)
            }));
        }
        rays
    }

    #[test]
    fn whatever_tiles_may_cost_the_answers_are_the_same() {
        let (mesh, eye) = (soup(3_000, 0.1), [0.1, -0.2, 0.3]);
        let (from, towards) = (around(&mesh, eye, EyeForm::From), around(&mesh, eye, EyeForm::Towards));
        let to = rays_to(eye);
        let away: Vec<Ray> = to.iter().map(|ray| Ray::new(eye, ray.direction)).collect();
        let right: Vec<Option<Hit>> = away.iter().map(|ray| from.world().closest(ray)).collect();
        let stopped: Vec<bool> = to.iter().map(|ray| towards.world().occluded(ray)).collect();
        assert!(stopped.iter().filter(|&&is| is).count() > 500 && stopped.iter().filter(|&&is| !is).count() > 500);
        for level in Level::available() {
            for budget in [Budget::of(0, 1), Budget::of(60, 1), Budget::USUAL, Budget::of(1 << 40, 1)] {
                let (mut hits, mut found) = (vec![None; away.len()], vec![false; to.len()]);
                let closest = tile::Closest { tree: &from, rays: &away, width: None, budget, hits: &mut hits };
                level.run(closest);
                level.run(shadow::Occluded { tree: &towards, rays: &to, budget, found: &mut found });
                assert!(hits == right && found == stopped, "{budget:?}, {}", level.name());
            }
        }
    }
}
