//! The heuristics against what is known of them analytically.

mod common;

use common::meshes::{Random, soup, unit};
use common::{build_spec, rays::mixed, training};
use rdh::heuristic::{Heuristic, Rdh, Sah};
use rdh::{Aabb, Axis, BuildOptions, Error, Query, Ray, RayClass, RaySample, RdhSpec, Spec, Training, build};

const BOX: Aabb = Aabb { min: [-1.0, -2.0, 0.5], max: [2.0, 1.5, 1.25] };

/// Whole lines, uniform and isotropic, that meet a box: through uniform points of the disc across each direction.
fn uniform_lines(bounds: &Aabb, n: usize, seed: u64) -> Vec<Ray> {
    let (centre, radius) = (bounds.centre(), bounds.diagonal() * 0.5);
    let mut random = Random::new(seed);
    let mut lines = Vec::new();
    while lines.len() < n {
        let d = random.vector();
        let square: f32 = d.iter().map(|x| x * x).sum();
        if !(1e-3..=1.0).contains(&square) {
            continue;
        }
        let d = unit(d);
        let helper = if d[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let x = unit(cross(d, helper));
        let y = cross(d, x);
        let (u, v) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        if u * u + v * v > 1.0 {
            continue;
        }
        let p = [0, 1, 2].map(|a: usize| centre[a] + radius * (u * x[a] + v * y[a]) - 2.0 * radius * d[a]);
        if bounds.clip_line(p, d, 0.0).is_some() {
            lines.push(Ray::new(p, d));
        }
    }
    lines
}

fn trained(rays: impl IntoIterator<Item = Ray>) -> Training {
    let sample = |ray| RaySample::new(ray, None, Query::Closest, RayClass::Other);
    Training::from_samples(rays.into_iter().map(sample).collect())
}

/// The premise of SAH as a test: under uniform isotropic lines, counting rays gives the ratio of areas.
#[test]
fn uniform_lines_reproduce_the_surface_area_heuristic() {
    const N: usize = 40_000;
    // No areas in the blend: the counts alone.
    let spec = RdhSpec { blend: rdh::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::PAPER };
    for seed in 1..=3 {
        let heuristic = Rdh::new(&spec, &trained(uniform_lines(&BOX, N, seed)), 1.0);
        let rays = heuristic.root(&BOX);
        assert_eq!(rays.len(), N);
        for axis in Axis::ALL {
            let a = axis.index();
            let planes: Vec<f32> = (1..9).map(|i| BOX.min[a] + BOX.extent()[a] * i as f32 / 9.0).collect();
            let (mut left, mut right) = (vec![0.0; 8], vec![0.0; 8]);
            heuristic.sweep(&rays, &BOX, axis, &planes, &mut left, &mut right);
            let (mut sah_left, mut sah_right) = (vec![0.0; 8], vec![0.0; 8]);
            Sah.sweep(&rays, &BOX, axis, &planes, &mut sah_left, &mut sah_right);
            for (p, sah) in left.iter().zip(&sah_left).chain(right.iter().zip(&sah_right)) {
                let standard_error = (sah * (1.0 - sah) / N as f32).sqrt();
                assert!((p - sah).abs() < 4.0 * standard_error, "seed {seed}, {axis:?}: {p} against {sah}");
            }
        }
    }
}

#[test]
fn descending_keeps_the_rays_that_meet_the_child() {
    let heuristic = Rdh::new(&RdhSpec::PAPER, &trained(uniform_lines(&BOX, 2000, 5)), 1.0);
    let rays = heuristic.root(&BOX);
    let (left, right) = BOX.split(Axis::X, 0.3);
    let (in_left, in_right) = (heuristic.descend(&rays, &left).len(), heuristic.descend(&rays, &right).len());
    let expected = |child: &Aabb| {
        let lines = uniform_lines(&BOX, 2000, 5);
        lines.iter().filter(|r| child.clip_line(r.origin, r.direction, 0.0).is_some()).count()
    };
    assert!(in_left.abs_diff(expected(&left)) <= 2 && in_right.abs_diff(expected(&right)) <= 2);
    assert!(in_left + in_right > 2000, "some rays cross both children");
}

/// A few rays are counted by another path than many: both must say the same.
#[test]
fn few_and_many_rays_are_counted_alike() {
    let spec = RdhSpec { blend: rdh::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::PAPER };
    let lines = uniform_lines(&BOX, 60, 7);
    let few = Rdh::new(&spec, &trained(lines.clone()), 1.0);
    let many = Rdh::new(&spec, &trained(lines.iter().flat_map(|&l| [l; 3])), 1.0);
    let planes: Vec<f32> = (0..37).map(|i| ((i * 17) % 37) as f32 * 0.08 - 1.0).collect();
    let sweep = |h: &Rdh| {
        let (mut left, mut right) = (vec![0.0; 37], vec![0.0; 37]);
        h.sweep(&h.root(&BOX), &BOX, Axis::X, &planes, &mut left, &mut right);
        (left, right)
    };
    let ((few_left, few_right), (many_left, many_right)) = (sweep(&few), sweep(&many));
    for (a, b) in few_left.iter().zip(&many_left).chain(few_right.iter().zip(&many_right)) {
        assert!((a - b).abs() < 1e-5, "{a} against {b}");
    }
}

#[test]
fn a_ray_in_the_plane_counts_on_both_sides() {
    let spec = RdhSpec { blend: rdh::heuristic::Blend::Confidence { prior: 0.0 }, ..RdhSpec::PAPER };
    let heuristic = Rdh::new(&spec, &trained([Ray::new([0.5, -3.0, 1.0], [0.0, 1.0, 0.0])]), 1.0);
    let (mut left, mut right) = ([0.0; 3], [0.0; 3]);
    heuristic.sweep(&heuristic.root(&BOX), &BOX, Axis::X, &[0.25, 0.5, 0.75], &mut left, &mut right);
    assert_eq!((left, right), ([0.0, 1.0, 1.0], [1.0, 1.0, 0.0]));
}

/// With its blend at zero the paper's heuristic is SAH: only the chances differ, so the trees are equal byte for byte.
#[test]
fn without_weight_the_papers_tree_is_the_sah_tree() {
    for (size, seed) in [(0.05, 1), (0.3, 2)] {
        let mesh = soup(3000, size, seed);
        for kd in ["kd", "kd(split=exact)", "kd(leaf=1,split=exact)", "kd(stop=paper,prune=none)"] {
            let paper = build_spec(&mesh, &format!("{kd}+rdh(paper,weight=0)"));
            assert_eq!(paper.fingerprint(), build_spec(&mesh, &format!("{kd}+sah")).fingerprint(), "{kd}");
            assert_ne!(paper.fingerprint(), build_spec(&mesh, &format!("{kd}+rdh(paper)")).fingerprint(), "{kd}");
        }
    }
}

#[test]
fn rays_that_miss_or_are_invalid_change_nothing() {
    let mesh = soup(1000, 0.1, 9);
    let sah = build_spec(&mesh, "kd+sah").fingerprint();
    let useless = [
        Ray::new([f32::NAN; 3], [1.0, 0.0, 0.0]),
        Ray::new([0.0; 3], [0.0; 3]),
        Ray::new([10.0, 10.0, 10.0], [1.0, 0.0, 0.0]),
        Ray::new([0.0; 3], [1.0, 0.0, 0.0]).within(5.0, 4.0),
    ];
    let spec: Spec = "kd(prune=area)+rdh".parse().expect("a spec");
    let accel = build(&mesh, &spec, &trained(useless), &BuildOptions::default()).expect("it builds");
    assert_eq!(accel.fingerprint(), sah);
}

#[test]
fn a_ray_heuristic_without_rays_is_an_error() {
    let spec: Spec = "kd+rdh".parse().expect("a spec");
    let error = build(&soup(10, 0.1, 1), &spec, &Training::none(), &BuildOptions::default()).err();
    assert_eq!(error, Some(Error::NoRays { spec: "kd+rdh".to_owned() }));
}

/// Rays that are all alike, or only one, must neither break the builder nor make a monster.
#[test]
fn degenerate_profiles_build_sane_trees() {
    let mesh = soup(2000, 0.1, 11);
    let ray = mixed(&mesh, 1, 3)[0];
    let sah = build_spec(&mesh, "kd+sah").stats().references;
    for rays in [vec![ray], vec![ray; 5000]] {
        for spec in ["kd+rdh", "kd+rdh(prior=0)", "kd+rdh(paper)"] {
            let accel = build(&mesh, &spec.parse().expect(spec), &trained(rays.clone()), &BuildOptions::default());
            let references = accel.expect("it builds").stats().references;
            assert!(references < 4 * sah, "{spec}: {references} references, {sah} by SAH");
        }
    }
    assert!(training(&mesh).len() > 1);
}
