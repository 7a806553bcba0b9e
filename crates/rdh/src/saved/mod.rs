//! `.rdh` files: a structure with its mesh and how it came about, as bytes, version 1.
//!
//! ```text
//!    0  magic "RDH-TREE"
//!    8  u32 version, u32 layout: 1 a kd-tree; 2, 4, 8 a bounding volume hierarchy of this width; 256 more if its
//!       leaves index the mesh's vertices
//!   16  u64 xxh3 checksum of all that follows
//!   24  u64 length of the file
//!   32  u64 xxh3 checksum of the mesh
//!   40  u64 bytes of the description, u64 parts
//!   56  u64 zero
//!   64  the parts, 32 bytes each: u32 number, u32 bytes of an element, u64 place, u64 elements, u64 zero
//!    …  the description: JSON
//!    …  the parts in the order of their numbers, each from a multiple of 64 on
//! ```
//! All little-endian; what lies between is zero. The numbers of parts are those of `Part` (`parts.rs`): the mesh comes first, then
//! the structure's arrays as they are in memory, so that a mapped file can be used where it lies. There is one way only to
//! write a tree, so reading and writing gives the same bytes.
//!
//! Nothing is believed: lengths and places, both checksums, the mesh, and every node and block are checked before a tree is
//! handed out. A file that was changed on purpose, checksums and all, can hold a tree that lacks triangles
//! ([`Accel::check`] finds that), but none that panics, hangs or reads what is not its own.

mod description;
mod header;
mod read;
mod write;

pub use read::read_mesh;

use description::Description;

use crate::accel::Accel;
use crate::bvh::Triangles;
use crate::error::{Error, Result};
use crate::parts::{Part, Written};
use crate::spec::{Spec, StructureSpec};

/// A bit of the layout.
const SHARED: u32 = 256;
const MAGIC: &[u8; 8] = b"RDH-TREE";
const VERSION: u32 = 1;
/// Where the checksummed part begins.
const CHECKED: usize = 24;
const HEADER: usize = 64;
/// Bytes of a row in the table of parts.
const ROW: usize = 32;
const ALIGN: usize = 64;

/// Arrays are written as they are in memory.
const LITTLE_ENDIAN: bool = cfg!(target_endian = "little");
const NOT_HERE: &str = "saved trees are for little-endian machines";

/// Which arrays a structure is made of, as a number.
fn layout(spec: &Spec) -> u32 {
    match spec.structure {
        // Nothing that is built, and no file.
        StructureSpec::Auto | StructureSpec::Eye(_) => 0,
        StructureSpec::Kd(_) => 1,
        StructureSpec::Bvh(bvh) => match bvh.triangles {
            Triangles::Copied => bvh.width.children(),
            Triangles::Shared => bvh.width.children() | SHARED,
        },
    }
}

/// All parts of a structure, its mesh and its unseen rays, in the order of their numbers.
fn parts<'a>(accel: &'a Accel, unseen: Option<&'a [u8]>) -> Vec<Written<'a>> {
    let mesh = accel.mesh();
    let mut parts =
        vec![Written::new(Part::Positions, mesh.positions()), Written::new(Part::Triangles, mesh.triangles())];
    parts.extend(mesh.masks().map(|masks| Written::new(Part::Masks, masks)));
    parts.extend(accel.structure().parts());
    parts.extend(unseen.map(|rays| Written::new(Part::Unseen, rays)));
    parts
}

fn fail<T>(offset: usize, reason: impl Into<String>) -> Result<T> {
    Err(Error::Format { offset, reason: reason.into() })
}
