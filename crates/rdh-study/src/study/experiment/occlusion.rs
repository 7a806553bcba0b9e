//! Where knowing the rays pays: the gain beside the measured depth complexity.

use rdh::{Accel, Ray};

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::study::lab::{Setting, entrants};
use crate::study::scope::Sample;

pub(super) struct Occlusion;

const SPECS: &str = "kd+sah,kd+rdh(paper),kd+rdh";
/// Lower bounds of the classes of depth complexity.
const CLASSES: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
/// One in so many rays is followed through everything.
const STRIDE: usize = 16;

impl Experiment for Occlusion {
    fn name(&self) -> &'static str {
        "occlusion"
    }

    fn question(&self) -> &'static str {
        "Does the gain grow with occlusion: with the number of surfaces that lie behind each other?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::ALL, &[Mode::Primary])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let view = lab.view(&found.job.view)?;
        let batches = lab.rays(&view, Mode::Primary);
        let rays = batches.iter().flat_map(|b| &b.rays).step_by(STRIDE);
        let depth = depth_complexity(&lab.first, rays);
        let lesson = lab.lesson(&view, Mode::Primary, Protocol::Unseen, lab.plan.training);
        let wanted: Vec<_> = specs(SPECS)?.into_iter().map(|spec| (spec, &lesson)).collect();
        let built = lab.build(&wanted, found);
        let settings = vec![vec![class_of(depth)]; built.len()];
        lab.measure(&entrants(&built, &settings), &batches, found);
        for row in &mut found.rows {
            row.depth_complexity = Some(depth);
        }
        Ok(())
    }
}

/// The mean number of surfaces along the rays that meet any, if nothing stopped them; 0 if none does.
fn depth_complexity<'r>(accel: &Accel, rays: impl Iterator<Item = &'r Ray>) -> f64 {
    let mut hits = Vec::new();
    let (mut surfaces, mut met) = (0, 0);
    for ray in rays {
        accel.all_hits(ray, &mut hits);
        surfaces += hits.len();
        met += usize::from(!hits.is_empty());
    }
    if met == 0 { 0.0 } else { surfaces as f64 / met as f64 }
}

fn class_of(depth: f64) -> Setting {
    let low = CLASSES.into_iter().rev().find(|&low| depth >= low);
    let name = |low: f64| match CLASSES.iter().find(|&&high| high > low) {
        Some(high) => format!("{low} to {high} surfaces behind each other"),
        None => format!("{low} or more surfaces behind each other"),
    };
    low.map_or_else(|| Setting::named("nothing in sight"), |low| Setting::at(name(low), low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rdh::{BuildOptions, Mesh, Spec, Training};

    #[test]
    fn classes_have_names() {
        let names = [0.0, 1.0, 2.5, 17.0].map(|d| class_of(d).text);
        let expected = ["nothing in sight", "1 to 2", "2 to 4", "16 or more"];
        assert!(names.iter().zip(expected).all(|(name, start)| name.starts_with(start)), "{names:?}");
    }

    #[test]
    fn surfaces_behind_each_other_are_counted_for_rays_that_meet_any() {
        let corners = |z: f32| [[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]];
        let positions: Vec<[f32; 3]> = [1.0, 2.0, 3.0].into_iter().flat_map(corners).collect();
        let mesh = Mesh::new(positions, (0..3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap();
        let accel = rdh::build(&mesh, &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        let rays = [0.0, 1.5, 5.0].map(|z| Ray::new([0.0, 0.0, z], [0.0, 0.0, 1.0]));
        assert_eq!(depth_complexity(&accel, rays.iter()), 2.5);
        assert_eq!(depth_complexity(&accel, rays[2..].iter()), 0.0);
    }
}
