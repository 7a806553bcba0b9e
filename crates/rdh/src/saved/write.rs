//! Writing.

use std::io;

use xxhash_rust::xxh3::Xxh3;

use super::header::Header;
use super::{ALIGN, Description, LITTLE_ENDIAN, MAGIC, NOT_HERE, VERSION, fail, layout, parts};
use crate::accel::{Accel, unsaved};
use crate::error::{Error, Result};
use crate::parts::Written;
use crate::rays::Profile;

impl Accel {
    /// The structure as the content of a `.rdh` file ([`saved`](crate::saved)): with its mesh and its provenance.
    ///
    /// # Errors
    /// [`Error::Spec`] for a lazy structure, which is never finished; [`Error::Format`] on a big-endian machine, or if the provenance is nested too deeply to be read again; lack of memory.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let unseen = unseen(self);
        let content = Content::of(self, unseen.as_deref())?;
        let bytes = content.header.length();
        let mut out = Vec::new();
        out.try_reserve_exact(bytes).map_err(|_| Error::OutOfMemory { what: "a saved tree", bytes })?;
        content.pieces(&mut |piece| out.extend_from_slice(piece));
        Ok(out)
    }

    /// Writes what [`Self::to_bytes`] gives, without a copy in memory.
    ///
    /// # Errors
    /// What `out` says; [`io::ErrorKind::InvalidData`] where `to_bytes` is an error.
    pub fn write_to(&self, out: &mut impl io::Write) -> io::Result<()> {
        let unseen = unseen(self);
        let content =
            Content::of(self, unseen.as_deref()).map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e))?;
        let mut written = Ok(());
        content.pieces(&mut |piece| {
            if written.is_ok() {
                written = out.write_all(piece);
            }
        });
        written
    }
}

fn unseen(accel: &Accel) -> Option<Vec<u8>> {
    accel.provenance().unseen.as_ref().map(Profile::to_bytes)
}

/// All of a file.
struct Content<'a> {
    layout: u32,
    header: Header,
    description: String,
    parts: Vec<Written<'a>>,
}

impl<'a> Content<'a> {
    fn of(accel: &'a Accel, unseen: Option<&'a [u8]>) -> Result<Self> {
        if !LITTLE_ENDIAN {
            return fail(0, NOT_HERE);
        }
        if accel.lazy().is_some() || accel.eye_tree().is_some() {
            return Err(unsaved(&accel.stats().spec));
        }
        let description = Description::of(accel).to_json()?;
        let (layout, parts) = (layout(&accel.stats().spec), parts(accel, unseen));
        let header = Header::new(layout, accel.mesh().checksum(), description.len(), &parts);
        Ok(Self { layout, header, description, parts })
    }

    /// Hands out the file, piece by piece.
    fn pieces(&self, take: &mut dyn FnMut(&[u8])) {
        let mut checksum = Xxh3::new();
        self.checked_pieces(&mut |piece| checksum.update(piece));
        take(MAGIC);
        take([VERSION, self.layout].map(u32::to_le_bytes).as_flattened());
        take(&checksum.digest().to_le_bytes());
        self.checked_pieces(take);
    }

    /// What the checksum is of.
    fn checked_pieces(&self, take: &mut dyn FnMut(&[u8])) {
        take(&self.header.to_bytes());
        take(self.description.as_bytes());
        let mut end = self.header.description.end;
        for (part, listed) in self.parts.iter().zip(&self.header.parts) {
            take(&[0; ALIGN][..listed.range.start - end]);
            take(part.bytes);
            end = listed.range.end;
        }
    }
}
