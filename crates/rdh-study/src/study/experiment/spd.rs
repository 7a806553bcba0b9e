//! Our rays beside those that others counted: the Standard Procedural Databases, as V. Havran published them in 1999.

use rdh::{RayClass, Spec};

use super::{Experiment, Job, Lab, Record, Scope};
use crate::integrate::Mode;
use crate::measure::tally;

pub(super) struct Spd;

/// Numbers of rays of Whitted ray tracing, for 513 × 513 eye rays, depth 5, and shadow rays towards front-facing lights only.
#[derive(Debug, Clone, Copy)]
pub struct Published {
    /// The scene's id.
    pub scene: &'static str,
    /// Eye rays that hit something.
    pub eye_hits: f64,
    /// Shadow rays.
    pub shadow: f64,
    /// Reflected and refracted rays.
    pub secondary: f64,
    /// How far ours may be off, relative to the published numbers: eye hits and shadow rays; secondary rays.
    pub tolerance: [f64; 2],
    /// Why ours differ.
    pub why: &'static str,
}

impl Published {
    /// The eye rays of the published counts.
    pub const EYE_RAYS: f64 = 513.0 * 513.0;
}

const TRIANGLES: &str = "of triangles in the original too: only the film differs";
const CURVED: &str =
    "spheres, cylinders and cones are triangles here, with flat normals and a little smaller than the true shapes";

/// What was published, by scene.
#[rustfmt::skip]
pub const PUBLISHED: [Published; 8] = [
    Published { scene: "gears4", eye_hits: 245_332.0, shadow: 2_088_012.0, secondary: 494_338.0, tolerance: [0.04, 0.04], why: TRIANGLES },
    Published { scene: "teapot12", eye_hits: 161_546.0, shadow: 406_340.0, secondary: 226_235.0, tolerance: [0.03, 0.03], why: TRIANGLES },
    Published { scene: "tetra6", eye_hits: 49_950.0, shadow: 46_262.0, secondary: 0.0, tolerance: [0.03, 0.0], why: TRIANGLES },
    Published { scene: "balls4", eye_hits: 263_169.0, shadow: 959_244.0, secondary: 179_884.0, tolerance: [0.04, 0.15], why: CURVED },
    Published { scene: "mount6", eye_hits: 173_685.0, shadow: 361_037.0, secondary: 710_436.0, tolerance: [0.04, 0.05], why: CURVED },
    Published { scene: "rings7", eye_hits: 263_169.0, shadow: 1_077_336.0, secondary: 312_879.0, tolerance: [0.05, 0.10], why: CURVED },
    Published { scene: "tree11", eye_hits: 169_907.0, shadow: 1_110_323.0, secondary: 0.0, tolerance: [0.04, 0.0], why: CURVED },
    Published {
        scene: "lattice12", eye_hits: 261_170.0, shadow: 1_180_774.0, secondary: 243_210.0, tolerance: [0.12, 0.30],
        why: "reflections between coarse spheres lose their way sooner: 0.69 secondary rays an eye ray at the default resolution, 0.84 at 4, \
              0.88 at 8, 0.90 at 12; published 0.92",
    },
];

impl Experiment for Spd {
    fn name(&self) -> &'static str {
        "spd"
    }

    fn question(&self) -> &'static str {
        "Are our rays those that others counted in the same scenes?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        let of = |p: &Published| scope.entries.iter().find(|e| e.id == p.scene);
        let entries = PUBLISHED.iter().filter_map(of).filter(|_| scope.modes.contains(&Mode::Whitted));
        let job = |scene: &str, view: &str| Job {
            experiment: self.name().to_owned(),
            scene: scene.to_owned(),
            view: view.to_owned(),
            frame: 0,
            mode: Mode::Whitted,
        };
        entries.filter_map(|e| Some(job(&e.id, &e.views.first()?.name))).collect()
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let published = PUBLISHED.iter().find(|p| p.scene == found.job.scene).ok_or("nothing is published of it")?;
        let batches = lab.rays(&lab.view(&found.job.view)?, Mode::Whitted);
        let of = |class| batches.iter().find(|b| b.class == class);
        let rays = |class| of(class).map_or(0, |b| b.rays.len() as u64);
        let eye_hits = of(RayClass::Primary).map_or(0, |b| tally(&lab.first, b).hits);
        let secondary = rays(RayClass::Reflection) + rays(RayClass::Refraction);
        let counted = [
            ("eye rays that hit, an eye ray", eye_hits, published.eye_hits),
            ("shadow rays, an eye ray", rays(RayClass::Shadow), published.shadow),
            ("secondary rays, an eye ray", secondary, published.secondary),
        ];
        let eye_rays = rays(RayClass::Primary) as f64;
        for (name, ours, theirs) in counted {
            let points = vec![[theirs / Published::EYE_RAYS, ours as f64 / eye_rays, 1.0]];
            found.curves.push(found.curve(name, Spec::default(), "published", points));
        }
        Ok(())
    }
}
