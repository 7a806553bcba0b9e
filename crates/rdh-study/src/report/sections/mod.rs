//! The report's sections, in order; each looks at one experiment, and is left out where that is not in the data.

mod aa;
mod assumptions;
mod blend;
mod bound;
mod common;
mod controls;
mod costs;
mod curves;
mod frames;
mod glance;
mod how_many;
mod kinds;
mod losses;
mod methods;
mod modes;
mod occlusion;
mod other;
mod paper;
mod pictures;
mod scenes;
mod spd;
mod termination;
mod which_rays;

use maud::Markup;

use super::view::Study;

pub(super) use glance::glance;

/// What a section says.
#[derive(Debug)]
pub(super) struct Section {
    /// Sentences that follow from the data, without the full stop; the first of them stands in the summary too.
    pub findings: Vec<Markup>,
    /// Tables and figures.
    pub body: Markup,
}

/// A section in the table below.
pub(super) struct Chapter {
    /// For links.
    pub id: &'static str,
    pub title: &'static str,
    /// What the section asks; empty where it asks nothing.
    pub question: &'static str,
    /// What it says; nothing if its experiment is not in the data.
    pub write: fn(&Study<'_>) -> Option<Section>,
}

/// The sections in their order.
pub(super) const CHAPTERS: &[Chapter] = &[
    paper::CHAPTER,
    modes::CHAPTER,
    kinds::CHAPTER,
    pictures::CHAPTER,
    occlusion::CHAPTER,
    assumptions::CHAPTER,
    how_many::CHAPTER,
    which_rays::CHAPTER,
    blend::CHAPTER,
    termination::CHAPTER,
    frames::CHAPTER,
    controls::CHAPTER,
    bound::CHAPTER,
    costs::CHAPTER,
    aa::CHAPTER,
    spd::CHAPTER,
    other::CHAPTER,
    losses::CHAPTER,
    scenes::CHAPTER,
    methods::CHAPTER,
];
