//! What checks of structures find.

use crate::geom::TriId;
use crate::mesh::Mesh;
use crate::parts::{Part, Place};
use crate::simd::{LANES, Lanes};

/// Something that is wrong with a structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault(pub String);

/// A list of faults, cut off at 100: a broken structure has millions.
#[derive(Debug, Default)]
pub(crate) struct Faults(Vec<(Place, Fault)>);

impl Faults {
    const MOST: usize = 100;

    /// Adds a fault, while there is room.
    pub(crate) fn add(&mut self, place: Place, what: String) {
        if !self.is_full() {
            self.0.push((place, Fault(what)));
        }
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether to look for more is of no use.
    pub(crate) fn is_full(&self) -> bool {
        self.0.len() == Self::MOST
    }

    /// The first one, and where it is.
    pub(crate) fn first(self) -> Option<(Place, Fault)> {
        self.0.into_iter().next()
    }

    /// All of them.
    pub(crate) fn all(self) -> Vec<Fault> {
        self.0.into_iter().map(|(_, fault)| fault).collect()
    }

    /// Blocks hold triangles of the mesh in all their lanes, bit for bit; the unused ones too. O(blocks).
    pub(crate) fn check_blocks<B: Lanes>(&mut self, blocks: &[B], mesh: &Mesh) {
        for (i, block) in blocks.iter().enumerate() {
            for lane in 0..LANES {
                let id = block.ids()[lane];
                let fault = match id as usize {
                    index if index >= mesh.len() => "there is no such triangle",
                    _ if !block.is_faithful(lane, TriId(id), mesh) => "the copy differs from the mesh",
                    _ => continue,
                };
                let what = format!("block {i}, lane {lane}, triangle {id}: {fault}");
                self.add(Place::of::<B>(Part::Blocks, i), what);
            }
            if self.is_full() {
                return;
            }
        }
    }
}
