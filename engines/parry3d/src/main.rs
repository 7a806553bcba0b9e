//! The crate parry3d as a competitor: its triangle mesh, with default flags.

use std::process::ExitCode;

use anyhow::{Context, Result};
use parry3d::math::Vector;
use parry3d::query::{Ray as ParryRay, RayCast};
use parry3d::shape::TriMesh;
use rdh_engine_protocol::clock::process_nanos;
use rdh_engine_protocol::{Built, Engine, Mesh, Ray};

/// Cargo.toml asks for this one.
const VERSION: &str = "0.31.1";

struct Parry(TriMesh);

fn main() -> ExitCode {
    rdh_engine_protocol::serve::<Parry>()
}

impl Engine for Parry {
    const NAME: &'static str = "parry3d";

    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>> {
        anyhow::ensure!(mode == "default", "unknown mode '{mode}'; known: default");
        let vertices: Vec<Vector> = mesh.positions.iter().map(|&p| p.into()).collect();
        let start = process_nanos();
        let mesh = TriMesh::new(vertices, mesh.triangles).ok().context("parry3d refuses the mesh")?;
        let build_nanos = process_nanos() - start;
        let corners = size_of_val(mesh.vertices()) + size_of_val(mesh.indices());
        let bytes = (mesh.bvh().total_memory_size() + corners) as u64;
        Ok(Built { engine: Self(mesh), version: VERSION.to_owned(), build_nanos, bytes })
    }

    #[inline(always)]
    fn closest(&self, ray: &Ray) -> f32 {
        self.0.cast_local_ray(&parry_ray(ray), ray.t_max, true).unwrap_or(f32::INFINITY)
    }

    /// The crate's own answer: it looks for the closest hit.
    #[inline(always)]
    fn occluded(&self, ray: &Ray) -> bool {
        self.0.intersects_local_ray(&parry_ray(ray), ray.t_max)
    }
}

/// Rays begin at their origins: the driver's `t_min` is 0.
#[inline(always)]
fn parry_ray(ray: &Ray) -> ParryRay {
    ParryRay::new(ray.origin.into(), ray.direction.into())
}
