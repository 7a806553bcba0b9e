//! Double precision: the hierarchy gives the hits of brute force, bit for bit, and no ray escapes from a closed mesh.

mod common;

use std::collections::BTreeMap;

use common::meshes::Random;
use rdh::precise::{AccelF64, HitF64, MeshF64, RayF64, naive};
use rdh::simd::Level;
use rdh::{BuildOptions, Error, Query, RayClass, RaySample, Spec, Training, TriId};

/// One of each form of hierarchies.
const SPECS: [&str; 7] =
    ["bvh2+sah", "bvh4+sah", "bvh8+sah", "bvh8(compact)+sah", "sbvh8+sah", "bvh8(high,from=kd)+sah", "bvh8+rdh"];

type Point = [f64; 3];

fn unit(random: &mut Random) -> f64 {
    // More bits than f32 has.
    f64::from(random.bits()) / 2f64.powi(32) + f64::from(random.bits()) / 2f64.powi(64)
}

fn signed(random: &mut Random) -> f64 {
    2.0 * unit(random) - 1.0
}

fn point(random: &mut Random) -> Point {
    [signed(random), signed(random), signed(random)]
}

/// A bumpy ball whose vertices have all bits of f64: an octahedron, divided `levels` times.
fn ball(levels: u32) -> MeshF64 {
    let mut random = Random::new(5);
    let mut points: Vec<Point> =
        vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut faces: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let sum: Point = [0, 1, 2].map(|k| points[a as usize][k] + points[b as usize][k]);
                let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                points.push(sum.map(|x| x / length * (1.0 + 0.02 * signed(&mut random))));
                points.len() as u32 - 1
            })
        };
        let divide = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(divide).collect();
    }
    MeshF64::new(points, faces).unwrap()
}

/// Triangles anywhere, of any size; some of them needles, some in a plane across an axis.
fn soup(n: u32) -> MeshF64 {
    let mut random = Random::new(6);
    let mut points = Vec::new();
    for i in 0..n {
        let (centre, size) = (point(&mut random), if i % 3 == 0 { 0.5 } else { 0.03 });
        let height = signed(&mut random);
        for corner in 0..3 {
            let off = point(&mut random).map(|x| x * size);
            let thin = if i % 5 == 0 && corner > 0 { 1e-9 } else { 1.0 };
            let p = [centre[0] + off[0], centre[1] + off[1] * thin, centre[2] + off[2] * thin];
            points.push(if i % 7 == 0 { [p[0], p[1], height] } else { p });
        }
    }
    MeshF64::new(points, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

fn moved(mesh: &MeshF64, scale: f64, to: Point) -> MeshF64 {
    let at = |p: &Point| [0, 1, 2].map(|a| p[a] * scale + to[a]);
    MeshF64::new(mesh.positions().iter().map(at).collect(), mesh.triangles().to_vec()).unwrap()
}

/// A size, and where the middle lies.
const PLACES: [(f64, Point); 7] = [
    (1.0, [0.0; 3]),
    // Metres in a map's grid, and in one around the earth's centre.
    (1.0, [4_512_345.678, 5_401_234.321, 321.5]),
    (0.001, [1e7, -1e7, 1e7]),
    (1e-30, [0.0; 3]),
    (1e30, [0.0; 3]),
    (1e-200, [0.0; 3]),
    (1e200, [0.0; 3]),
];

/// A ray from a point: at a vertex, at an edge, along an axis through a vertex, or anywhere; of any length.
fn aimed(mesh: &MeshF64, from: Point, how: usize, random: &mut Random) -> RayF64 {
    let corners = mesh.corners(TriId(random.below(mesh.len()) as u32));
    let (p, q, part) = (corners[random.below(3)], corners[random.below(3)], unit(random));
    let towards = |target: Point| RayF64::new(from, [0, 1, 2].map(|a| target[a] - from[a]));
    let ray = match how % 4 {
        0 => towards(p),
        1 => towards([0, 1, 2].map(|a| p[a] + part * (q[a] - p[a]))),
        2 => {
            let axis = random.below(3);
            let (mut origin, mut direction) = (p, [0.0, -0.0, 0.0]);
            origin[axis] = from[axis];
            direction[axis] = if p[axis] >= from[axis] { 1.0 } else { -1.0 };
            RayF64::new(origin, direction)
        }
        _ => RayF64::new(from, point(random)),
    };
    let length = (random.below(41) as f64 - 20.0).exp2();
    RayF64 { direction: ray.direction.map(|d| d * length), ..ray }
}

fn bits(hit: &HitF64) -> [u64; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), u64::from(hit.tri.0)]
}

