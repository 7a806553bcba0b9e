//! Where the rays come from that a tree is built for.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// Where the representative rays come from, as in `--rrs`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// There are none.
    None,
    /// One in so many of this frame's own pixels. They are paid for: a first tree is built in a hurry, and the pixels
    /// are cast through it before the real tree is built.
    Frame(u32),
    /// The frame so many frames ago, along a camera path or of an animation. They are there already.
    Previous(u32),
    /// Another view of the same scene.
    View(String),
    /// All views of the scene alike.
    All,
}

impl Source {
    const KNOWN: &str = "none, frame:1/N, previous:K, view:NAME, all";
}

impl FromStr for Source {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let unknown = || Error::UnknownName { what: "source of rays", name: text.to_owned(), known: Self::KNOWN };
        let number = |text: &str| text.parse::<u32>().map_err(|_| unknown());
        match text.split_once(':') {
            None if text == "none" => Ok(Self::None),
            None if text == "all" => Ok(Self::All),
            Some(("frame", part)) => match number(part.strip_prefix("1/").ok_or_else(unknown)?)? {
                0 => Err(unknown()),
                part => Ok(Self::Frame(part)),
            },
            Some(("previous", frames)) => Ok(Self::Previous(number(frames)?)),
            Some(("view", name)) if !name.is_empty() => Ok(Self::View(name.to_owned())),
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Frame(part) => write!(f, "frame:1/{part}"),
            Self::Previous(frames) => write!(f, "previous:{frames}"),
            Self::View(name) => write!(f, "view:{name}"),
            Self::All => f.write_str("all"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_round_trip_and_nonsense_is_refused() {
        for text in ["none", "frame:1/64", "previous:8", "view:table", "all"] {
            assert_eq!(text.parse::<Source>().unwrap().to_string(), text);
        }
        for text in ["", "frame", "frame:64", "frame:1/0", "previous:", "previous:-1", "view:", "everything"] {
            assert!(text.parse::<Source>().is_err(), "{text}");
        }
    }
}
