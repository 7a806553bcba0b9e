//! One module a command.

pub(crate) mod bench;
pub(crate) mod build;
pub(crate) mod cast;
pub(crate) mod compare;
pub(crate) mod convert;
pub(crate) mod merge;
pub(crate) mod rays;
pub(crate) mod record;
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod scenes;
pub(crate) mod shell;
pub(crate) mod study;
pub(crate) mod tune;
pub(crate) mod verify;
