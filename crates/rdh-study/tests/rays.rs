//! The rays of each mode, against what can be known by thought.

mod common;

use std::collections::BTreeSet;

use common::{at, boxes, cube, plan, room, view};
use rdh::{Accel, BuildOptions, Query, Ray, RayClass, Spec, Training, build};
use rdh_scene::{Material, Scene};
use rdh_study::measure::tally;
use rdh_study::{Mode, Plan, Protocol, RayBatch, Shoot, Stage};

fn tree(stage: &Stage) -> Accel {
    build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap()
}

/// The test rays of a scene's first view.
fn batches(scene: &Scene, mode: Mode, plan: &Plan) -> (Stage, Accel, Vec<RayBatch>) {
    let stage = Stage::new(scene).unwrap();
    let accel = tree(&stage);
    let batches = Shoot::new(&stage, mode, &scene.views[0], plan).batches(&accel);
    (stage, accel, batches)
}

fn classes(batches: &[RayBatch]) -> Vec<(RayClass, Query, usize)> {
    batches.iter().map(|b| (b.class, b.query, b.rays.len())).collect()
}

fn bits(ray: &Ray) -> [u32; 8] {
    let ([a, b, c], [d, e, f]) = (ray.origin, ray.direction);
    [a, b, c, d, e, f, ray.t_min, ray.t_max].map(f32::to_bits)
}

const MIRROR: Material = Material { diffuse: 0.1, mirror: 0.9, transmission: 0.0, index: 1.0 };
const GLASS: Material = Material { diffuse: 0.0, mirror: 0.1, transmission: 0.9, index: 1.5 };
const PIXELS: usize = 48 * 32;

#[test]
fn every_primary_ray_hits_a_closed_room_and_has_length_one() {
    let scene = room(None);
    let (_, accel, batches) = batches(&scene, Mode::Primary, &plan(&[]));
    assert_eq!(classes(&batches), [(RayClass::Primary, Query::Closest, PIXELS)]);
    let tally = tally(&accel, &batches[0]);
    assert_eq!(tally.hits, PIXELS as u64);
    let length = |r: &Ray| r.direction.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
    assert!(batches[0].rays.iter().all(|r| (length(r) - 1.0).abs() < 1e-6 && r.t_max == f32::INFINITY));
}

#[test]
fn each_pixel_has_one_jittered_ray_in_scan_line_order() {
    let scene = room(None);
    let (stage, _, batches) = batches(&scene, Mode::Primary, &plan(&[]));
    let lens = rdh_study::Lens::new(&stage, Mode::Primary, &scene.views[0], 48.0 / 32.0);
    for (i, ray) in batches[0].rays.iter().enumerate() {
        // A ray lies in its pixel if it is on the right side of the pixel's four borders; their corners will do here.
        let corner =
            |dx: usize, dy: usize| lens.ray((i % 48 + dx) as f64 / 48.0, (i / 48 + dy) as f64 / 32.0).direction;
        let side = |a: [f32; 3], b: [f32; 3]| {
            let [a, b, d] = [a, b, ray.direction].map(|v| v.map(f64::from));
            (a[1] * b[2] - a[2] * b[1]) * d[0] + (a[2] * b[0] - a[0] * b[2]) * d[1] + (a[0] * b[1] - a[1] * b[0]) * d[2]
        };
        let around = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let sides: Vec<bool> = (0..4).map(|k| side(around[k], around[(k + 1) % 4]) > 0.0).collect();
        assert!(sides.iter().all(|&s| s == sides[0]), "pixel {i}");
    }
}

#[test]
fn a_mirror_room_reflects_to_depth_five_and_shadows_nothing() {
    let scene = room(Some(MIRROR));
    let (_, accel, batches) = batches(&scene, Mode::Whitted, &plan(&[]));
    // The primary ray has depth 1, so four reflections follow; a convex room sees its light from every hit.
    let expected = [
        (RayClass::Primary, Query::Closest, PIXELS),
        (RayClass::Shadow, Query::Occluded, 5 * PIXELS),
        (RayClass::Reflection, Query::Closest, 4 * PIXELS),
    ];
    assert_eq!(classes(&batches), expected);
    let hits: Vec<u64> = batches.iter().map(|b| tally(&accel, b).hits).collect();
    assert_eq!(hits, [PIXELS as u64, 0, 4 * PIXELS as u64]);
}

