//! There is no leaky twin for this machine.

use crate::accel::Accel;
use crate::geom::{Hit, Ray};

/// A hierarchy whose answers may be wrong: there is none.
#[derive(Debug, Clone)]
pub enum Twin {}

impl Twin {
    /// Nothing.
    pub fn of(_accel: &Accel) -> Option<Self> {
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
