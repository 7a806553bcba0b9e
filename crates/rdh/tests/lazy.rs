//! Structures that grow where rays come: the answers of all others, whoever comes first, and no growth where nobody comes.

mod common;

use common::meshes::{Random, heights, soup};
use common::{build_spec, rays::mixed, training};
use rdh::{Accel, BuildOptions, Error, Hit, Mesh, Ray, Spec, build, lazy::Growth};

const LAZY: [&str; 3] = ["bvh8(lazy)+sah", "bvh8(quick,lazy)+sah", "bvh8(lazy)+rdh"];

fn bits(hit: Option<Hit>) -> Option<(u32, u32, u32, u32)> {
    hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.tri.0))
}

fn growth(accel: &Accel) -> Growth {
    accel.lazy().expect("a lazy structure").growth()
}

fn build_with(mesh: &Mesh, spec: &str, options: &BuildOptions<'_>) -> rdh::Result<Accel> {
    let spec: Spec = spec.parse().expect(spec);
    build(mesh, &spec, &training(&soup(500, 0.05, 1)), options)
}

/// The same triangles in an order that says nothing about where they are.
fn shuffled(mesh: &Mesh) -> Mesh {
    let (mut triangles, mut random) = (mesh.triangles().to_vec(), Random::new(5));
    for i in (1..triangles.len()).rev() {
        triangles.swap(i, ((random.unit() * (i + 1) as f32) as usize).min(i));
    }
    Mesh::new(mesh.positions().to_vec(), triangles).expect("a valid mesh")
}

/// Of more triangles than grow at once: in an order that helps, and in none.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let terrain = heights(90, |i, j| ((i * 37 + j * 91) % 17) as f32 * 0.004);
    let mixed_up = shuffled(&terrain);
    let masks = (0..terrain.len() as u32).map(|i| 1 << (i % 3)).collect();
    let masked = terrain.clone().with_masks(masks).expect("a mask each");
    let corner = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.2], [0.0, 1.0, 0.1]], vec![[0, 1, 2]; 9_000]).expect("valid");
    vec![
        ("terrain", terrain),
        ("terrain in no order", mixed_up),
        ("masked terrain", masked),
        ("soup", soup(12_000, 0.03, 3)),
        ("one triangle many times", corner),
    ]
}

#[test]
fn answers_are_those_of_other_structures_bit_for_bit() {
    for (name, mesh) in meshes() {
        let others = build_spec(&mesh, "bvh8+sah");
        let (mut all, mut expected) = (Vec::new(), Vec::new());
        for spec in LAZY {
            let accel = build_spec(&mesh, spec);
            for (i, ray) in mixed(&mesh, 900, 21).iter().enumerate() {
                let ray = &Ray { mask: 1 + i as u32 % 7, ..*ray };
                let at = || format!("{name}, {spec}, {ray:?}");
                assert_eq!(accel.occluded(ray), others.occluded(ray), "{}", at());
                assert_eq!(bits(accel.closest(ray)), bits(others.closest(ray)), "{}", at());
                let odd = |hit: &Hit| hit.tri.0 % 2 == 1;
                assert_eq!(bits(accel.closest_where(ray, odd)), bits(others.closest_where(ray, odd)), "{}", at());
                assert_eq!(accel.occluded_where(ray, odd), others.occluded_where(ray, odd), "{}", at());
                if i % 9 == 0 {
                    accel.all_hits(ray, &mut all);
                    others.all_hits(ray, &mut expected);
                    assert_eq!(all, expected, "{}", at());
                }
            }
            assert_eq!(accel.check(&mesh), [], "{name}, {spec}");
            assert!(growth(&accel).trees > 1, "{name}, {spec}: {:?}", growth(&accel));
        }
    }
}

#[test]
fn many_threads_at_once_grow_what_one_grows() {
    for (name, mesh) in meshes() {
        let rays = mixed(&mesh, 600, 23);
        for spec in LAZY {
            let alone = build_spec(&mesh, spec);
            let expected: Vec<_> = rays.iter().map(|ray| bits(alone.closest(ray))).collect();
            let shared = build_spec(&mesh, spec);
            std::thread::scope(|scope| {
                for thread in 0..8 {
                    let (shared, rays, expected) = (&shared, &rays, &expected);
                    scope.spawn(move || {
                        for i in 0..rays.len() {
                            // Each begins elsewhere, half of them go backwards.
                            let i = (i + thread * rays.len() / 8) % rays.len();
                            let i = if thread % 2 == 0 { i } else { rays.len() - 1 - i };
                            assert_eq!(bits(shared.closest(&rays[i])), expected[i], "{name}, {spec}, ray {i}");
                        }
                    });
                }
            });
            assert_eq!(shared.fingerprint(), alone.fingerprint(), "{name}, {spec}");
            assert_eq!(growth(&shared), growth(&alone), "{name}, {spec}");
        }
    }
}

/// Two heaps far from each other.
fn heaps() -> Mesh {
    let heap = soup(12_000, 0.02, 3);
    let (mut positions, mut triangles) = (heap.positions().to_vec(), heap.triangles().to_vec());
    let n = positions.len() as u32;
    positions.extend(heap.positions().iter().map(|p| [p[0] + 100.0, p[1], p[2]]));
    triangles.extend(heap.triangles().iter().map(|t| t.map(|i| i + n)));
    Mesh::new(positions, triangles).expect("a valid mesh")
}

