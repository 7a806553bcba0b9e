//! `cargo xtask browser FILE.html`: a page in a real browser, at the widths of a phone, a tablet and a desk, in light and dark.
//!
//! ```text
//!  visit        one look at the page: load it, collect complaints, take a picture
//!  chromium     the browser's process, spoken to by its debugging protocol through a pipe
//!  checks.js    what is looked for in the page itself
//! ```

mod chromium;
mod visit;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use chromium::Chromium;
use visit::{Look, Scheme};

/// Look at a page in a real browser (Chromium), and complain.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The page
    #[arg(value_name = "FILE.html")]
    page: PathBuf,
    /// Widths of the window in pixels
    #[arg(long, value_delimiter = ',', default_value = "360,800,1400", value_parser = clap::value_parser!(u32).range(200..=8000))]
    widths: Vec<u32>,
    /// Write pictures of every look, and the page as it is printed, into this folder
    #[arg(long, value_name = "DIR")]
    screenshots: Option<PathBuf>,
    /// The browser [default: CHROMIUM, else the first of chromium, chromium-browser, google-chrome that is there]
    #[arg(long, value_name = "PROGRAM")]
    chromium: Option<PathBuf>,
}

/// Whether there is nothing to complain about.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let page = fs::canonicalize(&arguments.page).with_context(|| arguments.page.display().to_string())?;
    if let Some(folder) = &arguments.screenshots {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let mut browser = Chromium::start(arguments.chromium.as_deref())?;
    let mut faultless = true;
    for scheme in [Scheme::Light, Scheme::Dark] {
        for &width in &arguments.widths {
            let look = Look { width, scheme };
            let faults = visit::visit(&mut browser, &page, &look)?;
            println!(
                "{look}: {}",
                if faults.is_empty() { "fine".to_owned() } else { format!("{} faults", faults.len()) }
            );
            faults.iter().for_each(|fault| println!("  {fault}"));
            faultless &= faults.is_empty();
            if let Some(folder) = &arguments.screenshots {
                write(&folder.join(format!("{look}.png")), &visit::screenshot(&mut browser)?)?;
            }
        }
    }
    if let Some(folder) = &arguments.screenshots {
        write(&folder.join("print.pdf"), &visit::print(&mut browser)?)?;
    }
    Ok(faultless)
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).with_context(|| path.display().to_string())
}
