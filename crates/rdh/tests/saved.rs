//! Saved trees: what is written is read, and nothing else is.

mod common;

use std::sync::Arc;

use common::meshes::{Random, closed, nasty, soup};
use common::rays::mixed;
use common::{SPECS, build_spec};
use rdh::simd::Level;
use rdh::{Accel, Error, Hit, Mesh, Profile, Provenance, Query, Ray, RayClass, RaySample};
use serde_json::json;
use xxhash_rust::xxh3::xxh3_64;

/// Bytes that begin at a multiple of 64, as a mapped file does; or beside one.
struct Lent {
    memory: Vec<[u64; 8]>,
    start: usize,
    len: usize,
}

impl Lent {
    fn new(bytes: &[u8], start: usize) -> Arc<Self> {
        // The vector's memory need not lie at a multiple of 64, but there is one in it.
        let mut memory = vec![[0; 8]; bytes.len() / 64 + 3];
        let start = start + bytemuck::cast_slice::<_, u8>(&memory).as_ptr().align_offset(64);
        bytemuck::cast_slice_mut(&mut memory)[start..start + bytes.len()].copy_from_slice(bytes);
        Arc::new(Self { memory, start, len: bytes.len() })
    }
}

impl AsRef<[u8]> for Lent {
    fn as_ref(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.memory)[self.start..self.start + self.len]
    }
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32, u32, u32)> {
    hit.map(|h| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.tri.0))
}

fn profile(rays: &[Ray]) -> Profile {
    let sample = |ray: &Ray| RaySample::new(*ray, None, Query::Occluded, RayClass::Ao);
    Profile::from_samples(rays.iter().map(sample).collect(), 7)
}

fn masked(mesh: Mesh) -> Mesh {
    let masks = (0..mesh.len() as u32).map(|i| 1 << (i % 3)).collect();
    mesh.with_masks(masks).unwrap()
}

fn assert_same(a: &Accel, b: &Accel, rays: &[Ray], what: &str) {
    assert_eq!(a.fingerprint(), b.fingerprint(), "{what}");
    assert_eq!((a.stats(), a.mesh(), a.bounds()), (b.stats(), b.mesh(), b.bounds()), "{what}");
    assert_eq!(a.provenance(), b.provenance(), "{what}");
    assert_eq!(b.check(b.mesh()), vec![], "{what}");
    let (mut all_a, mut all_b) = (Vec::new(), Vec::new());
    for (i, ray) in rays.iter().enumerate() {
        let ray = if i % 2 == 0 { *ray } else { ray.masked(1) };
        assert_eq!(bits(a.closest(&ray)), bits(b.closest(&ray)), "{what}");
        assert_eq!(a.occluded(&ray), b.occluded(&ray), "{what}");
        a.all_hits(&ray, &mut all_a);
        b.all_hits(&ray, &mut all_b);
        assert_eq!(all_a, all_b, "{what}");
    }
}

#[test]
fn every_structure_is_read_as_it_was_written() {
    let meshes = nasty().into_iter().chain(closed().into_iter().map(|(name, mesh, _)| (name, mesh)));
    for (i, (name, mesh)) in meshes.enumerate() {
        let mesh = if i % 2 == 0 { mesh } else { masked(mesh) };
        let rays = mixed(&mesh, 60, 5);
        for spec in SPECS.iter().filter(|spec| !["lazy", "eye", "light"].iter().any(|name| spec.contains(name))) {
            let what = format!("{name}, {spec}");
            let settings = json!({ "scene": name, "view": [1, 2.5, null] });
            let evidence = Some(json!([{ "ratio": 0.8 }]));
            let unseen = (i % 3 == 0).then(|| profile(&rays));
            let provenance = Provenance { seed: Some(7), settings, evidence, unseen };
            let accel = build_spec(&mesh, spec).with_provenance(provenance);
            let bytes = accel.to_bytes().unwrap();
            let mut written = Vec::new();
            accel.write_to(&mut written).unwrap();
            assert_eq!(bytes, written);
            for start in [0, 1] {
                let shared = Accel::from_shared(Lent::new(&bytes, start)).unwrap_or_else(|e| panic!("{what}: {e}"));
                assert_same(&accel, &shared, &rays, &what);
            }
            let copied = Accel::from_bytes(&bytes).unwrap();
            assert_same(&accel, &copied, &rays, &what);
            assert_eq!(copied.to_bytes().unwrap(), bytes, "{what}");
            let (of_tree, provenance) = rdh::saved::read_mesh(&bytes).unwrap();
            assert_eq!((&of_tree, &provenance), (&mesh, copied.provenance()));
        }
    }
}

