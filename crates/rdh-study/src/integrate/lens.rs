//! From film positions to rays: the pinhole camera, and the spinning scanner.

use rdh::{Ray, Vec3};
use rdh_scene::{Camera, View};

use super::lidar::{LIDAR_BEAMS, LIDAR_FIELD_DEGREES};
use super::mode::Mode;
use super::stage::Stage;
use super::vector::{V3, add, cross, dot, narrow, scale, sub, unit};

/// What turns a film position into the ray that starts there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens(Kind);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Camera(Camera),
    Scanner { eye: Vec3, forward: V3, right: V3, up: V3 },
}

impl Lens {
    /// The lens of a mode at a view; `aspect` is the picture's width over its height.
    pub fn new(stage: &Stage, mode: Mode, view: &View, aspect: f64) -> Self {
        let camera = Camera::new(view, stage.origin(), aspect);
        if mode != Mode::Lidar {
            return Self(Kind::Camera(camera));
        }
        // The axis is the scene's up, whatever the view is tilted by; a turn begins where the view looks.
        let up = stage.up();
        let level = |v: V3| unit(sub(v, scale(up, dot(v, up))));
        let look = sub(view.target, view.eye);
        let forward = level(look).or_else(|| level([1.0, 0.6, 0.3])).or_else(|| level([0.0, 1.0, 0.0])).unwrap_or(up);
        let right = cross(forward, up);
        Self(Kind::Scanner { eye: camera.eye(), forward, right, up })
    }

    /// The ray through a film position: (0, 0) is the upper left corner. A scanner's `x` chooses the beam, top to bottom,
    /// and `y` is the part of the turn, clockwise from above: so the film's rows are firings.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        match &self.0 {
            Kind::Camera(camera) => camera.ray(x, y),
            Kind::Scanner { eye, forward, right, up } => {
                let beam = (x * LIDAR_BEAMS as f64).floor().clamp(0.0, LIDAR_BEAMS as f64 - 1.0);
                let elevation = (0.5 - (beam + 0.5) / LIDAR_BEAMS as f64) * LIDAR_FIELD_DEGREES.to_radians();
                let (sin, cos) = (y * std::f64::consts::TAU).sin_cos();
                let level = add(scale(*forward, cos), scale(*right, sin));
                let direction = add(scale(level, elevation.cos()), scale(*up, elevation.sin()));
                Ray::new(*eye, narrow(direction))
            }
        }
    }
}
