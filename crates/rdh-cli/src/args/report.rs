//! Arguments of `rdh report`.

use std::path::PathBuf;

/// Make one self-contained page of a study: what was found, in words, tables and plots.
///
/// The page needs no network and no script, and can be sent to a colleague or printed. It is made from the study's records, finished or not;
/// pictures of a few views are drawn anew.
#[derive(Debug, clap::Args)]
pub(crate) struct ReportArgs {
    /// Folders of `rdh study --out`: one study, or its shards
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// The page to write [default: report.html in the first folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw no pictures: nothing is built or traced then
    #[arg(long)]
    pub no_pictures: bool,
    /// Write the tables as Markdown, too
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// The machine that measured, as the page names it [default: this one]
    #[arg(long, value_name = "TEXT")]
    pub machine: Option<String>,
}
