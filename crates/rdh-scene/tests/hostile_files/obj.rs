//! OBJ files.

use super::{CORNERS, Case, Expect, SIDES};

/// The cube, its sides as quadrilaterals.
pub(crate) fn cube() -> String {
    let vertex = |p: [f32; 3]| format!("v {} {} {}\n", p[0], p[1], p[2]);
    let face = |q: [u16; 4]| format!("f {}\n", q.map(|i| format!("{}/1/1", i + 1)).join(" "));
    let vertices: String = CORNERS.into_iter().map(vertex).collect();
    format!("o cube\n{vertices}vt 0 0\nvn 0 0 1\n{}", SIDES.into_iter().map(face).collect::<String>())
}

pub(crate) fn cases() -> Vec<Case> {
    let and = |more: &str| cube() + more;
    let latin = [&b"o caf\xe9\n"[..], cube().as_bytes(), b"g \xff\xfe\0\n"].concat();
    let vertices = "v 0 0 0\n".repeat(1_000_000);
    let groups = format!("{}{}", cube(), "g a\nf 1 2 3\n".repeat(200_000));
    vec![
        Case::new("index_902.obj", and("f 900 901 902\n"), Expect::Error("line 18: vertex index 902 is out of range")),
        Case::new("index_0.obj", and("f 0 1 2\n"), Expect::Error("line 18: vertex index 0")),
        Case::new("index_far_back.obj", and("f -100 -200 -300\n"), Expect::Error("line 18: vertex index -100")),
        Case::new(
            "index_least.obj",
            and("f -9223372036854775808 1 2\n"),
            Expect::Error("line 18: vertex index -92233720"),
        ),
        Case::new("index_most.obj", and("f 9223372036854775807 1 2\n"), Expect::Error("larger than can be numbered")),
        Case::new("index_2e64.obj", and("f 18446744073709551616 1 2\n"), Expect::Error("is not a vertex index")),
        Case::new("nan.obj", cube().replace("v 1 0 0", "v nan inf 1e999"), Expect::Error("line 3: coordinate NaN")),
        Case::new("infinite.obj", cube().replace("v 1 0 0", "v 1 1e999 0"), Expect::Error("line 3: coordinate inf")),
        Case::new("two_corners.obj", and("f 1 2\nf 1\nf\n"), Expect::Triangles(12)),
        Case::new("not_utf8.obj", latin, Expect::Triangles(12)),
        Case::new("long_line.obj", and(&format!("f {}\n", "1 ".repeat(2_000_000))), Expect::Triangles(12 + 1_999_998)),
        Case::new(
            "long_polygon.obj",
            and(&format!("f {}\n", "1 2 3 ".repeat(300_000))),
            Expect::Triangles(12 + 899_998),
        ),
        Case::new("long_word.obj", and(&format!("f {}\n", "1".repeat(5_000_000))), Expect::Error("line 18: '1111")),
        Case::new("mtllib.obj", and("mtllib ../../../../etc/passwd\n"), Expect::Triangles(12)),
        Case::new("million_vertices.obj", vertices, Expect::Triangles(0)),
        Case::new("many_groups.obj", groups, Expect::Triangles(200_012)),
        Case::new("many_unknowns.obj", and(&"zzz\nyyy\n".repeat(300_000)), Expect::Triangles(12)),
        Case::new("continued.obj", and(&"\\\n".repeat(1_000_000)), Expect::Triangles(12)),
        Case::new("binary.obj", vec![0; 100_000], Expect::Error("is it an OBJ file?")),
        Case::new("empty.obj", "", Expect::Error("no line with a vertex or face")),
    ]
}
