use super::*;

fn scene(bytes: &[u8]) -> Result<Scene> {
    read(bytes, &Context::default())
}

/// A square with a colour between the coordinates, faces before vertices, and an element in between.
fn square(format: &str, big: bool) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment end_header\nelement face 2\nproperty uchar flags\n\
         property list ushort int vertex_index\nelement edge 1\nproperty list uchar double w\n\
         element vertex 4\nproperty double x\nproperty uchar red\nproperty double y\nproperty short z\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    let mut put = |le: &[u8]| {
        let mut number = le.to_vec();
        if big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for face in [&[0i32, 1, 2, 3][..], &[2, 0]] {
        put(&[7]);
        put(&(face.len() as u16).to_le_bytes());
        face.iter().for_each(|i| put(&i.to_le_bytes()));
    }
    put(&[1]);
    put(&0.5f64.to_le_bytes());
    for [x, y] in [[0.1f64, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        put(&x.to_le_bytes());
        put(&[255]);
        put(&y.to_le_bytes());
        put(&(-2i16).to_le_bytes());
    }
    bytes
}

const ASCII: &str = "ply\r\nformat ascii 1.0\r\nelement face 2\r\nproperty uchar flags\r\n\
    property list ushort int vertex_index\r\nelement edge 1\r\nproperty list uchar double w\r\n\
    element vertex 4\r\nproperty double x\r\nproperty uchar red\r\nproperty double y\r\nproperty short z\r\nend_header\r\n\
    7 4 0 1 2 3\r\n7 2 2 0\r\n1 0.5\r\n0.1 255 0 -2\r\n1 255 0 -2\r\n1 255 1 -2\r\n0 255 1 -2";

#[test]
fn the_three_encodings_agree() {
    let little = scene(&square("binary_little_endian", false)).unwrap();
    let big = scene(&square("binary_big_endian", true)).unwrap();
    let ascii = scene(ASCII.as_bytes()).unwrap();
    assert_eq!(little.geometries[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(little.geometries[0].positions[0], [0.1, 0.0, -2.0]);
    for other in [&big, &ascii] {
        assert_eq!(other.geometries, little.geometries);
        assert_eq!(other.notes, little.notes);
    }
    let counts: Vec<_> = little.notes.iter().map(|n| n.count).collect();
    // Face properties, fans, two-cornered polygons, edges, vertex properties.
    assert_eq!(counts, [1, 1, 1, 1, 1]);
}

#[test]
fn every_truncation_is_an_error() {
    for whole in [square("binary_little_endian", false), square("binary_big_endian", true)] {
        for length in 0..whole.len() {
            assert!(scene(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
        }
    }
    // In ascii, the last digit can go unnoticed.
    for length in 0..ASCII.len() - 1 {
        assert!(scene(&ASCII.as_bytes()[..length]).is_err(), "{length} of {} bytes", ASCII.len());
    }
}

#[test]
fn errors_name_the_place() {
    let error = |text: &str| scene(text.as_bytes()).unwrap_err().to_string();
    let changed = |from: &str, to: &str| error(&ASCII.replace(from, to));
    assert_eq!(changed("0 1 2 3", "0 1 2 4"), "line 14: vertex index 4 is out of range (the file has 4)");
    assert_eq!(changed("0.1 255", "inf 255"), "line 17: coordinate inf is not a finite number");
    assert_eq!(changed("7 4 0", "7 -4 0"), "line 14: a list can't have length -4");
    assert_eq!(changed("double x", "double a"), "header: element 'vertex' has no property 'x'");
    assert_eq!(changed("double x", "quad x"), "line 9: unknown type 'quad'");
    assert_eq!(changed("vertex 4", "vertex -4"), "line 8: '-4' is not a count of elements");
    assert_eq!(error("plywood"), "line 1: a PLY file starts with 'ply'");
    assert_eq!(error("ply\ncomment"), "line 2: the header has no end ('end_header' is missing)");
}
