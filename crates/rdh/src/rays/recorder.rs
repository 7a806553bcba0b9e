//! placeholder
use super::{Profile, Query, RayClass};
use crate::geom::{Hit, Ray};
/// recorder
pub struct Recorder {}
impl Recorder {
    /// new
    pub fn new(_capacity: usize, _seed: u64) -> Self {
        Self {}
    }
    /// record
    pub fn record(&self, _ray: &Ray, _hit: Option<Hit>, _query: Query, _class: RayClass) {}
    /// into
    pub fn into_profile(self) -> Profile {
        Profile::default()
    }
}
