//! What a file says about its tree, as JSON.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::fail;
use crate::accel::{Accel, Provenance, Stats};
use crate::error::{Error, Result};
use crate::rays::Profile;

/// What a file says about its tree.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Description {
    /// What wrote it.
    program: String,
    pub(super) stats: Stats,
    seed: Option<u64>,
    settings: Value,
    evidence: Option<Value>,
}

impl Description {
    pub(super) fn of(accel: &Accel) -> Self {
        let Provenance { seed, settings, evidence, unseen: _ } = accel.provenance();
        let program = concat!("rdh ", env!("CARGO_PKG_VERSION")).to_owned();
        Self { program, stats: *accel.stats(), seed: *seed, settings: settings.clone(), evidence: evidence.clone() }
    }

    pub(super) fn provenance(self, unseen: Option<Profile>) -> Provenance {
        Provenance { seed: self.seed, settings: self.settings, evidence: self.evidence, unseen }
    }

    /// As text, which has been read back: what can be written can be read.
    ///
    /// # Errors
    /// [`Error::Format`] for settings or evidence nested too deeply.
    pub(super) fn to_json(&self) -> Result<String> {
        let text = serde_json::to_string(self).or_else(|e| fail(0, e.to_string()))?;
        Self::from_json(text.as_bytes(), 0)?;
        Ok(text)
    }

    /// Out of bytes that lie at `offset`.
    pub(super) fn from_json(json: &[u8], offset: usize) -> Result<Self> {
        serde_json::from_slice(json).map_err(|e| {
            let at = place(json, e.line(), e.column());
            Error::Format { offset: offset + at, reason: format!("the description of the tree: {e}") }
        })
    }
}

/// The byte at a line and column, both counted from 1.
fn place(json: &[u8], line: usize, column: usize) -> usize {
    let start: usize = json.split_inclusive(|&b| b == b'\n').take(line.saturating_sub(1)).map(<[u8]>::len).sum();
    (start + column.saturating_sub(1)).min(json.len())
}
