//! Hard furniture.

use crate::generate::round::lathe;
use crate::generate::shape::{Shape, block};

/// A table with a top of `width` by `depth` at 0.74 m on four round legs.
pub(crate) fn table(width: f64, depth: f64, r: u32) -> Shape {
    let (x, y) = (width / 2.0, depth / 2.0);
    let mut shape = block([-x, -y, 0.7], [x, y, 0.74]);
    shape.block([0.1 - x, 0.1 - y, 0.62], [x - 0.1, y - 0.1, 0.7]);
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let [lx, ly] = [sx * (x - 0.07), sy * (y - 0.07)];
        shape.rod([lx, ly, 0.0], [lx, ly, 0.7], 0.03, r);
    }
    shape
}

/// A round table of 0.74 m height: foot, stem and top turned as one.
pub(crate) fn round_table(radius: f64, r: u32) -> Shape {
    let profile = [
        [0.0, 0.0],
        [0.4 * radius, 0.0],
        [0.38 * radius, 0.03],
        [0.07, 0.06],
        [0.05, 0.3],
        [0.05, 0.64],
        [0.12, 0.7],
        [radius - 0.02, 0.7],
        [radius, 0.72],
        [radius - 0.02, 0.74],
        [0.0, 0.74],
    ];
    lathe(&profile, 2 * r)
}

/// A desk with drawers on its right; one sits at its -y side.
pub(crate) fn desk(r: u32) -> Shape {
    let mut shape = block([-0.8, -0.4, 0.7], [0.8, 0.4, 0.73]);
    shape.block([-0.78, -0.38, 0.0], [-0.75, 0.38, 0.7]);
    shape.block([0.35, -0.36, 0.02], [0.76, 0.36, 0.7]);
    shape.block([-0.75, 0.33, 0.25], [0.35, 0.36, 0.7]);
    for z in [0.05, 0.27, 0.49] {
        shape.block([0.37, -0.38, z], [0.74, -0.36, z + 0.2]);
        shape.rod([0.48, -0.4, z + 0.1], [0.62, -0.4, z + 0.1], 0.012, r);
    }
    shape
}

/// A wooden chair that faces -y.
pub(crate) fn chair(r: u32) -> Shape {
    let mut shape = block([-0.22, -0.22, 0.43], [0.22, 0.2, 0.46]);
    for x in [-0.18, 0.18] {
        shape.rod([x, -0.19, 0.0], [x, -0.19, 0.43], 0.02, r);
        shape.rod([x, 0.17, 0.0], [x, 0.17, 0.46], 0.02, r);
        shape.rod([x, 0.17, 0.46], [x, 0.26, 0.95], 0.018, r);
    }
    for z in [0.58, 0.71, 0.84] {
        let y = 0.17 + 0.09 * (z - 0.43) / 0.49;
        shape.block([-0.18, y - 0.01, z], [0.18, y + 0.01, z + 0.07]);
    }
    shape.rod([-0.18, -0.19, 0.22], [0.18, -0.19, 0.22], 0.012, r);
    shape
}

/// A swivel chair that faces -y: five castors, a stem, soft seat and back, arm rests.
pub(crate) fn office_chair(r: u32) -> Shape {
    let mut shape = Shape::default();
    for i in 0..5 {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 5.0).sin_cos();
        shape.rod([0.0, 0.0, 0.1], [0.28 * cos, 0.28 * sin, 0.07], 0.02, r);
        shape.ball([0.28 * cos, 0.28 * sin, 0.03], 0.03, r);
    }
    shape.rod([0.0, 0.0, 0.08], [0.0, 0.0, 0.43], 0.03, r);
    shape.pillow([-0.24, -0.24, 0.42], [0.24, 0.24, 0.5], 2 * r);
    shape.pillow([-0.22, 0.2, 0.55], [0.22, 0.28, 1.05], 2 * r);
    shape.rod([0.0, 0.2, 0.46], [0.0, 0.26, 0.7], 0.02, r);
    for x in [-0.27, 0.27] {
        shape.rod([x * 0.8, 0.0, 0.46], [x, 0.0, 0.66], 0.015, r);
        shape.pillow([x - 0.03, -0.13, 0.66], [x + 0.03, 0.13, 0.69], r);
    }
    shape
}

/// A wardrobe of two doors, 1.6 m wide, 2.1 m high and 0.6 m deep.
pub(crate) fn wardrobe(r: u32) -> Shape {
    let mut shape = block([-0.8, -0.27, 0.0], [0.8, 0.3, 2.1]);
    shape.block([-0.79, -0.3, 0.08], [-0.005, -0.27, 2.08]);
    shape.block([0.005, -0.3, 0.08], [0.79, -0.27, 2.08]);
    for x in [-0.05, 0.05] {
        shape.ball([x, -0.32, 1.05], 0.02, r);
    }
    shape
}

/// A kitchen counter of some 0.6 m units with a sink in the first, and wall cupboards above.
pub(crate) fn counter(units: u32, r: u32) -> Shape {
    let width = 0.6 * f64::from(units);
    let mut shape = block([0.0, -0.24, 0.08], [width, 0.3, 0.86]);
    shape.block([0.0, -0.2, 0.0], [width, 0.3, 0.08]);
    shape.block([-0.01, -0.3, 0.86], [width + 0.01, 0.3, 0.9]);
    shape.block([0.0, 0.0, 1.45], [width, 0.3, 2.15]);
    for i in 0..units {
        let x = 0.6 * f64::from(i);
        shape.block([x + 0.01, -0.26, 0.1], [x + 0.59, -0.24, 0.84]);
        shape.rod([x + 0.2, -0.285, 0.76], [x + 0.4, -0.285, 0.76], 0.01, r);
        shape.block([x + 0.01, -0.02, 1.46], [x + 0.59, 0.0, 2.14]);
        shape.rod([x + 0.5, -0.035, 1.55], [x + 0.5, -0.035, 1.7], 0.01, r);
    }
    let rim = [[0.0, 0.0], [0.18, 0.0], [0.2, 0.01], [0.19, 0.02], [0.16, 0.005], [0.0, 0.003]];
    shape.turned(&rim, [0.3, -0.02, 0.9], 2 * r);
    shape.rod([0.3, 0.2, 0.9], [0.3, 0.2, 1.15], 0.015, r);
    shape.rod([0.3, 0.2, 1.15], [0.3, 0.02, 1.12], 0.012, r);
    shape
}

/// A fridge.
pub(crate) fn fridge(r: u32) -> Shape {
    let mut shape = block([-0.3, -0.27, 0.04], [0.3, 0.3, 1.85]);
    shape.block([-0.29, -0.31, 0.06], [0.29, -0.27, 0.6]);
    shape.block([-0.29, -0.31, 0.62], [0.29, -0.27, 1.84]);
    shape.rod([0.24, -0.34, 0.8], [0.24, -0.34, 1.3], 0.015, r);
    for (x, y) in [(-0.25, -0.2), (0.25, -0.2), (0.25, 0.25), (-0.25, 0.25)] {
        shape.rod([x, y, 0.0], [x, y, 0.04], 0.02, r);
    }
    shape
}