#[test]
fn a_shadow_ray_ends_at_the_light() {
    let scene = room(None);
    let (stage, _, batches) = batches(&scene, Mode::Whitted, &plan(&[]));
    let shadow = batches.iter().find(|b| b.class == RayClass::Shadow).unwrap();
    assert_eq!(shadow.rays.len(), PIXELS);
    for ray in &shadow.rays {
        let end = ray.at(ray.t_max);
        assert!((0..3).all(|a| (end[a] - stage.lights()[0][a]).abs() < 1e-5), "{end:?}");
    }
}

#[test]
fn a_light_behind_a_wall_is_shadowed_and_one_behind_the_surface_casts_no_ray() {
    let mut scene = room(None);
    scene.lights[0].position = [0.0, 0.0, 30.0];
    let (_, accel, outside) = batches(&scene, Mode::Whitted, &plan(&[]));
    let shadow = outside.iter().find(|b| b.class == RayClass::Shadow).unwrap();
    // From inside, the light above is in front of the floor and of the walls' planes nowhere but there: a wall's plane
    // has the light on its inner side too, the ceiling's has not.
    assert!(!shadow.rays.is_empty() && tally(&accel, shadow).hits == shadow.rays.len() as u64);
    assert!(shadow.rays.iter().all(|r| r.origin[2] < 10.0 - 1e-4));
}

#[test]
fn a_glass_pane_is_entered_and_left_by_snells_law() {
    // A glass cube before the eye, in a room: straight rays pass undeviated.
    let mut scene = room(None);
    scene.materials = vec![Material::DIFFUSE, GLASS];
    scene.geometries.push(rdh_scene::Geometry { material: 1, ..cube(1.0) });
    scene.instances.push(at(1, [0.0, 0.0, 0.0]));
    scene.views = vec![view("pane", [-5.0, 0.1, 0.2], [0.0, 0.1, 0.2])];
    let plan = Plan { size: [1, 1], ..plan(&[]) };
    scene.views[0].fov_y_degrees = 0.01;
    let (_, accel, batches) = batches(&scene, Mode::Whitted, &plan);
    let refraction = &batches.iter().find(|b| b.class == RayClass::Refraction).unwrap().rays;
    // Depth first: the reflection's subtree is in another class, so the first refraction goes through the front.
    let inside = accel.closest(&refraction[0]).unwrap();
    assert!((refraction[0].direction[0] - 1.0).abs() < 1e-6 && (inside.t - 2.0).abs() < 1e-3);
    // Somewhere a ray leaves through the back, still straight.
    assert!(refraction.iter().any(|r| r.origin[0] > 1.0 && (r.direction[0] - 1.0).abs() < 1e-6));
    // Both start off the surface, on the side to which they go.
    assert!(refraction[0].origin[0] > -1.0 && refraction[0].origin[0] < -0.9999);
}

#[test]
fn paths_have_four_bounces_and_a_shadow_ray_at_every_hit() {
    let scene = room(Some(MIRROR));
    let (_, accel, batches) = batches(&scene, Mode::Path, &plan(&[]));
    let expected = [
        (RayClass::Primary, Query::Closest, PIXELS),
        (RayClass::Shadow, Query::Occluded, 5 * PIXELS),
        (RayClass::Bounce, Query::Closest, 4 * PIXELS),
    ];
    assert_eq!(classes(&batches), expected);
    assert_eq!(tally(&accel, &batches[1]).hits, 0);
    assert_eq!(tally(&accel, &batches[2]).hits, 4 * PIXELS as u64);
}

#[test]
fn bounces_start_on_surfaces_and_fill_the_cosine_lobe() {
    let scene = room(None);
    let (_, _, batches) = batches(&scene, Mode::Path, &plan(&[]));
    let bounces = &batches.iter().find(|b| b.class == RayClass::Bounce).unwrap().rays;
    let mut sum = 0.0;
    for ray in bounces {
        // The wall on which it starts: one coordinate is ±10, to within the offset of 16 half ulps of 10 + the wall's diagonal.
        let (axis, at) = (0..3).map(|a| (a, ray.origin[a])).max_by(|x, y| x.1.abs().total_cmp(&y.1.abs())).unwrap();
        assert!(at.abs() < 10.0 && at.abs() > 10.0 - 1e-4, "{:?}", ray.origin);
        let cosine = -ray.direction[axis] * at.signum();
        assert!(cosine > 0.0);
        sum += f64::from(cosine);
    }
    // E[cos] = 2/3, its deviation 0.236: 4 standard errors.
    let n = bounces.len() as f64;
    assert!((sum / n - 2.0 / 3.0).abs() < 4.0 * 0.236 / n.sqrt(), "{}", sum / n);
}

