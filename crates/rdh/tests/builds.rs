//! What builds promise besides right answers: the same tree on any number of threads, budgets, cancellation, growth.

mod common;

use std::sync::atomic::{AtomicUsize, Ordering};

use common::meshes::{heights, icosphere, nasty, soup, tessellated_box};
use common::{SPECS, build_spec, rays::mixed, training};
use rdh::simd::Level;
use rdh::{BuildOptions, Counts, Error, Mesh, Spec, Training, build};

fn terrain(n: u32) -> Mesh {
    heights(n, |i, j| ((i * 37 + j * 91) % 17) as f32 * 0.004)
}

#[test]
fn the_tree_does_not_depend_on_threads_or_instructions() {
    for mesh in [terrain(80), soup(12_000, 0.03, 3)] {
        let rays = training(&soup(500, 0.05, 1));
        for spec in SPECS {
            let spec: Spec = spec.parse().expect(spec);
            let with = |threads| {
                let options = BuildOptions { threads: Some(threads), ..BuildOptions::default() };
                build(&mesh, &spec, &rays, &options).expect("it builds").fingerprint()
            };
            let one = with(1);
            assert_eq!((one, one), (with(2), with(7)), "{spec}");
            for level in Level::available() {
                let options = BuildOptions { threads: Some(1), level: Some(level), ..BuildOptions::default() };
                let tree = build(&mesh, &spec, &rays, &options).expect("it builds");
                assert_eq!(tree.fingerprint(), one, "{spec}, {}", level.name());
            }
        }
    }
}

/// More triangles than one thread puts into bins, and an odd number. Where heights are 0, signs of zeros differ by triangle: the last
/// one, which has no partner in a pair, lies among others of another sign.
fn large_terrain() -> Mesh {
    let terrain = terrain(187);
    let (mut points, mut triangles) = (terrain.positions().to_vec(), terrain.triangles().to_vec());
    while triangles.len() < 70_001 {
        let x = (70_001 - triangles.len()) as f32 * 1e-5;
        let next = points.len() as u32;
        points.extend([[x, 0.0, -0.0], [x + 1e-3, 0.0, -0.0], [x, 1e-3, -0.0]]);
        triangles.push([next, next + 1, next + 2]);
    }
    Mesh::new(points, triangles).expect("a valid mesh")
}

#[test]
fn large_trees_do_not_depend_on_threads_either() {
    let mesh = large_terrain();
    let rays = training(&soup(500, 0.05, 1));
    // The boxes of a binary node's children, which threads have found, are only seen where they are not opened at once.
    for spec in [
        "kd+sah",
        "kd+rdh",
        "bvh2+sah",
        "bvh8(quick)+sah",
        "bvh8(split=sweep)+sah",
        "sbvh8+sah",
        "bvh8(high)+sah",
        "bvh8+rdh",
        "bvh8(from=kd)+sah",
        "bvh8(compact)+sah",
    ] {
        let spec: Spec = spec.parse().expect(spec);
        let with = |threads| {
            let options = BuildOptions { threads: Some(threads), ..BuildOptions::default() };
            build(&mesh, &spec, &rays, &options).expect("it builds").fingerprint()
        };
        assert_eq!(with(1), with(3), "{spec}");
    }
}

#[test]
fn reference_budgets_are_kept() {
    for spec in ["kd+sah", "bvh8+sah", "sbvh8+sah", "sbvh8(high)+sah", "bvh8(from=kd)+sah"] {
        let parsed: Spec = spec.parse().expect(spec);
        for (name, mesh) in nasty() {
            for max_refs in [mesh.len(), mesh.len() + mesh.len() / 16, 2 * mesh.len(), 5 * mesh.len()] {
                let options = BuildOptions { max_refs: Some(max_refs), ..BuildOptions::default() };
                let accel = build(&mesh, &parsed, &Training::none(), &options).expect(name);
                assert!(accel.stats().references <= max_refs, "{spec}, {name}, {max_refs}: {:?}", accel.stats());
                assert!(accel.check(&mesh).is_empty(), "{spec}, {name}, {max_refs}");
            }
        }
    }
}

