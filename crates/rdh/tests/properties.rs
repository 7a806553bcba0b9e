//! The properties that every structure and heuristic must have, run on each by listing them once.

mod common;

use common::meshes::{Random, closed, nasty};
use common::rays::{AIMS, Aim, aimed, batch, mixed};
use common::{SPECS, build_spec};
use rdh::simd::Level;
use rdh::{Counts, Hit, Mesh, Ray, naive};

/// All meshes of the tests.
fn meshes() -> Vec<(&'static str, Mesh)> {
    nasty().into_iter().chain(closed().into_iter().map(|(name, mesh, _)| (name, mesh))).collect()
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32, u32, u32)> {
    hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.tri.0))
}

#[test]
fn every_structure_agrees_with_brute_force_bit_for_bit() {
    for (name, mesh) in meshes() {
        let rays = mixed(&mesh, 240, 11);
        let expected: Vec<_> = rays.iter().map(|r| bits(naive::closest(&mesh, r))).collect();
        for spec in SPECS {
            let accel = build_spec(&mesh, spec);
            for level in Level::available() {
                let accel = accel.clone().with_level(level);
                for (ray, expected) in rays.iter().zip(&expected) {
                    let at = || format!("{name}, {spec}, {}, {ray:?}", level.name());
                    assert_eq!(bits(accel.closest(ray)), *expected, "{}", at());
                    assert_eq!(accel.occluded(ray), expected.is_some(), "{}", at());
                    let mut counts = Counts::default();
                    assert_eq!(bits(accel.closest_counted(ray, &mut counts)), *expected, "{}", at());
                }
            }
        }
    }
}

/// Whatever batches are made of, and however long they are, their rays hit what they hit alone.
#[test]
fn batches_answer_as_single_rays_do() {
    const SIZES: [usize; 9] = [0, 1, 7, 63, 64, 65, 200, 1000, 5000];
    let meshes = nasty().into_iter().map(|(name, mesh)| (name, mesh, [0.1, 0.2, 0.3])).chain(closed());
    for (name, mesh, inside) in meshes {
        let [x, y, z] = inside;
        let around = ["eye", "light"].map(|name| format!("kd({name}={x},{y},{z})+sah"));
        let specs = ["bvh8+sah", "bvh8(high)+sah", "sbvh8+sah", "bvh8(compact)+sah", "bvh8+rdh", "bvh4+sah", "kd+sah"];
        for spec in specs.into_iter().chain(around.iter().map(String::as_str)) {
            let accel = build_spec(&mesh, spec);
            for (seed, size) in SIZES.into_iter().enumerate() {
                let rays = batch(&mesh, inside, size, seed as u64);
                let expected: Vec<_> = rays.iter().map(|ray| bits(accel.closest(ray))).collect();
                for level in Level::available() {
                    let accel = accel.clone().with_level(level);
                    // What was there before is not what is found.
                    let (mut hits, mut occluded) = (vec![None; size], vec![size % 2 == 0; size]);
                    accel.closest_many(&rays, &mut hits);
                    accel.occluded_many(&rays, &mut occluded);
                    for (i, ray) in rays.iter().enumerate() {
                        let at = || format!("{name}, {spec}, {}, {i} of {size}: {ray:?}", level.name());
                        assert_eq!(bits(hits[i]), expected[i], "{}", at());
                        assert_eq!(occluded[i], expected[i].is_some(), "{}", at());
                    }
                }
            }
        }
    }
}

#[test]
fn batches_respect_masks() {
    let plain = common::meshes::soup(400, 0.3, 25);
    let masks: Vec<u32> = (0..plain.len() as u32).map(|i| 1 << (i % 3)).collect();
    let mesh = plain.with_masks(masks).expect("one mask a triangle");
    let accel = build_spec(&mesh, "bvh8+sah");
    let masked = |(i, ray): (usize, Ray)| ray.masked([0, 1, 2, 5, 7][i % 5]);
    let rays: Vec<Ray> = batch(&mesh, [0.5; 3], 4000, 1).into_iter().enumerate().map(masked).collect();
    for level in Level::available() {
        let accel = accel.clone().with_level(level);
        let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
        accel.closest_many(&rays, &mut hits);
        accel.occluded_many(&rays, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(bits(hits[i]), bits(accel.closest(ray)), "{}, {ray:?}", level.name());
            assert_eq!(occluded[i], hits[i].is_some(), "{}, {ray:?}", level.name());
        }
    }
    assert!(rays.iter().any(|ray| accel.occluded(ray)) && rays.iter().any(|ray| !accel.occluded(ray)));
}

