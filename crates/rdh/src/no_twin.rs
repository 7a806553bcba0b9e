//! There is no leaky twin for this machine.

use crate::accel::Accel;
use crate::geom::{Hit, Ray};

/// What lets rays slip through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leak {
    /// Box planes without slack.
    Boxes,
    /// Triangles by Möller and Trumbore in f32.
    Triangles,
    /// Both.
    Both,
}

/// A hierarchy whose answers may be wrong: there is none.
#[derive(Debug, Clone)]
pub enum Twin {}

impl Twin {
    /// Nothing.
    pub fn of(_accel: &Accel, _leak: Leak) -> Option<Self> {
        None
    }

    /// The nearest hit, or nearly so.
    pub fn closest(&self, _ray: &Ray) -> Option<Hit> {
        match *self {}
    }

    /// Whether anything is hit, or nearly so.
    pub fn occluded(&self, _ray: &Ray) -> bool {
        match *self {}
    }
}