#[test]
fn byte_and_depth_budgets_are_kept_or_refused() {
    let mesh = soup(5000, 0.2, 5);
    let free = *build_spec(&mesh, "kd+sah").stats();
    let options = BuildOptions { max_bytes: Some(free.bytes / 2), ..BuildOptions::default() };
    let accel = build(&mesh, &Spec::default(), &Training::none(), &options).expect("half of it is enough");
    assert!(accel.stats().bytes <= free.bytes / 2);
    assert!(accel.check(&mesh).is_empty());
    let options = BuildOptions { max_bytes: Some(1000), ..BuildOptions::default() };
    let error = build(&mesh, &Spec::default(), &Training::none(), &options).err();
    assert_eq!(error, Some(Error::OverBudget { what: "bytes", limit: 1000 }));
    let options = BuildOptions { max_depth: Some(3), ..BuildOptions::default() };
    assert!(build(&mesh, &Spec::default(), &Training::none(), &options).expect("it builds").stats().depth <= 3);
}

#[test]
fn a_build_can_be_cancelled_and_reports_progress() {
    let mesh = terrain(120);
    for threads in [1, 2] {
        let asked = AtomicUsize::new(0);
        let cancel = || asked.fetch_add(1, Ordering::Relaxed) >= 3;
        let options = BuildOptions { threads: Some(threads), cancel: Some(&cancel), ..BuildOptions::default() };
        assert_eq!(build(&mesh, &Spec::default(), &Training::none(), &options).err(), Some(Error::Cancelled));
        let reports = AtomicUsize::new(0);
        let progress = |part: f64| {
            assert!((0.0..=1.0).contains(&part));
            reports.fetch_add(1, Ordering::Relaxed);
        };
        let options = BuildOptions { threads: Some(threads), progress: Some(&progress), ..BuildOptions::default() };
        build(&mesh, &Spec::default(), &Training::none(), &options).expect("it builds");
        assert!(reports.load(Ordering::Relaxed) > 10);
    }
}

/// Every stage asks often enough, and wherever it is told to stop, it does.
#[test]
fn builds_can_be_cancelled_in_every_stage() {
    let mesh = terrain(120);
    let rays = training(&mesh);
    let cancelled_at = |spec: &Spec, limit: usize| {
        let asked = AtomicUsize::new(0);
        let cancel = || asked.fetch_add(1, Ordering::Relaxed) >= limit;
        let options = BuildOptions { threads: Some(1), cancel: Some(&cancel), ..BuildOptions::default() };
        (build(&mesh, spec, &rays, &options).err(), asked.into_inner())
    };
    let often = ["bvh8+sah", "bvh8(high)+sah", "bvh8+rdh", "sbvh8(high)+rdh", "bvh8(from=kd)+sah"].map(|text| {
        let spec: Spec = text.parse().expect(text);
        let (error, often) = cancelled_at(&spec, usize::MAX);
        assert_eq!(error, None, "{text}");
        for limit in (0..often).step_by(often.div_ceil(4)).chain([often - 1]) {
            let (error, asked) = cancelled_at(&spec, limit);
            assert_eq!(error, Some(Error::Cancelled), "{text}, {limit} of {often}");
            // Subtrees that others have begun ask once more each.
            assert!(asked <= limit + 8, "{text}: asked {asked} times, cancelled at {limit}");
        }
        often
    });
    let [plain, high, guided, ..] = often;
    assert!(high >= plain + 8 && guided >= plain + 8, "moves and visits are asked about too: {often:?}");
}

/// Memory and nodes grow no faster than the mesh, and steps a ray only as its logarithm.
#[test]
fn trees_grow_with_their_meshes() {
    let stats: Vec<_> = [40, 160].map(|n| *build_spec(&terrain(n), "kd+sah").stats()).into();
    let growth = |f: fn(&rdh::Stats) -> usize| f(&stats[1]) as f64 / f(&stats[0]) as f64 / 16.0;
    assert!(growth(|s| s.references) < 1.2 && growth(|s| s.bytes) < 1.2 && growth(|s| s.nodes) < 1.2, "{stats:?}");
    assert!(stats[1].depth <= stats[0].depth + 8);
}

