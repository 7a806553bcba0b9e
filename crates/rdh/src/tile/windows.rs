//! How a batch is cut into what may become tiles.

use super::{Choice, RAYS, choice};

/// So many windows ahead memory is asked for.
const SOON: usize = 8;

/// What may become tiles, one after the other: squares of rows as long as there are eight of them, then runs.
pub(crate) struct Windows {
    from: usize,
    column: usize,
    /// 0 if there are no rows.
    width: usize,
    count: usize,
}

impl Windows {
    /// Of so many rays, which are rows of `width` of a picture or have no rows.
    pub(crate) fn new(count: usize, width: Option<usize>) -> Self {
        Self { from: 0, column: 0, width: width.unwrap_or(0), count }
    }

    /// The first ray that is left, or that of the row whose rays are handed out.
    pub(crate) fn from(&self) -> usize {
        self.from
    }

    /// Whether there are no more rays.
    pub(crate) fn is_empty(&self) -> bool {
        self.from >= self.count
    }

    /// The next rays; none at the end.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> Choice {
        match self.advance() {
            (from, Some(columns)) => Choice::square(from, self.width, columns),
            (from, None) => Choice::run(from, self.count - from),
        }
    }

    /// The rays behind so many windows; none at the end.
    pub(crate) fn nth(&mut self, skipped: usize) -> Choice {
        for _ in 0..skipped {
            self.advance();
        }
        self.next()
    }

    /// Where, about, ray `i` of a window is that will come soon.
    #[inline(always)]
    pub(crate) fn soon(&self, i: usize) -> usize {
        match self.width {
            0 => self.from + SOON * RAYS + i,
            width => {
                let (x, y) = choice::place(i);
                self.from + y * width + self.column + 8 * SOON + x
            }
        }
    }

    /// Goes on by a window: where that starts, and how many columns it has, if it is a square.
    #[inline(always)]
    fn advance(&mut self) -> (usize, Option<usize>) {
        if self.width > 0 && self.count - self.from >= 8 * self.width {
            let (from, columns) = (self.from + self.column, (self.width - self.column).min(8));
            self.column += 8;
            if self.column >= self.width {
                (self.column, self.from) = (0, self.from + 8 * self.width);
            }
            return (from, Some(columns));
        }
        let from = self.from;
        self.from = (from + RAYS).min(self.count);
        (from, None)
    }
}