#[test]
fn shared_bytes_are_not_copied_and_live_as_long_as_the_tree() {
    let mesh = masked(soup(2000, 0.1, 3));
    for spec in ["kd+sah", "bvh2+sah", "bvh8+rdh"] {
        let accel = build_spec(&mesh, spec);
        let lent = Lent::new(&accel.to_bytes().unwrap(), 0);
        let shared = Accel::from_shared(lent.clone()).unwrap();
        let within = |address: usize| (*lent).as_ref().as_ptr_range().contains(&(address as *const u8));
        assert!(within(shared.mesh().positions().as_ptr() as usize));
        assert!(within(shared.mesh().masks().unwrap().as_ptr() as usize));
        // Mesh: three arrays; structure: masks, nodes, blocks.
        assert!(Arc::strong_count(&lent) >= 6, "{}", Arc::strong_count(&lent));
        drop(accel);
        let clone = shared.clone();
        drop(shared);
        assert!(clone.closest(&Ray::new([-2.0, 0.01, 0.02], [1.0, 0.0, 0.0])).is_some() || clone.stats().triangles > 0);
        drop(clone);
        assert_eq!(Arc::strong_count(&lent), 1);
    }
}

/// A small saved tree with everything in it.
fn sample(spec: &str, seed: u64) -> Vec<u8> {
    let mesh = masked(soup(40, 0.5, seed));
    let unseen = Some(profile(&mixed(&mesh, 9, seed)));
    let provenance = Provenance { seed: Some(seed), settings: json!({ "a": 1 }), evidence: None, unseen };
    build_spec(&mesh, spec).with_provenance(provenance).to_bytes().unwrap()
}

const SAMPLES: [&str; 4] = ["kd+sah", "bvh2+sah", "sbvh4+sah", "bvh8+rdh"];

fn place(result: Result<Accel, Error>) -> (usize, String) {
    match result {
        Err(Error::Format { offset, reason }) => (offset, reason),
        other => panic!("{:?}", other.map(|accel| accel.stats().spec.to_string())),
    }
}

#[test]
fn a_file_that_is_cut_off_anywhere_is_an_error() {
    for spec in SAMPLES {
        let bytes = sample(spec, 1);
        for len in 0..bytes.len() {
            let (offset, reason) = place(Accel::from_bytes(&bytes[..len]));
            assert!(offset <= len, "{len}: byte {offset}: {reason}");
        }
        let longer = [&bytes[..], &[0; 64]].concat();
        assert_eq!(place(Accel::from_bytes(&longer)).0, bytes.len());
    }
}

#[test]
fn what_it_is_not_is_said() {
    let bytes = sample("kd+sah", 1);
    assert_eq!(place(Accel::from_bytes(b"RDH-RAYS")), (0, "this is not a .rdh file".to_owned()));
    assert_eq!(place(Accel::from_bytes(b"solid x")).0, 0);
    let changed = |at: usize, value: u8| {
        let mut bytes = bytes.clone();
        bytes[at] = value;
        bytes
    };
    let (offset, reason) = place(Accel::from_bytes(&changed(8, 9)));
    assert_eq!((offset, reason.as_str()), (8, "version 9; this program reads version 1"));
    // The layout stands before the checksummed part.
    let (offset, reason) = place(Accel::from_bytes(&changed(12, 8)));
    assert_eq!((offset, reason.as_str()), (12, "layout 8 is not that of kd+sah"));
    let (offset, reason) = place(Accel::from_bytes(&changed(bytes.len() - 1, !bytes[bytes.len() - 1])));
    assert_eq!((offset, reason.as_str()), (16, "the checksum does not match: the file was altered or damaged"));
}

#[test]
fn settings_too_deep_to_be_read_are_not_written() {
    let deep = (0..200).fold(json!(1), |inner, _| json!([inner]));
    let accel = build_spec(&soup(3, 1.0, 1), "kd+sah");
    let accel = accel.with_provenance(Provenance { settings: deep, ..Provenance::default() });
    assert!(accel.to_bytes().is_err() && accel.write_to(&mut Vec::new()).is_err());
}

/// Sets both checksums right again, as far as the table of parts can be understood.
fn sign(bytes: &mut [u8], random: &mut Random) {
    let word = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    if random.below(8) > 0 {
        let (mut hashed, mut counts) = (Vec::new(), [0u64; 2]);
        for row in (64..).step_by(32).take(word(bytes, 48).min(7) as usize).take_while(|row| row + 32 <= bytes.len()) {
            let (number, stride) = (word(bytes, row) as u32, word(bytes, row) >> 32);
            let (start, count) = (word(bytes, row + 8), word(bytes, row + 16));
            let range = start as usize..start.saturating_add(count.saturating_mul(stride)) as usize;
            if let (1..=3, Some(part)) = (number, bytes.get(range)) {
                hashed.extend_from_slice(part);
                counts[number.min(2) as usize - 1] = if number < 3 { count } else { counts[1] };
            }
        }
        let hashed = [counts.map(u64::to_le_bytes).as_flattened(), &hashed].concat();
        bytes[32..40].copy_from_slice(&xxh3_64(&hashed).to_le_bytes());
    }
    let checksum = xxh3_64(&bytes[24..]);
    bytes[16..24].copy_from_slice(&checksum.to_le_bytes());
}

