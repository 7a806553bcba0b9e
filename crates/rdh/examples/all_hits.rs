//! Everything along a ray, in order, and how thick it is: `cargo run --release -p rdh --example all_hits`.

use rdh::{BuildOptions, Mesh, Ray, Training, build};

pub(crate) fn main() -> rdh::Result<()> {
    // Three cubes in a row, each closed: eight corners, six faces of two triangles.
    let corner = |cube: u32, i: u32| [(2 * cube + (i & 1)) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32];
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let positions = (0..3).flat_map(|cube| (0..8).map(move |i| corner(cube, i))).collect();
    let halves = |cube: u32| {
        faces.into_iter().flat_map(move |[a, b, c, d]| [[a, b, c], [a, c, d]].map(|t| t.map(|i| 8 * cube + i)))
    };
    let mesh = Mesh::new(positions, (0..3).flat_map(halves).collect())?;
    let accel = build(&mesh, &"kd+sah".parse()?, &Training::none(), &BuildOptions::default())?;

    // Through the diagonals of the faces, which two triangles share: each crossing counts once, so their number is even.
    let ray = Ray::new([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
    let mut hits = Vec::new();
    accel.all_hits(&ray, &mut hits);
    let inside: f32 = hits.chunks(2).map(|pair| pair[1].t - pair[0].t).sum();
    println!("{} crossings, {inside} units inside", hits.len());
    assert_eq!((hits.len(), inside), (6, 3.0));
    Ok(())
}
