//! What a spec names: trees around an eye, and a hierarchy for all other rays.

use super::EyeTree;
use super::spec::{EyeForm, EyeOptions, EyeSpec};
use crate::accel;
use crate::bvh::BvhSpec;
use crate::error::{Error, Result};
use crate::geom::{Ray, Vec3};
use crate::heuristic::HeuristicSpec;
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::rays::{RayClass, Training};
use crate::spec::{Spec, StructureSpec};

impl EyeSpec {
    /// The same, with its place, if it was left open: where most of the training rays start, or the shadow rays among them end.
    pub(crate) fn placed(self, rays: &Training) -> Result<Self> {
        let common = if self.form == EyeForm::Towards { common_end } else { common_origin };
        match self.place.or_else(|| common(rays)) {
            Some(place) => Ok(Self { place: Some(place), ..self }),
            None => Err(unplaced(self)),
        }
    }

    /// Builds the hierarchy by the same heuristic, then the trees around the eye within what is left of the budget.
    pub(crate) fn build(
        self,
        mesh: &Mesh,
        heuristic: HeuristicSpec,
        rays: &Training,
        options: &BuildOptions<'_>,
    ) -> Result<EyeTree> {
        let Some(eye) = self.place else { return Err(unplaced(self)) };
        let world = Spec { structure: StructureSpec::Bvh(BvhSpec::default()), heuristic };
        let world = accel::build(mesh, &world, rays, options)?;
        let left = options.max_bytes.map(|limit| limit.saturating_sub(world.stats().bytes));
        let none = Training::none();
        let rays = if heuristic == HeuristicSpec::Sah { &none } else { rays };
        let form = EyeOptions { form: self.form, ..EyeOptions::default() };
        EyeTree::build(world, eye, rays, &form, &BuildOptions { max_bytes: left, ..*options })
    }
}

impl EyeTree {
    /// What names it.
    pub(crate) fn spec(&self) -> Spec {
        let heuristic = if self.trained_on > 0 { HeuristicSpec::Rdh(Default::default()) } else { HeuristicSpec::Sah };
        Spec { structure: StructureSpec::Eye(EyeSpec { place: Some(self.eye()), form: self.form }), heuristic }
    }
}

/// The point from which rays of the largest weight start, bit for bit, and more than one of them; of equal ones the first in order of bits.
fn common_origin(rays: &Training) -> Option<Vec3> {
    let valid = rays.samples().iter().filter(|s| s.ray.is_valid());
    let mut starts: Vec<([u32; 3], u64)> =
        valid.map(|s| (s.ray.origin.map(f32::to_bits), u64::from(s.weight))).collect();
    starts.sort_unstable();
    let groups = starts.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1);
    let weighed = groups.map(|group| (group.iter().map(|(_, weight)| weight).sum::<u64>(), group[0].0));
    let most = weighed.reduce(|most, next| if next.0 > most.0 { next } else { most });
    most.map(|(_, bits)| bits.map(f32::from_bits))
}

/// So many shadow rays say where a light may be.
const SEEDS: usize = 64;
/// Rays end at one point if their ends are not farther apart than this, in units of the largest coordinate.
const NEAR: f64 = 1e-5;

/// The point at which shadow rays of the largest weight end, and more than one of them: in the middle of what rounding makes of it.
fn common_end(rays: &Training) -> Option<Vec3> {
    let shadow = rays.samples().iter().filter(|s| s.class == RayClass::Shadow && s.ray.is_valid());
    let ends: Vec<([f64; 3], f64)> = shadow.map(|s| (end_of(&s.ray), f64::from(s.weight))).collect();
    let finite = |end: &[f64; 3]| end.iter().all(|x| x.is_finite());
    let seeds = ends.iter().step_by(ends.len().div_ceil(SEEDS).max(1)).filter(|(end, _)| finite(end));
    let groups = seeds.map(|(seed, _)| group(&ends, seed)).filter(|group| group.count > 1);
    let most = groups.reduce(|most, next| if next.weight > most.weight { next } else { most })?;
    Some(most.sum.map(|x| (x / most.weight) as f32))
}

