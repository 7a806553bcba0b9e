//! Values with a form of their own: `512x512`, `x:0.5`, `z:40%`.

use std::fmt;
use std::str::FromStr;

use rdh::simd::Level;
use rdh::{Axis, RayClass};

/// A film's size in pixels, `WIDTHxHEIGHT`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    pub width: usize,
    pub height: usize,
}

/// A plane across one axis, `AXIS:POSITION`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slice {
    pub axis: Axis,
    pub place: Place,
}

/// Where on its axis a plane is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// In world coordinates.
    World(f64),
    /// A part of the scene's box, 0 to 1.
    Part(f64),
    /// Through the view's eye.
    Eye,
}

/// What a ray of each class counts, `CLASS=NUMBER,…`; 1 for those that are not named.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClassWeights(pub [f64; 8]);

impl Size {
    const LARGEST: usize = 16_384;
    /// Rays, counts and colours of more pixels would not fit into memory together.
    const MOST_PIXELS: usize = rdh_study::Plan::MAX_PIXELS;
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |s: &str| s.parse().ok().filter(|n| (1..=Self::LARGEST).contains(n));
        let sides = text.split_once(['x', 'X', '×']).and_then(|(w, h)| Some((side(w)?, side(h)?)));
        let (width, height) = sides
            .ok_or_else(|| format!("WIDTHxHEIGHT is needed, such as 512x512, with sides of 1 to {}", Self::LARGEST))?;
        if width * height > Self::MOST_PIXELS {
            return Err(format!("at most {} pixels are possible", Self::MOST_PIXELS));
        }
        Ok(Self { width, height })
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Slice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once(':').and_then(|(a, p)| Some(Self { axis: axis(a)?, place: place(p)? }));
        parsed
            .ok_or_else(|| "AXIS:POSITION is needed: x:0.5 (world coordinates), y:40% (of the scene), z:eye".to_owned())
    }
}

fn axis(name: &str) -> Option<Axis> {
    match name {
        "x" | "X" => Some(Axis::X),
        "y" | "Y" => Some(Axis::Y),
        "z" | "Z" => Some(Axis::Z),
        _ => None,
    }
}

fn place(text: &str) -> Option<Place> {
    let number = |s: &str| s.parse().ok().filter(|x: &f64| x.is_finite());
    match text.strip_suffix('%') {
        Some(percent) => number(percent).filter(|p| (0.0..=100.0).contains(p)).map(|p| Place::Part(p / 100.0)),
        None if text == "eye" => Some(Place::Eye),
        None => number(text).map(Place::World),
    }
}

impl FromStr for ClassWeights {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut weights = [1.0; 8];
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let pair = part.split_once('=').and_then(|(name, weight)| {
                let class = RayClass::ALL.into_iter().find(|c| c.name() == name.trim())?;
                Some((class, weight.trim().parse().ok().filter(|w| (0.0..=1e9).contains(w))?))
            });
            let (class, weight) = pair.ok_or_else(|| {
                let known = RayClass::ALL.map(RayClass::name).join(", ");
                format!("'{part}': CLASS=NUMBER is needed, with a number from 0 to 1e9; classes: {known}")
            })?;
            weights[class as usize] = weight;
        }
        Ok(Self(weights))
    }
}

/// A number of threads that a machine may have.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    in_range(text, 1, 4096)
}

/// A number of rays that fits into memory.
pub(crate) fn ray_count(text: &str) -> Result<usize, String> {
    in_range(text, 1, 1 << 26)
}

/// A number of rounds that ends some day.
pub(crate) fn rounds(text: &str) -> Result<usize, String> {
    in_range(text, 1, 10_000)
}

/// A part of a whole.
pub(crate) fn part(text: &str) -> Result<f64, String> {
    let part = text.parse().ok().filter(|x| (0.0..=1.0).contains(x));
    part.ok_or_else(|| "a number from 0 to 1 is needed".to_owned())
}

/// Instructions that this CPU has.
pub(crate) fn level(text: &str) -> Result<Level, String> {
    let levels = Level::available();
    let names = || levels.iter().map(|level| level.name()).collect::<Vec<_>>().join(", ");
    let level = levels.iter().find(|level| level.name() == text).copied();
    level.ok_or_else(|| format!("this CPU has {}", names()))
}

/// Megabytes, as bytes.
pub(crate) fn megabytes(text: &str) -> Result<usize, String> {
    in_range(text, 1, 1 << 30).map(|mb| mb.saturating_mul(1_000_000))
}

/// A magnification.
pub(crate) fn zoom(text: &str) -> Result<f32, String> {
    let factor = text.parse().ok().filter(|x| (1.0..=1e4).contains(x));
    factor.ok_or_else(|| "a number from 1 to 10000 is needed".to_owned())
}

fn in_range(text: &str, least: usize, most: usize) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (least..=most).contains(n));
    number.ok_or_else(|| format!("a whole number from {least} to {most} is needed"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for wrong in ["", "640", "0x5", "5x0", "640x", "-1x5", "99999x5", "4x4x4", "1.5x2", "16384x16384"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn slices() {
        assert_eq!("x:0.5".parse(), Ok(Slice { axis: Axis::X, place: Place::World(0.5) }));
        assert_eq!("y:-3e2".parse(), Ok(Slice { axis: Axis::Y, place: Place::World(-300.0) }));
        assert_eq!("z:50%".parse(), Ok(Slice { axis: Axis::Z, place: Place::Part(0.5) }));
        assert_eq!("Z:eye".parse(), Ok(Slice { axis: Axis::Z, place: Place::Eye }));
        for wrong in ["", "x", "x:", "w:1", "x:nan", "x:inf", "x:101%", "x:%", "0.5"] {
            assert!(wrong.parse::<Slice>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn class_weights() {
        assert_eq!("".parse(), Ok(ClassWeights([1.0; 8])));
        let weights = "shadow=2, primary=0".parse::<ClassWeights>().unwrap().0;
        assert_eq!(weights[..3], [0.0, 2.0, 1.0]);
        for wrong in ["shadow", "shadow=", "shadow=-1", "shadow=nan", "shade=1"] {
            assert!(wrong.parse::<ClassWeights>().unwrap_err().contains("classes: primary"), "{wrong}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert_eq!(threads("4096"), Ok(4096));
        assert!(threads("0").is_err() && threads("many").is_err() && ray_count("99999999999").is_err());
    }
}
