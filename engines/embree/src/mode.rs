//! What is built: `high-avx2`, `medium-robust-avx512`.

use std::str::FromStr;

use anyhow::{Error, Result, bail};
use rdh_engine_protocol::Absent;

/// What is built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Mode {
    pub(crate) quality: Quality,
    /// Whether edges are watertight (Embree's are not by default).
    pub(crate) robust: bool,
    /// Embree's name of an instruction set.
    pub(crate) isa: String,
}

/// How carefully the tree is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Binned SAH.
    Medium,
    /// With spatial splits.
    High,
}

impl FromStr for Mode {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<_> = text.split('-').collect();
        let (quality, robust, isa) = match parts[..] {
            [quality, isa] => (quality, false, isa),
            [quality, "robust", isa] => (quality, true, isa),
            _ => bail!("unknown mode '{text}'; known: high|medium[-robust]-sse2|sse4.2|avx|avx2|avx512"),
        };
        let quality = match quality {
            "medium" => Quality::Medium,
            "high" => Quality::High,
            _ => bail!("unknown quality '{quality}'; known: medium, high"),
        };
        // Embree takes its options as one text, in which a comma would begin another option: only known names go in.
        if !["sse2", "sse4.2", "avx", "avx2", "avx512"].contains(&isa) {
            bail!("unknown instruction set '{isa}'; known: sse2, sse4.2, avx, avx2, avx512");
        }
        Ok(Self { quality, robust, isa: isa.to_owned() })
    }
}

impl Mode {
    /// Refuses what this machine can't run: Embree would not say so, but crash or take other instructions.
    pub(crate) fn check(&self) -> Result<()> {
        if supported(&self.isa) {
            return Ok(());
        }
        Err(Absent(format!("this machine lacks {}", self.isa)).into())
    }
}

#[cfg(target_arch = "x86_64")]
fn supported(isa: &str) -> bool {
    match isa {
        "avx" => is_x86_feature_detected!("avx"),
        "avx2" => is_x86_feature_detected!("avx2"),
        "avx512" => {
            is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512cd")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512vl")
        }
        _ => true,
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn supported(_isa: &str) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_parsed_and_wrong_ones_refused() {
        let mode: Mode = "medium-robust-avx512".parse().unwrap();
        assert_eq!((mode.quality, mode.robust, mode.isa.as_str()), (Quality::Medium, true, "avx512"));
        assert!(!"high-sse4.2".parse::<Mode>().unwrap().robust);
        for text in ["", "high", "low-avx2", "high-avx3", "high-robust", "high-solid-avx2", "high-avx2,threads=9"] {
            assert!(text.parse::<Mode>().is_err(), "{text}");
        }
    }
}
