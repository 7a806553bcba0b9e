//! What hits mean on their meshes, and queries with a filter.

mod common;

use common::meshes::{Random, closed, icosphere, nasty, soup};
use common::rays::{AIMS, aimed, mixed};
use common::{SPECS, build_spec};
use rdh::{Mesh, Ray, naive};

/// Directions on both sides of a triangle, some of them nearly or exactly in its plane.
fn directions(mesh: &Mesh, hit: &rdh::Hit, random: &mut Random) -> Vec<[f32; 3]> {
    let [a, b, c] = mesh.corners(hit.tri);
    let edge = [0, 1, 2].map(|i| b[i] - a[i]);
    let other = [0, 1, 2].map(|i| c[i] - a[i]);
    let (p, q) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let within = [0, 1, 2].map(|i| p * edge[i] + q * other[i]);
    let size = within.iter().fold(0.0f32, |most, x| most.max(x.abs()));
    let anywhere = random.vector();
    let grazing = [0, 1, 2].map(|i| within[i] + anywhere[i] * size * 1e-5);
    let all = [anywhere, anywhere.map(|x| -x), within, edge, other, grazing];
    all.into_iter().filter(|d| d.iter().any(|&x| x != 0.0)).collect()
}

#[test]
fn spawned_rays_never_hit_their_own_triangle() {
    let mut random = Random::new(41);
    let mut spawned = 0;
    let meshes = closed().into_iter().map(|(name, mesh, _)| (name, mesh)).chain(nasty());
    for (name, mesh) in meshes {
        let accel = build_spec(&mesh, "bvh8+sah");
        let mut hits = Vec::new();
        for ray in mixed(&mesh, 3000, 43) {
            let Some(hit) = accel.closest(&ray) else { continue };
            for direction in directions(&mesh, &hit, &mut random) {
                let next = mesh.spawn(&hit, direction);
                accel.all_hits(&next, &mut hits);
                assert!(hits.iter().all(|h| h.tri != hit.tri), "{name}: {hit:?} again by {next:?}");
                spawned += 1;
            }
        }
    }
    assert!(spawned > 100_000, "only {spawned}");
}

/// From inside a closed mesh every way out is found, and nothing but the mesh's own size is added.
#[test]
fn spawned_rays_stay_on_their_side() {
    let mut random = Random::new(47);
    let mesh = icosphere(4);
    let accel = build_spec(&mesh, "bvh8+sah");
    for i in 0..20_000 {
        let ray = aimed(&mesh, [0.13, -0.07, 0.21], AIMS[i % 4], &mut random);
        let Some(hit) = accel.closest(&ray) else { continue };
        let (point, d) = (mesh.point(&hit), random.vector());
        let normal = mesh.normal(hit.tri).expect("it has an area");
        let dot = |a: [f32; 3], b: [f32; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f32>();
        let outwards = dot(normal, d) * dot(normal, point).signum();
        let next = mesh.spawn(&hit, d);
        let gap = (0..3).map(|a| (next.origin[a] - point[a]).powi(2)).sum::<f32>().sqrt();
        assert!(gap < 4e-6, "moved by {gap}");
        // Inwards there is the other side.
        assert!(outwards > -0.05 || accel.closest(&next).is_some_and(|h| h.tri != hit.tri));
    }
}

#[test]
fn points_normals_and_values_lie_on_the_surface() {
    let mesh = icosphere(4);
    let accel = build_spec(&mesh, "bvh8+sah");
    for ray in mixed(&mesh, 2000, 49) {
        let Some(hit) = accel.closest(&ray) else { continue };
        let (point, normal) = (mesh.point(&hit), mesh.normal(hit.tri).expect("it has an area"));
        let corner = mesh.corners(hit.tri)[0];
        let height: f32 = (0..3).map(|a| normal[a] * (point[a] - corner[a])).sum();
        assert!(height.abs() < 1e-6, "{height}");
        assert!((normal.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-6);
        let same = mesh.interpolate(&hit, mesh.positions());
        assert!((0..3).all(|a| (same[a] - point[a]).abs() < 1e-6), "{same:?} {point:?}");
        assert!((hit.weights().iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
    let flat = Mesh::new(vec![[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]], vec![[0, 1, 2]]).expect("a valid mesh");
    assert_eq!(flat.normal(rdh::TriId(0)), None);
}

#[test]
fn what_does_not_pass_is_no_hit() {
    let mesh = soup(600, 0.4, 51);
    let (mut passed, mut refused) = (0, 0);
    for spec in SPECS {
        let accel = build_spec(&mesh, spec);
        for ray in mixed(&mesh, 300, 53) {
            let expected = naive_where(&mesh, &ray, |hit| hit.tri.0 % 3 == 0);
            let found = accel.closest_where(&ray, |hit| hit.tri.0 % 3 == 0);
            assert_eq!(found, expected, "{spec}, {ray:?}");
            assert_eq!(accel.occluded_where(&ray, |hit| hit.tri.0 % 3 == 0), expected.is_some(), "{spec}, {ray:?}");
            assert_eq!(accel.closest_where(&ray, |_| true), accel.closest(&ray));
            assert_eq!((accel.closest_where(&ray, |_| false), accel.occluded_where(&ray, |_| false)), (None, false));
            let all = accel.closest(&ray);
            passed += usize::from(found.is_some());
            refused += usize::from(all != found);
        }
    }
    assert!(passed > 100 && refused > 100, "{passed}, {refused}");
}

fn naive_where(mesh: &Mesh, ray: &Ray, passes: impl Fn(&rdh::Hit) -> bool) -> Option<rdh::Hit> {
    let kept: Vec<u32> = (0..mesh.len() as u32).map(|i| u32::from(i % 3 == 0)).collect();
    let masked = mesh.clone().with_masks(kept).expect("one mask a triangle");
    let hit = naive::closest(&masked, &ray.masked(1));
    assert!(hit.is_none_or(|hit| passes(&hit)));
    hit
}
