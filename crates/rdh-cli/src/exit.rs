//! How the program ends: 0 fine, 1 failed, 2 usage, 3 a verification failed.

use std::fmt;
use std::io;
use std::process::ExitCode;

use anyhow::Error;

/// What was typed makes no sense: exit code 2.
#[derive(Debug)]
pub(crate) struct Usage(pub String);

/// Results that must agree don't: exit code 3.
#[derive(Debug)]
pub(crate) struct Disagreement(pub String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}
impl std::error::Error for Disagreement {}

/// A usage error, ready to be returned.
pub(crate) fn usage(message: impl Into<String>) -> Error {
    Error::new(Usage(message.into()))
}

/// The exit code of a result; an error is said on standard error, its chain only: a backtrace is of no use to users.
pub(crate) fn code(result: anyhow::Result<()>) -> ExitCode {
    let Err(error) = result else { return ExitCode::SUCCESS };
    // Whoever reads our output has seen enough: `rdh scenes | head -1` is no failure.
    if error.chain().any(is_broken_pipe) {
        return ExitCode::SUCCESS;
    }
    eprintln!("error: {}", chain(&error));
    ExitCode::from(number(&error))
}

fn number(error: &Error) -> u8 {
    if error.chain().any(|e| e.is::<Usage>()) {
        2
    } else if error.chain().any(|e| e.is::<Disagreement>()) {
        3
    } else {
        1
    }
}

/// The causes, outermost first. Some errors repeat their cause's text; that is said once.
fn chain(error: &Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.ends_with(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

fn is_broken_pipe(error: &(dyn std::error::Error + 'static)) -> bool {
    error.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe)
}

#[cfg(test)]
mod tests {
    use anyhow::Context as _;

    use super::*;

    #[test]
    fn the_kind_of_error_survives_its_context() {
        let usage = Err::<(), _>(usage("no such scene")).context("compare").unwrap_err();
        assert_eq!((number(&usage), chain(&usage).as_str()), (2, "compare: no such scene"));
        assert_eq!(number(&Error::new(Disagreement("hits differ".into()))), 3);
        assert_eq!(number(&anyhow::anyhow!("disk full")), 1);
    }

    #[test]
    fn a_cause_is_said_once() {
        let inner = io::Error::other("disk full");
        let error = Error::new(inner).context("a.rays: disk full");
        assert_eq!(chain(&error), "a.rays: disk full");
    }
}
