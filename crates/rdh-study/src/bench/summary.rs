//! Ours against each base over all scenes, and what builds cost: from the rows alone.

use super::registry::Form;
use super::rows::{BenchDocument, BenchRow, BenchSummary, BuildSummary};
use crate::stats;

impl BenchDocument {
    /// Makes the summaries anew.
    pub fn summarise(&mut self) {
        self.summary = speedups(&self.rows);
        self.builds = builds(&self.rows);
    }

    /// Our Mrays/s over those of the base's fastest mode on the same rays, by medians; nothing if one of them isn't there
    /// or has wrong answers.
    pub fn speedup(&self, row: &BenchRow, base: &str) -> Option<f64> {
        speedup(&self.rows, row, base)
    }
}

fn speedups(rows: &[BenchRow]) -> Vec<BenchSummary> {
    let mut summaries = Vec::new();
    for base in distinct(rows.iter().filter_map(|row| row.base.as_deref())) {
        for column in distinct(rows.iter().map(|row| row.column)) {
            for spec in distinct(rows.iter().filter(|row| row.is_ours()).map(|row| row.engine.as_str())) {
                let ours = rows.iter().filter(|r| r.is_ours() && r.engine == spec && r.column == column);
                let of_scene = |row| Some((row, speedup(rows, row, base)?));
                let speedups: Vec<_> = ours.filter_map(of_scene).collect();
                summaries.extend(summary(base, &speedups));
            }
        }
    }
    summaries
}

fn summary(base: &str, speedups: &[(&BenchRow, f64)]) -> Option<BenchSummary> {
    let (worst_row, worst) = *speedups.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let ratios: Vec<f64> = speedups.iter().map(|(_, s)| *s).collect();
    let clusters: Vec<Vec<f64>> = ratios.iter().map(|&ratio| vec![ratio]).collect();
    Some(BenchSummary {
        form: worst_row.form,
        column: worst_row.column,
        spec: worst_row.engine.clone(),
        profile: worst_row.profile,
        base: base.to_owned(),
        base_mode: "best".to_owned(),
        n: ratios.len(),
        speedup: stats::geometric_mean(&ratios),
        ci95: stats::cluster_bootstrap(&clusters, 1)?,
        worst,
        worst_scene: worst_row.scene.clone(),
    })
}

fn speedup(rows: &[BenchRow], row: &BenchRow, base: &str) -> Option<f64> {
    let others = rows.iter().filter(|other| other.same_case(row) && other.base.as_deref() == Some(base));
    let others = others.filter(|other| row.agrees && other.agrees);
    let ratio = |other: &BenchRow| {
        // Slow ones cast fewer rays, and ours the same.
        let same = other.same_rays.iter().find(|same| same.spec == row.engine);
        let ours = if other.same_rays.is_empty() { Some(row.mrays_per_sec) } else { same.map(|s| s.mrays_per_sec) };
        Some(ours? / other.mrays_per_sec)
    };
    others.filter_map(ratio).min_by(f64::total_cmp)
}

/// Each scene counts once, however many columns it has.
fn builds(rows: &[BenchRow]) -> Vec<BuildSummary> {
    let engine = |name: &str| {
        let mut scenes: Vec<&BenchRow> = Vec::new();
        for row in rows.iter().filter(|row| row.engine == name) {
            if !scenes.iter().any(|known| known.scene == row.scene) {
                scenes.push(row);
            }
        }
        let triangles: usize = scenes.iter().map(|row| row.triangles).sum();
        let build_secs: f64 = scenes.iter().map(|row| row.build_secs).sum();
        let bytes: u64 = scenes.iter().map(|row| row.bytes).sum();
        let per_triangle = |x: f64| x / triangles.max(1) as f64;
        BuildSummary {
            engine: name.to_owned(),
            n: scenes.len(),
            triangles,
            build_secs,
            secs_per_million: per_triangle(build_secs) * 1e6,
            bytes_per_triangle: per_triangle(bytes as f64),
        }
    };
    // Packets share the tree of the single rays.
    let single = rows.iter().filter(|row| row.form == Form::Single);
    distinct(single.map(|row| row.engine.as_str())).into_iter().map(engine).collect()
}

/// In the order in which they come first.
fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut known = Vec::new();
    for item in items {
        if !known.contains(&item) {
            known.push(item);
        }
    }
    known
}