/// Trained by images of rays like those to come.
fn built(mesh: &MeshF64, spec: &str) -> AccelF64 {
    let (spec, options): (Spec, _) = (spec.parse().unwrap(), BuildOptions::default());
    let first = AccelF64::build(mesh, &"bvh8+sah".parse().unwrap(), &Training::none(), &options).unwrap();
    let mut random = Random::new(8);
    let sample = |i: usize| {
        let from = mesh.corners(TriId(random.below(mesh.len()) as u32))[0];
        let ray = aimed(mesh, from, i, &mut random);
        let hit = first.closest(&ray);
        first.image(&ray, hit.as_ref()).map(|(ray, hit)| RaySample::new(ray, hit, Query::Closest, RayClass::Other))
    };
    let training = Training::from_samples((0..200).filter_map(sample).collect());
    let accel = AccelF64::build(mesh, &spec, &training, &options).unwrap();
    assert!(accel.accel().check(accel.accel().mesh()).is_empty(), "{spec}");
    accel
}

/// All queries, beside brute force.
fn assert_same(accel: &AccelF64, ray: &RayF64, hits: &mut Vec<HitF64>) -> usize {
    let (closest, all) = (naive::closest(accel.mesh(), ray), naive::all_hits(accel.mesh(), ray));
    accel.all_hits(ray, hits);
    let who = || format!("{}: {ray:?}", accel.accel().stats().spec);
    assert_eq!(accel.closest(ray).as_ref().map(bits), closest.as_ref().map(bits), "{}", who());
    assert_eq!(accel.occluded(ray), closest.is_some(), "{}", who());
    assert!(hits.iter().map(bits).eq(all.iter().map(bits)), "{}: {hits:?} instead of {all:?}", who());
    usize::from(closest.is_some())
}

#[test]
fn hits_are_those_of_brute_force() {
    for (scale, to) in PLACES {
        for shape in [ball(2), soup(150)] {
            let mesh = moved(&shape, scale, to);
            for spec in SPECS {
                for level in Level::available() {
                    let accel = built(&mesh, spec).with_level(level);
                    let (mut random, mut hits, mut hit) = (Random::new(9), Vec::new(), 0);
                    for i in 0..140 {
                        let away = [0.5, 1.5, 50.0, 3e5, 1e9][i % 5] * scale;
                        let off = point(&mut random);
                        let from = [0, 1, 2].map(|a| to[a] + off[a] * away);
                        let mut ray = aimed(&mesh, from, i / 5, &mut random);
                        // Ends at or near what is hit: they belong to the ray.
                        if let (3, Some(first)) = (i % 7, naive::closest(&mesh, &ray)) {
                            let ends = [first.t.next_down(), first.t, first.t.next_up()];
                            ray = ray.within(ends[random.below(3)], ends[random.below(3)].max(0.0) * 1.5);
                        }
                        hit += assert_same(&accel, &ray, &mut hits);
                    }
                    assert!(hit > 50, "{spec}: only {hit} rays hit something at {to:?}");
                }
            }
        }
    }
}

#[test]
fn no_ray_escapes_from_a_closed_mesh() {
    for (scale, to) in PLACES {
        let mesh = moved(&ball(4), scale, to);
        let accel =
            AccelF64::build(&mesh, &"bvh8+sah".parse().unwrap(), &Training::none(), &BuildOptions::default()).unwrap();
        let (mut random, mut hits) = (Random::new(10), Vec::new());
        for i in 0..20_000 {
            let off = point(&mut random);
            let from = [0, 1, 2].map(|a| to[a] + 0.4 * off[a] * scale);
            let mut ray = aimed(&mesh, from, i, &mut random);
            if i % 4 == 2 && ray.origin.iter().zip(&to).any(|(x, to)| (x - to).abs() > 0.5 * scale) {
                // Along an axis through a vertex may be outside: then from here.
                ray.origin = from;
            }
            assert!(accel.closest(&ray).is_some() && accel.occluded(&ray), "{ray:?}");
            if i % 8 == 0 {
                accel.all_hits(&ray, &mut hits);
                assert!(hits.len() % 2 == 1, "{} hits of {ray:?}", hits.len());
            }
        }
    }
}

