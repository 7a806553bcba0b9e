//! What mesh files and scenes hold.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use rdh::{Aabb, Vec3};
use rdh_scene::formats::{mesh_files, read_file};
use rdh_scene::{Note, Scene};
use serde::Serialize;

use crate::context::Context;
use crate::output::{print, print_json};
use crate::pick::Shelf;
use crate::table::{Cell, Table, short_coordinate};

#[derive(Serialize)]
struct Contents {
    version: u32,
    files: Vec<Content>,
}

/// What a mesh file, or a scene, holds.
#[derive(Debug, Serialize)]
struct Content {
    file: String,
    geometries: usize,
    instances: usize,
    /// All instances counted.
    triangles: usize,
    /// Every geometry counted once.
    unique_triangles: usize,
    /// Of `triangles`, those of exactly no area.
    zero_area: usize,
    materials: usize,
    lights: usize,
    views: usize,
    /// In world coordinates; null for a scene without triangles.
    bounds_min: Option<[f64; 3]>,
    bounds_max: Option<[f64; 3]>,
    /// The world coordinates of the scene's own `[0, 0, 0]`.
    origin: [f64; 3],
    /// What was dropped or repaired.
    notes: Vec<Note>,
    secs: f64,
}

pub(super) fn print_contents(names: &[String], shelf: &Shelf, context: &Context) -> Result<()> {
    let names = with_folders_opened(names)?;
    let bar = context.bar(names.len() as u64);
    let mut files = Vec::new();
    for name in &names {
        bar.set_message(name.clone());
        files.push(content(name, shelf)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let contents = Contents { version: 1, files };
    if context.json { print_json(&contents) } else { print(&contents_text(&contents, context)) }
}

/// A folder stands for all mesh files in it.
fn with_folders_opened(names: &[String]) -> Result<Vec<String>> {
    let mut all = Vec::new();
    for name in names {
        if Path::new(name).is_dir() {
            all.extend(mesh_files(Path::new(name))?.iter().map(|p| p.display().to_string()));
        } else {
            all.push(name.clone());
        }
    }
    Ok(all)
}

fn content(name: &str, shelf: &Shelf) -> Result<Content> {
    let file = Path::new(name);
    let entry = if file.is_file() { None } else { Some(shelf.find(name)?.entry) };
    let start = Instant::now();
    let scene = match &entry {
        None => read_file(file)?,
        Some(entry) => entry.load(0).with_context(|| format!("scene '{name}'"))?,
    };
    Ok(Content::of(name, scene, start.elapsed().as_secs_f64()))
}

impl Content {
    fn of(name: &str, scene: Scene, secs: f64) -> Self {
        let bounds = world_bounds(&scene);
        Self {
            file: name.to_owned(),
            geometries: scene.geometries.len(),
            instances: scene.instances.len(),
            triangles: scene.triangle_count(),
            unique_triangles: scene.geometries.iter().map(|g| g.triangles.len()).sum(),
            zero_area: scene.zero_area_count(),
            materials: scene.materials.len(),
            lights: scene.lights.len(),
            views: scene.views.len(),
            bounds_min: bounds.map(|(min, _)| min),
            bounds_max: bounds.map(|(_, max)| max),
            origin: scene.origin,
            notes: scene.notes,
            secs,
        }
    }
}

fn world_bounds(scene: &Scene) -> Option<([f64; 3], [f64; 3])> {
    let mut bounds = Aabb::EMPTY;
    for instance in &scene.instances {
        let geometry = &scene.geometries[instance.geometry];
        let used = geometry.triangles.iter().flatten().filter_map(|&i| geometry.positions.get(i as usize));
        let place = |p: &Vec3| instance.scene_from_object.point(p.map(f64::from)).map(|x| x as f32);
        bounds = used.map(place).fold(bounds, Aabb::with);
    }
    let world = |p: Vec3| [0, 1, 2].map(|a| f64::from(p[a]) + scene.origin[a]);
    (!bounds.is_empty()).then(|| (world(bounds.min), world(bounds.max)))
}

fn contents_text(contents: &Contents, context: &Context) -> String {
    let columns =
        ["file", ">geometries", ">instances", ">triangles", ">unique", ">zero area", ">seconds", "bounds", "origin"];
    let mut table = Table::new(&columns);
    for file in &contents.files {
        let numbers = [file.geometries, file.instances, file.triangles, file.unique_triangles, file.zero_area];
        let mut row = vec![Cell::from(&*file.file)];
        row.extend(numbers.map(|n| Cell::from(n.to_string())));
        row.push(format!("{:.3}", file.secs).into());
        row.push(bounds_text(file).into());
        row.push(
            if file.origin == [0.0; 3] { String::new() } else { file.origin.map(short_coordinate).join(" ") }.into(),
        );
        table.push(row);
    }
    let faint = context.styles.faint;
    let line = |file: &Content| {
        let notes: Vec<_> = file.notes.iter().map(|n| format!("{} {}", n.count, n.what)).collect();
        format!("{}{}: {}{}\n", faint.render(), file.file, notes.join("; "), faint.render_reset())
    };
    let notes: String = contents.files.iter().filter(|file| !file.notes.is_empty()).map(line).collect();
    let notes = if notes.is_empty() { notes } else { format!("\nNot used, or repaired:\n{notes}") };
    table.text(context.styles.head) + &notes
}

fn bounds_text(file: &Content) -> String {
    let (Some(min), Some(max)) = (file.bounds_min, file.bounds_max) else { return "empty".to_owned() };
    let side = |a: usize| format!("{}..{}", short_coordinate(min[a]), short_coordinate(max[a]));
    [0, 1, 2].map(side).join(" ")
}
