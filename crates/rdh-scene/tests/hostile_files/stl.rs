//! STL files.

use super::{CORNERS, Case, Expect, triangles};

/// The cube in ascii.
pub(crate) fn ascii() -> String {
    let vertex = |i: u16| CORNERS[usize::from(i)].map(|x| x.to_string()).join(" ");
    let facet = |t: [u16; 3]| {
        let vertices: String = t.into_iter().map(|i| format!("vertex {}\n", vertex(i))).collect();
        format!("facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid c\n{}endsolid c\n", triangles().map(facet).collect::<String>())
}

/// The cube in binary, with a count of ours.
pub(crate) fn binary(count: u32) -> Vec<u8> {
    with(b"", count, triangles().map(|t| t.map(|i| CORNERS[usize::from(i)])))
}

fn with(header: &[u8], count: u32, triangles: impl Iterator<Item = [[f32; 3]; 3]>) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub(crate) fn cases() -> Vec<Case> {
    let solid = [b"solid", &binary(12)[5..]].concat();
    let numbers = [f32::NAN, f32::INFINITY].map(|x| with(b"", 1, std::iter::once([[x, 0.0, 0.0], [0.0; 3], [1.0; 3]])));
    let [nan, infinite] = numbers;
    let many_solids = "solid\nendsolid\n".repeat(300_000);
    let all_different = (0..200_000).map(|i| [[i as f32, 0.0, 0.0], [i as f32, 1.0, 0.0], [i as f32, 0.0, 1.0]]);
    let no_end = format!("solid {}", "a".repeat(5_000_000));
    vec![
        Case::new("count_4G.stl", binary(u32::MAX), Expect::Error("byte 80: the header's count is 4294967295")),
        Case::new("count_50M.stl", binary(50_000_000), Expect::Error("bytes for 12 triangles")),
        Case::new("count_short.stl", binary(3), Expect::Error("the header's count is 3, but")),
        Case::new("solid_but_binary.stl", solid, Expect::Triangles(12)),
        Case::new("empty.stl", "", Expect::Error("this file only 0")),
        Case::new("nan.stl", nan, Expect::Error("byte 84 (triangle 0): coordinate NaN")),
        Case::new("infinite.stl", infinite, Expect::Error("byte 84 (triangle 0): coordinate inf")),
        Case::new("short_ascii.stl", "solid\nfacet normal 0 0", Expect::Error("line 2: the file ends")),
        Case::new("only_solid.stl", "solid", Expect::Error("line 1: the file ends")),
        Case::new("name_of_5M.stl", no_end, Expect::Error("line 1: the file ends")),
        Case::new("many_solids.stl", many_solids, Expect::Triangles(0)),
        Case::new("no_corner_shared.stl", with(b"", 200_000, all_different), Expect::Triangles(200_000)),
        Case::new(
            "text.stl",
            ascii().replace("endloop", "vertex 0 0 0 endloop"),
            Expect::Error("line 7: expected 'endloop'"),
        ),
    ]
}
