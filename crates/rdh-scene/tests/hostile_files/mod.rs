//! Hostile files and random mutations, made on the spot.

pub(crate) mod gltf;
pub(crate) mod memory;
pub(crate) mod obj;
pub(crate) mod ply;
pub(crate) mod stl;

/// A file and what is to become of it.
pub(crate) struct Case {
    /// Its name, with the extension that decides the reader.
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    pub(crate) expect: Expect,
}

#[derive(Debug)]
pub(crate) enum Expect {
    /// It is read, and has so many triangles.
    Triangles(usize),
    /// It is refused; the message has this in it, beside the file.
    Error(&'static str),
}

impl Case {
    pub(crate) fn new(name: &str, bytes: impl Into<Vec<u8>>, expect: Expect) -> Self {
        Self { name: name.to_owned(), bytes: bytes.into(), expect }
    }
}

/// The corners of a cube.
pub(crate) const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// The sides of the cube.
pub(crate) const SIDES: [[u16; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// The sides as 12 triangles.
pub(crate) fn triangles() -> impl Iterator<Item = [u16; 3]> {
    SIDES.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
}

/// A good file of each kind: the cube.
pub(crate) fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("cube.obj", obj::cube().into_bytes()),
        ("cube_ascii.ply", ply::ascii().into_bytes()),
        ("cube_little.ply", ply::binary(false)),
        ("cube_big.ply", ply::binary(true)),
        ("cube_ascii.stl", stl::ascii().into_bytes()),
        ("cube_binary.stl", stl::binary(12)),
        ("cube.gltf", gltf::cube().text()),
        ("cube.glb", gltf::cube().glb()),
        ("cube_moving.glb", gltf::moving().glb()),
    ]
}

/// Small random numbers (xorshift).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % limit.max(1)
    }
}

/// Bytes that have made parsers stumble.
const TELLING: [&[u8]; 14] = [
    b"-1",
    b"0",
    b"1e999",
    b"nan",
    b"4294967295",
    b"9223372036854775808",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"{}",
    b"[",
    b"\"",
    b"\n",
    b" ",
    b"\x80",
];

/// A copy with one to four random changes.
pub(crate) fn mutated(seed: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(8)).min(bytes.len());
        match random.below(6) {
            _ if bytes.is_empty() => break,
            0 => bytes[at] = random.below(256) as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..end)),
            3 => bytes.truncate(at),
            4 => {
                let twice = bytes[at..end].to_vec();
                bytes.splice(at..at, twice);
            }
            _ => {
                let telling = TELLING[random.below(TELLING.len())];
                bytes.splice(at..end, telling.iter().copied());
            }
        }
    }
    bytes
}