/// What f32 can't tell apart: a step of a millimetre, ten thousand kilometres away.
#[test]
fn millimetres_count_at_ten_thousand_kilometres() {
    let far = 1e7;
    let plate =
        |height: f64| [[far, far, far + height], [far + 1.0, far, far + height], [far, far + 1.0, far + height]];
    let heights = [0.0, 0.001, 0.002];
    let mesh = MeshF64::new(heights.iter().flat_map(|&h| plate(h)).collect(), vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    let mesh = mesh.unwrap();
    let accel = built(&mesh, "bvh8+sah");
    let (down, mut hits) = (RayF64::new([far + 0.25, far + 0.25, far + 1.0], [0.0, 0.0, -1.0]), Vec::new());
    accel.all_hits(&down, &mut hits);
    assert_eq!(hits.iter().map(|hit| hit.tri.0).collect::<Vec<_>>(), [2, 1, 0]);
    for (hit, height) in hits.iter().zip([0.002, 0.001, 0.0]) {
        // Heights are stored to 2 nanometres there.
        assert!((hit.t - (1.0 - height)).abs() < 4e-9, "{hit:?}");
        assert!((hit.u - 0.25).abs() < 1e-8 && (hit.v - 0.25).abs() < 1e-8, "{hit:?}");
    }
}

#[test]
fn masks_hide_triangles() {
    let masks = |mesh: MeshF64| (0..mesh.len() as u32).map(|i| 1 << (i % 3)).collect::<Vec<_>>();
    let mesh = soup(200);
    let mesh = mesh.clone().with_masks(masks(mesh)).unwrap();
    let (accel, mut random, mut hits) = (built(&mesh, "bvh8+sah"), Random::new(11), Vec::new());
    let mut hit = 0;
    for i in 0..300 {
        let from = point(&mut random).map(|x| 2.0 * x);
        let ray = aimed(&mesh, from, i, &mut random).masked(1 << (i % 4));
        hit += assert_same(&accel, &ray, &mut hits);
        assert!(i % 4 < 3 || hits.is_empty());
    }
    assert!(hit > 50, "{hit}");
}

#[test]
fn what_is_wrong_is_an_error_or_a_miss() {
    let (tri, at) = ([[0, 1, 2]], [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert!(matches!(
        MeshF64::new(vec![[0.0, f64::NAN, 0.0]], vec![]),
        Err(Error::NotFinite { vertex: 0, axis: 1, .. })
    ));
    assert!(matches!(
        MeshF64::new(at.to_vec(), vec![[0, 1, 3]]),
        Err(Error::IndexOutOfRange { triangle: 0, index: 3, vertices: 3 })
    ));
    let mesh = MeshF64::new(at.to_vec(), tri.to_vec()).unwrap();
    assert!(mesh.clone().with_masks(vec![]).is_err());
    for spec in ["kd+sah", "bvh8(lazy)+sah", "auto"] {
        let built = AccelF64::build(&mesh, &spec.parse().unwrap(), &Training::none(), &BuildOptions::default());
        assert!(matches!(built, Err(Error::Spec { .. })), "{spec}");
    }
    let accel = built(&mesh, "bvh8+sah");
    let down = RayF64::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
    assert!(accel.occluded(&down) && accel.occluded(&down.within(1.0, 1.0)));
    for ray in [
        down.within(f64::NAN, 2.0),
        down.within(2.0, 1.0),
        down.within(f64::NEG_INFINITY, f64::NEG_INFINITY),
        down.within(f64::INFINITY, f64::INFINITY),
        RayF64 { direction: [0.0; 3], ..down },
        RayF64 { direction: [0.0, f64::INFINITY, 0.0], ..down },
        RayF64 { origin: [f64::NAN; 3], ..down },
        RayF64 { origin: [f64::MAX; 3], ..down },
    ] {
        assert!(!accel.occluded(&ray) && accel.closest(&ray).is_none(), "{ray:?}");
    }
    let empty = AccelF64::build(
        &MeshF64::new(vec![[f64::MAX; 3]], vec![]).unwrap(),
        &"bvh8+sah".parse().unwrap(),
        &Training::none(),
        &BuildOptions::default(),
    );
    assert!(empty.unwrap().closest(&down).is_none());
}

/// Vertices that no triangle uses, triangles of no size, and coordinates at the ends of what there is.
#[test]
fn odd_meshes_have_the_hits_of_brute_force() {
    let (mut random, mut hits) = (Random::new(12), Vec::new());
    for size in [f64::from_bits(1), 1e-310, 1e-160, 1.0, 1e150, 1e305] {
        let mut points: Vec<Point> = (0..60).map(|_| point(&mut random).map(|x| x * size)).collect();
        points[0] = [0.0; 3];
        points[1] = points[2];
        points.push([f64::MAX, -f64::MAX, f64::MAX]);
        let triangles = (0..58).map(|i| [i, i + 1, i + 2]).chain([[3, 3, 4], [0, 0, 0]]).collect();
        let mesh = MeshF64::new(points, triangles).unwrap();
        let accel = built(&mesh, "sbvh8+sah");
        for i in 0..200 {
            let from = point(&mut random).map(|x| 2.0 * x * size);
            assert_same(&accel, &aimed(&mesh, from, i, &mut random), &mut hits);
        }
    }
}
