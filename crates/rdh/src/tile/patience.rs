//! How often tiles are tried where they do not pay.

/// After tiles that did not pay, more and more windows go without.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Patience {
    /// Windows to come without a tile.
    left: u32,
    /// How many it were the last time.
    last: u32,
}

impl Patience {
    /// At most so many windows go without.
    const MOST: u32 = 32;

    /// Whether the next window may become a tile.
    #[inline(always)]
    pub(super) fn tries(&mut self) -> bool {
        let tries = self.left == 0;
        self.left = self.left.saturating_sub(1);
        tries
    }

    /// A tile has paid or not.
    #[inline(always)]
    pub(super) fn note(&mut self, has_paid: bool) {
        self.last = if has_paid { 0 } else { (2 * self.last + 1).min(Self::MOST) };
        self.left = self.last;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patience_grows_and_is_given_back() {
        let mut patience = Patience::default();
        let mut tried = 0;
        for _ in 0..1000 {
            if patience.tries() {
                tried += 1;
                patience.note(false);
            }
        }
        assert!((30..60).contains(&tried), "{tried}");
        patience = Patience::default();
        assert!((0..10).all(|_| patience.tries()));
    }
}
