//! Arguments of `rdh completions` and `rdh man`.

use std::path::PathBuf;

use clap_complete::Shell;

/// Print what a shell needs to complete arguments of rdh.
///
/// For example `rdh completions bash > ~/.local/share/bash-completion/completions/rdh`.
#[derive(Debug, clap::Args)]
pub(crate) struct CompletionsArgs {
    /// Which shell
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

/// Print the manual page, or write those of all commands.
#[derive(Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// A folder for one page a command
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}