/// Half a million rays from inside closed meshes, in bundles at edges and vertices: none escapes.
#[test]
fn no_ray_of_a_batch_escapes_from_a_closed_mesh() {
    let mut cast = 0;
    for (name, mesh, inside) in closed() {
        let accel = build_spec(&mesh, "bvh8+sah");
        for aim in AIMS {
            let mut random = Random::new(31);
            let mut rays = Vec::new();
            while rays.len() < 16_000 {
                // Many rays at one place, some exactly alike.
                let first = aimed(&mesh, inside, aim, &mut random);
                let near = |random: &mut Random| first.direction.map(|x| x * (1.0 + 1e-5 * random.between(-1.0, 1.0)));
                rays.push(first);
                rays.extend(
                    (1..64).map(|i| if i % 3 == 0 { first } else { Ray { direction: near(&mut random), ..first } }),
                );
            }
            let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
            accel.closest_many(&rays, &mut hits);
            accel.occluded_many(&rays, &mut occluded);
            for (i, ray) in rays.iter().enumerate() {
                assert!(hits[i].is_some() && occluded[i], "{name}, {aim:?}: missed by {ray:?}");
            }
            cast += rays.len();
        }
    }
    assert!(cast > 500_000, "only {cast} rays");
}

#[test]
fn all_hits_agree_with_brute_force() {
    for (name, mesh) in meshes() {
        let rays = mixed(&mesh, 120, 13);
        let expected: Vec<_> = rays.iter().map(|r| naive::all_hits(&mesh, r)).collect();
        for spec in SPECS {
            let accel = build_spec(&mesh, spec);
            let mut hits = Vec::new();
            for (ray, expected) in rays.iter().zip(&expected) {
                accel.all_hits(ray, &mut hits);
                assert_eq!(&hits, expected, "{name}, {spec}, {ray:?}");
            }
        }
    }
}

#[test]
fn every_structure_is_well_formed() {
    for (name, mesh) in meshes() {
        for spec in SPECS {
            let faults = build_spec(&mesh, spec).check(&mesh);
            assert!(faults.is_empty(), "{name}, {spec}: {:?}", faults.first());
        }
    }
}

/// Over a million rays from inside closed meshes, at edges, at vertices and along axes: none escapes.
#[test]
fn no_ray_escapes_from_a_closed_mesh() {
    const RAYS: usize = 12_000;
    let mut cast = 0;
    for (name, mesh, inside) in closed() {
        for spec in ["kd+sah", "kd(leaf=1,split=exact)+sah", "kd+rdh", "bvh8+sah", "bvh4+sah", "bvh8(from=kd)+sah"] {
            let accel = build_spec(&mesh, spec);
            for aim in AIMS {
                let mut random = Random::new(17);
                for _ in 0..RAYS {
                    let ray = aimed(&mesh, inside, aim, &mut random);
                    assert!(accel.closest(&ray).is_some(), "{name}, {spec}, {aim:?}: missed by {ray:?}");
                    assert!(accel.occluded(&ray), "{name}, {spec}, {aim:?}: not occluded: {ray:?}");
                    cast += 1;
                }
            }
        }
    }
    assert!(cast > 1_000_000, "only {cast} rays");
}

