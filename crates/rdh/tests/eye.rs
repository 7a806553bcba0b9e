//! Trees around eyes against brute force.

use rdh::eye::{EyeForm, EyeOptions, EyeTree};
use rdh::simd::Level;
use rdh::tune::Measure;
use rdh::{
    Accel, BuildOptions, Counts, Error, HeldOut, Hit, Mesh, Query, Ray, RayClass, RaySample, Spec, Training, TriId,
    TuneOptions, Vec3, naive,
};

/// Numbers from −1 to 1 that repeat.
fn random(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }
}

/// A sphere of triangles around a place: closed.
fn sphere(radius: f32, at: Vec3, rings: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (vec![], vec![]);
    let segments = 2 * rings;
    for i in 0..=rings {
        for j in 0..segments {
            let (a, b) =
                (std::f32::consts::PI * i as f32 / rings as f32, std::f32::consts::TAU * j as f32 / segments as f32);
            let p = [a.sin() * b.cos(), a.sin() * b.sin(), a.cos()];
            let p = if i == 0 {
                [0.0, 0.0, 1.0]
            } else if i == rings {
                [0.0, 0.0, -1.0]
            } else {
                p
            };
            positions.push([0, 1, 2].map(|k| at[k] + radius * p[k]));
        }
    }
    let vertex = |i: u32, j: u32| i * segments + if i == 0 || i == rings { 0 } else { j % segments };
    for i in 0..rings {
        for j in 0..segments {
            triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)]);
            triangles.push([vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
        }
    }
    (positions, triangles)
}

/// Some spheres, a floor and triangles anywhere, all scaled and moved.
fn scene(scale: f32, offset: f32) -> Mesh {
    let (mut positions, mut triangles) = sphere(3.0, [0.0; 3], 12);
    let mut join = |(p, t): (Vec<Vec3>, Vec<[u32; 3]>)| {
        let first = positions.len() as u32;
        positions.extend(p);
        triangles.extend(t.iter().map(|t| t.map(|i| i + first)));
    };
    join(sphere(0.5, [1.0, 0.5, 0.2], 8));
    join(sphere(0.25, [-1.0, 0.75, -0.5], 6));
    let floor = vec![[-4.0, -4.0, -1.0], [4.0, -4.0, -1.0], [4.0, 4.0, -1.0], [-4.0, 4.0, -1.0]];
    join((floor, vec![[0, 1, 2], [0, 2, 3]]));
    let mut random = random(5);
    for _ in 0..150 {
        let size = 0.2 + random().abs();
        let at = [random(), random(), random()].map(|x| 2.5 * x);
        let corner = |random: &mut dyn FnMut() -> f32| [0, 1, 2].map(|k| at[k] + size * random());
        join((vec![corner(&mut random), corner(&mut random), corner(&mut random)], vec![[0, 1, 2]]));
    }
    let positions = positions.iter().map(|p| p.map(|x| x * scale + offset)).collect();
    Mesh::new(positions, triangles).unwrap()
}

fn world(mesh: &Mesh) -> Accel {
    let spec: Spec = "bvh8+sah".parse().unwrap();
    rdh::build(mesh, &spec, &Training::none(), &BuildOptions::default()).unwrap()
}

fn tree(mesh: &Mesh, eye: Vec3, form: EyeForm) -> EyeTree {
    let options = EyeOptions { form, ..EyeOptions::default() };
    EyeTree::build(world(mesh), eye, &Training::none(), &options, &BuildOptions::default()).unwrap()
}

