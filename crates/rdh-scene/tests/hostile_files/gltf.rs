//! glTF files.

use serde_json::{Value, json};

use super::{CORNERS, Case, Expect, triangles};

/// A document and its buffer.
#[derive(Clone)]
pub(crate) struct Document {
    json: Value,
    bin: Vec<u8>,
}

/// The cube.
pub(crate) fn cube() -> Document {
    let mut bin: Vec<u8> = CORNERS.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend(triangles().flatten().flat_map(u16::to_le_bytes));
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": bin.len()}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
    });
    Document { json, bin }
}

/// The cube with a skin of one joint, a sparse accessor and an animation; its data are the cube's own bytes.
pub(crate) fn moving() -> Document {
    let views = json!([{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72},
        {"buffer": 0, "byteOffset": 168, "byteLength": 128}]);
    let sparse = json!({"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}});
    let mut document = cube()
        .with("/bufferViews", views)
        .with(
            "/accessors/0",
            json!({"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "sparse": sparse}),
        )
        .with("/meshes/0/primitives/0/attributes", json!({"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}))
        .with("/nodes", json!([{"mesh": 0, "skin": 0}, {"rotation": [0, 0, 0, 1]}]))
        .with("/scenes/0/nodes", json!([0, 1]))
        .with("/buffers/0/byteLength", json!(296));
    document.bin.resize(168 + 32, 0);
    for _ in 0..8 {
        document.bin.extend([255, 0, 0, 0]);
    }
    document.bin.extend([0f32, 1.0].iter().flat_map(|x| x.to_le_bytes()));
    document.bin.resize(296, 64);
    let accessors = document.json["accessors"].as_array_mut().unwrap();
    accessors.push(json!({"bufferView": 2, "componentType": 5121, "count": 8, "type": "VEC4"}));
    accessors.push(json!({"bufferView": 2, "byteOffset": 32, "componentType": 5121, "normalized": true, "count": 8, "type": "VEC4"}));
    accessors.push(json!({"bufferView": 2, "byteOffset": 64, "componentType": 5126, "count": 2, "type": "SCALAR"}));
    accessors.push(json!({"bufferView": 2, "byteOffset": 72, "componentType": 5126, "count": 2, "type": "VEC3"}));
    document.json["skins"] = json!([{"joints": [1]}]);
    document.json["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
        "samplers": [{"input": 4, "output": 5}]}]);
    document
}

impl Document {
    /// Replaces or adds a value.
    fn with(mut self, path: &str, value: Value) -> Self {
        let (parent, key) = path.rsplit_once('/').unwrap();
        match self.json.pointer_mut(parent).unwrap() {
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
            parent => parent[key] = value,
        }
        self
    }

    /// As text, the buffer in it.
    pub(crate) fn text(&self) -> Vec<u8> {
        const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut uri = "data:application/octet-stream;base64,".to_owned();
        for group in self.bin.chunks(3) {
            let bits = group.iter().fold(0, |bits, &b| bits << 8 | usize::from(b)) << (8 * (3 - group.len()));
            let sextets = (0..=group.len()).map(|k| ALPHABET[bits >> (18 - 6 * k) & 63]);
            uri.extend(sextets.map(char::from));
        }
        let mut json = self.json.clone();
        if json["buffers"][0].get("uri").is_none() {
            json["buffers"][0]["uri"] = uri.into();
        }
        json.to_string().into_bytes()
    }

    pub(crate) fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().into_bytes(), &self.bin)
    }
}

fn glb(mut json: Vec<u8>, bin: &[u8]) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut chunks = Vec::new();
    for (kind, data) in [(b"JSON", &json[..]), (b"BIN\0", bin)] {
        chunks.extend((data.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(data);
    }
    [b"glTF\x02\0\0\0", &(12 + chunks.len() as u32).to_le_bytes()[..], &chunks].concat()
}

/// The cube's GLB with four bytes replaced.
fn patched(at: usize, word: u32) -> Vec<u8> {
    let mut bytes = cube().glb();
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    bytes
}

pub(crate) fn cases() -> Vec<Case> {
    let with = |path: &str, value: Value| cube().with(path, value).text();
    let refused =
        |name: &str, path: &str, value: Value, reason| Case::new(name, with(path, value), Expect::Error(reason));
    let chain: Vec<Value> = (1..=100_000).map(|i| json!({"children": [i]})).chain([json!({"mesh": 0})]).collect();
    let doubling: Vec<Value> = (1..=26).map(|i| json!({"children": [i, i]})).chain([json!({"mesh": 0})]).collect();
    let doubling_apart: Vec<Value> = (0..26)
        .map(|i| json!({"children": [2 * i + 2, 2 * i + 3]}))
        .chain(vec![json!({"children": [51]}); 28])
        .collect();
    let no_view = json!({"componentType": 5126, "count": u32::MAX, "type": "VEC3"});
    let long_strip = cube()
        .with("/accessors/0", no_view.clone())
        .with("/meshes/0/primitives/0", json!({"attributes": {"POSITION": 0}, "mode": 5}));
    let deep = format!("{{\"asset\":{}", "[".repeat(200_000));
    let deep_ignored = format!("{{\"extras\":{}", "[".repeat(200_000));
    vec![
        refused("cycle.gltf", "/nodes", json!([{"children": [1]}, {"children": [0]}]), "node 0: can't be a root"),
        refused("self.gltf", "/nodes", json!([{"children": [0]}]), "node 0: can't be a root of the scene"),
        refused(
            "cycle_below.gltf",
            "/nodes",
            json!([{"children": [1]}, {"children": [2]}, {"children": [1]}]),
            "already one of node 0",
        ),
        Case::new("deep.gltf", with("/nodes", chain.into()), Expect::Triangles(12)),
        refused("doubling.gltf", "/nodes", doubling.into(), "node 0: child 1 is already one of node 0"),
        refused("doubling_apart.gltf", "/nodes", doubling_apart.into(), "nodes must form trees"),
        refused(
            "view_1e9.gltf",
            "/bufferViews/0/byteLength",
            json!(1_000_000_000),
            "buffer view 0: 1000000000 bytes from 0 on",
        ),
        refused(
            "offset_2e63.gltf",
            "/bufferViews/0/byteOffset",
            json!(1u64 << 63),
            "buffer view 0: 96 bytes from 9223372036854775808 on",
        ),
        refused("offset_wraps.gltf", "/bufferViews/0/byteOffset", json!(u64::MAX - 95), "buffer view 0: "),
        refused(
            "count_4G.gltf",
            "/accessors/0/count",
            json!(u32::MAX),
            "accessor 0, buffer view 0: 4294967295 elements",
        ),
        refused(
            "count_2e63.gltf",
            "/accessors/0/count",
            json!(1u64 << 63),
            "accessor 0, buffer view 0: 9223372036854775808",
        ),
        refused("count_9.gltf", "/accessors/0/count", json!(9), "accessor 0, buffer view 0: 9 elements of 12 bytes"),
        refused(
            "indices_40.gltf",
            "/accessors/1/count",
            json!(40),
            "accessor 1, buffer view 1: 40 elements of 2 bytes",
        ),
        refused(
            "index_beyond.gltf",
            "/accessors/0/count",
            json!(5),
            "index 7: vertex index 5 is out of range (there are 5)",
        ),
        refused("stride_4.gltf", "/bufferViews/0/byteStride", json!(4), "byte stride 4 is less than"),
        refused("stride_0.gltf", "/bufferViews/0/byteStride", json!(0), "byte stride 0 is less than"),
        refused("stride_2e63.gltf", "/bufferViews/0/byteStride", json!(1u64 << 63), "8 elements of 12 bytes"),
        Case::new("no_view.gltf", with("/accessors/0", no_view), Expect::Triangles(12)),
        Case::new(
            "no_view_strip.gltf",
            long_strip.text(),
            Expect::Error("node 0, mesh 0, primitive 0: unpacks to far more"),
        ),
        refused(
            "outside.gltf",
            "/buffers/0/uri",
            json!("../../../../../../../../etc/passwd"),
            "buffer 0: file '../../../../../../../../etc/passwd'",
        ),
        refused(
            "device.gltf",
            "/buffers/0/uri",
            json!("/dev/zero"),
            "buffer 0: file '/dev/zero' is not named by a relative path",
        ),
        refused(
            "not_base64.gltf",
            "/buffers/0/uri",
            json!("data:;base64,????"),
            "buffer 0: the data URI's base64 is malformed",
        ),
        refused("bad_escape.gltf", "/buffers/0/uri", json!("%ff%fe.bin"), "buffer 0: "),
        refused(
            "matrix.gltf",
            "/nodes/0",
            json!({"mesh": 0, "matrix": vec![1e308; 16]}),
            "node 0: its matrix is not affine",
        ),
        refused(
            "far.gltf",
            "/nodes/0",
            json!({"mesh": 0, "scale": [1e300, 1, 1]}),
            "beyond the range of 32-bit floats",
        ),
        Case::new("deep_json.gltf", deep, Expect::Error("JSON: ")),
        Case::new("deep_ignored.gltf", deep_ignored, Expect::Error("JSON: ")),
        Case::new("empty.gltf", "", Expect::Error("JSON: EOF")),
        Case::new("not_json.gltf", [0xff; 100], Expect::Error("JSON: ")),
        Case::new("length_4G.glb", patched(8, u32::MAX), Expect::Error("byte 8: the header's length is 4294967295")),
        Case::new("length_4.glb", patched(8, 4), Expect::Error("byte 8: the header's length is 4")),
        Case::new("chunk_4G.glb", patched(12, 0xffff_fff0), Expect::Error("byte 12: a chunk's length is 4294967280")),
        Case::new(
            "chunk_kind.glb",
            patched(16, 0),
            Expect::Error("byte 16: the first chunk of a GLB must be its JSON"),
        ),
        Case::new("version_1.glb", patched(4, 1), Expect::Error("byte 4: GLB version 1")),
        Case::new("header.glb", b"glTF\x02", Expect::Error("a GLB header has 12 bytes")),
    ]
}

/// Small files that refer to the same data over and over.
pub(crate) fn bombs() -> Vec<Case> {
    let list = |item: &str, count: usize| vec![item; count].join(",");
    let document = |rest: String| format!(r#"{{"asset":{{"version":"2.0"}},{rest}}}"#);
    let far_more = Expect::Error("unpacks to far more data than the file has");
    let cube = cube();
    let cube_with = |meshes: String, nodes: String, skins: String| {
        let mut json = cube.json.clone();
        json.as_object_mut().unwrap().retain(|key, _| !["meshes", "nodes", "scenes", "scene"].contains(&key.as_str()));
        let rest = json.to_string();
        let json = format!(r#"{{"meshes":[{meshes}],"nodes":[{nodes}],"skins":[{skins}],{}"#, &rest[1..]);
        glb(json.into_bytes(), &cube.bin)
    };
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let one_mesh = format!(r#"{{"primitives":[{primitive}]}}"#);
    let skin = format!(r#"{{"joints":[{}]}}"#, list("0", 60_000));
    // Many primitives over one long list of indices: 4 million triangles for each of 5,000.
    let long = 1_000_000;
    let shared = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}],
            "buffers":[{{"byteLength":{long}}}],"bufferViews":[{{"buffer":0,"byteLength":{long}}}],
            "accessors":[{{"componentType":5126,"count":1,"type":"VEC3"}},
                {{"bufferView":0,"componentType":5121,"count":{long},"type":"SCALAR"}}]}}"#,
        list(r#"{"attributes":{"POSITION":0},"indices":1,"mode":5}"#, 5_000)
    );
    vec![
        Case::new(
            "empty_nodes.gltf",
            document(format!(r#""nodes":[{}]"#, list("{}", 3_000_000))),
            Expect::Error("JSON: unpacks"),
        ),
        Case::new(
            "some_empty_nodes.gltf",
            document(format!(r#""nodes":[{}]"#, list("{}", 120_000))),
            Expect::Triangles(0),
        ),
        Case::new(
            "empty_primitives.gltf",
            document(format!(r#""meshes":[{{"primitives":[{}]}}]"#, list(r#"{"attributes":{}}"#, 1_000_000))),
            Expect::Error("JSON: unpacks"),
        ),
        Case::new(
            "children.gltf",
            document(format!(r#""nodes":[{{"children":[{}]}}]"#, list("1", 4_000_000))),
            Expect::Error("node 0: child 1 does not exist"),
        ),
        Case::new(
            "extensions.gltf",
            document(format!(r#""extensionsUsed":[{}]"#, list("\"\"", 2_000_000))),
            Expect::Error("at most 256 extensions"),
        ),
        Case::new(
            "materials.gltf",
            document(format!(r#""materials":[{}]"#, list("0", 4_000_000))),
            Expect::Triangles(0),
        ),
        Case::new(
            "instances.glb",
            cube_with(one_mesh.clone(), list(r#"{"mesh":0}"#, 100_000), String::new()),
            Expect::Triangles(1_200_000),
        ),
        Case::new("shared_indices.glb", glb(shared.into_bytes(), &vec![0; long]), Expect::Error("unpacks to far more")),
        Case::new(
            "primitives.glb",
            cube_with(
                format!(r#"{{"primitives":[{}]}}"#, list(primitive, 20_000)),
                r#"{"mesh":0}"#.to_owned(),
                String::new(),
            ),
            Expect::Triangles(240_000),
        ),
        Case::new(
            "skins.glb",
            cube_with(one_mesh.clone(), list(r#"{"mesh":0,"skin":0}"#, 60_000), skin.clone()),
            far_more,
        ),
        Case::new(
            "many_skins.glb",
            cube_with(
                one_mesh,
                (0..40).map(|i| format!(r#"{{"mesh":0,"skin":{i}}}"#)).collect::<Vec<_>>().join(","),
                list(&skin, 40),
            ),
            Expect::Error("unpacks"),
        ),
    ]
}
