//! A saved structure, read and cast through: `cargo run --release -p rdh --example load -- TREE.rdh`; without a file it makes one.

use std::fs;

use rdh::{Accel, BuildOptions, Mesh, Ray, Training, build};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let made = std::env::temp_dir().join(format!("rdh-example-{}.rdh", std::process::id()));
    let file = std::env::args_os().nth(1).filter(|file| file.to_string_lossy().ends_with(".rdh"));
    if file.is_none() {
        let mesh = Mesh::new(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]], vec![[0, 1, 2]])?;
        let accel = build(&mesh, &"bvh8+sah".parse()?, &Training::none(), &BuildOptions::default())?;
        fs::write(&made, accel.to_bytes()?)?;
    }

    // The library reads bytes. All of them are checked first; a file that was cut off or altered is an error that says where.
    // `rdh_scene::saved::open` maps a file instead, and `Accel::from_shared` uses whatever bytes you have where they lie.
    let accel = Accel::from_bytes(&fs::read(file.as_deref().unwrap_or(made.as_os_str()))?)?;
    let (stats, bounds) = (accel.stats(), accel.bounds());
    println!("{} over {} triangles, {} nodes", stats.spec, stats.triangles, stats.nodes);

    let ray = Ray::new(bounds.min.map(|x| x - 1.0), bounds.extent().map(|x| x * 0.5 + 1.0));
    println!("from below its corner to its middle: {:?}", accel.closest(&ray));
    if file.is_none() {
        fs::remove_file(&made)?;
    }
    Ok(())
}
