//! Double precision: vertices and rays in f64, for geodata and long ways, answered through a hierarchy in f32.
//!
//! ```text
//!  MeshF64 ──> its image in f32, moved and scaled ──> Accel      finds what a ray might hit (coarse)
//!      └──────────────────────────────────────────> triangle   decides what it hits, in f64 alone
//! ```
//! The hierarchy only sifts: that it loses no hit is argued in docs/watertight.md. Answers are those of brute force ([`naive`]), bit for
//! bit, and no ray escapes from a closed mesh.
//!
//! `mesh` and `ray` are the data; `exact` compares products, `powers` scales; `triangle` is THE test; `coarse` makes images in f32;
//! `trace` walks.

mod coarse;
mod exact;
mod mesh;
pub mod naive;
mod powers;
mod ray;
mod trace;
mod triangle;

pub use mesh::MeshF64;
pub use ray::{HitF64, RayF64};

use crate::accel::{Accel, Structure};
use crate::bvh::When;
use crate::error::{Error, Result};
use crate::geom::{Hit, Ray};
use crate::options::BuildOptions;
use crate::rays::Training;
use crate::simd::Level;
use crate::spec::{Spec, StructureSpec};
use coarse::Coarse;

/// A hierarchy over a mesh in f64; answers queries from any number of threads. Clones share all memory.
///
/// It takes the memory of the mesh, of its image in f32 and of the hierarchy. Cells of a hierarchy for rays that start farther away
/// than 2²⁰ times the mesh's size can't be told apart: such rays are right, but slow.
#[derive(Debug, Clone)]
pub struct AccelF64 {
    mesh: MeshF64,
    coarse: Coarse,
    accel: Accel,
}

impl AccelF64 {
    /// Builds a hierarchy (`bvh8+sah` and its kin, not `lazy`), from [images](Self::image) of rays where the spec asks for them.
    ///
    /// # Errors
    /// [`Error::Spec`] for what is no hierarchy; else as [`build`](crate::build()).
    pub fn build(mesh: &MeshF64, spec: &Spec, rays: &Training, options: &BuildOptions<'_>) -> Result<Self> {
        match spec.structure {
            StructureSpec::Bvh(bvh) if bvh.when != When::OnDemand => {}
            _ => {
                let reason =
                    "in double precision there are finished hierarchies alone, bvh8+sah for instance".to_owned();
                return Err(Error::Spec { spec: spec.to_string(), reason });
            }
        }
        let coarse = Coarse::of(mesh);
        let accel = crate::build(&coarse.mesh(mesh)?, spec, rays, options)?;
        Ok(Self { mesh: mesh.clone(), coarse, accel })
    }

    /// The nearest hit; of equally near ones that with the smallest triangle id.
    pub fn closest(&self, ray: &RayF64) -> Option<HitF64> {
        let mut best: Option<HitF64> = None;
        self.cast(ray, &mut |hit, _| {
            if best.is_none_or(|best| hit.wins_over(&best)) {
                best = Some(*hit);
            }
            best.map(|best| best.t)
        });
        best
    }

    /// Whether anything is hit.
    pub fn occluded(&self, ray: &RayF64) -> bool {
        let mut found = false;
        self.cast(ray, &mut |_, _| {
            found = true;
            None
        });
        found
    }

    /// All hits, nearest first, then by id; each shared edge counts for exactly one of its triangles. `hits` is cleared first.
    pub fn all_hits(&self, ray: &RayF64, hits: &mut Vec<HitF64>) {
        hits.clear();
        self.cast(ray, &mut |hit, sheared| {
            if triangle::owns(sheared) {
                hits.push(*hit);
            }
            Some(ray.t_max)
        });
        in_order(hits);
    }

    fn cast(&self, ray: &RayF64, sink: trace::Sink<'_>) {
        let Some(image) = self.coarse.image(ray) else { return };
        let query = trace::Query { mesh: &self.mesh, ray, image: &image, sink };
        match self.accel.structure() {
            Structure::Bvh2(tree) => tree.level().run(trace::Walk { tree, query }),
            Structure::Bvh4(tree) => tree.level().run(trace::Walk { tree, query }),
            Structure::Bvh8(tree) => tree.level().run(trace::Walk { tree, query }),
            Structure::Compact8(tree) => tree.level().run(trace::Walk { tree, query }),
            // Nothing else is built.
            Structure::Kd(_) | Structure::Lazy(_) | Structure::Eye(_) => {}
        }
    }

    /// The mesh that it was built over.
    pub fn mesh(&self) -> &MeshF64 {
        &self.mesh
    }

    /// The hierarchy over the mesh's image in f32.
    pub fn accel(&self) -> &Accel {
        &self.accel
    }

    /// A ray and what it hit, in the space of [`Self::accel`]: what a [`Recorder`](crate::Recorder) takes, so that the next hierarchy
    /// can be built for such rays. Nothing for an invalid ray.
    pub fn image(&self, ray: &RayF64, hit: Option<&HitF64>) -> Option<(Ray, Option<Hit>)> {
        let image = self.coarse.image(ray)?;
        Some((image.ray, hit.map(|hit| image.hit(hit))))
    }

    /// The same, traced with other instructions: for tests and measurements. The answers are the same.
    pub fn with_level(self, level: Level) -> Self {
        Self { accel: self.accel.with_level(level), ..self }
    }
}

/// Nearest first, then by id; each triangle once.
fn in_order(hits: &mut Vec<HitF64>) {
    hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.tri.cmp(&b.tri)));
    hits.dedup_by_key(|hit| hit.tri);
}
