//! A subtree that is not there until a ray reaches it.

use std::sync::{Mutex, OnceLock, PoisonError};

use super::ground::Ground;
use crate::bvh::{Bvh, Extent};
use crate::simd::Boxes;

/// A subtree: runs of triangles that wait, or what has grown of them. Whoever comes first grows it, others wait for that; then nobody
/// waits any more.
#[derive(Debug)]
pub(super) struct Subtree {
    grown: OnceLock<Grown>,
    /// Taken when it grows.
    waiting: Mutex<Vec<Extent>>,
    depth: u32,
}

/// What has grown.
#[derive(Debug)]
pub(super) enum Grown {
    /// A node with subtrees, of which none need be there yet.
    Node(Box<Node>),
    /// All of it.
    Tree(Box<Bvh<8>>),
    /// The budget, or memory, has forbidden it to grow: rays test all of its triangles.
    Bare(Vec<Extent>),
}

/// A wide node of the upper tree.
#[derive(Debug)]
pub(super) struct Node {
    /// The subtrees' boxes, the largest one first.
    pub(super) boxes: Boxes<8>,
    /// As many as there are boxes.
    pub(super) children: Vec<Subtree>,
}

impl Subtree {
    /// Over runs of triangles, so many edges below the root.
    pub(super) fn new(runs: Vec<Extent>, depth: u32) -> Self {
        Self { grown: OnceLock::new(), waiting: Mutex::new(runs), depth }
    }

    /// Edges between it and the root.
    pub(super) fn depth(&self) -> u32 {
        self.depth
    }

    /// What has grown; now, if nothing has yet.
    #[inline(always)]
    pub(super) fn get(&self, ground: &Ground) -> &Grown {
        match self.grown.get() {
            Some(grown) => grown,
            None => self.grow(|runs| ground.grow(runs, self.depth)),
        }
    }

    /// Lets it grow by `how`, unless it has grown; where that gives nothing its triangles stay bare. `how` must not wait for other
    /// subtrees, nor run anything else on this thread: a ray that is cast meanwhile on the same thread would wait for itself.
    #[cold]
    #[inline(never)]
    pub(super) fn grow(&self, how: impl FnOnce(&mut Vec<Extent>) -> Option<Grown>) -> &Grown {
        self.grown.get_or_init(|| self.grown_by(how))
    }

    /// The same for who alone has the structure, before there are rays: other threads may help.
    pub(super) fn grow_alone(&self, how: impl FnOnce(&mut Vec<Extent>) -> Option<Grown>) -> &Grown {
        match self.grown.get() {
            Some(grown) => grown,
            None => {
                let grown = self.grown_by(how);
                self.grown.get_or_init(|| grown)
            }
        }
    }

    /// The runs are given up last: if growing should panic, whoever comes next finds them.
    fn grown_by(&self, how: impl FnOnce(&mut Vec<Extent>) -> Option<Grown>) -> Grown {
        self.with_waiting(|runs| {
            let grown = how(runs);
            let runs = std::mem::take(runs);
            grown.unwrap_or(Grown::Bare(runs))
        })
    }

    /// What has grown so far.
    pub(super) fn grown(&self) -> Option<&Grown> {
        self.grown.get()
    }

    /// Looks at what waits.
    pub(super) fn with_waiting<T>(&self, look: impl FnOnce(&mut Vec<Extent>) -> T) -> T {
        look(&mut self.waiting.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
