//! Small scenes whose answers are known.
#![allow(dead_code, reason = "each test file uses a part")]

use rdh::Vec3;
use rdh_scene::{Entry, Geometry, Instance, Kind, Material, PointLight, Scene, Source, Transform, View};
use rdh_study::{Plan, Target};

/// A closed box of 12 triangles from -1 to 1 (times `size`), its normals outwards.
pub(crate) fn cube(size: f32) -> Geometry {
    let corner = |i: u32| -> Vec3 { [0, 1, 2].map(|a| if i >> a & 1 == 1 { size } else { -size }) };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    Geometry { name: "cube".into(), positions: (0..8).map(corner).collect(), triangles, material: 0 }
}

pub(crate) fn at(geometry: usize, place: [f64; 3]) -> Instance {
    Instance { geometry, scene_from_object: Transform::translation(place) }
}

pub(crate) fn view(name: &str, eye: [f64; 3], target: [f64; 3]) -> View {
    View { name: name.into(), eye, target, up: [0.0, 0.0, 1.0], fov_y_degrees: 60.0 }
}

/// A closed room from -10 to 10, seen from inside, with a light in it. All of `material`, or the default ones.
pub(crate) fn room(material: Option<Material>) -> Scene {
    Scene {
        name: "room".into(),
        geometries: vec![cube(10.0)],
        instances: vec![at(0, [0.0; 3])],
        materials: material.into_iter().collect(),
        lights: vec![PointLight { position: [1.0, 2.0, 8.0] }],
        views: vec![view("inside", [-5.0, -6.0, 1.0], [3.0, 2.0, 0.5]), view("up", [0.5, 0.0, -3.0], [0.0, 1.0, 4.0])],
        up: [0.0, 0.0, 1.0],
        ..Scene::default()
    }
}

/// A room with a grid of `side`³ boxes in it, far from the origin of the world.
pub(crate) fn boxes(side: usize) -> Scene {
    let mut scene = room(None);
    scene.name = "boxes".into();
    scene.geometries.push(cube(0.7));
    scene.lights.clear();
    scene.origin = [1000.0, -500.0, 20.0];
    for view in &mut scene.views {
        for a in 0..3 {
            view.eye[a] += scene.origin[a];
            view.target[a] += scene.origin[a];
        }
    }
    let place = |i: usize| 14.0 * (i as f64 + 0.5) / side as f64 - 7.0;
    for i in 0..side.pow(3) {
        scene.instances.push(at(1, [place(i % side), place(i / side % side), place(i / side / side)]));
    }
    scene
}

pub(crate) fn entry(scene: &Scene) -> Entry {
    Entry {
        id: scene.name.clone(),
        kind: Kind::Interior,
        triangles: scene.triangle_count(),
        about: String::new(),
        views: scene.views.clone(),
        frames: 1,
        quick: false,
        source: Source::Generator(Default::default()),
    }
}

/// A plan for some scenes, small enough for a test.
pub(crate) fn plan(scenes: &[Scene]) -> Plan {
    Plan {
        targets: scenes.iter().map(|s| Target::all(entry(s))).collect(),
        size: [48, 32],
        training: 500,
        rounds: 2,
        small_rounds: 2,
        small_builds: 1,
        ..Plan::default()
    }
}

/// Loads from memory.
pub(crate) fn loader(scenes: Vec<Scene>) -> impl Fn(&Entry, u32) -> rdh_scene::Result<Scene> {
    move |entry, _| {
        let found = scenes.iter().find(|s| s.name == entry.id).cloned();
        found.ok_or_else(|| rdh_scene::Error::whole("no such scene"))
    }
}
