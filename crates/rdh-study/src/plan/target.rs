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
            let names = || known.iter().map(|v| v.name.as_str()).collect::<Vec<_>>().join(", ");
            let found = known.iter().find(|v| v.name == *name).cloned();
            found.ok_or_else(|| format!("unknown view '{name}'; known: {}", names()))
        };
        self.views.iter().map(find).collect()
    }
}
