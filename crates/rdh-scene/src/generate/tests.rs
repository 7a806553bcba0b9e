//! What holds for every generator.

use std::collections::BTreeMap;

use super::*;
use crate::scene::Geometry;

/// One of each, small, and one that uses other parameters.
const SAMPLES: &[&str] = &[
    "balls(size=2)",
    "gears(size=2)",
    "jacks(size=2,resolution=3)",
    "lattice(size=3)",
    "mount(size=4)",
    "rings(size=2)",
    "shells(size=1)",
    "sombrero(size=1)",
    "teapot(size=5)",
    "tetra(size=4)",
    "tree(size=5,resolution=1)",
    "building(rooms_x=1,rooms_y=1,floors=1,detail=1)",
    "building(rooms_x=4,rooms_y=3,floors=3,detail=2,seed=4)",
    "building(rooms_x=2,rooms_y=5,floors=2,detail=3)",
    "city(blocks_x=1,blocks_y=1,detail=1)",
    "city(blocks_x=2,blocks_y=3,detail=2,seed=9)",
    "forest(trees=1,detail=1)",
    "forest(trees=20,detail=2,seed=7)",
    "forest(trees=10,detail=3)",
    "terrain(cells=40)",
];

fn table(call: &str) -> toml::Table {
    parse_call(call).unwrap()
}

#[test]
fn counts_stay_below_their_bounds() {
    let finest = [
        "building(rooms_x=7,rooms_y=2,floors=1,detail=8)",
        "building(rooms_x=7,rooms_y=2,floors=2,detail=5,seed=3)",
        "building(rooms_x=40,rooms_y=2,floors=4,detail=1)",
        "city(blocks_x=1,blocks_y=1,detail=6)",
        "city(blocks_x=6,blocks_y=6,detail=4)",
        "city(blocks_x=12,blocks_y=12,detail=1)",
        "forest(trees=4,detail=4)",
        "forest(trees=1000,detail=1)",
    ];
    for call in SAMPLES.iter().chain(&finest) {
        let most = read_table(&table(call)).unwrap().triangles_at_most();
        let count = make(&table(call), 0).unwrap().triangle_count() as f64;
        assert!(count <= most, "{call}: {count} > {most}");
        assert!(most <= 12.0 * count + 200_000.0, "{call}: the bound {most} is far above {count}");
    }
}

#[test]
fn the_same_parameters_give_the_same_scene() {
    for call in SAMPLES {
        let (a, b) = (make(&table(call), 3).unwrap(), make(&table(call), 3).unwrap());
        assert_eq!((&a.geometries, &a.instances, &a.views), (&b.geometries, &b.instances, &b.views), "{call}");
    }
}

#[test]
fn seeds_matter() {
    for name in ["building", "city", "forest", "terrain(cells=40)"] {
        let mut other = table(name);
        let first = make(&other, 0).unwrap();
        other.insert("seed".to_owned(), toml::Value::Integer(77));
        let second = make(&other, 0).unwrap();
        assert!(first.geometries != second.geometries || first.instances != second.instances, "{name}");
    }
}

#[test]
fn a_room_does_not_depend_on_the_buildings_size() {
    let [one, two] = [1, 2].map(|n| make(&table(&format!("building(rooms_x={n},rooms_y=1,floors=1)")), 0).unwrap());
    assert!(two.instances.len() > one.instances.len() + 10);
    assert!(one.instances.iter().all(|piece| two.instances.contains(piece)));
}

/// Triangles have an area even after rounding to f32, and every corner is used properly.
#[test]
fn no_triangle_is_degenerate() {
    for call in SAMPLES {
        let mesh = make(&table(call), 0).unwrap().flatten().unwrap().mesh;
        let flat = (0..mesh.len() as u32).find(|&i| doubled_area(mesh.corners(rdh::TriId(i))) <= 0.0);
        assert_eq!(flat, None, "{call}: {:?}", flat.map(|i| mesh.corners(rdh::TriId(i))));
    }
}

