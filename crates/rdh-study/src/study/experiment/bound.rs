//! What is left: how far from SAH, and from RDH, is the best tree there could be?

use rdh_scene::catalog;

use super::{Experiment, Job, Lab, Record, Scope};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::rows::Curve;
use crate::study::bound::{SEARCHED_UP_TO, bounds};
use crate::study::scope::Sample;

pub(super) struct Bound;

/// The first view of scenes in which a search gets somewhere.
const SAMPLE: Sample = Sample { triangles: SEARCHED_UP_TO, quick_triangles: 5_000, ..Sample::MEDIUM };
/// Rays to learn from, and as many to pay.
const RAYS: usize = 4096;
/// Scenes whose generator also makes a version that is small enough for the optimum: its lattice holds most of the planes
/// that the builder would choose.
const REDUCED: [(&str, &str); 6] = [
    ("tetra5", "tetra(size=3)"),
    ("teapot4", "teapot(size=1)"),
    ("balls3", "balls(size=1,resolution=1)"),
    ("jacks3", "jacks(size=1,resolution=1)"),
    ("lattice6", "lattice(size=1,resolution=1)"),
    ("tree8", "tree(size=2,resolution=1)"),
];

impl Experiment for Bound {
    fn name(&self) -> &'static str {
        "bound"
    }

    fn question(&self) -> &'static str {
        "What could any kd-tree gain: the optimum over all trees of a lattice, trees that know the test rays, and a search for better ones?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), SAMPLE, &[Mode::Primary, Mode::Path])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        bound(lab, found)?;
        if let Some((_, reduced)) = REDUCED.iter().find(|(id, _)| *id == lab.entry.id) {
            let entry = catalog::find(reduced, &[]).map_err(|e| e.to_string())?;
            bound(&lab.at_scene(&entry)?, found)?;
        }
        Ok(())
    }
}

/// Curves of one point each, over the number of triangles.
fn bound(lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
    let mode = found.job.mode;
    // A reduced scene is seen as its larger version is.
    let view = lab.view(&found.job.view)?;
    let training = lab.lesson(&view, mode, Protocol::Unseen, RAYS).training;
    let test = lab.sample(&view, mode, RAYS);
    let triangles = lab.mesh().len() as f64;
    for bound in bounds(lab.mesh(), &training, &test).map_err(|e| e.to_string())? {
        let curve = found.curve(bound.name, bound.spec, "triangles", vec![[triangles, bound.ratio, 1.0]]);
        found.curves.push(Curve { scene: lab.entry.id.clone(), ..curve });
    }
    Ok(())
}