/// Rays from a point: neighbours, some anywhere, and some through vertices, midpoints of edges and points in triangles.
fn rays_from(mesh: &Mesh, eye: Vec3, seed: u64) -> Vec<Ray> {
    let mut random = random(seed);
    let mut rays = Vec::new();
    for i in 0..1024 {
        let (x, y) = ((i % 32) as f32 / 40.0 - 0.4, (i / 32) as f32 / 40.0 - 0.4);
        rays.push(Ray::new(eye, [1.0, x, y]));
    }
    for _ in 0..200 {
        rays.push(Ray::new(eye, [random(), random(), random()]));
    }
    for t in mesh.triangles().iter().step_by(3) {
        let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
        let middle = [0, 1, 2].map(|k| 0.5 * a[k] + 0.5 * b[k]);
        let inner = [0, 1, 2].map(|k| 0.25 * a[k] + 0.25 * b[k] + 0.5 * c[k]);
        for p in [a, middle, inner] {
            rays.push(Ray::new(eye, [0, 1, 2].map(|k| p[k] - eye[k])));
        }
    }
    let n = rays.len();
    for i in (0..n).step_by(7) {
        let from = random().abs() * 1.2;
        rays.push(rays[i].within(from, from + 2.0 * random().abs()));
        rays.push(rays[i].within(0.0, random().abs()));
        rays.push(rays[i].within(-1.0, 2.0));
    }
    rays
}

/// Every query of every ray, one by one and together, against brute force.
fn agrees(tree: &EyeTree, mesh: &Mesh, rays: &[Ray]) {
    let (mut hits, mut found) = (vec![None; rays.len()], vec![false; rays.len()]);
    let right: Vec<Option<Hit>> = rays.iter().map(|ray| naive::closest(mesh, ray)).collect();
    let bits = |hit: Option<Hit>| hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.tri));
    for (ray, &right) in rays.iter().zip(&right) {
        assert_eq!(bits(tree.closest(ray)), bits(right), "{ray:?} alone");
        assert_eq!(tree.occluded(ray), right.is_some(), "{ray:?} alone, any hit");
    }
    for level in Level::available() {
        let tree = tree.clone().with_level(level);
        tree.closest_many(rays, &mut hits);
        tree.occluded_many(rays, &mut found);
        for width in [1, 13, 32, rays.len() + 1] {
            let mut in_rows = vec![None; rays.len()];
            tree.closest_rows(rays, width, &mut in_rows);
            assert!(in_rows == hits, "in rows of {width}");
        }
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(bits(hits[i]), bits(right[i]), "{ray:?}, ray {i} of many, {}", level.name());
            assert_eq!(found[i], right[i].is_some(), "{ray:?}, ray {i} of many, any hit, {}", level.name());
        }
    }
}

fn well_formed(tree: &EyeTree) {
    assert_eq!(tree.check(), vec![]);
}

