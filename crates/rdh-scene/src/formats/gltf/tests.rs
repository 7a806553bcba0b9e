use serde_json::{Value, json};

use super::*;

/// A document that is put together piece by piece.
struct Doc {
    json: Value,
    bin: Vec<u8>,
}

/// Codes of component types.
const I8: u32 = 5120;
const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

impl Doc {
    fn new() -> Self {
        let json = json!({ "asset": {"version": "2.0"}, "buffers": [{}], "bufferViews": [], "accessors": [], "meshes": [],
            "nodes": [], "scenes": [{"nodes": [0]}], "scene": 0 });
        Self { json, bin: Vec::new() }
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.bin.extend(bytes);
        self.push("bufferViews", view)
    }

    fn accessor(&mut self, bytes: &[u8], kind: u32, count: usize, shape: &str) -> usize {
        let view = self.view(bytes, None);
        self.push("accessors", json!({"bufferView": view, "componentType": kind, "count": count, "type": shape}))
    }

    fn floats(&mut self, numbers: &[f32], shape: &str, each: usize) -> usize {
        self.accessor(&le(numbers), F32, numbers.len() / each, shape)
    }

    /// Three corners of a unit square, or all four.
    fn corners(&mut self, count: usize) -> usize {
        self.floats(&SQUARE[..3 * count], "VEC3", 3)
    }

    /// A mesh of one primitive, and node 0 that shows it.
    fn mesh(&mut self, primitive: Value) {
        let mesh = self.push("meshes", json!({"name": "m", "primitives": [primitive]}));
        self.push("nodes", json!({"mesh": mesh}));
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = self.bin.len().into();
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut chunks = Vec::new();
        for (kind, data) in [(b"JSON", &text), (b"BIN\0", &self.bin)] {
            chunks.extend((data.len() as u32).to_le_bytes());
            chunks.extend(kind);
            chunks.extend(data);
        }
        [b"glTF\x02\0\0\0", &(12 + chunks.len() as u32).to_le_bytes()[..], &chunks].concat()
    }

    fn read_at(&self, time_secs: Option<f64>) -> Result<Scene> {
        read(&self.glb(), &Context { folder: None, time_secs })
    }

    fn scene(&self) -> Scene {
        self.read_at(None).unwrap()
    }

    fn error(&self) -> String {
        self.read_at(None).unwrap_err().to_string()
    }
}

const SQUARE: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

fn le(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A document of one triangle at node 0.
fn triangle() -> Doc {
    let mut doc = Doc::new();
    let positions = doc.corners(3);
    doc.mesh(json!({"attributes": {"POSITION": positions}}));
    doc
}

/// The corners of all triangles, in world coordinates.
fn world(scene: &Scene) -> Vec<[[f64; 3]; 3]> {
    let mut all = Vec::new();
    for instance in &scene.instances {
        let geometry = &scene.geometries[instance.geometry];
        let there = |i: u32| {
            let p = instance.scene_from_object.point(geometry.positions[i as usize].map(f64::from));
            [0, 1, 2].map(|a| p[a] + scene.origin[a])
        };
        all.extend(geometry.triangles.iter().map(|t| t.map(there)));
    }
    all
}

/// The first corner of the first triangle, rounded to millionths.
fn first_corner(scene: &Scene) -> [f64; 3] {
    world(scene)[0][0].map(|x| (x * 1e6).round() / 1e6 + 0.0)
}

#[test]
fn indices_may_be_of_every_unsigned_type() {
    for (kind, bytes) in [(U8, 1), (U16, 2), (U32, 4)] {
        let mut doc = Doc::new();
        let positions = doc.corners(4);
        let raw: Vec<u8> = [0u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()[..bytes].to_vec()).collect();
        let indices = doc.accessor(&raw, kind, 6, "SCALAR");
        doc.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices}));
        assert_eq!(doc.scene().geometries[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    }
}

#[test]
fn strips_and_fans_keep_their_outside() {
    for (mode, triangles) in [(5, [[0, 1, 2], [1, 3, 2]]), (6, [[1, 2, 0], [2, 3, 0]])] {
        let mut doc = Doc::new();
        let positions = doc.corners(4);
        doc.mesh(json!({"attributes": {"POSITION": positions}, "mode": mode}));
        assert_eq!(doc.scene().geometries[0].triangles, triangles);
    }
}

#[test]
fn points_and_lines_are_dropped_with_a_note() {
    let mut doc = triangle();
    doc.json["meshes"][0]["primitives"].as_array_mut().unwrap().extend([
        json!({"attributes": {"POSITION": 0}, "mode": 0}),
        json!({"attributes": {"POSITION": 0}, "mode": 3}),
        json!({"attributes": {}}),
    ]);
    let notes: Vec<_> = doc.scene().notes.iter().map(|n| (n.what.clone(), n.count)).collect();
    let expected = ["primitives of points", "primitives of lines", "primitives without positions"];
    assert_eq!(notes, expected.map(|what| (what.to_owned(), 1)));
}

