//! From names to scenes and views: ids, generators with parameters, mesh files, each perhaps with `:view`.

use std::path::Path;

use anyhow::{Context as _, Error, Result};
use rdh_scene::{Entry, catalog};
use rdh_study::Target;

use crate::exit::usage;

/// The scenes that have names: the embedded ones and those of a folder.
#[derive(Debug)]
pub(crate) struct Shelf {
    embedded: Vec<Entry>,
    indexed: Option<Vec<Entry>>,
}

impl Shelf {
    /// Reads the folder's index, if there is a folder.
    pub(crate) fn open(folder: Option<&Path>) -> Result<Self> {
        let embedded = catalog::embedded().context("the embedded scenes")?;
        let indexed = folder.map(catalog::indexed).transpose()?;
        Ok(Self { embedded, indexed })
    }

    /// The scenes that come with the program.
    pub(crate) fn embedded(&self) -> &[Entry] {
        &self.embedded
    }

    /// The scenes of the folder.
    pub(crate) fn indexed(&self) -> &[Entry] {
        self.indexed.as_deref().unwrap_or_default()
    }

    /// What is meant if no scene is named: those of the folder, else the quick set.
    pub(crate) fn usual(&self) -> Vec<Target> {
        let entries: Vec<_> = match &self.indexed {
            Some(indexed) => indexed.iter().collect(),
            None => self.embedded.iter().filter(|e| e.quick).collect(),
        };
        entries.into_iter().cloned().map(Target::all).collect()
    }

    /// The scene that a name means: all its views, or the one after the colon.
    ///
    /// # Errors
    /// Usage for what nothing is called, with the names that are near; what the reader says of a file.
    pub(crate) fn find(&self, name: &str) -> Result<Target> {
        let (scene, view) = catalog::split_view(name);
        let entry = catalog::find(scene, self.indexed()).map_err(error)?;
        match view {
            None => Ok(Target::all(entry)),
            Some(view) => {
                let (view, frame) = known_view(&entry, view)?;
                Ok(Target { frames: vec![frame], ..Target::view(entry, view) })
            }
        }
    }

    /// As [`Self::find`], but one view: the first one unless another is named.
    pub(crate) fn find_view(&self, name: &str, view: Option<&str>) -> Result<Target> {
        let mut target = self.find(name)?;
        match view {
            Some(_) if !target.views.is_empty() => return Err(usage(format!("'{name}' names a view already"))),
            Some(view) => {
                let (view, frame) = known_view(&target.entry, view)?;
                (target.views, target.frames) = (vec![view], vec![frame]);
            }
            None if target.views.is_empty() => target.views.extend(target.entry.views.first().map(|v| v.name.clone())),
            None => {}
        }
        Ok(target)
    }
}

/// A view and a frame: `street`, `street@7` of an animation, or `drive@60`, a place on a camera path of the scene at rest.
fn known_view(entry: &Entry, text: &str) -> Result<(String, u32)> {
    let is_view = |name: &str| entry.views.iter().any(|v| v.name == name);
    if is_view(text) {
        return Ok((text.to_owned(), 0));
    }
    if let Some((name, frame)) = text.split_once('@') {
        let frame: u32 = frame.parse().map_err(|_| usage(format!("'{text}': the frame isn't a number")))?;
        let path = entry.paths().unwrap_or_default().into_iter().find(|p| p.name == name);
        match path.map(|p| p.frames) {
            Some(frames) if frame < frames => return Ok((text.to_owned(), 0)),
            None if is_view(name) && frame < entry.frames => return Ok((name.to_owned(), frame)),
            None if !is_view(name) => {}
            frames => {
                let count = frames.unwrap_or(entry.frames);
                return Err(usage(format!("'{text}': there are frames 0 to {}", count.saturating_sub(1))));
            }
        }
    }
    let known: Vec<_> = entry.views.iter().map(|v| v.name.as_str()).collect();
    Err(usage(format!("scene '{}' has no view '{text}'; known: {}", entry.id, known.join(", "))))
}

/// A file that is there and can't be read is a failure; a name for nothing is wrong usage.
fn error(error: rdh_scene::Error) -> Error {
    if error.file.as_ref().is_some_and(|f| f.exists()) { Error::new(error) } else { usage(error.to_string()) }
}
