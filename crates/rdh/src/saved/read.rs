//! Reading.

use std::sync::Arc;

use super::header::Header;
use super::{Description, HEADER, LITTLE_ENDIAN, NOT_HERE, fail, layout};
use crate::accel::{Accel, Provenance, Structure};
use crate::error::{Error, Result};
use crate::mem::{Bytes, Lent};
use crate::mesh::Mesh;
use crate::parts::{Part, Parts, Place};
use crate::rays::Profile;

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

/// The mesh of a saved tree and how the tree came about; its nodes and blocks are left alone.
///
/// # Errors
/// As [`Accel::from_bytes`].
pub fn read_mesh(data: &[u8]) -> Result<(Mesh, Provenance)> {
    let Opened { parts, description, mesh } = open(Bytes::Borrowed(data))?;
    Ok((mesh, description.provenance(unseen(&parts)?)))
}

/// A file whose header, description and mesh are sound.
struct Opened<'a> {
    parts: Parts<'a>,
    description: Description,
    mesh: Mesh,
}

fn open(bytes: Bytes<'_>) -> Result<Opened<'_>> {
    if !LITTLE_ENDIAN {
        return fail(0, NOT_HERE);
    }
    let header = Header::read(bytes.all())?;
    let description = Description::from_json(&bytes.all()[header.description.clone()], header.description.start)?;
    let spec = &description.stats.spec;
    if layout(spec) != header.layout {
        return fail(12, format!("layout {} is not that of {spec}", header.layout));
    }
    let parts = Parts { bytes, listed: header.parts };
    let mesh = mesh(&parts)?;
    if mesh.checksum() != header.mesh {
        return fail(32, "the mesh has another checksum");
    }
    Ok(Opened { parts, description, mesh })
}

fn read(bytes: Bytes<'_>) -> Result<Accel> {
    let Opened { parts, description, mesh } = open(bytes)?;
    let described = description.stats;
    let structure = Structure::from_parts(&described.spec, &parts, &mesh)?;
    let accel = Accel::of(structure, mesh, described.spec, described.trained_on);
    if *accel.stats() != described {
        return fail(HEADER, "the description is not that of the tree");
    }
    let unseen = unseen(&parts)?;
    let expected = super::parts(&accel, unseen.as_ref().map(|_| &[][..]));
    if !expected.iter().map(|written| written.part).eq(parts.listed.iter().map(|listed| listed.part)) {
        return fail(HEADER, "there are parts that do not belong to such a tree");
    }
    Ok(accel.with_provenance(description.provenance(unseen)))
}

fn mesh(parts: &Parts<'_>) -> Result<Mesh> {
    let mesh = Mesh::of_arrays(parts.get(Part::Positions)?, parts.get(Part::Triangles)?)?;
    match parts.find(Part::Masks)? {
        Some(masks) => mesh.with_mask_array(masks),
        None => Ok(mesh),
    }
}

fn unseen(parts: &Parts<'_>) -> Result<Option<Profile>> {
    let Some(bytes) = parts.find::<u8>(Part::Unseen)? else { return Ok(None) };
    match Profile::from_bytes(&bytes) {
        Ok(profile) => Ok(Some(profile)),
        Err(Error::Format { offset, reason }) => {
            Err(parts.error(Place { part: Part::Unseen, byte: offset }, format!("unseen rays: {reason}")))
        }
        Err(other) => Err(other),
    }
}