/// Where a ray ends, if it does.
fn end_of(ray: &Ray) -> [f64; 3] {
    [0, 1, 2].map(|a| f64::from(ray.origin[a]) + f64::from(ray.t_max) * f64::from(ray.direction[a]))
}

/// Ends of rays that are one point but for rounding.
struct Group {
    count: usize,
    weight: f64,
    /// Of the ends, by weight.
    sum: [f64; 3],
}

fn group(ends: &[([f64; 3], f64)], seed: &[f64; 3]) -> Group {
    let near = NEAR * seed.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    let mut group = Group { count: 0, weight: 0.0, sum: [0.0; 3] };
    for (end, weight) in ends.iter().filter(|(end, _)| (0..3).all(|a| (end[a] - seed[a]).abs() <= near)) {
        group.count += 1;
        group.weight += weight;
        (0..3).for_each(|a| group.sum[a] += weight * end[a]);
    }
    group
}

fn unplaced(eye: EyeSpec) -> Error {
    let spec = Spec { structure: StructureSpec::Eye(eye), heuristic: HeuristicSpec::Sah };
    let reason = match eye.form {
        EyeForm::From => "no two of the training rays start at one point",
        EyeForm::Towards => "no two of the shadow rays among the training rays end at one point: light=X,Y,Z",
    };
    Error::Spec { spec: spec.to_string(), reason: reason.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::{Query, RaySample};
    use crate::soup::numbers;

    fn from(origin: Vec3, weight: u32) -> RaySample {
        let ray = Ray::new(origin, [1.0, 2.0, 3.0]);
        RaySample { weight, ..RaySample::new(ray, None, Query::Closest, RayClass::Primary) }
    }

    #[test]
    fn the_eye_is_where_most_rays_start() {
        let (a, b, c) = ([1.0, 2.0, 3.0], [-1.0, 0.0, 5.0], [7.0; 3]);
        let found = |samples: Vec<RaySample>| common_origin(&Training::from_samples(samples));
        assert_eq!(found(vec![]), None);
        assert_eq!(found(vec![from(a, 1), from(b, 9), from(c, 1)]), None);
        assert_eq!(found(vec![from(a, 1), from(b, 1), from(c, 9), from(a, 1)]), Some(a));
        assert_eq!(found(vec![from(a, 1), from(b, 2), from(a, 1), from(b, 2)]), Some(b));
        assert_eq!(found([from([f32::NAN; 3], 9); 2].to_vec()), None);
        // Zeros of other signs are other points.
        assert_eq!(found(vec![from([0.0; 3], 1), from([-0.0; 3], 1)]), None);
    }

    #[test]
    fn the_light_is_where_most_shadow_rays_end() {
        let mut number = numbers(3);
        let mut to = |light: Vec3, class: RayClass| {
            let origin = [number(), number(), number()].map(|x| 3.0 * x);
            let way: [f64; 3] = [0, 1, 2].map(|a| f64::from(light[a]) - f64::from(origin[a]));
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            let ray = Ray::new(origin, way.map(|x| (x / length) as f32)).within(0.0, length as f32);
            RaySample::new(ray, None, Query::Occluded, class)
        };
        let (lamp, window) = ([1.5, -2.25, 4.0], [-7.0, 1.0, 0.5]);
        let mut samples: Vec<RaySample> = (0..300).map(|_| to(lamp, RayClass::Shadow)).collect();
        samples.extend((0..200).map(|_| to(window, RayClass::Shadow)));
        samples.extend((0..900).map(|_| to(window, RayClass::Ao)));
        samples.extend([from([0.0; 3], 9), RaySample { class: RayClass::Shadow, ..from([1.0; 3], 9) }]);
        let end = common_end(&Training::from_samples(samples)).expect("they meet");
        assert!((0..3).all(|a| (end[a] - lamp[a]).abs() <= 2e-6), "{end:?}");
        assert_eq!(common_end(&Training::none()), None);
        assert_eq!(common_end(&Training::from_samples(vec![to(lamp, RayClass::Shadow)])), None);
    }
}
