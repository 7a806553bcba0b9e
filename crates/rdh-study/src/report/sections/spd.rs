//! Ray counts of the procedural databases beside published ones.

use maud::{Markup, html};
use rdh::RayClass;

use super::super::table::table;
use super::super::view::Study;
use super::super::words::{self, signed};
use super::{Chapter, Section};
use crate::integrate::Mode;
use crate::rows::Row;

pub(super) const CHAPTER: Chapter = Chapter {
    id: "spd",
    title: "Are these the scenes they claim to be?",
    question: "Havran published in 1999 how many rays of each sort the Standard Procedural Databases take. Do ours agree?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let rows: Vec<Vec<Markup>> = PUBLISHED.iter().filter_map(|p| p.row(study)).collect();
    if rows.is_empty() {
        return None;
    }
    let finding = html! { "Rays an eye ray of " (words::count(rows.len(), "procedural database")) " stand beside those that were published" };
    let body = html! {
        (table("Rays an eye ray, ours and as published (513 × 513 eye rays, depth 5)",
            &["scene", ">eye rays that hit", ">published", ">", ">shadow rays", ">published", ">", ">reflected, refracted", ">published", ">"], &rows))
        p.note {
            "Ours are triangles with flat normals, a little smaller than the true spheres, cylinders and cones of the original: silhouettes lose a "
            "little, and reflections between curved shapes lose their way sooner. Gears, teapot and tetra are polygons in the original too. "
            "Few pixels make coarse counts."
        }
    };
    Some(Section { findings: vec![finding], body })
}

struct Published {
    scene: &'static str,
    eye_hits: f64,
    shadow: f64,
    /// Reflected and refracted.
    secondary: f64,
}

const EYE_RAYS: f64 = 513.0 * 513.0;

#[rustfmt::skip]
const PUBLISHED: [Published; 8] = [
    Published { scene: "balls4", eye_hits: 263_169.0, shadow: 959_244.0, secondary: 179_884.0 },
    Published { scene: "gears4", eye_hits: 245_332.0, shadow: 2_088_012.0, secondary: 494_338.0 },
    Published { scene: "lattice12", eye_hits: 261_170.0, shadow: 1_180_774.0, secondary: 243_210.0 },
    Published { scene: "mount6", eye_hits: 173_685.0, shadow: 361_037.0, secondary: 710_436.0 },
    Published { scene: "rings7", eye_hits: 263_169.0, shadow: 1_077_336.0, secondary: 312_879.0 },
    Published { scene: "teapot12", eye_hits: 161_546.0, shadow: 406_340.0, secondary: 226_235.0 },
    Published { scene: "tetra6", eye_hits: 49_950.0, shadow: 46_262.0, secondary: 0.0 },
    Published { scene: "tree11", eye_hits: 169_907.0, shadow: 1_110_323.0, secondary: 0.0 },
];

impl Published {
    /// Ours beside it, from the first Whitted job of the scene's first view.
    fn row(&self, study: &Study<'_>) -> Option<Vec<Markup>> {
        let same =
            |r: &&crate::study::Record| r.job.scene == self.scene && r.job.mode == Mode::Whitted && !r.rows.is_empty();
        let record = study.records.iter().find(same)?;
        let first = &record.rows[0];
        let of = |class| {
            record.rows.iter().find(|r: &&Row| r.class == class && r.spec == first.spec && r.setting == first.setting)
        };
        let eye = of(RayClass::Primary)?;
        let rays = |class| of(class).map_or(0.0, |r| r.rays as f64);
        let ours = [eye.hits as f64, rays(RayClass::Shadow), rays(RayClass::Reflection) + rays(RayClass::Refraction)];
        let mut row = vec![html! { (self.scene) }];
        for (ours, theirs) in ours.into_iter().zip([self.eye_hits, self.shadow, self.secondary]) {
            let [ours, theirs] = [ours / eye.rays as f64, theirs / EYE_RAYS];
            row.extend([
                html! { (format!("{ours:.3}")) },
                html! { (format!("{theirs:.3}")) },
                html! { @if theirs > 0.0 { (signed(ours / theirs)) } },
            ]);
        }
        Some(row)
    }
}
