//! Named views and the pinhole camera behind them.

use rdh::Ray;

/// Who looks where.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct View {
    /// Its name within the scene.
    pub name: String,
    /// The eye, in world coordinates.
    pub eye: [f64; 3],
    /// The point in the middle of the picture, in world coordinates.
    pub target: [f64; 3],
    /// Which direction is up in the picture.
    pub up: [f64; 3],
    /// Full vertical angle of view.
    pub fov_y_degrees: f64,
}

/// A pinhole camera; its rays start at the eye, with directions of length 1 before rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: [f32; 3],
    forward: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
}

impl Camera {
    /// The camera of a view of a scene whose positions are relative to `origin`; `aspect` is width over height.
    pub fn new(view: &View, origin: [f64; 3], aspect: f64) -> Self {
        let forward = unit(sub(view.target, view.eye));
        let mut right = cross(forward, view.up);
        if dot(right, right) < 1e-12 {
            // Looking along `up`: any right will do.
            let other = if forward[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            right = cross(forward, other);
        }
        let right = unit(right);
        let up = cross(right, forward);
        let half = (view.fov_y_degrees.to_radians() * 0.5).tan();
        Self {
            eye: sub(view.eye, origin).map(|x| x as f32),
            forward,
            right: right.map(|x| x * half * aspect),
            up: up.map(|x| x * half),
        }
    }

    /// The eye, relative to the scene's origin.
    pub fn eye(&self) -> [f32; 3] {
        self.eye
    }

    /// The ray through a film position: (0, 0) is the picture's upper left corner, (1, 1) its lower right one.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let (sx, sy) = (2.0 * x - 1.0, 1.0 - 2.0 * y);
        let d = [0, 1, 2].map(|a| self.forward[a] + sx * self.right[a] + sy * self.up[a]);
        Ray::new(self.eye, unit(d).map(|x| x as f32))
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
