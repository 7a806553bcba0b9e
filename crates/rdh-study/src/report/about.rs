//! What a report says of itself: where its figures come from. The library asks no clock and no machine, so all is passed in.

/// What is not in the records.
#[derive(Debug, Clone, Default)]
pub struct About {
    /// When the report was made, as text.
    pub date: String,
    /// The program's version.
    pub version: String,
    /// The processor and the system.
    pub machine: String,
    /// The commands that make the study and the report again.
    pub commands: Vec<String>,
    /// The study's settings, as names and values in words.
    pub settings: Vec<(String, String)>,
    /// Jobs of the study that have no record yet.
    pub missing: usize,
    /// Views as pictures.
    pub pictures: Vec<Picture>,
}

/// Pictures of one view.
#[derive(Debug, Clone)]
pub struct Picture {
    /// `scene:view`.
    pub place: String,
    /// Why it is shown, in words.
    pub why: String,
    /// What is shown, row by row.
    pub rows: Vec<Vec<Panel>>,
}

/// One picture.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    /// Which structure, or what.
    pub title: String,
    /// A figure or two.
    pub note: String,
    /// What it shows, for those who can't see it.
    pub says: String,
    /// A whole PNG file.
    pub png: Vec<u8>,
    /// Its width and height in pixels.
    pub size: [usize; 2],
    /// What its colours mean.
    pub scale: Option<Scale>,
}

/// A scale of colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// What is counted.
    pub label: String,
    /// The numbers at both ends.
    pub ends: [f64; 2],
    /// Colours from the first end to the second, evenly spaced, as sRGB.
    pub colours: Vec<[u8; 3]>,
}
