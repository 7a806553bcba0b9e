//! How training rays are chosen.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// How the training rays are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// From other film positions and another seed than the test rays. Recommended: no ray is both learnt and counted.
    #[default]
    Unseen,
    /// A subset of the frame's own pixels; the whole frame counts. The paper's.
    Paper,
    /// All test rays: the bound of what any sample could give.
    Same,
}

impl FromStr for Protocol {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        match name {
            "unseen" | "default" => Ok(Self::Unseen),
            "paper" => Ok(Self::Paper),
            "same" => Ok(Self::Same),
            _ => Err(Error::UnknownName { what: "protocol", name: name.to_owned(), known: "unseen, paper, same" }),
        }
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unseen => "unseen",
            Self::Paper => "paper",
            Self::Same => "same",
        })
    }
}