#[test]
fn positions_may_be_interleaved_quantised_and_sparse() {
    let mut doc = Doc::new();
    // x, y, z and a byte of something else.
    let view = doc.view(&[0, 0, 0, 9, 127, 0, 0, 9, 129, 127, 0, 9, 0, 128, 64], Some(4));
    let mut accessor = json!({"bufferView": view, "componentType": I8, "normalized": true, "count": 4, "type": "VEC3"});
    let (which, what) = (doc.view(&[2], None), doc.view(&[64, 0, 127], None));
    accessor["sparse"] =
        json!({"count": 1, "indices": {"bufferView": which, "componentType": U8}, "values": {"bufferView": what}});
    let positions = doc.push("accessors", accessor);
    doc.mesh(json!({"attributes": {"POSITION": positions}, "mode": 5}));
    let half = (64.0f64 / 127.0) as f32;
    let expected = [[0.0; 3], [1.0, 0.0, 0.0], [half, 0.0, 1.0], [0.0, -1.0, half]];
    assert_eq!(doc.scene().geometries[0].positions, expected);
}

#[test]
fn a_sparse_accessor_needs_no_data_beneath() {
    let mut doc = Doc::new();
    let (which, what) = (doc.view(&[1, 2], None), doc.view(&le(&SQUARE[3..9]), None));
    let positions = doc.push(
        "accessors",
        json!({"componentType": F32, "count": 3, "type": "VEC3", "sparse":
        {"count": 2, "indices": {"bufferView": which, "componentType": U8}, "values": {"bufferView": what}}}),
    );
    doc.mesh(json!({"attributes": {"POSITION": positions}}));
    assert_eq!(doc.scene().geometries[0].positions, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    doc.bin[0] = 2;
    assert!(doc.error().ends_with("accessor 0, sparse: the indices must rise and stay below the accessor's count"));
}

#[test]
fn few_vertices_of_a_long_list_are_kept_alone() {
    let mut doc = Doc::new();
    let positions = doc.floats(&(0..900).map(|i| i as f32).collect::<Vec<_>>(), "VEC3", 3);
    let indices = doc.accessor(&[200, 100, 200, 7, 100, 200], U8, 6, "SCALAR");
    doc.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let geometry = &doc.scene().geometries[0];
    assert_eq!(geometry.triangles, [[2, 1, 2], [0, 1, 2]]);
    assert_eq!(geometry.positions, [[21.0, 22.0, 23.0], [300.0, 301.0, 302.0], [600.0, 601.0, 602.0]]);
}

#[test]
fn nodes_nest_and_mirror() {
    let mut doc = triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    doc.json["nodes"][0] = json!({"children": [1], "translation": [10, 0, 0], "rotation": [0, 0, half, half]});
    doc.push("nodes", json!({"children": [2], "scale": [-2, 1, 1]}));
    doc.push("nodes", json!({"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]}));
    let scene = doc.scene();
    // 3 along x, mirrored and doubled to -6, a quarter turn about z, 10 along x.
    assert_eq!(first_corner(&scene), [10.0, -6.0, 0.0]);
    assert!(scene.instances[0].scene_from_object.mirrors());
}

#[test]
fn geographic_translations_stay_exact() {
    let mut doc = triangle();
    doc.json["nodes"][0]["translation"] = json!([85000.123, 447500.456, 2.5]);
    let scene = doc.scene();
    assert_ne!(scene.origin, [0.0; 3]);
    assert_eq!(first_corner(&scene), [85000.123, 447500.456, 2.5]);
    assert!(scene.instances[0].scene_from_object.0.iter().all(|row| row[3].abs() <= 1.0));
}

#[test]
fn a_node_moves_along_every_kind_of_curve() {
    let straight = [0.0, 0.0, 0.0, 8.0, 0.0, 0.0];
    // Tangent in, value, tangent out; leaving with slope 4, arriving with slope 0.
    let spline = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let cases = [("LINEAR", &straight[..], 2.0), ("STEP", &straight, 0.0), ("CUBICSPLINE", &spline, 2.375)];
    for (interpolation, values, quarter) in cases {
        let mut doc = triangle();
        let input = doc.floats(&[1.0, 3.0], "SCALAR", 1);
        let output = doc.floats(values, "VEC3", 3);
        doc.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            "samplers": [{"input": input, "output": output, "interpolation": interpolation}]}]);
        for (secs, x) in [(0.0, 0.0), (1.5, quarter), (3.0, 8.0), (9.0, 8.0)] {
            let corner = first_corner(&doc.read_at(Some(secs)).unwrap());
            assert_eq!(corner, [x, 0.0, 0.0], "{interpolation} at {secs} s");
        }
        assert_eq!(first_corner(&doc.scene()), [0.0; 3]);
        assert_eq!(doc.scene().notes[0].what, "animations not shown");
    }
}

#[test]
fn rotations_turn_evenly_the_shorter_way() {
    let mut doc = triangle();
    let input = doc.floats(&[0.0, 1.0], "SCALAR", 1);
    // A quarter turn about z, its quaternion with the other sign.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let output = doc.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half], "VEC4", 4);
    doc.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}],
        "samplers": [{"input": input, "output": output}]}]);
    let scene = doc.read_at(Some(1.0 / 3.0)).unwrap();
    let [_, x_axis, _] = world(&scene)[0];
    assert!((x_axis[0] - 30f64.to_radians().cos()).abs() < 1e-6 && (x_axis[1] - 0.5).abs() < 1e-6, "{x_axis:?}");
}