fn doubled_area([a, b, c]: [rdh::Vec3; 3]) -> f64 {
    let d = |p: rdh::Vec3| [0, 1, 2].map(|i| f64::from(p[i]) - f64::from(a[i]));
    vector::length(vector::cross(d(b), d(c)))
}

/// Neighbours agree on which side is out: an edge is never used twice in the same direction; and what is closed has
/// a positive volume.
#[test]
fn outsides_are_consistent() {
    for call in SAMPLES {
        for geometry in &make(&table(call), 0).unwrap().geometries {
            check_outside(geometry, call);
        }
    }
}

fn check_outside(geometry: &Geometry, call: &str) {
    let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for [a, b, c] in &geometry.triangles {
        for edge in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    let twice = edges.iter().find(|(_, count)| **count > 1);
    assert_eq!(twice, None, "{call}: {}", geometry.name);
    let is_closed = edges.keys().all(|&[a, b]| edges.contains_key(&[b, a]));
    let volume = volume(geometry);
    assert!(!is_closed || volume > 0.0, "{call}: {} is inside out: {volume}", geometry.name);
}

/// Six times the volume, seen from the first vertex.
fn volume(geometry: &Geometry) -> f64 {
    let origin = geometry.positions[0].map(f64::from);
    let corner = |i: u32| vector::sub(geometry.positions[i as usize].map(f64::from), origin);
    geometry.triangles.iter().map(|t| vector::dot(corner(t[0]), vector::cross(corner(t[1]), corner(t[2])))).sum()
}

/// Round things lie on their surfaces.
#[test]
fn spheres_and_tubes_are_true() {
    for resolution in [1, 2, 5, 16] {
        let sphere = round::sphere(resolution);
        assert_eq!(sphere.triangles.len() as u64, round::sphere_triangles(resolution));
        assert!(sphere.positions.iter().all(|&p| (vector::length(p) - 1.0).abs() < 1e-12));
        let cone = round::tube(resolution, 0.5);
        assert_eq!(cone.triangles.len() as u64, round::tube_triangles(resolution));
        assert!(cone.positions.iter().all(|p| (p[0].hypot(p[1]) - (1.0 - 0.5 * p[2])).abs() < 1e-12));
    }
}

#[test]
fn only_frames_move_cars() {
    let at = |frame: u32| make(&table("city(blocks_x=2,blocks_y=1,detail=1)"), frame).unwrap();
    let (rest, moved) = (at(0), at(1));
    assert_eq!(rest.geometries, moved.geometries);
    assert_eq!(rest.instances.len(), moved.instances.len());
    let changed: Vec<&str> = std::iter::zip(&rest.instances, &moved.instances)
        .filter(|(a, b)| a != b)
        .map(|(a, _)| rest.geometries[a.geometry].name.as_str())
        .collect();
    assert!(changed.len() > 6, "{changed:?}");
    assert!(changed.iter().all(|name| ["car", "panes", "wheels"].contains(name)), "{changed:?}");
}

#[test]
fn calls_round_trip() {
    for call in SAMPLES {
        let table = table(call);
        assert_eq!(parse_call(&format_call(&table)).unwrap(), table);
    }
    for bad in ["balls(size=3", "balls(size)", "balls(=3)", "balls(size=)", "balls(size=3,size=4)", "balls(,)"] {
        assert!(parse_call(bad).is_err(), "{bad}");
    }
}

#[test]
fn wild_parameters_are_refused_before_anything_is_made() {
    for call in [
        "building(rooms_x=1000,rooms_y=1000,floors=200)",
        "building(rooms_x=4000000000)",
        "building(rooms_x=0)",
        "city(blocks_x=500,blocks_y=500)",
        "city(detail=7)",
        "forest(trees=1000000)",
        "forest(trees=4294967295)",
        "terrain(cells=1)",
        "terrain(cells=5001)",
        "terrain(cells=2.5)",
        "terrain(seed=yes)",
    ] {
        assert!(make(&table(call), 0).is_err(), "{call}");
    }
}
