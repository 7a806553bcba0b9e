//! What the fuzz targets do with their bytes: each may answer with an error, but neither panic, nor hang, nor take memory that
//! the bytes don't pay for, nor be wrong.

mod bits;
mod saved;

use std::path::Path;

use bits::Bits;
use rdh::precise::{self, AccelF64, MeshF64};
use rdh::{BuildOptions, Mesh, Profile, Query, RayClass, RaySample, Spec, Training, naive};
use rdh_scene::formats::{Context, format_of};

/// Reads a mesh file that refers to files beside it; what is read must be whole.
pub fn mesh(format: &str, data: &[u8]) {
    let Ok(format) = format_of(Path::new(&format!("fuzz.{format}"))) else { unreachable!("a known format") };
    // The bytes after a telling word are the file `a.bin` beside it.
    let (file, beside) = split_at(data, b"--beside--");
    let folder = beside.and_then(|bytes| {
        let folder = tempfile::tempdir().ok()?;
        std::fs::write(folder.path().join("a.bin"), bytes).ok()?;
        Some(folder)
    });
    let context =
        Context { folder: folder.as_ref().map(|f| f.path()), time_secs: (data.len() % 2 == 0).then_some(0.5) };
    if let Ok(scene) = (format.read)(file, &context) {
        // A file can ask for many copies of what it holds; making them is its reader's wish.
        if scene.triangle_count() < 1 << 16 {
            scene.flatten().expect("a scene that was read is whole");
        }
    }
}

/// Reads a profile; what is read is written again to the same bytes.
pub fn rays(data: &[u8]) {
    if let Ok(profile) = Profile::from_bytes(data) {
        let again = Profile::from_bytes(&profile.to_bytes()).expect("what was written can be read");
        assert_eq!(again.to_bytes(), profile.to_bytes());
        let (training, _, _) = profile.split(1);
        drop(training);
    }
}

/// Reads the index of a folder of scenes.
pub fn index(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scenes.toml"), data).expect("a file");
    drop(rdh_scene::index::read_index(folder.path()));
}

/// Reads a study's log, however it was cut off.
pub fn log(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log");
    std::fs::write(&path, data).expect("a file");
    drop(rdh_study::study::log::read::<rdh_study::study::Record>(&path));
}

/// Opens a saved tree, or what was made of one; what is opened can be used.
pub fn saved(data: &[u8]) {
    saved::open(data);
}

/// Cuts a triangle: both parts' boxes must hold the points of the triangle on their side, computed in f64.
pub fn clip(data: &[u8]) {
    let mut bits = Bits::new(data);
    let corners = [0; 3].map(|_| [0; 3].map(|_| bits.scaled()));
    let axis = rdh::Axis::ALL[bits.below(3)];
    let (plane, a) = (bits.scaled(), axis.index());
    let (left, right) = rdh::fuzzing::split_triangle(&corners, axis, plane);
    for _ in 0..16 {
        let (u, v) = (f64::from(bits.byte()) / 512.0, f64::from(bits.byte()) / 512.0);
        let at = |i: usize| {
            let [p, q, r] = corners.map(|c| f64::from(c[i]));
            (1.0 - u - v) * p + u * q + v * r
        };
        let point = [at(0), at(1), at(2)];
        let part = if point[a] <= f64::from(plane) { left } else { right };
        for i in 0..3 {
            let room = corners.iter().fold(0.0f64, |most, c| most.max(f64::from(c[i]).abs())) * 1e-14;
            assert!(
                point[i] >= f64::from(part.min[i]) - room && point[i] <= f64::from(part.max[i]) + room,
                "{point:?}"
            );
        }
    }
}

