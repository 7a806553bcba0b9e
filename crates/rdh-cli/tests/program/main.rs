//! The program from outside: what it prints, writes, and how it ends.

mod bench;
mod cast;
mod compare;
mod guide;
mod rays;
mod render;
mod report;
mod run;
mod scenes;
mod study;
mod trees;
mod tune;
mod usage;
