//! Lamps, crockery, and what else lies and hangs about.

use crate::generate::place::stand;
use crate::generate::round::{lathe, torus};
use crate::generate::shape::{Shape, block};
use crate::scene::Transform;

/// A lamp that hangs from z = 0: rod, hood and bulb, down to -0.42.
pub(crate) fn ceiling_lamp(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.rod([0.0, 0.0, -0.2], [0.0, 0.0, -0.001], 0.01, r);
    let hood = [[0.03, -0.2], [0.2, -0.38], [0.21, -0.38], [0.03, -0.18], [0.0, -0.18]];
    shape.turned(&hood, [0.0; 3], 2 * r);
    shape.ball([0.0, 0.0, -0.27], 0.06, 2 * r);
    shape
}

/// A lamp as tall as a person.
pub(crate) fn floor_lamp(r: u32) -> Shape {
    let base = [[0.0, 0.0], [0.16, 0.0], [0.15, 0.02], [0.02, 0.04], [0.012, 0.08], [0.012, 1.5], [0.0, 1.5]];
    shaded(&base, 1.4, 0.2, 0.3, r)
}

/// A lamp for desks and bedsides.
pub(crate) fn table_lamp(r: u32) -> Shape {
    let base = [[0.0, 0.0], [0.07, 0.0], [0.075, 0.03], [0.04, 0.12], [0.055, 0.18], [0.01, 0.24], [0.0, 0.34]];
    shaded(&base, 0.27, 0.13, 0.17, r)
}

/// A turned base with a shade that is open above and below, and a bulb.
fn shaded(base: &[[f64; 2]], z: f64, radius: f64, height: f64, r: u32) -> Shape {
    let top = 0.65 * radius;
    let shade =
        [[top - 0.005, z + height], [radius - 0.005, z], [radius, z], [top, z + height], [top - 0.005, z + height]];
    let mut shape = lathe(base, 2 * r);
    shape.turned(&shade, [0.0; 3], 2 * r);
    shape.ball([0.0, 0.0, z + height * 0.6], 0.2 * height, r);
    shape
}

/// A flat plate.
pub(crate) fn plate(r: u32) -> Shape {
    let profile = [
        [0.0, 0.0],
        [0.07, 0.0],
        [0.09, 0.012],
        [0.13, 0.02],
        [0.13, 0.024],
        [0.085, 0.018],
        [0.065, 0.006],
        [0.0, 0.006],
    ];
    lathe(&profile, 2 * r)
}

/// A bowl.
pub(crate) fn bowl(r: u32) -> Shape {
    let profile = [
        [0.0, 0.0],
        [0.05, 0.0],
        [0.05, 0.01],
        [0.1, 0.05],
        [0.125, 0.1],
        [0.12, 0.1],
        [0.09, 0.05],
        [0.04, 0.018],
        [0.0, 0.018],
    ];
    lathe(&profile, 2 * r)
}

/// A cup with an ear towards +x.
pub(crate) fn cup(r: u32) -> Shape {
    let profile = [[0.0, 0.0], [0.03, 0.0], [0.038, 0.02], [0.04, 0.09], [0.036, 0.09], [0.034, 0.02], [0.0, 0.012]];
    let ear = stand([0.045, 0.0, 0.05], 0.0).after(&crate::generate::place::turn([1.0, 0.0, 0.0], 90.0));
    lathe(&profile, 2 * r).with(&torus(0.022, 0.005, r), &ear)
}

/// A vase.
pub(crate) fn vase(r: u32) -> Shape {
    let profile = [
        [0.0, 0.0],
        [0.05, 0.0],
        [0.09, 0.08],
        [0.1, 0.15],
        [0.07, 0.24],
        [0.035, 0.3],
        [0.05, 0.35],
        [0.044, 0.35],
        [0.028, 0.3],
        [0.062, 0.24],
        [0.09, 0.15],
        [0.08, 0.08],
        [0.0, 0.02],
    ];
    lathe(&profile, 2 * r)
}

/// A waste-paper bin.
pub(crate) fn bin(r: u32) -> Shape {
    lathe(&[[0.0, 0.0], [0.11, 0.0], [0.15, 0.32], [0.14, 0.32], [0.1, 0.01], [0.0, 0.01]], 2 * r)
}

/// A flat screen on a foot; its face looks to -y.
pub(crate) fn monitor(r: u32) -> Shape {
    let mut shape = block([-0.3, -0.015, 0.14], [0.3, 0.02, 0.5]);
    shape.block([-0.29, -0.02, 0.15], [0.29, -0.015, 0.49]);
    shape.rod([0.0, 0.05, 0.01], [0.0, 0.03, 0.25], 0.02, r);
    shape.turned(&[[0.0, 0.0], [0.12, 0.0], [0.11, 0.012], [0.0, 0.012]], [0.0, 0.05, 0.0], 2 * r);
    shape
}

/// A keyboard with its keys.
pub(crate) fn keyboard() -> Shape {
    let mut shape = block([-0.22, -0.075, 0.0], [0.22, 0.075, 0.012]);
    for (row, column) in (0..5).flat_map(|row| (0..15).map(move |column| (row, column))) {
        let [x, y] = [0.0285 * f64::from(column) - 0.213, 0.028 * f64::from(row) - 0.069];
        shape.block([x, y, 0.012], [x + 0.025, y + 0.024, 0.02]);
    }
    shape
}

/// A radiator for under a window, 1.4 m wide; its back is at y = 0.
pub(crate) fn radiator(r: u32) -> Shape {
    let mut shape = Shape::default();
    for i in 0..14 {
        let x = 0.1 * f64::from(i) - 0.65;
        shape.pillow([x - 0.04, -0.12, 0.12], [x + 0.04, -0.03, 0.72], r);
    }
    shape.rod([-0.7, -0.075, 0.18], [0.7, -0.075, 0.18], 0.02, r);
    shape.rod([-0.7, -0.075, 0.66], [0.7, -0.075, 0.66], 0.02, r);
    for x in [-0.6, 0.6] {
        shape.block([x - 0.02, -0.1, 0.0], [x + 0.02, -0.05, 0.2]);
    }
    shape
}

/// A blind of tilted slats that hangs from z = 0 by `drop`, `width` wide.
pub(crate) fn blind(width: f64, drop: f64, slats: u32) -> Shape {
    let mut shape = block([-width / 2.0, -0.025, -0.04], [width / 2.0, 0.025, -0.001]);
    for i in 1..=slats {
        let z = -0.04 - (drop - 0.04) * f64::from(i) / f64::from(slats);
        let tilt = Transform::translation([0.0, 0.0, z]).after(&crate::generate::place::turn([1.0, 0.0, 0.0], 30.0));
        shape.append(&block([-width / 2.0, -0.02, -0.001], [width / 2.0, 0.02, 0.001]), &tilt);
    }
    shape
}

/// A framed picture, centred; its back is at y = 0.
pub(crate) fn picture(width: f64, height: f64) -> Shape {
    let (x, z) = (width / 2.0, height / 2.0);
    let mut shape = block([-x, -0.012, -z], [x, -0.002, z]);
    shape.block([-x - 0.03, -0.03, -z - 0.03], [x + 0.03, 0.0, -z]);
    shape.block([-x - 0.03, -0.03, z], [x + 0.03, 0.0, z + 0.03]);
    shape.block([-x - 0.03, -0.03, -z], [-x, 0.0, z]);
    shape.block([x, -0.03, -z], [x + 0.03, 0.0, z]);
    shape
}
