//! Upholstery.

use crate::generate::shape::{Shape, block};

/// A sofa of some seats, each 0.7 m wide, that faces -y.
pub(crate) fn sofa(seats: u32, r: u32) -> Shape {
    let half = 0.35 * f64::from(seats);
    let mut shape = Shape::default();
    shape.block([-half, -0.4, 0.1], [half, 0.42, 0.26]);
    for i in 0..seats {
        let x = 0.7 * f64::from(i) - half;
        shape.pillow([x + 0.005, -0.44, 0.24], [x + 0.695, 0.24, 0.46], 2 * r);
        shape.pillow([x + 0.01, 0.16, 0.42], [x + 0.69, 0.4, 0.86], 2 * r);
    }
    for x in [-half - 0.1, half + 0.1] {
        shape.pillow([x - 0.12, -0.44, 0.06], [x + 0.12, 0.45, 0.62], 2 * r);
    }
    shape.pillow([-half, 0.32, 0.1], [half, 0.48, 0.8], 2 * r);
    for (x, y) in [(-half, -0.35), (half, -0.35), (half, 0.35), (-half, 0.35)] {
        shape.rod([x, y, 0.0], [x, y, 0.12], 0.025, r);
    }
    shape
}

/// A sofa for one.
pub(crate) fn armchair(r: u32) -> Shape {
    sofa(1, r)
}

/// A double bed's frame, 1.7 m by 2.1 m, its head at +y.
pub(crate) fn bed(r: u32) -> Shape {
    let mut shape = block([-0.85, -1.05, 0.15], [0.85, 1.0, 0.32]);
    shape.block([-0.88, 0.99, 0.0], [0.88, 1.05, 1.0]);
    shape.rod([-0.9, 1.02, 1.0], [0.9, 1.02, 1.0], 0.04, r);
    for (x, y) in [(-0.78, -0.98), (0.78, -0.98)] {
        shape.rod([x, y, 0.0], [x, y, 0.15], 0.03, r);
    }
    shape
}

/// What lies on it: mattress, two pillows and a folded blanket.
pub(crate) fn bedding(r: u32) -> Shape {
    let mut shape = Shape::default();
    shape.pillow([-0.82, -1.03, 0.3], [0.82, 0.98, 0.52], 3 * r);
    for x in [-0.4, 0.4] {
        shape.pillow([x - 0.33, 0.52, 0.48], [x + 0.33, 0.95, 0.66], 2 * r);
    }
    shape.pillow([-0.86, -1.06, 0.44], [0.86, -0.1, 0.58], 3 * r);
    shape
}