/// Builds a structure over any bits, and casts any rays: as brute force does.
pub fn trace(data: &[u8]) {
    const SPECS: [&str; 12] = [
        "kd+sah",
        "kd(leaf=1,split=exact)+sah",
        "kd+rdh",
        "bvh8+sah",
        "bvh8(high)+sah",
        "bvh4(quick)+sah",
        "sbvh8+sah",
        "bvh8+rdh",
        "bvh2(split=sweep)+sah",
        "bvh8(from=kd)+sah",
        "bvh8(compact)+sah",
        "sbvh8(high)+rdh(rays=whole)",
    ];
    let mut bits = Bits::new(data);
    let spec: Spec = SPECS[bits.below(SPECS.len())].parse().expect("a spec");
    let vertices = 3 + bits.below(61);
    let positions = (0..vertices).map(|_| [0; 3].map(|_| bits.float())).collect();
    let triangles = (0..1 + bits.below(64)).map(|_| [0; 3].map(|_| bits.below(vertices) as u32)).collect();
    let (mesh, _) = Mesh::sanitised(positions, triangles).expect("few triangles");
    let rays: Vec<_> = (0..16).map(|_| bits.ray(&mesh)).collect();
    let sample = |&ray| RaySample::new(ray, naive::closest(&mesh, &ray), Query::Closest, RayClass::Other);
    let training = Training::from_samples(rays.iter().map(sample).collect());
    let accel = match rdh::build(&mesh, &spec, &training, &BuildOptions::default()) {
        Ok(accel) => accel,
        Err(rdh::Error::NoRays { .. }) => return,
        Err(error) => panic!("{spec}: {error}"),
    };
    assert!(accel.check(&mesh).is_empty(), "{spec}: {:?}", accel.check(&mesh).first());
    let mut hits = Vec::new();
    for ray in &rays {
        assert_eq!(accel.closest(ray), naive::closest(&mesh, ray), "{spec}, {ray:?}");
        assert_eq!(accel.occluded(ray), naive::occluded(&mesh, ray), "{spec}, {ray:?}");
        accel.all_hits(ray, &mut hits);
        assert_eq!(hits, naive::all_hits(&mesh, ray), "{spec}, {ray:?}");
    }
}

/// Builds a hierarchy for double precision, and casts any rays: as brute force in f64 does.
pub fn precise(data: &[u8]) {
    const SPECS: [&str; 5] = ["bvh8+sah", "bvh4+sah", "sbvh8+sah", "bvh8(from=kd)+sah", "bvh8(compact)+sah"];
    let mut bits = Bits::new(data);
    let spec: Spec = SPECS[bits.below(SPECS.len())].parse().expect("a spec");
    let vertices = 3 + bits.below(61);
    // In a map's coordinates as often as anywhere.
    let middle = [0.0, 5_334_784.25][bits.below(2)];
    let positions = (0..vertices).map(|_| [0; 3].map(|_| middle + bits.double())).collect();
    let triangles = (0..1 + bits.below(64)).map(|_| [0; 3].map(|_| bits.below(vertices) as u32)).collect();
    let mesh = MeshF64::new(positions, triangles).expect("finite vertices, indices in range");
    let accel = AccelF64::build(&mesh, &spec, &Training::none(), &BuildOptions::default()).expect("it builds");
    let mut hits = Vec::new();
    for _ in 0..16 {
        let ray = bits.ray_f64(&mesh);
        assert_eq!(accel.closest(&ray), precise::naive::closest(&mesh, &ray), "{spec}, {ray:?}");
        assert_eq!(accel.occluded(&ray), precise::naive::occluded(&mesh, &ray), "{spec}, {ray:?}");
        accel.all_hits(&ray, &mut hits);
        assert_eq!(hits, precise::naive::all_hits(&mesh, &ray), "{spec}, {ray:?}");
    }
}

/// What stands before a word, and what stands behind it.
fn split_at<'a>(data: &'a [u8], word: &[u8]) -> (&'a [u8], Option<&'a [u8]>) {
    match data.windows(word.len()).position(|w| w == word) {
        Some(at) => (&data[..at], Some(&data[at + word.len()..])),
        None => (data, None),
    }
}
