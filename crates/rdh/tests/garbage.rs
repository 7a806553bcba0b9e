//! Garbage in: any bit pattern builds, within bounds, and what is good in it is still hit.

mod common;

use common::meshes::{Random, icosphere, soup};
use common::rays::mixed;
use common::{SPECS, build_spec};
use rdh::{Mesh, TriId, naive};

/// Coordinates and indices of any bits; one index in eight is out of range.
fn garbage(triangles: usize, random: &mut Random) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let vertices = triangles * 2;
    let positions = (0..vertices).map(|_| [0; 3].map(|_| f32::from_bits(random.bits()))).collect();
    let index = |random: &mut Random| {
        if random.below(8) == 0 { random.bits() } else { random.below(vertices) as u32 }
    };
    (positions, (0..triangles).map(|_| [index(random), index(random), index(random)]).collect())
}

#[test]
fn any_bits_build_and_agree_with_brute_force() {
    let mut random = Random::new(61);
    let mut wrong_triangles = 0;
    for round in 0..12 {
        let (positions, triangles) = garbage(40 + 60 * round, &mut random);
        let (mesh, wrong) = Mesh::sanitised(positions, triangles).expect("not too many");
        wrong_triangles += wrong.triangles.len();
        for spec in SPECS {
            let accel = build_spec(&mesh, spec);
            assert_eq!(accel.check(&mesh), [], "round {round}, {spec}");
            for ray in mixed(&mesh, 60, 63 + round as u64) {
                assert_eq!(accel.closest(&ray), naive::closest(&mesh, &ray), "round {round}, {spec}, {ray:?}");
            }
        }
    }
    assert!(wrong_triangles > 100);
}

#[test]
fn good_triangles_keep_their_ids_and_their_hits() {
    let good = icosphere(3);
    let (mut positions, mut triangles) = (good.positions().to_vec(), good.triangles().to_vec());
    let bad = positions.len() as u32;
    positions.push([0.0, f32::NAN, 0.0]);
    positions.push([f32::INFINITY, 0.0, 0.0]);
    let places = [3usize, 77, 500];
    for (place, third) in places.into_iter().zip([bad, bad + 1, u32::MAX]) {
        triangles.insert(place, [0, 1, third]);
    }
    let (mesh, wrong) = Mesh::sanitised(positions, triangles).expect("not too many");
    assert_eq!(wrong.triangles, places.map(|p| TriId(p as u32)));
    assert_eq!(wrong.vertices, [bad, bad + 1]);
    assert_eq!(mesh.bounds(), good.bounds());
    let old = |id: u32| id - places.iter().filter(|&&p| (p as u32) < id).count() as u32;
    for spec in SPECS {
        let accel = build_spec(&mesh, spec);
        let mut seen = Vec::new();
        accel.cells(&mut |_, _, count| seen.push(count));
        for ray in mixed(&good, 300, 65) {
            let expected = naive::closest(&good, &ray).map(|h| (h.tri.0, h.t));
            assert_eq!(accel.closest(&ray).map(|h| (old(h.tri.0), h.t)), expected, "{spec}");
        }
        if spec.starts_with("bvh") && !spec.contains("from=kd") {
            assert_eq!(seen.iter().sum::<usize>(), good.len(), "{spec}: no leaf lists what is wrong");
        }
    }
}

#[test]
fn nothing_good_is_an_empty_scene() {
    let ray = rdh::Ray::new([0.0; 3], [1.0, 0.0, 0.0]);
    for (positions, triangles) in [
        (vec![], vec![[0, 1, 2]]),
        (vec![[f32::NAN; 3]], vec![[0, 0, 0]]),
        (vec![[f32::INFINITY; 3]; 3], vec![[0, 1, 2]; 2000]),
        (vec![], vec![]),
    ] {
        let (mesh, wrong) = Mesh::sanitised(positions, triangles).expect("not too many");
        assert_eq!(wrong.triangles.len(), mesh.len());
        for spec in SPECS {
            let accel = build_spec(&mesh, spec);
            assert_eq!((accel.check(&mesh), accel.closest(&ray)), (vec![], None), "{spec}");
        }
    }
}

#[test]
fn clean_meshes_stay_as_they_are() {
    let mesh = soup(300, 0.3, 67);
    let (same, wrong) = Mesh::sanitised(mesh.positions().to_vec(), mesh.triangles().to_vec()).expect("not too many");
    assert_eq!((same, wrong.is_empty()), (mesh, true));
}