/// What cannot be separated becomes one leaf at once, instead of a search without end.
#[test]
fn identical_triangles_are_one_leaf() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.2], [0.0, 1.0, 0.1]];
    let mesh = Mesh::new(points, vec![[0, 1, 2]; 20_000]).expect("a valid mesh");
    for spec in ["kd+sah", "kd(leaf=1,split=exact)+sah"] {
        let stats = *build_spec(&mesh, spec).stats();
        assert!(stats.references <= 40_000 && stats.nodes < 100, "{spec}: {stats:?}");
    }
}

#[test]
fn built_specs_are_reported_as_asked() {
    let mesh = icosphere(2);
    for text in SPECS {
        let accel = build_spec(&mesh, text);
        assert_eq!(&accel.stats().spec.to_string(), text);
        assert_eq!(accel.stats().triangles, mesh.len());
        // A tree around a point is one for each of its sides.
        if text.starts_with("kd") && !text.contains("eye=") && !text.contains("light=") {
            assert_eq!(accel.stats().nodes, 2 * accel.stats().leaves - 1);
        }
    }
}

/// What the baselines cost, so that no change makes them worse unnoticed: steps, tests and bytes for fixed rays, within 1 %.
#[test]
fn the_baselines_stay_as_good_as_they_are() {
    let golden = include_str!("golden/baselines.txt");
    let mut current = String::new();
    for (name, mesh) in [("terrain", terrain(100)), ("soup", soup(20_000, 0.03, 7)), ("box", tessellated_box(48))] {
        let rays = mixed(&mesh, 2000, 31);
        for spec in ["kd+sah", "kd(prune=none)+sah", "kd(stop=paper,prune=none)+sah", "kd(leaf=1,split=exact)+sah"] {
            let accel = build_spec(&mesh, spec);
            let mut counts = Counts::default();
            for ray in &rays {
                accel.closest_counted(ray, &mut counts);
            }
            let bytes = accel.stats().bytes;
            current += &format!("{name} {spec} {} {} {bytes}\n", counts.steps(), counts.tests);
        }
    }
    let numbers = |line: &str| line.rsplitn(4, ' ').take(3).map(|x| x.parse::<f64>().expect(line)).collect::<Vec<_>>();
    assert_eq!(golden.lines().count(), current.lines().count(), "expected lines:\n{current}");
    for (was, is) in golden.lines().zip(current.lines()) {
        let worse = numbers(was).iter().zip(numbers(is)).any(|(was, is)| is > was * 1.01);
        assert!(!worse, "was: {was}\nis:  {is}\nall:\n{current}");
    }
}

#[test]
fn idle_parts_stay_leaves_of_a_bounded_size_and_busy_ones_are_split() {
    let mesh = soup(20_000, 0.02, 9);
    let leaves = |spec: &str| {
        let accel = build_spec(&mesh, spec);
        assert!(accel.check(&mesh).is_empty(), "{spec}");
        let mut sizes = Vec::new();
        accel.cells(&mut |_, _, triangles| sizes.push(triangles));
        sizes
    };
    // The mean leaf says how far it was split, the largest one what a ray may have to pay in it.
    let mean = |sizes: &[usize]| sizes.iter().sum::<usize>() as f64 / sizes.len() as f64;
    let (split, some, all) = (leaves("kd+sah"), leaves("kd(idle=0.1)+sah"), leaves("kd(idle=1000)+sah"));
    assert!(mean(&split) < mean(&some) && mean(&some) < mean(&all), "{} {} {}", mean(&split), mean(&some), mean(&all));
    assert!(all.iter().all(|&n| n <= 256), "larger nodes are split however idle they are");
    assert_eq!(build_spec(&mesh, "kd(idle=0)+rdh").fingerprint(), build_spec(&mesh, "kd+rdh").fingerprint());
}
