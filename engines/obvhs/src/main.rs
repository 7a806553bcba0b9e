//! The crate obvhs as a competitor: its binary hierarchy and its compressed wide one, by its own presets.

use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Result, bail};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris, node::Bvh2Node};
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use rdh_engine_protocol::{Built, Engine, Mesh, Ray};

/// Cargo.toml asks for this one.
const VERSION: &str = "0.4.0";

/// A tree, and the triangles in the order of its leaves, as its documentation recommends.
struct Obvhs {
    tree: Tree,
    triangles: Vec<RtTriangle>,
}

enum Tree {
    Binary(Bvh2),
    Wide(CwBvh),
}

fn main() -> ExitCode {
    rdh_engine_protocol::serve::<Obvhs>()
}

impl Engine for Obvhs {
    const NAME: &'static str = "obvhs";

    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>> {
        let (structure, preset) = mode.split_once('-').unwrap_or((mode, "medium"));
        let params = params(preset)?;
        if !["bvh2", "cwbvh"].contains(&structure) {
            bail!("unknown structure '{structure}'; known: bvh2, cwbvh");
        }
        let triangle = |[a, b, c]: [[f32; 3]; 3]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() };
        let triangles: Vec<_> = mesh.corners().map(triangle).collect();
        drop(mesh);
        let build = || {
            let mut core = Duration::default();
            let (tree, order) = if structure == "bvh2" {
                let tree = build_bvh2_from_tris(&triangles, params, &mut core);
                let order = tree.primitive_indices.clone();
                (Tree::Binary(tree), order)
            } else {
                let tree = build_cwbvh_from_tris(&triangles, params, &mut core);
                let order = tree.primitive_indices.clone();
                (Tree::Wide(tree), order)
            };
            let triangles = order.iter().map(|&i| (&triangles[i as usize]).into()).collect();
            Self { tree, triangles }
        };
        Ok(Built::time(VERSION, build, Self::bytes))
    }

    #[inline(always)]
    fn closest(&self, ray: &Ray) -> f32 {
        let (mut hit, ray) = (RayHit::none(), obvhs_ray(ray));
        let test = |ray: &ObvhsRay, i: usize| self.triangles[i].intersect(ray);
        let is_hit = match &self.tree {
            Tree::Binary(tree) => tree.ray_traverse(ray, &mut hit, test),
            Tree::Wide(tree) => tree.ray_traverse(ray, &mut hit, test),
        };
        if is_hit { hit.t } else { f32::INFINITY }
    }

    #[inline(always)]
    fn occluded(&self, ray: &Ray) -> bool {
        let ray = obvhs_ray(ray);
        let test = |ray: &ObvhsRay, i: usize| self.triangles[i].intersect(ray);
        !match &self.tree {
            Tree::Binary(tree) => tree.ray_traverse_miss(ray, test),
            Tree::Wide(tree) => tree.ray_traverse_miss(ray, test),
        }
    }
}

impl Obvhs {
    /// Nodes and triangles; the order of the leaves is not needed to trace.
    fn bytes(&self) -> usize {
        let nodes = match &self.tree {
            Tree::Binary(tree) => size_of::<Bvh2Node>() * tree.nodes.len(),
            Tree::Wide(tree) => size_of::<CwBvhNode>() * tree.nodes.len(),
        };
        nodes + size_of::<RtTriangle>() * self.triangles.len()
    }
}

fn params(preset: &str) -> Result<BvhBuildParams> {
    Ok(match preset {
        "fast" => BvhBuildParams::fast_build(),
        "medium" => BvhBuildParams::medium_build(),
        "slow" => BvhBuildParams::slow_build(),
        "very_slow" => BvhBuildParams::very_slow_build(),
        _ => bail!("unknown preset '{preset}'; known: fast, medium, slow, very_slow"),
    })
}

#[inline(always)]
fn obvhs_ray(ray: &Ray) -> ObvhsRay {
    ObvhsRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}