#[test]
fn a_line_crosses_a_closed_mesh_an_even_number_of_times() {
    for (name, mesh, inside) in closed() {
        let accel = build_spec(&mesh, "kd+sah");
        let mut random = Random::new(19);
        let mut hits = Vec::new();
        for aim in AIMS {
            for _ in 0..3000 {
                let ray = aimed(&mesh, inside, aim, &mut random).within(f32::NEG_INFINITY, f32::INFINITY);
                accel.all_hits(&ray, &mut hits);
                assert!(hits.len().is_multiple_of(2), "{name}, {aim:?}: {} by {ray:?}", hits.len());
                // A line along an axis may only touch the mesh, and then crosses it nowhere.
                assert!(!hits.is_empty() || aim == Aim::Axis, "{name}, {aim:?}: none by {ray:?}");
            }
        }
    }
}

#[test]
fn invalid_rays_hit_nothing() {
    let mesh = common::meshes::icosphere(2);
    let good = Ray::new([0.0; 3], [1.0, 0.0, 0.0]);
    for spec in SPECS {
        let accel = build_spec(&mesh, spec);
        assert!(accel.closest(&good).is_some());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for axis in 0..3 {
                let (mut from, mut along) = (good, good);
                from.origin[axis] = bad;
                along.direction[axis] = bad;
                assert_eq!((accel.closest(&from), accel.closest(&along)), (None, None));
            }
        }
        for ray in [
            Ray { direction: [0.0, -0.0, 0.0], ..good },
            good.within(2.0, 1.0),
            good.within(f32::NAN, 1.0),
            good.within(0.0, f32::NAN),
        ] {
            assert_eq!(accel.closest(&ray), None);
            assert!(!accel.occluded(&ray));
        }
    }
}

/// Where a ray starts so far away that no box can be told from another, it still meets all of them, and of triangles that are
/// equally near the smallest id wins.
#[test]
fn rays_from_the_end_of_the_world_miss_nothing() {
    let at = |i: u32| ((i * 37 + 11) % 64) as f32 * 0.01;
    let corners = |x: f32| [[x, -1.0, -1.0], [x, 2.0, -1.0], [x, -1.0, 2.0]];
    let points = (0..64).flat_map(|i| corners(at(i))).collect();
    let mesh = Mesh::new(points, (0..64).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).expect("a valid mesh");
    let from = |x: f32, along: f32| Ray::new([x, 0.0, 0.0], [along, 0.0, 0.0]);
    let rays = [
        from(-3e38, 1.0).within(2.9e38, f32::INFINITY),
        from(3e38, -1.0).within(2.9e38, f32::INFINITY),
        from(3e38, 1.0).within(f32::NEG_INFINITY, -2.9e38),
        from(-3e38, -1.0).within(f32::NEG_INFINITY, -2.9e38),
        from(3e38, 1.0).within(f32::NEG_INFINITY, f32::INFINITY),
    ];
    for (spec, ray) in SPECS.iter().flat_map(|spec| rays.map(|ray| (spec, ray))) {
        let accel = build_spec(&mesh, spec);
        for level in Level::available() {
            let (accel, at) = (accel.clone().with_level(level), format!("{spec}, {}, {ray:?}", level.name()));
            let hit = accel.closest(&ray);
            assert_eq!((bits(hit), hit.map(|h| h.tri.0)), (bits(naive::closest(&mesh, &ray)), Some(0)), "{at}");
            assert!(accel.occluded(&ray), "{at}");
            let mut hits = Vec::new();
            accel.all_hits(&ray, &mut hits);
            assert_eq!(hits, naive::all_hits(&mesh, &ray), "{at}");
        }
    }
}