/// Changes one to four bytes or words, mostly to something that might pass.
fn mutate(bytes: &mut [u8], random: &mut Random) {
    for _ in 0..1 + random.below(4) {
        let word = random.below(bytes.len() / 4) * 4;
        let old = u32::from_le_bytes(bytes[word..word + 4].try_into().unwrap());
        let elsewhere = random.below(bytes.len() / 4) * 4;
        let new = match random.below(10) {
            0 => 0,
            1 => u32::MAX,
            2 => random.below(64) as u32,
            3 => old.wrapping_add(1),
            4 => old ^ 1 << random.below(32),
            5 => [f32::NAN, f32::INFINITY, -0.0, 1e30, f32::MIN_POSITIVE][random.below(5)].to_bits(),
            6 => old.wrapping_add(4).wrapping_sub(random.below(2) as u32 * 8),
            7 => random.bits(),
            8 => 1 << 31 | old,
            _ => u32::from_le_bytes(bytes[elsewhere..elsewhere + 4].try_into().unwrap()),
        };
        bytes[word..word + 4].copy_from_slice(&new.to_le_bytes());
    }
}

/// Files that were altered by accident: always an error.
fn plain_mutants(count: usize) {
    let mut random = Random::new(17);
    let samples = SAMPLES.map(|spec| sample(spec, 2));
    for i in 0..count {
        let original = &samples[i % samples.len()];
        let mut bytes = original.clone();
        match random.below(3) {
            0 => bytes[random.below(original.len())] ^= 1 << random.below(8),
            1 => mutate(&mut bytes, &mut random),
            _ => {
                let (a, b) = (random.below(bytes.len()), random.below(bytes.len()));
                bytes.swap(a, b);
            }
        }
        if bytes != *original {
            place(Accel::from_bytes(&bytes));
        }
    }
}

/// Files that were altered on purpose: an error, or a tree that can be asked anything. Returns how many were trees.
fn signed_mutants(count: usize) -> usize {
    let mut random = Random::new(18);
    let samples = SAMPLES.map(|spec| sample(spec, 3));
    let rays = mixed(&soup(40, 0.5, 3), 12, 4);
    let mut accepted = 0;
    for i in 0..count {
        let mut bytes = samples[i % samples.len()].clone();
        mutate(&mut bytes, &mut random);
        sign(&mut bytes, &mut random);
        let read = if i % 2 == 0 { Accel::from_bytes(&bytes) } else { Accel::from_shared(Lent::new(&bytes, 0)) };
        let Ok(accel) = read else { continue };
        accepted += 1;
        accel.check(accel.mesh());
        accel.cells(&mut |_, _, _| {});
        Accel::from_bytes(&accel.to_bytes().unwrap()).unwrap();
        for level in Level::available() {
            let (accel, mut hits) = (accel.clone().with_level(level), Vec::new());
            for ray in &rays {
                accel.all_hits(ray, &mut hits);
                assert!(accel.closest(ray).is_none_or(|hit| hit.tri.index() < accel.mesh().len()));
                accel.occluded(ray);
            }
        }
    }
    accepted
}

#[test]
fn altered_files_are_errors() {
    plain_mutants(10_000);
}

#[test]
fn altered_files_with_right_checksums_are_errors_or_do_no_harm() {
    let accepted = signed_mutants(10_000);
    assert!(accepted > 100, "{accepted}: too few mutants come that far");
}

#[test]
#[ignore = "minutes"]
fn a_million_altered_files() {
    plain_mutants(1_000_000);
    signed_mutants(1_000_000);
}

#[test]
fn counts_that_a_file_only_claims_take_no_memory() {
    let bytes = sample("bvh8+sah", 1);
    for at in [24, 40, 48, 72, 80, 68].into_iter().chain((64..256).step_by(8)) {
        for claim in [u64::MAX, 1 << 62, 1 << 40, 1 << 32, (1 << 32) - 1] {
            let mut bytes = bytes.clone();
            bytes[at..at + 8].copy_from_slice(&claim.to_le_bytes());
            sign(&mut bytes, &mut Random::new(1));
            place(Accel::from_bytes(&bytes));
        }
    }
}
