//! Which scenes and views.

use rdh_scene::{Entry, View};

/// A scene and the views that are wanted of it.
#[derive(Debug, Clone)]
pub struct Target {
    /// The scene.
    pub entry: Entry,
    /// Names of the wanted views; empty for all.
    pub views: Vec<String>,
    /// The frames; usually only 0, the scene at rest.
    pub frames: Vec<u32>,
}

impl Target {
    /// A scene at rest, with all its views.
    pub fn all(entry: Entry) -> Self {
        Self { entry, views: Vec::new(), frames: vec![0] }
    }

    /// A scene at rest, with one of its views.
    pub fn view(entry: Entry, view: impl Into<String>) -> Self {
        Self { entry, views: vec![view.into()], frames: vec![0] }
    }

    /// How many views it will have, as far as is known before it is loaded.
    pub(crate) fn views_expected(&self) -> usize {
        self.view_names().len()
    }

    pub(crate) fn view_names(&self) -> Vec<String> {
        if self.views.is_empty() {
            self.entry.views.iter().map(|v| v.name.clone()).collect()
        } else {
            self.views.clone()
        }
    }

    /// The wanted views, once the scene is loaded: those of the catalogue, else the scene's own, else one from outside.
    ///
    /// # Errors
    /// An unknown name, with the known ones.
    pub fn resolve(&self, own: &[View], overview: impl FnOnce() -> View) -> Result<Vec<View>, String> {
        let mut known = if self.entry.views.is_empty() { own.to_vec() } else { self.entry.views.clone() };
        if known.is_empty() {
            known.push(overview());
        }
        if self.views.is_empty() {
            return Ok(known);
        }
        let find = |name: &String| {
            if let Some(view) = path_view(&self.entry, name, 0)? {
                return Ok(view);
            }
            find_view(&known, name).cloned()
        };
        self.views.iter().map(find).collect()
    }
}

/// A view by name.
///
/// # Errors
/// An unknown name, with the known ones.
pub(crate) fn find_view<'v>(views: &'v [View], name: &str) -> Result<&'v View, String> {
    let names = || views.iter().map(|v| v.name.as_str()).collect::<Vec<_>>().join(", ");
    views.iter().find(|v| v.name == name).ok_or_else(|| format!("unknown view '{name}'; known: {}", names()))
}

/// A view along a camera path of a scene, some frames before the named one: `walk@60`. Nothing for other names.
///
/// # Errors
/// A path that there isn't; a frame that isn't a number, or lies before the path's first one.
pub(crate) fn path_view(entry: &Entry, name: &str, before: u32) -> Result<Option<View>, String> {
    let Some((path, frame)) = name.split_once('@') else { return Ok(None) };
    let paths = entry.paths().map_err(|e| e.to_string())?;
    let path = paths.iter().find(|p| p.name == path).ok_or_else(|| format!("there is no path '{path}'"))?;
    let frame: u32 = frame.parse().map_err(|_| format!("'{name}': the frame isn't a number"))?;
    let frame = frame.checked_sub(before).ok_or_else(|| format!("'{name}' has no frame {before} before it"))?;
    Ok(path.at(frame))
}