/// A crossing just before the start, or just behind the end, counts where its `t` is rounded to one of them: with a long direction
/// everything within 10⁻³⁸ of it, and farther.
#[test]
fn what_rounds_to_an_end_of_the_interval_counts() {
    let at = |i: u32| (i as f32 - 16.0) * 3e-39;
    let corners = |x: f32, lean: f32| [[x, -1.0, -1.0], [x + lean, 2.0, -1.0], [x, -1.0, 2.0]];
    // Every fourth one leans: its corners lie on both sides of the start.
    let points = (0..32).flat_map(|i| corners(at(i), if i % 4 == 3 { at(i) + 1e-39 } else { 0.0 })).collect();
    let mesh = Mesh::new(points, (0..32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).expect("a valid mesh");
    let long = [1.0, 1e6, 3e7, 1e9, 1e20, 1e38].into_iter().flat_map(|d| [d, -d]);
    let rays: Vec<Ray> = long
        .flat_map(|d| [-2e-38, -1e-39, 0.0, 4e-39, 3e-38].map(|x| Ray::new([x, 0.25, -0.25], [d, 0.0, 0.0])))
        .flat_map(|ray| [ray, ray.within(0.0, 0.0), ray.within(-f32::MAX, 0.0), ray.within(-1e-45, 1e-45)])
        .collect();
    let expected: Vec<_> = rays.iter().map(|ray| bits(naive::closest(&mesh, ray))).collect();
    let beside = |ray: &Ray| {
        let all = naive::all_hits(&mesh, ray);
        let behind =
            |hit: &Hit| hit.t == 0.0 && (mesh.corners(hit.tri)[0][0] - ray.origin[0]) * ray.direction[0] != 0.0;
        all.iter().filter(|hit| behind(hit)).count()
    };
    assert!(rays.iter().map(beside).sum::<usize>() > 100);
    for spec in SPECS {
        let accel = build_spec(&mesh, spec);
        for level in Level::available() {
            let accel = accel.clone().with_level(level);
            for (ray, expected) in rays.iter().zip(&expected) {
                let at = || format!("{spec}, {}, {ray:?}", level.name());
                assert_eq!(bits(accel.closest(ray)), *expected, "{}", at());
                assert_eq!(accel.occluded(ray), expected.is_some(), "{}", at());
            }
        }
    }
}

#[test]
fn both_ends_of_the_interval_count() {
    let mesh = common::meshes::soup(200, 0.3, 21);
    let accel = build_spec(&mesh, "kd+sah");
    for ray in mixed(&mesh, 300, 23) {
        let Some(hit) = accel.closest(&ray) else { continue };
        assert_eq!(accel.closest(&ray.within(hit.t, hit.t)), Some(hit));
        assert_ne!(accel.closest(&ray.within(hit.t.next_up(), f32::INFINITY)), Some(hit));
    }
}

#[test]
fn masks_hide_triangles() {
    let plain = common::meshes::soup(400, 0.3, 25);
    let masks: Vec<u32> = (0..plain.len() as u32).map(|i| 1 << (i % 3)).collect();
    let mesh = plain.with_masks(masks).expect("one mask a triangle");
    for spec in SPECS {
        let accel = build_spec(&mesh, spec);
        for ray in mixed(&mesh, 200, 27) {
            for mask in [0, 1, 2, 5, 7] {
                let ray = ray.masked(mask);
                assert_eq!(bits(accel.closest(&ray)), bits(naive::closest(&mesh, &ray)), "{spec}, mask {mask}");
                let mut hits = Vec::new();
                accel.all_hits(&ray, &mut hits);
                assert_eq!(hits, naive::all_hits(&mesh, &ray));
            }
        }
    }
}

/// Scaling mesh and rays by a power of two is exact: the same triangles, the scaled distances.
#[test]
fn a_power_of_two_changes_nothing_but_distances() {
    let mesh = common::meshes::icosphere(3);
    let rays = mixed(&mesh, 300, 29);
    let base: Vec<_> = rays.iter().map(|r| build_spec(&mesh, "kd+sah").closest(r)).take(60).collect();
    for exponent in [-60, -20, -1, 1, 20, 60] {
        let factor = (exponent as f32).exp2();
        let accel = build_spec(&common::meshes::moved(&mesh, |p| p.map(|x| x * factor)), "kd+sah");
        for (ray, base) in rays.iter().zip(&base) {
            let scaled =
                Ray { origin: ray.origin.map(|x| x * factor), ..*ray }.within(ray.t_min * factor, ray.t_max * factor);
            let hit = accel.closest(&scaled);
            assert_eq!(hit.map(|h| (h.tri, h.t / factor)), base.map(|h| (h.tri, h.t)));
        }
    }
}
