//! Millimetres in a map's coordinates: `cargo run --release -p rdh --example far_from_home`.

use rdh::precise::{AccelF64, MeshF64, RayF64};
use rdh::{BuildOptions, Training};

pub(crate) fn main() -> rdh::Result<()> {
    // Two steps of a kerb, in metres of a zone of the Universal Transverse Mercator grid; f32 knows half metres there.
    let (east, north) = (691_608.0, 5_334_784.0);
    let step = |up: f64| [[east, north, up], [east + 2.0, north, up], [east, north + 2.0, up]];
    let positions = [519.000, 519.003].into_iter().flat_map(step).collect();
    let mesh = MeshF64::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
    let accel = AccelF64::build(&mesh, &"bvh8+sah".parse()?, &Training::none(), &BuildOptions::default())?;

    // From an aeroplane, straight down.
    let ray = RayF64::new([east + 0.5, north + 0.5, 3519.0], [0.0, 0.0, -1.0]);
    let mut hits = Vec::new();
    accel.all_hits(&ray, &mut hits);
    println!("the upper step is {:.4} m below, the lower one {:.4} m", hits[0].t, hits[1].t);
    assert!((hits[1].t - hits[0].t - 0.003).abs() < 1e-9);
    Ok(())
}
