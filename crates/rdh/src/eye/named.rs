//! What a spec names: trees around an eye, and a hierarchy for all other rays.

use super::EyeTree;
use super::spec::{EyeForm, EyeOptions, EyeSpec};
use crate::accel;
use crate::bvh::BvhSpec;
use crate::error::{Error, Result};
use crate::geom::Vec3;
use crate::heuristic::HeuristicSpec;
use crate::mesh::Mesh;
use crate::options::BuildOptions;
use crate::rays::Training;
use crate::spec::{Spec, StructureSpec};

impl EyeSpec {
    /// The same, with its place: where most of the training rays start, if it was left open.
    pub(crate) fn placed(self, rays: &Training) -> Result<Self> {
        match self.place.or_else(|| common_origin(rays)) {
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
        Spec { structure: StructureSpec::Eye(EyeSpec { place: Some(self.eye), form: self.form }), heuristic }
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

fn unplaced(eye: EyeSpec) -> Error {
    let spec = Spec { structure: StructureSpec::Eye(eye), heuristic: HeuristicSpec::Sah };
    let reason = match eye.form {
        EyeForm::From => "no two of the training rays start at one point",
        EyeForm::Towards => "rays don't tell where their light is: light=X,Y,Z",
    };
    Error::Spec { spec: spec.to_string(), reason: reason.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;
    use crate::rays::{Query, RayClass, RaySample};

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
}