#[test]
fn nothing_grows_that_no_ray_reaches() {
    let mesh = heaps();
    let accel = build_spec(&mesh, "bvh8(lazy)+sah");
    let before = growth(&accel);
    assert_eq!((before.upper_nodes, before.trees, before.waiting_triangles), (1, 0, mesh.len()), "the root alone");
    // From one heap away from the other, and past both.
    for ray in [Ray::new([0.5, 0.5, 0.5], [-1.0, 0.1, 0.2]), Ray::new([0.5, 50.0, 0.5], [1.0, 0.0, 0.0])] {
        accel.occluded(&ray);
        accel.closest(&ray);
    }
    let after = growth(&accel);
    assert!(after.trees > 0 && after.waiting_triangles >= mesh.len() / 2, "{after:?}");
    let waiting = after.waiting_triangles;
    // And then the other one, through all of it.
    for ray in mixed(&soup(500, 0.5, 9), 200, 3) {
        accel.closest(&Ray { origin: [ray.origin[0] + 100.0, ray.origin[1], ray.origin[2]], ..ray });
    }
    assert!(growth(&accel).waiting_triangles < waiting, "{:?}", growth(&accel));
    assert_eq!(accel.check(&mesh), []);
}

#[test]
fn known_rays_grow_what_they_reach_ahead_and_no_more() {
    let mesh = heaps();
    let spec: Spec = "bvh8(lazy)+rdh".parse().expect("a spec");
    // They all lie in the first heap.
    let rays = training(&soup(500, 0.02, 3));
    for threads in [1, 3] {
        let options = BuildOptions { threads: Some(threads), ..BuildOptions::default() };
        let accel = build(&mesh, &spec, &rays, &options).expect("it builds");
        let known = growth(&accel);
        assert!(known.trees > 0, "{known:?}");
        assert!(known.waiting_triangles >= mesh.len() / 3, "{known:?}");
        assert_eq!(accel.stats().trained_on, rays.len());
        assert_eq!(accel.check(&mesh), []);
    }
    assert!(matches!(build(&mesh, &spec, &rdh::Training::none(), &BuildOptions::default()), Err(Error::NoRays { .. })));
}

#[test]
fn a_spent_budget_makes_queries_slow_but_not_wrong() {
    let mesh = soup(12_000, 0.03, 3);
    let rays = mixed(&mesh, 200, 27);
    let others = build_spec(&mesh, "bvh8+sah");
    let free = build_spec(&mesh, "bvh8(lazy)+sah");
    for ray in &rays {
        free.closest(ray);
        free.occluded(ray);
    }
    let needed = free.lazy().expect("a lazy structure").bytes();
    for limit in [needed, needed * 3 / 4, needed / 2, 12_000 * 32] {
        let options = BuildOptions { max_bytes: Some(limit), ..BuildOptions::default() };
        let accel = build_with(&mesh, "bvh8(lazy)+sah", &options).expect("there is room for the runs");
        for ray in &rays {
            assert_eq!(bits(accel.closest(ray)), bits(others.closest(ray)), "{limit}: {ray:?}");
            assert_eq!(accel.occluded(ray), others.occluded(ray), "{limit}: {ray:?}");
        }
        assert!(accel.lazy().expect("a lazy structure").bytes() <= limit);
        assert_eq!(accel.check(&mesh), [], "{limit}");
        let grown = growth(&accel);
        match limit {
            _ if limit == needed => assert_eq!(grown, growth(&free)),
            384_000 => assert!(grown.bare_triangles > mesh.len() / 2, "hardly anything may grow: {grown:?}"),
            _ => assert!(grown.bare > 0 && grown.trees > 0, "{limit}: {grown:?}"),
        }
    }
    let options = BuildOptions { max_bytes: Some(100), ..BuildOptions::default() };
    let refused = build_with(&mesh, "bvh8(lazy)+sah", &options).map(|_| ());
    assert_eq!(refused, Err(Error::OverBudget { what: "bytes", limit: 100 }));
    let options = BuildOptions { max_refs: Some(100), ..BuildOptions::default() };
    let refused = build_with(&mesh, "bvh8(lazy)+sah", &options).map(|_| ());
    assert_eq!(refused, Err(Error::OverBudget { what: "references", limit: 100 }));
}

#[test]
fn it_can_be_cancelled_and_tells_how_far_it_is() {
    let mesh = soup(12_000, 0.03, 3);
    for spec in LAZY {
        let cancel = || true;
        let options = BuildOptions { cancel: Some(&cancel), ..BuildOptions::default() };
        assert_eq!(build_with(&mesh, spec, &options).map(|_| ()), Err(Error::Cancelled), "{spec}");
    }
    let most = std::sync::Mutex::new(0.0f64);
    let progress = |part: f64| {
        let mut most = most.lock().expect("no panic");
        *most = most.max(part);
    };
    let options = BuildOptions { progress: Some(&progress), ..BuildOptions::default() };
    build_with(&mesh, "bvh8(lazy)+sah", &options).expect("it builds");
    assert_eq!(*most.lock().expect("no panic"), 1.0);
}

#[test]
fn it_is_not_saved() {
    let accel = build_spec(&soup(3_000, 0.03, 3), "bvh8(lazy)+sah");
    assert!(matches!(accel.to_bytes(), Err(Error::Spec { reason, .. }) if reason.contains("not saved")));
}
