//! Saved trees: what is opened can be checked, traced and saved again, whatever the bytes were.

use std::sync::{Arc, LazyLock};

use rdh::simd::Level;
use rdh::{Accel, BuildOptions, Mesh, Provenance, Query, Ray, RayClass, RaySample, Training, naive};
use xxhash_rust::xxh3::xxh3_64;

use crate::bits::Bits;

/// One of each layout.
const SPECS: [&str; 6] = ["kd+sah", "bvh2+sah", "sbvh4+sah", "bvh8+rdh", "bvh8(from=kd)+sah", "bvh8(compact)+sah"];

/// Where the checksummed part of a file begins, where its table of parts does, and how long a row of it is.
const CHECKED: usize = 24;
const HEADER: usize = 64;
const ROW: usize = 32;

/// Opens the bytes themselves, or a saved tree in which they say what is changed, signed anew.
pub(crate) fn open(data: &[u8]) {
    let mut bits = Bits::new(data);
    let bytes = match bits.below(8) {
        0 => data[1.min(data.len())..].to_vec(),
        1 => signed(data[1.min(data.len())..].to_vec(), true),
        _ => altered(&mut bits),
    };
    let copied = Accel::from_bytes(&bytes);
    assert_eq!(copied.is_ok(), Accel::from_shared(Arc::new(bytes.clone())).is_ok(), "copied and shared are alike");
    rdh::saved::read_mesh(&bytes).ok();
    if let Ok(accel) = copied {
        use_it(&accel, &mut bits);
    }
}

/// Some words of a good file, changed.
fn altered(bits: &mut Bits<'_>) -> Vec<u8> {
    static SAVED: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| SPECS.iter().map(|spec| saved(spec)).collect());
    let mut bytes = SAVED[bits.below(SPECS.len())].clone();
    for _ in 0..1 + bits.below(6) {
        let at = bits.word() as usize % (bytes.len() / 4) * 4;
        let old = u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        let new = match bits.below(6) {
            0 => u32::from(bits.byte()),
            1 => old.wrapping_add(u32::from(bits.byte())),
            2 => old.wrapping_sub(u32::from(bits.byte())),
            3 => old ^ 1 << bits.below(32),
            4 => bits.float().to_bits(),
            _ => bits.word(),
        };
        bytes[at..at + 4].copy_from_slice(&new.to_le_bytes());
    }
    if bits.below(8) == 0 {
        bytes.truncate(bits.word() as usize % (bytes.len() + 1));
    }
    let mesh_too = bits.below(8) > 0;
    signed(bytes, mesh_too)
}

/// A small saved tree with everything in it.
fn saved(spec: &str) -> Vec<u8> {
    let at = |i: usize| ((i * 37 + i * i * 11) % 64) as f32 / 32.0 - 1.0;
    let positions = (0..60).map(|i| [at(i), at(i + 100), at(3 * i + 7)]).collect();
    let triangles = (0..40).map(|i| [i, (i + 7) % 60, (i * 3 + 1) % 60]).collect();
    let mesh = Mesh::new(positions, triangles).expect("a valid mesh");
    let mesh = mesh.with_masks((0..40).map(|i| 1 << (i % 3)).collect()).expect("a mask each");
    let ray = |i: usize| Ray::new([at(i), at(i + 1), -2.0], [at(i + 5), at(i + 6), 1.0]);
    let sample = |i| RaySample::new(ray(i), naive::closest(&mesh, &ray(i)), Query::Closest, RayClass::Other);
    let training = Training::from_samples((0..50).map(sample).collect());
    let accel = rdh::build(&mesh, &spec.parse().expect(spec), &training, &BuildOptions::default()).expect(spec);
    let unseen = Some(rdh::Profile::from_samples((50..60).map(sample).collect(), 1));
    accel.with_provenance(Provenance { seed: Some(1), unseen, ..Provenance::default() }).to_bytes().expect(spec)
}

/// With right checksums: that of the file, and that of the mesh as far as the table of parts can be understood.
fn signed(mut bytes: Vec<u8>, mesh_too: bool) -> Vec<u8> {
    if bytes.len() < HEADER {
        return bytes;
    }
    if mesh_too {
        let checksum = mesh_checksum(&bytes);
        bytes[32..40].copy_from_slice(&checksum.to_le_bytes());
    }
    let checksum = xxh3_64(&bytes[CHECKED..]);
    bytes[16..CHECKED].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

fn mesh_checksum(bytes: &[u8]) -> u64 {
    let word = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
    let (mut arrays, mut counts) = (Vec::new(), [0u64; 2]);
    let rows = (HEADER..).step_by(ROW).take(word(48).min(7) as usize);
    for row in rows.take_while(|row| row + ROW <= bytes.len()) {
        let (number, stride, start, count) = (word(row) as u32, word(row) >> 32, word(row + 8), word(row + 16));
        let range = start as usize..start.saturating_add(count.saturating_mul(stride)) as usize;
        if let (1..=3, Some(part)) = (number, bytes.get(range)) {
            arrays.extend_from_slice(part);
            if number < 3 {
                counts[number as usize - 1] = count;
            }
        }
    }
    xxh3_64(&[counts.map(u64::to_le_bytes).as_flattened(), &arrays].concat())
}

/// Asks a tree everything. Its answers may be wrong, since its boxes may be; but it gives some, within its mesh.
fn use_it(accel: &Accel, bits: &mut Bits<'_>) {
    let again = Accel::from_bytes(&accel.to_bytes().expect("what was read can be written")).expect("and read again");
    assert_eq!(again.fingerprint(), accel.fingerprint());
    accel.check(accel.mesh());
    accel.cells(&mut |_, _, _| {});
    let rays: Vec<_> = (0..8).map(|_| bits.ray(accel.mesh())).collect();
    let mut hits = Vec::new();
    for level in Level::available() {
        let accel = accel.clone().with_level(level);
        for ray in &rays {
            accel.all_hits(ray, &mut hits);
            accel.occluded(ray);
            assert!(hits.iter().chain(&accel.closest(ray)).all(|hit| hit.tri.index() < accel.mesh().len()));
        }
    }
}
