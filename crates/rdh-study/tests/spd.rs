//! The rays of Whitted ray tracing, counted on the Standard Procedural Databases, against those that V. Havran published in
//! 1999 for 513 × 513 eye rays, depth 5 and shadow rays towards front-facing lights only. Curved shapes are triangles here,
//! with flat normals and a little smaller than the true ones, so that reflections differ most.

mod common;

use common::plan;
use rdh::{BuildOptions, RayClass, Spec, Training, build};
use rdh_scene::catalog;
use rdh_study::measure::tally;
use rdh_study::{Mode, Plan, Shoot, Stage};

struct Published {
    scene: &'static str,
    eye_hits: f64,
    shadow: f64,
    /// Reflected and refracted.
    secondary: f64,
    /// How far off eye hits and shadow rays, and secondary rays, may be: relative to the published ones.
    tolerance: [f64; 2],
}

const EYE_RAYS: f64 = 513.0 * 513.0;
const SIDE: usize = 160;

#[rustfmt::skip]
const PUBLISHED: [Published; 8] = [
    // Of triangles in the original too.
    Published { scene: "gears4", eye_hits: 245_332.0, shadow: 2_088_012.0, secondary: 494_338.0, tolerance: [0.04, 0.04] },
    Published { scene: "teapot12", eye_hits: 161_546.0, shadow: 406_340.0, secondary: 226_235.0, tolerance: [0.03, 0.03] },
    Published { scene: "tetra6", eye_hits: 49_950.0, shadow: 46_262.0, secondary: 0.0, tolerance: [0.03, 0.0] },
    // Of spheres, cylinders and cones.
    Published { scene: "balls4", eye_hits: 263_169.0, shadow: 959_244.0, secondary: 179_884.0, tolerance: [0.04, 0.15] },
    Published { scene: "mount6", eye_hits: 173_685.0, shadow: 361_037.0, secondary: 710_436.0, tolerance: [0.04, 0.05] },
    Published { scene: "rings7", eye_hits: 263_169.0, shadow: 1_077_336.0, secondary: 312_879.0, tolerance: [0.05, 0.10] },
    Published { scene: "tree11", eye_hits: 169_907.0, shadow: 1_110_323.0, secondary: 0.0, tolerance: [0.04, 0.0] },
    // Reflections between coarse spheres lose their way sooner: the finer the spheres, the nearer the counts (0.69 an eye ray at the
    // default resolution, 0.84 at 4, 0.88 at 8, 0.90 at 12).
    Published { scene: "lattice12", eye_hits: 261_170.0, shadow: 1_180_774.0, secondary: 243_210.0, tolerance: [0.12, 0.30] },
];

#[test]
fn ray_counts_are_the_published_ones() {
    let entries = catalog::embedded().unwrap();
    for published in &PUBLISHED {
        let entry = entries.iter().find(|e| e.id == published.scene).expect("the scene is embedded");
        let stage = Stage::new(&entry.load(0).unwrap()).unwrap();
        let accel = build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        let plan = Plan { size: [SIDE, SIDE], ..plan(&[]) };
        let batches = Shoot::new(&stage, Mode::Whitted, &entry.views[0], &plan).batches(&accel);
        let of = |class| batches.iter().find(|b| b.class == class);
        let rays = |class| of(class).map_or(0, |b| b.rays.len() as u64);
        let [exact, loose] = published.tolerance;
        let eye_hits = of(RayClass::Primary).map_or(0, |b| tally(&accel, b).hits);
        let secondary = rays(RayClass::Reflection) + rays(RayClass::Refraction);
        let counted = [
            ("eye rays that hit", eye_hits, published.eye_hits, exact),
            ("shadow rays", rays(RayClass::Shadow), published.shadow, exact),
            ("secondary rays", secondary, published.secondary, loose),
        ];
        for (what, ours, theirs, tolerance) in counted {
            let (ours, theirs) = (ours as f64 / (SIDE * SIDE) as f64, theirs / EYE_RAYS);
            let off = (ours - theirs).abs();
            println!("{:10} {what:18} {ours:.4} an eye ray, published {theirs:.4}", published.scene);
            assert!(off <= tolerance * theirs, "{}: {what}: {ours:.4}, published {theirs:.4}", published.scene);
        }
    }
}
