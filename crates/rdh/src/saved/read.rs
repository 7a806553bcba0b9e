//! Reading.

use std::sync::Arc;

use super::header::Header;
use super::{Description, LITTLE_ENDIAN, NOT_HERE, fail, layout, parts};
use crate::accel::{Accel, Stats, Structure};
use crate::error::Result;
use crate::mem::{Bytes, Lent};
use crate::mesh::Mesh;
use crate::parts::{Part, Parts};

impl Accel {
    /// The structure that a `.rdh` file ([`saved`](crate::saved)) holds, copied out of it. All is checked before it is used; memory is only
    /// taken for what is really there. O(file).
    ///
    /// # Errors
    /// [`Error::Format`](crate::Error::Format) with the byte and the reason, if the bytes are no saved tree, of another version, cut off,
    /// altered, or not well-formed; lack of memory.
    pub fn from_bytes(data: &[u8]) -> Result<Self> {
        read(Bytes::Borrowed(data))
    }

    /// [`Self::from_bytes`], of bytes that are used where they lie and never change, such as those of a mapped file: nothing is
    /// copied if they begin at a multiple of 64, and all processes that map a file have it in memory once.
    ///
    /// Traversal is a few percent slower than in a copy where the system gives large pages to the one and not to the other.
    ///
    /// # Errors
    /// As [`Self::from_bytes`].
    pub fn from_shared(bytes: Arc<dyn AsRef<[u8]> + Send + Sync>) -> Result<Self> {
        read(Bytes::Lent(Lent::by(bytes)))
    }
}

fn read(bytes: Bytes<'_>) -> Result<Accel> {
    if !LITTLE_ENDIAN {
        return fail(0, NOT_HERE);
    }
    let header = Header::read(bytes.all())?;
    let description = Description::from_json(&bytes.all()[header.description.clone()], header.description.start)?;
    let described: Stats = description.stats;
    if layout(&described.spec) != header.layout {
        return fail(12, format!("layout {} is not that of {}", header.layout, described.spec));
    }
    let listed = Parts { bytes, listed: header.parts };
    let mesh = mesh(&listed)?;
    if mesh.checksum() != header.mesh {
        return fail(32, "the mesh has another checksum");
    }
    let structure = Structure::from_parts(&described.spec, &listed, &mesh)?;
    let accel = Accel::of(structure, mesh, described.spec, described.trained_on);
    if *accel.stats() != described {
        return fail(header.description.start, "the description is not that of the tree");
    }
    if !parts(&accel).iter().map(|w| w.part).eq(listed.listed.iter().map(|l| l.part)) {
        return fail(super::HEADER, "there are parts that do not belong to such a tree");
    }
    Ok(accel.with_provenance(description.provenance()))
}

fn mesh(parts: &Parts<'_>) -> Result<Mesh> {
    let mesh = Mesh::of_arrays(parts.get(Part::Positions)?, parts.get(Part::Triangles)?)?;
    match parts.find(Part::Masks)? {
        Some(masks) => mesh.with_mask_array(masks),
        None => Ok(mesh),
    }
}
