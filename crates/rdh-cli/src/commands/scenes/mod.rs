//! `rdh scenes`: which scenes there are, or what is in mesh files.

mod contents;

use anyhow::Result;
use rdh_scene::{Entry, Kind, View};
use serde::Serialize;

use crate::args::ScenesArgs;
use crate::context::Context;
use crate::output::{print, print_json};
use crate::pick::Shelf;
use crate::table::{Cell, Table};

/// Prints the list, or the contents of the named scenes and files.
pub(crate) fn run(args: &ScenesArgs, context: &Context) -> Result<()> {
    let shelf = Shelf::open(context.folder.as_deref())?;
    if args.files.is_empty() { list(&shelf, context) } else { contents::print_contents(&args.files, &shelf, context) }
}

#[derive(Serialize)]
struct List<'a> {
    version: u32,
    scenes: Vec<Listed<'a>>,
}

/// A scene of the list.
#[derive(Serialize)]
struct Listed<'a> {
    id: &'a str,
    kind: Kind,
    triangles: usize,
    frames: u32,
    quick: bool,
    embedded: bool,
    about: &'a str,
    views: &'a [View],
}

fn list(shelf: &Shelf, context: &Context) -> Result<()> {
    let embedded = shelf.embedded().iter().map(|e| listed(e, true));
    let scenes = embedded.chain(shelf.indexed().iter().map(|e| listed(e, false))).collect();
    let list = List { version: 1, scenes };
    if context.json { print_json(&list) } else { print(&list_table(&list, context)) }
}

fn listed(entry: &Entry, embedded: bool) -> Listed<'_> {
    Listed {
        id: &entry.id,
        kind: entry.kind,
        triangles: entry.triangles,
        frames: entry.frames,
        quick: entry.quick,
        embedded,
        about: &entry.about,
        views: &entry.views,
    }
}

fn list_table(list: &List<'_>, context: &Context) -> String {
    let mut table = Table::new(&["scene", "kind", ">triangles", ">frames", "", "views", "about"]);
    for scene in &list.scenes {
        let views: Vec<_> = scene.views.iter().map(|v| v.name.as_str()).collect();
        table.push(vec![
            scene.id.into(),
            kind_name(scene.kind).into(),
            scene.triangles.to_string().into(),
            scene.frames.to_string().into(),
            if scene.quick { "quick" } else { "" }.into(),
            views.join(" ").into(),
            Cell::styled(scene.about, context.styles.faint),
        ]);
    }
    let views: usize = list.scenes.iter().map(|s| s.views.len()).sum();
    table.text(context.styles.head) + &format!("\n{} scenes, {views} views\n", list.scenes.len())
}

fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Open => "open",
        Kind::Interior => "interior",
        Kind::Dense => "dense",
    }
}