#[test]
fn rays_from_the_eye_hit_what_brute_force_hits() {
    let mesh = scene(1.0, 0.0);
    let on_triangle = {
        let [a, b, c] = mesh.corners(TriId(700));
        [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
    };
    let eyes = [
        [0.1, 0.2, 0.3],
        [0.0; 3],
        // In the floor's plane, on a vertex, on an edge, on a triangle, outside, far away.
        [0.5, -0.25, -1.0],
        mesh.positions()[400],
        [4.0, 0.0, -1.0],
        on_triangle,
        [10.0, 4.0, 2.0],
        [-1e6, 1e6, 3e5],
    ];
    for (i, eye) in eyes.into_iter().enumerate() {
        for form in [EyeForm::From, EyeForm::Towards] {
            let tree = tree(&mesh, eye, form);
            well_formed(&tree);
            agrees(&tree, &mesh, &rays_from(&mesh, eye, i as u64));
        }
    }
}

/// Walls that lie on walls, some steps of rounding apart: up to five triangles of which margins can't tell which is nearest.
#[test]
fn surfaces_on_surfaces_are_told_apart() {
    for layers in 1..6 {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for layer in 0..layers {
            let x = f32::from_bits(2.0f32.to_bits() + [0, 1, 0, 3, 1][layer]);
            let first = positions.len() as u32;
            positions.extend([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[y, z]| [x, y, z]));
            let quad = if layer % 2 == 0 { [[0, 1, 2], [2, 0, 3]] } else { [[3, 0, 1], [1, 2, 3]] };
            triangles.extend(quad.map(|t| t.map(|i: u32| i + first)));
        }
        // Behind them, seen by rays that start beyond some of them.
        let behind = positions.len() as u32;
        positions.extend([[2.5, -9.0, -9.0], [2.5, 9.0, -9.0], [2.5, 0.0, 9.0]]);
        triangles.push([behind, behind + 1, behind + 2]);
        let mesh = Mesh::new(positions, triangles).unwrap();
        let tree = tree(&mesh, [0.0; 3], EyeForm::From);
        well_formed(&tree);
        let at = |i: usize| (i as f32 - 16.0) / 24.0;
        let mut rays: Vec<Ray> = (0..1024).map(|i| Ray::new([0.0; 3], [1.0, at(i % 32), at(i / 32)])).collect();
        for i in 0..rays.len() {
            let Some(hit) = naive::closest(&mesh, &rays[i]) else { continue };
            let beyond = |steps: u32| f32::from_bits(hit.t.to_bits() + steps);
            rays.extend([0, 1, 2, 3, 4].map(|steps| rays[i].within(beyond(steps), f32::INFINITY)));
            rays.extend([0, 1, 3].map(|steps| rays[i].within(0.0, beyond(steps))));
            rays.push(rays[i].within(0.0, f32::from_bits(hit.t.to_bits() - 1)));
            rays.push(rays[i].within(beyond(1), beyond(2)));
        }
        agrees(&tree, &mesh, &rays);
    }
}

#[test]
fn a_closed_mesh_has_no_holes() {
    let (positions, triangles) = sphere(1.0, [0.25, -0.5, 3.0], 24);
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mut random = random(3);
    for eye in [[0.25, -0.5, 3.0], [0.5, -0.25, 3.5], [0.3, -0.4, 2.125]] {
        let tree = tree(&mesh, eye, EyeForm::From);
        let mut rays = Vec::new();
        for t in mesh.triangles() {
            let corners = t.map(|i| mesh.positions()[i as usize]);
            for k in 0..3 {
                let (p, q, s) = (corners[k], corners[(k + 1) % 3], 0.5 + 0.5 * random());
                for s in [0.0, 0.5, s] {
                    let on_edge = [0, 1, 2].map(|a| p[a] + s * (q[a] - p[a]) - eye[a]);
                    rays.push(Ray::new(eye, on_edge));
                }
            }
        }
        let mut hits = vec![None; rays.len()];
        tree.closest_many(&rays, &mut hits);
        assert_eq!(hits.iter().filter(|h| h.is_none()).count(), 0, "of {}", rays.len());
        assert!(rays.iter().all(|ray| tree.closest(ray).is_some()));
        agrees(&tree, &mesh, &rays);
    }
}

/// Rays from points of the mesh to a light, with ends of all kinds.
fn rays_to(mesh: &Mesh, light: Vec3, seed: u64) -> Vec<Ray> {
    let mut random = random(seed);
    let mut rays = Vec::new();
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|i| mesh.positions()[i as usize]);
        for _ in 0..2 {
            let (mut u, mut v) = (random().abs(), random().abs());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
            let to = [0, 1, 2].map(|k| light[k] - p[k]);
            let length = to.iter().map(|x| x * x).sum::<f32>().sqrt();
            rays.push(Ray::new(p, to).within(1e-3, 1.0));
            rays.push(Ray::new(p, to).within(0.0, 1.0));
            rays.push(Ray::new(p, to).within(1e-4, 0.999));
            rays.push(Ray::new(p, to).within(1e-3, 0.5));
            rays.push(Ray::new(p, to));
            rays.push(Ray::new(p, to.map(|x| x / length)).within(1e-4, length));
            rays.push(Ray::new(p, [to[0] + 0.1 * random(), to[1], to[2]]).within(1e-3, 1.0));
        }
    }
    rays
}

#[test]
fn rays_towards_a_light_are_stopped_by_what_stops_them() {
    let mesh = scene(1.0, 0.0);
    for (i, light) in
        [[0.1, 0.2, 0.3], [0.5, -0.25, -1.0], mesh.positions()[400], [9.0, 9.0, 9.0]].into_iter().enumerate()
    {
        let tree = tree(&mesh, light, EyeForm::Towards);
        well_formed(&tree);
        let rays = rays_to(&mesh, light, i as u64);
        agrees(&tree, &mesh, &rays);
    }
}

