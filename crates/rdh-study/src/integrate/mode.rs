//! The modes by name.

use std::fmt;
use std::str::FromStr;

use rdh::{Ray, RayClass};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::caster::Caster;
use super::random::Random;
use super::stage::Stage;
use super::{ao, lidar, path, primary, whitted};
use crate::error::{Error, Result};

/// Which rays a study casts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Mode {
    /// Primary rays alone; also named `casting`, after the paper's ray casting.
    Primary,
    /// Primary, shadow, reflected and refracted rays to depth 5; also named `tracing`, after the paper's ray tracing.
    Whitted,
    /// Diffuse paths of 4 bounces with next-event shadow rays, no roulette.
    Path,
    /// 4 short any-hit rays at each primary hit.
    Ao,
    /// A spinning scanner of 64 × 2048 rays at the view's eye.
    Lidar,
}

impl Mode {
    /// All of them, in order.
    pub const ALL: [Self; 5] = [Self::Primary, Self::Whitted, Self::Path, Self::Ao, Self::Lidar];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Whitted => "whitted",
            Self::Path => "path",
            Self::Ao => "ao",
            Self::Lidar => "lidar",
        }
    }

    /// The classes of its rays, in the order of their batches.
    pub fn classes(self) -> &'static [RayClass] {
        match self {
            Self::Primary => &[RayClass::Primary],
            Self::Whitted => &[RayClass::Primary, RayClass::Shadow, RayClass::Reflection, RayClass::Refraction],
            Self::Path => &[RayClass::Primary, RayClass::Shadow, RayClass::Bounce],
            Self::Ao => &[RayClass::Primary, RayClass::Ao],
            Self::Lidar => &[RayClass::Lidar],
        }
    }

    /// Columns and rows of its film: one test ray each.
    pub fn film(self, size: [usize; 2]) -> [usize; 2] {
        if self == Self::Lidar { [lidar::LIDAR_BEAMS, lidar::LIDAR_AZIMUTHS] } else { size }
    }

    /// Follows the path that starts with `ray`; returns the light that comes back along it, about 0 to 1.
    pub(crate) fn trace(self, stage: &Stage, ray: &Ray, random: &mut Random, caster: &mut impl Caster) -> f64 {
        match self {
            Self::Primary => primary::trace(stage, ray, caster),
            Self::Whitted => whitted::trace(stage, ray, caster),
            Self::Path => path::trace(stage, ray, random, caster),
            Self::Ao => ao::trace(stage, ray, random, caster),
            Self::Lidar => lidar::trace(stage, ray, caster),
        }
    }
}

impl FromStr for Mode {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        match name {
            "casting" => return Ok(Self::Primary),
            "tracing" => return Ok(Self::Whitted),
            _ => {}
        }
        let known = "primary (casting), whitted (tracing), path, ao, lidar";
        let unknown = || Error::UnknownName { what: "mode", name: name.to_owned(), known };
        Self::ALL.into_iter().find(|m| m.name() == name).ok_or_else(unknown)
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Mode {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Mode {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        String::deserialize(d)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_the_papers_names_are_accepted() {
        for mode in Mode::ALL {
            assert_eq!(mode.name().parse::<Mode>().unwrap(), mode);
        }
        assert_eq!("casting".parse::<Mode>().unwrap(), Mode::Primary);
        assert_eq!("tracing".parse::<Mode>().unwrap(), Mode::Whitted);
        let error = "photon".parse::<Mode>().unwrap_err().to_string();
        assert!(error.contains("'photon'") && error.contains("whitted"), "{error}");
    }
}
