//! What the property tests share: meshes, rays, and the list of everything that must have the properties.
#![allow(dead_code, unreachable_pub, reason = "each test file uses its part of this shared module")]

pub mod meshes;
pub mod rays;

use rdh::{Accel, BuildOptions, Mesh, Spec, Training, build};

/// Every structure and heuristic, listed once: all property tests run on each.
pub const SPECS: &[&str] = &[
    "kd+sah",
    "kd(split=exact)+sah",
    "kd(leaf=1,split=exact)+sah",
    "kd(leaf=1)+sah",
    "kd(prune=none,stop=cost)+sah",
    "kd(prune=none,stop=paper)+sah",
    "kd+rdh(paper)",
    "kd+rdh(paper,weight=0)",
    "kd+rdh",
    "kd(split=exact)+rdh(prior=0)",
    "kd(leaf=1)+rdh(rays=whole,cap=100)",
    "kd(prune=visits)+rdh(prior=2)",
    "kd(idle=0.001)+rdh",
    "bvh2+sah",
    "bvh4+sah",
    "bvh8+sah",
    "bvh8(quick)+sah",
    "sbvh2+sah",
    "sbvh8+sah",
    "bvh8(split=sweep)+sah",
    "sbvh4(split=sweep)+sah",
    "bvh8(high)+sah",
    "sbvh4(high)+sah",
    "bvh8(from=kd)+sah",
    "bvh4(high,from=kd)+sah",
    "bvh8(compact)+sah",
    "sbvh8(quick,compact)+sah",
    "bvh8+rdh",
    "bvh8(from=kd)+rdh",
    "bvh2(quick,from=kd)+rdh(paper)",
    "bvh2+rdh(prior=0)",
    "bvh8+rdh(splits=areas,order=areas)",
    "sbvh8(high)+rdh(rays=whole)",
    "bvh8(lazy)+sah",
    "bvh8(quick,lazy)+sah",
    "bvh8(lazy)+rdh",
    "kd(eye=0.1,0.2,0.3)+sah",
    "kd(eye=0.1,0.2,0.3)+rdh",
    "kd(light=0.1,0.2,0.3)+sah",
];

/// The tree of a spec, trained on random rays through the mesh.
pub fn build_spec(mesh: &Mesh, spec: &str) -> Accel {
    let spec: Spec = spec.parse().expect(spec);
    build(mesh, &spec, &training(mesh), &BuildOptions::default()).expect("a valid mesh builds")
}

/// Rays for training: from inside and outside, with their hits; every third one would take any.
pub fn training(mesh: &Mesh) -> Training {
    use rdh::{Query, RayClass, RaySample, naive};
    let sample = |(i, ray)| {
        let query = if i % 3 == 0 { Query::Occluded } else { Query::Closest };
        RaySample::new(ray, naive::closest(mesh, &ray), query, RayClass::Other)
    };
    Training::from_samples(rays::mixed(mesh, 300, 7).into_iter().enumerate().map(sample).collect())
}
