//! `rdh completions` and `rdh man`.

use std::fs;

use anyhow::{Context as _, Result};
use clap::CommandFactory;

use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::output::print;

/// Prints a shell's completions.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "rdh", &mut text);
    print(&String::from_utf8(text)?)
}

/// Prints the manual page, or writes those of all commands.
pub(crate) fn man(args: &ManArgs) -> Result<()> {
    let command = Cli::command();
    if let Some(folder) = &args.output {
        let named = || format!("{} can't be written", folder.display());
        fs::create_dir_all(folder).with_context(named)?;
        return clap_mangen::generate_to(command, folder).with_context(named);
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    print(&String::from_utf8(page)?)
}
