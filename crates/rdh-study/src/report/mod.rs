//! From a study's records to one self-contained page that a researcher can send to a colleague.
//!
//! ```text
//!  page        title, summary, contents, and the sections in order
//!  sections    one experiment each: what it asks, what was found, tables and figures
//!  markdown    the effects as plain tables
//!  shown       which views are worth a picture
//!  group       which pairs stand in one line
//!  figure, table, words    plots in two widths; effects as tables; numbers as sentences
//!  svg         plots
//!  view        the study as sections see it
//!  effect      mean ratios with intervals, wins and losses
//!  pairs       a structure and the base of its setting, on the same rays
//! ```
//! Sentences follow from the figures: whoever changes the data changes what is said. Nothing here reads files or clocks; what the
//! records don't hold is passed in by [`About`].

mod about;
mod effect;
mod figure;
mod group;
mod markdown;
mod page;
mod pairs;
mod sections;
mod shown;
mod svg;
mod table;
mod view;
mod words;

pub use about::{About, Panel, Picture, Scale};
pub use shown::{Shown, views_to_show};
pub use words::short_number;

use crate::study::Record;

/// The report as one HTML document.
pub fn html(records: &[Record], about: &About) -> String {
    page::page(&view::Study::new(records, about))
}

/// The effects of every experiment as tables in Markdown.
pub fn markdown(records: &[Record]) -> String {
    markdown::tables(&view::Study::new(records, &About::default()))
}
