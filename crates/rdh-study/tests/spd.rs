//! The rays of Whitted ray tracing, counted on the Standard Procedural Databases, against those that V. Havran published in
//! 1999 for 513 × 513 eye rays, depth 5 and shadow rays towards front-facing lights only. Curved shapes are triangles here,
//! with flat normals and a little smaller than the true ones, so that reflections differ most.

mod common;

use common::plan;
use rdh::{BuildOptions, RayClass, Spec, Training, build};
use rdh_scene::catalog;
use rdh_study::measure::tally;
use rdh_study::study::experiment::spd::{PUBLISHED, Published};
use rdh_study::{Mode, Plan, Shoot, Stage};

const SIDE: usize = 160;

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
            let (ours, theirs) = (ours as f64 / (SIDE * SIDE) as f64, theirs / Published::EYE_RAYS);
            let off = (ours - theirs).abs();
            println!("{:10} {what:18} {ours:.4} an eye ray, published {theirs:.4}", published.scene);
            assert!(off <= tolerance * theirs, "{}: {what}: {ours:.4}, published {theirs:.4}", published.scene);
        }
    }
}