#[test]
fn any_size_and_any_place() {
    for (scale, offset) in
        [(1e-12, 0.0), (1e12, 0.0), (1.0, 1000.0), (1.0, 1e6), (1e-30, 0.0), (1e30, 0.0), (1e-3, 1.0)]
    {
        let mesh = scene(scale, offset);
        let eye = [0.1, 0.2, 0.3].map(|x: f32| x * scale + offset);
        let rays: Vec<Ray> = rays_from(&mesh, eye, 1).into_iter().step_by(5).collect();
        agrees(&tree(&mesh, eye, EyeForm::From), &mesh, &rays);
        let rays: Vec<Ray> = rays_to(&mesh, eye, 1).into_iter().step_by(11).collect();
        agrees(&tree(&mesh, eye, EyeForm::Towards), &mesh, &rays);
    }
}

#[test]
fn sampled_rays_make_windows_and_all_others_are_answered_too() {
    let mesh = scene(1.0, 0.0);
    let eye = [0.1, 0.2, 0.3];
    let all = rays_from(&mesh, eye, 1);
    let sample = |ray: &Ray| RaySample {
        weight: 64,
        ..RaySample::new(*ray, naive::closest(&mesh, ray), Query::Closest, RayClass::Primary)
    };
    let training = Training::from_samples(all[..1024].iter().step_by(5).map(sample).collect());
    let build = |options: &BuildOptions<'_>| {
        EyeTree::build(world(&mesh), eye, &training, &EyeOptions::default(), options).unwrap()
    };
    let tree = build(&BuildOptions::default());
    well_formed(&tree);
    assert_eq!(tree.stats().sides, 1);
    assert!(tree.stats().triangles < mesh.len() / 2, "{:?}", tree.stats());
    agrees(&tree, &mesh, &all);
    let one = build(&BuildOptions { threads: Some(1), ..BuildOptions::default() });
    let two = build(&BuildOptions { threads: Some(2), ..BuildOptions::default() });
    assert_eq!(one.fingerprint(), two.fingerprint(), "the same on any number of threads");
}

#[test]
fn masks_are_obeyed() {
    let mesh = scene(1.0, 0.0);
    let masks = (0..mesh.len() as u32).map(|i| 1 << (i % 3)).collect();
    let mesh = mesh.with_masks(masks).unwrap();
    let eye = [0.1, 0.2, 0.3];
    let masked = |(i, ray): (usize, Ray)| ray.masked(i as u32 % 8);
    let rays: Vec<Ray> = rays_from(&mesh, eye, 1).into_iter().enumerate().map(masked).collect();
    agrees(&tree(&mesh, eye, EyeForm::From), &mesh, &rays);
    let rays: Vec<Ray> = rays_to(&mesh, eye, 1).into_iter().step_by(3).enumerate().map(masked).collect();
    let tree = tree(&mesh, eye, EyeForm::Towards);
    well_formed(&tree);
    agrees(&tree, &mesh, &rays);
}

