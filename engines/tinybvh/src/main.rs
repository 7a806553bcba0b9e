//! TinyBVH as a competitor, by way of the crate tinybvh-rs, which builds the C++ library: its eight-wide hierarchy for
//! CPUs, by binned SAH (`bvh8`) or with spatial splits (`bvh8-hq`). The crate has no any-hit query.

use std::process::ExitCode;

use anyhow::{Result, anyhow, bail};
use rdh_engine_protocol::clock::process_nanos;
use rdh_engine_protocol::{Built, Engine, Mesh, Ray, memory};
use tinybvh_rs::{INFINITE, Intersection, Intersector, Ray as TinyRay, bvh, bvh8_cpu, mbvh};

/// Cargo.toml asks for this one.
const VERSION: &str = "1.6.8 (tinybvh-rs 0.1.0-beta.3)";

/// All masks of instances.
const ALL: u32 = 0xFFFF;

struct TinyBvh(bvh8_cpu::BVH);

/// The library wants more alignment than the crate's type has.
#[repr(align(64))]
struct Aligned(TinyRay);

fn main() -> ExitCode {
    rdh_engine_protocol::serve::<TinyBvh>()
}

impl Engine for TinyBvh {
    const NAME: &'static str = "tinybvh";

    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>> {
        let corners: Vec<[f32; 4]> = mesh.corners().flatten().map(|[x, y, z]| [x, y, z, 0.0]).collect();
        drop(mesh);
        let fail = |e| anyhow!("tinybvh: {e}");
        let (before, start) = (memory::resident_bytes(), process_nanos());
        let mut binary = match mode {
            "bvh8" => bvh::BVH::new(corners.as_slice().into()).map_err(fail)?,
            "bvh8-hq" => bvh::BVH::new_hq(corners.as_slice().into()).map_err(fail)?,
            _ => bail!("unknown mode '{mode}'; known: bvh8, bvh8-hq"),
        };
        // The most that a leaf of the wide hierarchy holds.
        binary.split_leaves(4);
        let wide = mbvh::BVH::new(&binary);
        let engine = Self(bvh8_cpu::BVH::new(&wide).map_err(fail)?);
        let build_nanos = process_nanos() - start;
        drop(wide);
        drop(binary);
        let bytes = memory::resident_bytes().saturating_sub(before) as u64;
        Ok(Built { engine, version: VERSION.to_owned(), build_nanos, bytes })
    }

    #[inline(always)]
    fn closest(&self, ray: &Ray) -> f32 {
        let t_max = ray.t_max.min(INFINITE);
        let mut query = Aligned(TinyRay {
            origin: ray.origin,
            padding_0: ALL,
            dir: ray.direction,
            padding_1: 0,
            r_d: ray.direction.map(reciprocal),
            padding_2: 0,
            hit: Intersection { t: t_max, ..Intersection::default() },
        });
        self.0.intersect(&mut query.0);
        if query.0.hit.t < t_max { query.0.hit.t } else { f32::INFINITY }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.closest(ray) < f32::INFINITY
    }
}

/// As the library's own constructor of rays has it, which normalises directions: ours need not be normal.
#[inline(always)]
fn reciprocal(x: f32) -> f32 {
    if x.abs() > 1e-12 { 1.0 / x } else { INFINITE.copysign(x) }
}
