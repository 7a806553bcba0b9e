use super::*;

fn scene(bytes: &[u8]) -> Result<Scene> {
    read(bytes, &Context::default())
}

fn ascii(name: &str, z: f32) -> String {
    let facet = |a: &str, b: &str, c: &str| {
        format!(
            "facet normal nan 0 1\n outer loop\n  vertex {a} {z}\n  vertex {b} {z}\n  VERTEX {c} {z}\n endloop\nendfacet\n"
        )
    };
    format!("solid {name}\n{}{}endsolid {name}\n", facet("0 0", "1 0", "1 1"), facet("0 0", "1 1", "0 1"))
}

fn binary(header: &[u8], count: u32, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

const SQUARE: [[[f32; 3]; 3]; 2] =
    [[[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [1.0, 1.0, 5.0]], [[0.0, 0.0, 5.0], [1.0, 1.0, 5.0], [0.0, 1.0, 5.0]]];

#[test]
fn each_solid_is_a_geometry_with_shared_corners() {
    let scene = scene(format!("{}{}", ascii("one of two", 0.0), ascii("", 5.0)).as_bytes()).unwrap();
    assert_eq!(scene.geometries[0].name, "one of two");
    assert_eq!(scene.geometries[1].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(scene.geometries[1].positions.len(), 4);
}

#[test]
fn a_binary_file_may_start_with_solid() {
    let binary = scene(&binary(b"solid but not ascii", 2, &SQUARE)).unwrap();
    let ascii = scene(ascii("", 5.0).as_bytes()).unwrap();
    assert_eq!(binary.geometries, ascii.geometries);
}

#[test]
fn errors_name_the_place() {
    let error = |bytes: &[u8]| scene(bytes).unwrap_err().to_string();
    let fewer = "byte 80: the header's count is 3, but there are bytes for 2 triangles";
    assert_eq!(error(&binary(b"", 3, &SQUARE)), fewer);
    assert_eq!(error(&binary(b"", 1, &SQUARE)), fewer.replace('3', "1"));
    assert_eq!(error(b""), "a binary STL has at least 84 bytes, and this file only 0");
    let mut nan = SQUARE;
    nan[1][2][0] = f32::NAN;
    assert_eq!(error(&binary(b"", 2, &nan)), "byte 134 (triangle 1): coordinate NaN is not a finite number");
    let text = ascii("s", 0.0);
    assert_eq!(error(text.replacen("vertex", "vortex", 1).as_bytes()), "line 4: expected 'vertex', found 'vortex'");
    assert_eq!(error(text.replacen("1 0 0", "1 inf 0", 1).as_bytes()), "line 5: coordinate inf is not a finite number");
    assert_eq!(
        error(text.replace("endsolid", "").as_bytes()),
        "line 16: expected 'facet' or 'endsolid' after 2 facets, found 's'"
    );
}

#[test]
fn every_truncation_is_an_error() {
    let text = ascii("s", 0.0);
    // The name after the last keyword may be missing.
    for length in 1..text.len() - 3 {
        assert!(scene(&text.as_bytes()[..length]).is_err(), "{length} of {} bytes", text.len());
    }
    let whole = binary(b"", 2, &SQUARE);
    for length in 0..whole.len() {
        assert!(scene(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
    }
}
