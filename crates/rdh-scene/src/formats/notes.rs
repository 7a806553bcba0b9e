//! Counting what a reader drops.

use crate::scene::Note;

/// What was dropped so far. The kinds are few, so a list will do.
#[derive(Debug, Default)]
pub(super) struct Notes(Vec<Note>);

impl Notes {
    /// Counts `count` more of a kind; nothing for 0.
    pub(super) fn add(&mut self, what: &str, count: usize) {
        if count == 0 {
            return;
        }
        match self.0.iter_mut().find(|n| n.what == what) {
            Some(note) => note.count = note.count.saturating_add(count),
            None => self.0.push(Note { what: what.to_owned(), count }),
        }
    }

    /// The notes, in the order in which their kinds were met.
    pub(super) fn finish(self) -> Vec<Note> {
        self.0
    }
}
