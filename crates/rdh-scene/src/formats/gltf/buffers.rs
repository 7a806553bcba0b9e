//! The bytes of a document's buffers: in the GLB, in the JSON, or in a file beneath the document's folder.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::base64;
use super::budget::Budget;
use super::schema::Buffer;
use crate::error::{Error, Result};
use crate::formats::{grow, text};

/// Buffers, each read when it is first asked for.
pub(super) struct Buffers<'a> {
    chunk: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    read: Vec<OnceCell<Bytes<'a>>>,
    /// Files that are read already: many buffers may lie in one.
    files: RefCell<BTreeMap<PathBuf, Rc<Vec<u8>>>>,
}

enum Bytes<'a> {
    Chunk(&'a [u8]),
    Decoded(Vec<u8>),
    File(Rc<Vec<u8>>),
}

impl Bytes<'_> {
    fn as_slice(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Decoded(bytes) => bytes,
            Self::File(bytes) => bytes,
        }
    }
}

impl<'a> Buffers<'a> {
    pub(super) fn new(count: usize, chunk: Option<&'a [u8]>, folder: Option<&'a Path>) -> Self {
        let read = (0..count).map(|_| OnceCell::new()).collect();
        Self { chunk, folder, read, files: RefCell::default() }
    }

    /// The bytes of a buffer, exactly as many as it claims.
    pub(super) fn bytes(&self, index: u32, buffers: &[Buffer], budget: &Budget) -> Result<&[u8]> {
        let place = || format!("buffer {index}");
        let at = |reason: String| Error::at(place(), reason);
        let (cell, buffer) = (self.read.get(index as usize), buffers.get(index as usize));
        let (Some(cell), Some(buffer)) = (cell, buffer) else { return Err(Error::at(place(), "does not exist")) };
        if cell.get().is_none() {
            let bytes = self.load(index, buffer, budget).map_err(at)?;
            cell.get_or_init(|| bytes);
        }
        let bytes = cell.get().map_or(&[][..], Bytes::as_slice);
        let length = usize::try_from(buffer.byte_length).ok();
        length
            .and_then(|length| bytes.get(..length))
            .ok_or_else(|| at(format!("claims {} bytes, but only {} are there", buffer.byte_length, bytes.len())))
    }

    fn load(&self, index: u32, buffer: &Buffer, budget: &Budget) -> Result<Bytes<'a>, String> {
        match (&buffer.uri, self.chunk) {
            (None, Some(chunk)) if index == 0 => Ok(Bytes::Chunk(chunk)),
            (None, _) => Err("has no data".to_owned()),
            (Some(uri), _) => match uri.strip_prefix("data:") {
                Some(data) => decoded(data),
                None => self.file(uri, budget).map(Bytes::File),
            },
        }
    }

    /// A file beneath the folder, links followed before that is decided.
    fn file(&self, uri: &str, budget: &Budget) -> Result<Rc<Vec<u8>>, String> {
        let shown = text::shown(uri.as_bytes());
        let failed = |e: std::io::Error| format!("file '{shown}': {e}");
        let relative = relative_path(uri).ok_or_else(|| format!("file '{shown}' is not named by a relative path"))?;
        let folder = self.folder.ok_or_else(|| format!("refers to file '{shown}', but data alone was given"))?;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let folder = folder.canonicalize().map_err(failed)?;
        let path = folder.join(relative).canonicalize().map_err(failed)?;
        if !path.starts_with(&folder) {
            return Err(format!("file '{shown}' lies outside the document's folder"));
        }
        if let Some(bytes) = self.files.borrow().get(&path) {
            return Ok(bytes.clone());
        }
        let bytes = Rc::new(whole_file(&path).map_err(|reason| format!("file '{shown}': {reason}"))?);
        budget.grow(bytes.len());
        self.files.borrow_mut().insert(path, bytes.clone());
        Ok(bytes)
    }
}

/// A regular file's bytes, as many as its size says.
fn whole_file(path: &Path) -> Result<Vec<u8>, String> {
    let about = std::fs::metadata(path).map_err(|e| e.to_string())?;
    if !about.is_file() {
        return Err("is not a file".to_owned());
    }
    let mut bytes = Vec::new();
    let size = usize::try_from(about.len()).map_err(|e| e.to_string())?;
    grow::reserve(&mut bytes, size).map_err(|e| e.to_string())?;
    File::open(path).and_then(|f| f.take(about.len()).read_to_end(&mut bytes)).map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// The data of a data URI, without its "data:". Only base64 is in use for buffers.
fn decoded<'a>(data: &str) -> Result<Bytes<'a>, String> {
    let (about, text) = data.split_once(',').ok_or("the data URI has no comma")?;
    if !about.ends_with(";base64") {
        return Err("the data URI is not in base64".to_owned());
    }
    base64::decode(text.as_bytes()).map(Bytes::Decoded).ok_or_else(|| "the data URI's base64 is malformed".to_owned())
}

/// The path of a relative URI, with its %-escapes replaced; `None` for absolute ones, other schemes and bad escapes.
fn relative_path(uri: &str) -> Option<PathBuf> {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        rest = after;
        if *first == b'%' {
            let (digits, after) = rest.split_first_chunk::<2>()?;
            bytes.push(u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?);
            rest = after;
        } else {
            bytes.push(*first);
        }
    }
    let path = String::from_utf8(bytes).ok()?;
    let absolute = path.starts_with(['/', '\\']) || path.contains([':', '\0']) || Path::new(&path).has_root();
    (!absolute && !path.is_empty()).then(|| path.into())
}
