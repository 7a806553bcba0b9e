//! Which of a part's rays may make a tile, one window after the other.

use super::coherence::{Extent, ask};
use super::patience::Patience;
use super::{Choice, Windows};
use crate::geom::{Aabb, Ray};

/// A tile of fewer rays is not worth it.
const FEWEST: usize = 16;

/// What is next of a part.
pub(super) enum Next {
    /// Rays to try a tile with.
    Tile(Choice),
    /// Rays that go otherwise.
    Others(Choice),
    /// No rays are left.
    End,
}

/// A part's rays, window by window, as long as tiles pay.
pub(super) struct Choices {
    extent: Extent,
    windows: Windows,
    patience: Patience,
    /// What is left of a window whose rays are of more classes than one.
    mixed: Option<Choice>,
    /// Whether the last choice was some of those.
    is_class: bool,
    /// Whether there are tiles at all.
    has_tiles: bool,
}

impl Choices {
    /// Of so many rays, which are rows of `width` of a picture or have no rows, through a structure within `bounds`.
    pub(super) fn new(count: usize, width: Option<usize>, bounds: &Aabb, has_tiles: bool) -> Self {
        let (extent, windows) = (Extent::of(bounds, count), Windows::new(count, width));
        Self { extent, windows, patience: Patience::default(), mixed: None, is_class: false, has_tiles }
    }

    /// The next ones.
    #[inline(always)]
    pub(super) fn next(&mut self, rays: &[Ray]) -> Next {
        self.is_class = self.mixed.is_some();
        let choice = match self.mixed.take() {
            Some(choice) => {
                let (class, rest) = choice.first_class(rays);
                self.mixed = (!rest.rays().is_empty()).then_some(rest);
                class
            }
            None => {
                if self.has_tiles {
                    ask(rays, |i| self.windows.soon(i));
                }
                self.windows.next()
            }
        };
        let which = choice.rays();
        if which.is_empty() {
            return Next::End;
        }
        let may = self.has_tiles && which.len() >= FEWEST;
        if may && (self.is_class || self.extent.is_coherent(rays, which) && self.patience.tries()) {
            Next::Tile(choice)
        } else {
            Next::Others(choice)
        }
    }

    /// A tile has walked: whether it was worth it.
    #[inline(always)]
    pub(super) fn has_paid(&mut self, has_paid: bool) {
        self.patience.note(has_paid);
    }

    /// The last choice made no tile: its rays come again class by class, or go otherwise.
    #[inline(always)]
    pub(super) fn failed(&mut self, choice: Choice) -> Option<Choice> {
        if self.is_class {
            return Some(choice);
        }
        self.mixed = Some(choice);
        None
    }

    /// The first ray that is left, or that of the row whose rays are handed out, if those from there on are all that are left.
    pub(super) fn rest(&self) -> Option<usize> {
        self.mixed.is_none().then(|| self.windows.from())
    }

    /// Whether there are no more rays.
    pub(super) fn is_empty(&self) -> bool {
        self.mixed.is_none() && self.windows.is_empty()
    }
}