#[test]
fn nothing_to_see_and_nothing_to_ask() {
    let empty = Mesh::new(vec![], vec![]).unwrap();
    let flat = Mesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2], [0, 0, 1]]).unwrap();
    for mesh in [empty, flat] {
        let tree = tree(&mesh, [0.0; 3], EyeForm::Towards);
        well_formed(&tree);
        let rays: Vec<Ray> = (0..100).map(|i| Ray::new([0.0; 3], [1.0, i as f32, 2.0])).collect();
        agrees(&tree, &mesh, &rays);
    }
    let mesh = scene(1.0, 0.0);
    let tree = tree(&mesh, [0.0; 3], EyeForm::Towards);
    let nan = f32::NAN;
    let odd = [
        Ray::new([nan, 0.0, 0.0], [1.0, 0.0, 0.0]),
        Ray::new([0.0; 3], [nan, 0.0, 0.0]),
        Ray::new([0.0; 3], [0.0; 3]),
        Ray::new([0.0; 3], [f32::INFINITY, 0.0, 0.0]),
        Ray::new([0.0; 3], [1.0, 0.0, 0.0]).within(2.0, 1.0),
        Ray::new([0.0; 3], [1.0, 0.0, 0.0]).within(nan, 1.0),
        Ray::new([0.0; 3], [1.0, 0.0, 0.0]).within(0.0, nan),
        Ray::new([-0.0; 3], [1.0, -0.0, 0.0]),
        Ray::new([0.0; 3], [1e-30, 0.0, 1e-30]),
        Ray::new([0.0; 3], [1e30, 1e30, -1e30]),
        Ray::new([1.0; 3], [-1e30, -1e30, -1e30]),
        Ray::new([1.0; 3], [-1.0; 3]).within(f32::NEG_INFINITY, 1.0),
        Ray::new([0.0; 3], [1.0; 3]),
        Ray::new([0.0; 3], [-1.0, 1.0, -1.0]),
    ];
    agrees(&tree, &mesh, &odd.repeat(9));
    tree.closest_many(&[], &mut []);
    tree.occluded_many(&[], &mut []);
}

#[test]
fn bad_input_is_refused() {
    let mesh = scene(1.0, 0.0);
    let build = |eye, options: &BuildOptions<'_>| {
        EyeTree::build(world(&mesh), eye, &Training::none(), &EyeOptions::default(), options)
    };
    let usual = BuildOptions::default();
    assert!(matches!(build([0.0, f32::NAN, 0.0], &usual), Err(Error::NotFinite { axis: 1, .. })));
    let small = BuildOptions { max_bytes: Some(1000), ..BuildOptions::default() };
    assert!(matches!(build([0.0; 3], &small), Err(Error::OverBudget { .. })));
    let cancel = || true;
    let cancelled = BuildOptions { cancel: Some(&cancel), ..BuildOptions::default() };
    assert!(matches!(build([0.0; 3], &cancelled), Err(Error::Cancelled)));
}

/// A part of a picture from an eye, and a few rays from elsewhere.
fn profile(mesh: &Mesh, eye: Vec3) -> Training {
    let rays = rays_from(mesh, eye, 3)
        .into_iter()
        .step_by(3)
        .chain(rays_from(mesh, [0.5, -0.25, 0.125], 4).into_iter().step_by(9));
    let sample = |ray: Ray| RaySample::new(ray, naive::closest(mesh, &ray), Query::Closest, RayClass::Primary);
    Training::from_samples(rays.map(sample).collect())
}