#[test]
fn ambient_rays_are_a_tenth_of_the_diagonal_long() {
    let scene = room(None);
    let (stage, accel, batches) = batches(&scene, Mode::Ao, &plan(&[]));
    let expected = [(RayClass::Primary, Query::Closest, PIXELS), (RayClass::Ao, Query::Occluded, 4 * PIXELS)];
    assert_eq!(classes(&batches), expected);
    let reach = 20.0 * 3f32.sqrt() * 0.1;
    assert!((stage.bounds().diagonal() * 0.1 - reach).abs() < 1e-5);
    assert!(batches[1].rays.iter().all(|r| r.t_min == 0.0 && (r.t_max - reach).abs() < 1e-5));
    // Whoever starts farther than that from all other walls sees nothing.
    let far = |r: &Ray| r.origin.iter().filter(|x| x.abs() > 10.0 - reach).count() == 1;
    let open: Vec<Ray> = batches[1].rays.iter().copied().filter(far).collect();
    let near = batches[1].rays.len() - open.len();
    assert!(open.len() > PIXELS && near > 0);
    assert!(open.iter().all(|r| !accel.occluded(r)));
    assert!(tally(&accel, &batches[1]).hits > 0);
}

#[test]
fn the_scanner_has_64_beams_at_the_stated_elevations() {
    let scene = room(None);
    let (_, accel, batches) = batches(&scene, Mode::Lidar, &plan(&[]));
    assert_eq!(classes(&batches), [(RayClass::Lidar, Query::Closest, 64 * 2048)]);
    assert_eq!(tally(&accel, &batches[0]).hits, 64 * 2048);
    let mut turn = 0.0f64;
    for (i, ray) in batches[0].rays.iter().enumerate() {
        let elevation = f64::from(ray.direction[2]).asin().to_degrees();
        let stated = 22.5 - 45.0 * ((i % 64) as f64 + 0.5) / 64.0;
        assert!((elevation - stated).abs() < 1e-3, "{i}: {elevation} {stated}");
        turn += f64::from(ray.direction[0]);
    }
    // A whole turn: no direction has more than the others.
    assert!((turn / (64.0 * 2048.0)).abs() < 1e-3);
}

#[test]
fn scenes_without_materials_have_every_eighth_part_a_mirror() {
    // 27 instances of the small box, after the room: numbers 7, 15 and 23 of all instances are mirrors.
    let scene = boxes(3);
    let stage = Stage::new(&scene).unwrap();
    let mirrors: BTreeSet<usize> =
        (0..28 * 12).filter(|&t| stage.material(rdh::TriId(t)).mirror > 0.0).map(|t| t as usize / 12).collect();
    assert_eq!(mirrors, BTreeSet::from([7, 15, 23]));
    // The same as one mesh: its connected parts.
    let flat = scene.flatten().unwrap();
    let one = rdh_scene::Geometry {
        positions: flat.mesh.positions().to_vec(),
        triangles: flat.mesh.triangles().to_vec(),
        ..Default::default()
    };
    let joined = Scene { geometries: vec![one], instances: vec![at(0, [0.0; 3])], ..scene };
    let joined = Stage::new(&joined).unwrap();
    assert!((0..28 * 12).all(|t| joined.material(rdh::TriId(t)) == stage.material(rdh::TriId(t))));
}

#[test]
fn scenes_without_lights_have_one_high_above_the_middle() {
    let mut scene = room(None);
    scene.lights.clear();
    assert_eq!(Stage::new(&scene).unwrap().lights(), [[0.0, 0.0, 8.0]]);
    scene.up = [0.0, -1.0, 0.0];
    assert_eq!(Stage::new(&scene).unwrap().lights(), [[0.0, -8.0, 0.0]]);
}

