//! PLY files.

use super::{CORNERS, Case, Expect, triangles};

fn header(format: &str, vertices: impl ToString, faces: impl ToString) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.to_string(),
        faces.to_string()
    )
}

/// The cube in ascii.
pub(crate) fn ascii() -> String {
    let vertex = |p: [f32; 3]| format!("{} {} {}\n", p[0], p[1], p[2]);
    let face = |t: [u16; 3]| format!("3 {} {} {}\n", t[0], t[1], t[2]);
    let vertices: String = CORNERS.into_iter().map(vertex).collect();
    header("ascii", 8, 12) + &vertices + &triangles().map(face).collect::<String>()
}

/// The cube in binary.
pub(crate) fn binary(big_endian: bool) -> Vec<u8> {
    let name = if big_endian { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = header(name, 8, 12).into_bytes();
    let ordered = |le: [u8; 4]| if big_endian { [le[3], le[2], le[1], le[0]] } else { le };
    bytes.extend(CORNERS.as_flattened().iter().flat_map(|x| ordered(x.to_le_bytes())));
    for triangle in triangles() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|&i| ordered(u32::from(i).to_le_bytes())));
    }
    bytes
}

fn little(vertices: u64, faces: u64) -> String {
    header("binary_little_endian", vertices, faces)
}

pub(crate) fn cases() -> Vec<Case> {
    let data = [0; 200];
    let claims = |vertices| [little(vertices, 12).as_bytes(), &data].concat();
    let list = |kind: &str, length: [u8; 4]| {
        let header = little(1, 1).replace("list uchar", &format!("list {kind}"));
        [header.as_bytes(), &[0; 12], &length, &[0; 64]].concat()
    };
    let nothing = "ply\nformat ascii 1.0\nelement nothing 18446744073709551615\nend_header\n";
    let no_faces = "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nend_header\n";
    let long_comment = format!("ply\nformat ascii 1.0\ncomment {}", "a".repeat(20_000_000));
    // A byte each: lists without an item, and vertices of three.
    let empty_faces = [little(0, 4_000_000).into_bytes(), vec![0; 4_000_000]].concat();
    let small = little(1_000_000, 0).replace("float", "char");
    let small = [small.into_bytes(), vec![1; 3_000_000]].concat();
    let elements = format!("ply\nformat ascii 1.0\n{}end_header\n", "element a 0\nproperty int x\n".repeat(200_000));
    vec![
        Case::new("vertices_4G.ply", claims(u64::from(u32::MAX)), Expect::Error("only 200 bytes are left")),
        Case::new("vertices_2e18.ply", claims(2_000_000_000_000_000_000), Expect::Error("byte 188: the header claims")),
        Case::new("vertices_negative.ply", header("ascii", -1, 12), Expect::Error("line 3: '-1' is not a count")),
        Case::new("list_4G.ply", list("uint", [255; 4]), Expect::Error("byte 180: a list of 4294967295")),
        Case::new("list_negative.ply", list("int", [255; 4]), Expect::Error("byte 179: a list can't have length -1")),
        Case::new("list_float.ply", list("float", [0; 4]), Expect::Error("line 8: the length of a list")),
        Case::new(
            "no_properties.ply",
            no_faces.replace("binary_little_endian", "ascii"),
            Expect::Error("no property 'x'"),
        ),
        Case::new("no_properties_binary.ply", no_faces, Expect::Error("header: element 'vertex' has no property 'x'")),
        Case::new("nothing_2e64.ply", nothing, Expect::Triangles(0)),
        Case::new(
            "index_600000.ply",
            ascii().replace("3 4 5 6\n", "3 4 5 600000\n"),
            Expect::Error("line 20: vertex index 600000"),
        ),
        Case::new(
            "index_fraction.ply",
            ascii().replace("3 4 5 6\n", "3 4 5 6.5\n"),
            Expect::Error("line 20: vertex index 6.5"),
        ),
        Case::new("nan.ply", ascii().replacen("0 0 0\n", "0 nan 0\n", 1), Expect::Error("line 10: coordinate NaN")),
        Case::new(
            "too_large.ply",
            ascii().replacen("0 0 0\n", "0 1e39 0\n", 1),
            Expect::Error("line 10: coordinate 1e39"),
        ),
        Case::new("long_header.ply", long_comment, Expect::Error("line 3: the header has no end")),
        Case::new("many_elements.ply", elements, Expect::Triangles(0)),
        Case::new("empty_faces.ply", empty_faces, Expect::Triangles(0)),
        Case::new("small_vertices.ply", small, Expect::Triangles(0)),
        Case::new("twice.ply", ascii().replace("face 12", "vertex 12"), Expect::Error("'vertex' is there twice")),
        Case::new("empty.ply", "", Expect::Error("line 1: a PLY file starts with 'ply'")),
    ]
}