#[test]
fn a_spec_names_them_and_they_are_structures_like_others() {
    let (mesh, eye) = (scene(1.0, 0.0), [0.1, 0.2, 0.3]);
    let training = profile(&mesh, eye);
    let build = |text: &str| {
        let spec: Spec = text.parse().expect(text);
        rdh::build(&mesh, &spec, &training, &BuildOptions::default()).expect(text)
    };
    for (text, placed) in [
        ("kd(eye)", "kd(eye=0.1,0.2,0.3)+sah"),
        ("kd(eye)+rdh", "kd(eye=0.1,0.2,0.3)+rdh"),
        ("kd(light=0.1,0.2,0.3)", "kd(light=0.1,0.2,0.3)+sah"),
    ] {
        let accel = build(text);
        assert_eq!(accel.stats().spec.to_string(), placed);
        assert_eq!(accel.check(&mesh), vec![]);
        let tree = accel.eye_tree().expect(text);
        let world = tree.world();
        assert_eq!(world.stats().spec.to_string(), placed.replace(&placed[..placed.find(')').unwrap() + 1], "bvh8"));
        assert_eq!(accel.stats().bytes, world.stats().bytes + tree.stats().bytes);
        assert_eq!(accel.stats().references, world.stats().references + tree.stats().references);
        // They come to the same by themselves.
        let same = Accel::from(tree.clone());
        assert_eq!((same.fingerprint(), same.stats().bytes), (accel.fingerprint(), accel.stats().bytes));
        // Mixed: rays from the eye, to it, and others, in runs of all lengths.
        let (from, to) = (rays_from(&mesh, eye, 1), rays_to(&mesh, eye, 1));
        let others = rays_from(&mesh, [0.5, -0.25, 0.125], 2);
        let mixed: Vec<Ray> = [&from[..1100], &to[..700], &others[..900]].concat();
        let mixed: Vec<Ray> =
            mixed.iter().copied().chain((0..600).flat_map(|i| [from[i], others[i], to[i % to.len()]])).collect();
        let (mut hits, mut found, mut all) = (vec![None; mixed.len()], vec![false; mixed.len()], Vec::new());
        accel.closest_many(&mixed, &mut hits);
        accel.occluded_many(&mixed, &mut found);
        for (i, ray) in mixed.iter().enumerate() {
            let right = naive::closest(&mesh, ray);
            assert!(hits[i] == right && accel.closest(ray) == right, "{text}, {ray:?}");
            assert!(found[i] == right.is_some() && accel.occluded(ray) == right.is_some(), "{text}, {ray:?}");
            accel.all_hits(ray, &mut all);
            assert!(all == naive::all_hits(&mesh, ray), "{text}, {ray:?}");
            assert_eq!(
                accel.closest_where(ray, |hit| hit.tri.0 % 2 == 0),
                world.closest_where(ray, |hit| hit.tri.0 % 2 == 0)
            );
        }
        let refused = accel.to_bytes().expect_err("they are not saved").to_string();
        assert!(refused.contains(placed) && refused.contains("not saved"), "{refused}");
    }
}

#[test]
fn an_eye_that_rays_do_not_tell_is_an_error() {
    let mesh = scene(1.0, 0.0);
    let build = |text: &str, rays: &Training| {
        let spec: Spec = text.parse().expect(text);
        rdh::build(&mesh, &spec, rays, &BuildOptions::default()).map(|accel| accel.stats().spec)
    };
    assert!(matches!(build("kd(eye)", &Training::none()), Err(Error::NoRays { .. })));
    let apart = (0..50).map(|i| Ray::new([i as f32, 0.0, 0.0], [0.0, 1.0, 0.0]));
    let apart = apart.map(|ray| RaySample::new(ray, None, Query::Closest, RayClass::Bounce)).collect();
    let apart = Training::from_samples(apart);
    let error = build("kd(eye)", &apart).expect_err("there is no such point").to_string();
    assert!(error.contains("no two of the training rays start at one point"), "{error}");
    let error = build("kd(light)", &apart).expect_err("there is no such point").to_string();
    assert!(error.contains("no two of the shadow rays"), "{error}");
}

#[test]
fn counts_tell_what_they_visit_and_tune_tries_them() {
    let (mesh, eye) = (scene(1.0, 0.0), [0.1, 0.2, 0.3]);
    let training = profile(&mesh, eye);
    let mut counts = Counts::default();
    let accel = rdh::build(&mesh, &"kd(eye)+rdh".parse().unwrap(), &training, &BuildOptions::default()).unwrap();
    for sample in training.samples() {
        accel.closest_counted(&sample.ray, &mut counts);
    }
    let rays = training.len() as u64;
    assert!(counts.leaves >= rays && counts.interiors > rays && counts.tests > rays / 2, "{counts:?}");
    let held_out = HeldOut::from_samples(training.samples().to_vec());
    let candidates = Spec::list("bvh8+sah,kd(eye)+rdh").unwrap();
    let tuned = rdh::tune(&mesh, &candidates, &training, &held_out, &TuneOptions::default(), None).unwrap();
    let trial = tuned.evidence.trials.iter().find(|trial| trial.spec == candidates[1]).expect("it is tried");
    assert!(trial.nanos_per_ray(Measure::Counts).is_some_and(|nanos| nanos > 0.0), "{trial:?}");
}
