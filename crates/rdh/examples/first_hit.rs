//! The first thing that a ray meets: `cargo run --release -p rdh --example first_hit`.

use rdh::{BuildOptions, Mesh, Ray, Training, build};

pub(crate) fn main() -> rdh::Result<()> {
    // A pyramid over the unit square, open below.
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
    let mesh = Mesh::new(positions, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])?;
    let accel = build(&mesh, &"bvh8+sah".parse()?, &Training::none(), &BuildOptions::default())?;

    let ray = Ray::new([0.5, -2.0, 0.25], [0.0, 1.0, 0.0]);
    let hit = accel.closest(&ray).expect("the ray goes through the pyramid");
    println!("triangle {} at {:?}, {} times the direction away", hit.tri.0, ray.at(hit.t), hit.t);
    assert_eq!((hit.tri.0, hit.t), (0, 2.125));

    // Whether anything is in the way takes less: a shadow ray that ends before the pyramid.
    assert!(accel.occluded(&ray) && !accel.occluded(&ray.within(0.0, 2.0)));
    Ok(())
}