/// Two joints, nodes 1 and 2; each corner of the triangle follows one, the other, or both by halves.
fn skinned() -> Doc {
    let mut doc = Doc::new();
    let positions = doc.corners(3);
    let joints = doc.accessor(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], U8, 3, "VEC4");
    let weights = doc.floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0], "VEC4", 4);
    let attributes = json!({"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights});
    doc.mesh(json!({"attributes": attributes, "mode": 4}));
    // The node's own place is of no matter.
    doc.json["nodes"][0] = json!({"mesh": 0, "skin": 0, "translation": [100, 100, 100]});
    doc.push("nodes", json!({"translation": [0, 0, 5]}));
    doc.push("nodes", json!({"translation": [0, 0, 9]}));
    let mut inverse = [0.0; 32];
    for matrix in inverse.chunks_mut(16) {
        matrix[..15].iter_mut().step_by(5).for_each(|diagonal| *diagonal = 1.0);
        matrix[15] = 1.0;
        matrix[14] = -5.0;
    }
    let inverse = doc.floats(&inverse, "MAT4", 16);
    doc.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": inverse}]);
    doc.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    doc
}

#[test]
fn skins_bend_at_rest_and_in_motion() {
    let mut doc = skinned();
    assert_eq!(world(&doc.scene())[0].map(|p| p[2]), [0.0, 4.0, 2.0]);
    let input = doc.floats(&[0.0], "SCALAR", 1);
    let output = doc.floats(&[7.0, 0.0, 5.0], "VEC3", 3);
    doc.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}],
        "samplers": [{"input": input, "output": output}]}]);
    let moved = doc.read_at(Some(0.0)).unwrap();
    assert_eq!(world(&moved)[0], [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [4.5, 1.0, 0.0]]);
    assert_eq!(moved.notes, []);
}

#[test]
fn vertices_without_a_joint_go_with_their_node() {
    let mut doc = skinned();
    let attributes = &mut doc.json["meshes"][0]["primitives"][0]["attributes"];
    attributes.as_object_mut().unwrap().remove("WEIGHTS_0");
    let scene = doc.scene();
    assert_eq!(first_corner(&scene), [100.0; 3]);
    assert_eq!(scene.notes[0].count, 3);
}

#[test]
fn errors_name_the_place() {
    let error = |path: &str, value: Value| {
        let mut doc = skinned();
        *doc.json.pointer_mut(path).unwrap() = value;
        doc.error()
    };
    let cases = [
        ("/asset/version", json!("1.0"), "asset: glTF version 1.0"),
        ("/scene", json!(3), "scene 3: does not exist"),
        ("/scenes/0/nodes", json!([0, 1, 1]), "node 1: is a root of the scene twice"),
        ("/scenes/0/nodes", json!([77]), "node 77: does not exist"),
        ("/nodes/1", json!({"children": [9]}), "node 1: child 9 does not exist"),
        ("/nodes/1", json!({"rotation": [0, 0, 0, 0]}), "node 1: its rotation"),
        ("/nodes/1", json!({"mesh": 5}), "node 1, mesh 5: does not exist"),
        ("/nodes/0/skin", json!(4), "node 0, skin 4: does not exist"),
        ("/skins/0/joints", json!([1, 8]), "node 0, skin 0, node 8: does not exist"),
        ("/skins/0/joints", json!([1]), "node 0, mesh 0, primitive 0, vertex 1: joint 1 is not one of skin 0"),
        ("/meshes/0/primitives/0/mode", json!(9), "node 0, mesh 0, primitive 0: unknown mode 9"),
        ("/accessors/0/componentType", json!(5124), "node 0, mesh 0, primitive 0, accessor 0: unknown component"),
        ("/accessors/0/count", json!(-1), "JSON: "),
        ("/buffers/0", json!({"byteLength": 1, "uri": "data:,"}), "node 0, skin 0, accessor 3, buffer 0: the data URI"),
    ];
    for (path, value, start) in cases {
        let error = error(path, value);
        assert!(error.starts_with(start), "{path}: {error}");
    }
}

#[test]
fn unknown_extensions_are_noted_if_used_and_refused_if_needed() {
    let mut doc = triangle();
    doc.json["extensionsUsed"] = json!(["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"]);
    doc.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(doc.scene().notes[0].what, "what extension EXT_mesh_gpu_instancing adds");
    doc.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert_eq!(doc.error(), "extensionsRequired: extension KHR_draco_mesh_compression is not supported");
}