#[test]
fn rays_depend_neither_on_threads_nor_on_the_structure() {
    let scene = boxes(3);
    let stage = Stage::new(&scene).unwrap();
    let other = build(
        stage.mesh(),
        &"kd(leaf=1,split=exact,prune=none)+sah".parse().unwrap(),
        &Training::none(),
        &BuildOptions::default(),
    );
    let (one, other) = (tree(&stage), other.unwrap());
    let plan = plan(&[]);
    for mode in Mode::ALL {
        let shoot = Shoot::new(&stage, mode, &scene.views[0], &plan);
        let in_threads = |n: usize, accel: &Accel| {
            rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| shoot.batches(accel))
        };
        let first = in_threads(1, &one);
        assert_eq!(first, in_threads(3, &one), "{mode}");
        assert_eq!(first, in_threads(2, &other), "{mode}");
        let classes: Vec<RayClass> = first.iter().map(|b| b.class).collect();
        assert!(classes.iter().all(|c| mode.classes().contains(c)) && classes.is_sorted(), "{mode}: {classes:?}");
    }
}

#[test]
fn training_rays_are_others_than_the_test_rays_unless_the_protocol_says_so() {
    let scene = boxes(2);
    let stage = Stage::new(&scene).unwrap();
    let accel = tree(&stage);
    for mode in [Mode::Primary, Mode::Whitted] {
        let with = |protocol| {
            let plan = Plan { protocol, ..plan(&[]) };
            let shoot = Shoot::new(&stage, mode, &scene.views[0], &plan);
            let tests: BTreeSet<[u32; 8]> = shoot.batches(&accel).iter().flat_map(|b| &b.rays).map(bits).collect();
            let training = shoot.training(&accel, tests.len());
            let shared = training.samples().iter().filter(|s| tests.contains(&bits(&s.ray))).count();
            (tests.len(), training.len(), shared)
        };
        assert_eq!(with(Protocol::Unseen), (with(Protocol::Unseen).0, 500, 0), "{mode}");
        let (_, trained, shared) = with(Protocol::Paper);
        assert!(trained == shared && trained > 300 && trained <= 500, "{mode}: {trained} {shared}");
        let (tests, trained, shared) = with(Protocol::Same);
        assert_eq!((trained, shared), (tests, tests), "{mode}");
    }
}

#[test]
fn training_rays_know_where_they_ended() {
    let scene = boxes(2);
    let stage = Stage::new(&scene).unwrap();
    let accel = tree(&stage);
    let shoot_plan = plan(&[]);
    let training = Shoot::new(&stage, Mode::Ao, &scene.views[0], &shoot_plan).training(&accel, 0);
    assert!(training.samples().iter().any(|s| s.class == RayClass::Ao && s.t_hit.is_some()));
    for sample in training.samples() {
        assert_eq!(sample.t_hit, accel.closest(&sample.ray).map(|h| h.t));
        assert_eq!(sample.query, if sample.class == RayClass::Ao { Query::Occluded } else { Query::Closest });
    }
}

#[test]
fn an_empty_scene_casts_primary_rays_into_nothing() {
    let scene = Scene { views: room(None).views, ..Scene::default() };
    for mode in Mode::ALL {
        let (_, accel, batches) = batches(&scene, mode, &plan(&[]));
        assert_eq!(batches.len(), 1, "{mode}");
        assert_eq!(tally(&accel, &batches[0]).hits, 0);
    }
}

#[test]
fn pictures_are_brighter_where_light_falls() {
    let scene = boxes(2);
    let stage = Stage::new(&scene).unwrap();
    let accel = tree(&stage);
    let lens = rdh_study::Lens::new(&stage, Mode::Whitted, &scene.views[1], 1.0);
    for mode in Mode::ALL {
        let pixels: Vec<f32> = (0..400u16)
            .map(|i| {
                rdh_study::radiance(
                    &stage,
                    &accel,
                    mode,
                    &lens.ray(f64::from(i % 20) / 20.0, f64::from(i / 20) / 20.0),
                    1,
                    i.into(),
                )
            })
            .collect();
        let (low, high) = pixels.iter().fold((f32::MAX, f32::MIN), |(l, h), &p| (l.min(p), h.max(p)));
        assert!(low >= 0.0 && high > low && high < 3.0, "{mode}: {low} {high}");
    }
}
