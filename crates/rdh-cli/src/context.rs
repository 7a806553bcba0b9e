//! What the global arguments mean: who may print what, where scenes are, how many threads there are.

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context as _, Result};
use clap::ColorChoice;
use clap::builder::styling::{AnsiColor, Style};
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use tracing::level_filters::LevelFilter;
use tracing_subscriber::fmt::MakeWriter;

use crate::args::Global;

/// What every command needs to know.
#[derive(Debug)]
pub(crate) struct Context {
    /// Standard output carries JSON and nothing else.
    pub json: bool,
    /// The folder of further scenes.
    pub folder: Option<PathBuf>,
    /// What all randomness comes from.
    pub seed: u64,
    /// How many threads were asked for.
    pub threads: Option<usize>,
    /// Styles of standard output.
    pub styles: Styles,
    bars: MultiProgress,
}

/// Styles of tables; all plain where colours are not wanted.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Styles {
    pub head: Style,
    pub faint: Style,
    pub better: Style,
    pub worse: Style,
}

impl Styles {
    const COLOURED: Self = Self {
        head: Style::new().bold(),
        faint: Style::new().dimmed(),
        better: AnsiColor::Green.on_default(),
        worse: AnsiColor::Red.on_default(),
    };
}

impl Context {
    /// Starts logging and rayon's threads.
    pub(crate) fn new(global: &Global) -> Result<Self> {
        let bars = if global.quiet { hidden() } else { MultiProgress::new() };
        start_log(global, &bars);
        if let Some(threads) = global.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build_global().with_context(|| format!("{threads} threads can't be started"))?;
        }
        Ok(Self {
            json: global.json,
            folder: global.scenes.clone(),
            seed: global.seed,
            threads: global.threads,
            styles: if colours(global.color, io::stdout().is_terminal()) {
                Styles::COLOURED
            } else {
                Styles::default()
            },
            bars,
        })
    }

    /// A progress bar on standard error; invisible unless that is a terminal.
    pub(crate) fn bar(&self, steps: u64) -> ProgressBar {
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed}, {eta} left  {wide_msg}");
        let bar = ProgressBar::new(steps).with_style(style.expect("the template is constant and has been tried"));
        let bar = self.bars.add(bar);
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }
}

fn hidden() -> MultiProgress {
    MultiProgress::with_draw_target(ProgressDrawTarget::hidden())
}

/// Whether output is coloured. `NO_COLOR` (no-color.org) counts unless colours are asked for by name.
fn colours(choice: ColorChoice, terminal: bool) -> bool {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    match choice {
        ColorChoice::Always => true,
        ColorChoice::Never => false,
        ColorChoice::Auto => terminal && !refused,
    }
}

fn start_log(global: &Global, bars: &MultiProgress) {
    let level = match (global.quiet, global.verbose) {
        (true, _) => LevelFilter::ERROR,
        (false, 0) => LevelFilter::WARN,
        (false, 1) => LevelFilter::INFO,
        (false, 2) => LevelFilter::DEBUG,
        (false, _) => LevelFilter::TRACE,
    };
    let log = tracing_subscriber::fmt().with_max_level(level).without_time().with_target(global.verbose > 1);
    let log = log.with_ansi(colours(global.color, io::stderr().is_terminal()));
    log.with_writer(BesideBars(bars.clone())).init();
}

/// Standard error, with the bars taken away while a line is written.
#[derive(Debug, Clone)]
struct BesideBars(MultiProgress);

impl Write for BesideBars {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.suspend(|| io::stderr().write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}

impl<'a> MakeWriter<'a> for BesideBars {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_by_name_beats_the_terminal() {
        assert!(colours(ColorChoice::Always, false));
        assert!(!colours(ColorChoice::Never, true));
        assert!(!colours(ColorChoice::Auto, false));
    }
}
