//! What an application really casts: recorded, sampled, split into sets that cannot be mixed up.

mod bottom;
mod drift;
mod file;
mod hash;
mod profile;
mod recorder;
mod sets;
mod slots;
mod summary;

pub use drift::Drift;
pub use profile::Profile;
pub use recorder::Recorder;
pub use sets::{HeldOut, Training, Unseen};
pub use summary::{Group, Summary};

use serde::{Deserialize, Serialize};

use crate::geom::{Hit, Ray};

/// What is asked of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Query {
    /// The nearest hit.
    Closest = 0,
    /// Whether anything is hit.
    Occluded = 1,
    /// All hits.
    All = 2,
}

/// What a ray is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum RayClass {
    /// From the camera.
    Primary = 0,
    /// Towards a light.
    Shadow = 1,
    /// Mirrored.
    Reflection = 2,
    /// Bent through glass.
    Refraction = 3,
    /// Diffusely scattered.
    Bounce = 4,
    /// Ambient occlusion: short, any hit.
    Ao = 5,
    /// From a scanner.
    Lidar = 6,
    /// Anything else.
    Other = 7,
}

impl Query {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::Closest, Self::Occluded, Self::All];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Occluded => "occluded",
            Self::All => "all",
        }
    }
}

impl RayClass {
    /// All of them, in order.
    pub const ALL: [Self; 8] = [
        Self::Primary,
        Self::Shadow,
        Self::Reflection,
        Self::Refraction,
        Self::Bounce,
        Self::Ao,
        Self::Lidar,
        Self::Other,
    ];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Reflection => "reflection",
            Self::Refraction => "refraction",
            Self::Bounce => "bounce",
            Self::Ao => "ao",
            Self::Lidar => "lidar",
            Self::Other => "other",
        }
    }
}

/// One sampled ray of a profile: the ray, how it ended, and how many like it there were.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaySample {
    /// The ray as it was cast.
    pub ray: Ray,
    /// Where it ended: the distance of its hit, if it had one.
    pub t_hit: Option<f32>,
    /// What was asked.
    pub query: Query,
    /// What it was for.
    pub class: RayClass,
    /// How many rays it stands for, at least 1.
    pub weight: u32,
}

impl RaySample {
    /// A sample of weight 1.
    pub fn new(ray: Ray, hit: Option<Hit>, query: Query, class: RayClass) -> Self {
        Self { ray, t_hit: hit.map(|h| h.t), query, class, weight: 1 }
    }

    /// The last `t` at which the query looked: its hit, else the ray's own end. A query for all hits looks everywhere.
    pub fn t_end(&self) -> f32 {
        match (self.query, self.t_hit) {
            (Query::Closest | Query::Occluded, Some(t)) => t.min(self.ray.t_max),
            _ => self.ray.t_max,
        }
    }

    /// Why it can't be used, if so: what comes from outside may hold anything.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        match self.t_hit {
            _ if !self.ray.is_valid() => {
                Some("the ray has a NaN, an infinite origin or direction, no direction or t_min > t_max")
            }
            Some(t) if !t.is_finite() => Some("the distance of the hit is not finite"),
            _ => None,
        }
    }

    /// Everything that tells rays apart: its bits, what was asked, and what it was for.
    pub(crate) fn identity(&self) -> [u32; 10] {
        let r: [u32; 9] = bytemuck::cast(self.ray);
        let tag = (self.query as u32) << 8 | self.class as u32;
        [r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], tag]
    }
}
