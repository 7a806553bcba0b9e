//! Tables for people, JSON for programs.

use anyhow::Result;
use rdh_study::stats;
use serde_json::{Value, json};

use super::columns::Column;

/// What was found out.
#[derive(Default)]
pub(crate) struct Report {
    pub(crate) rows: Vec<Row>,
    /// Answers that differ by more than they may.
    pub(crate) faults: Vec<Fault>,
}

/// Answers that differ by more than they may, in words.
pub(crate) struct Fault(pub(crate) String);

/// What others' builds are grouped by: ours are compared with the best of each group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Base {
    Embree4,
    Embree4Robust,
}

/// One contender on the rays of one column of one scene.
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) view: String,
    pub(crate) column: Column,
    pub(crate) engine: String,
    /// Nothing for ours.
    pub(crate) base: Option<Base>,
    /// Whether it was built for rays.
    pub(crate) trained: bool,
    pub(crate) rays: usize,
    pub(crate) hits: u64,
    pub(crate) t_sum: f64,
    /// By the median round.
    pub(crate) mrays_per_sec: f64,
    /// By the fastest round.
    pub(crate) mrays_per_sec_best: f64,
    pub(crate) build_secs: f64,
    pub(crate) bytes: u64,
}

/// Our structure against a group of others in a column, over all scenes.
struct Summary {
    column: Column,
    spec: String,
    trained: bool,
    base: Base,
    /// Scene and our Mrays/s over the base's best.
    speedups: Vec<(String, f64)>,
}

impl Base {
    const ALL: [Self; 2] = [Self::Embree4, Self::Embree4Robust];

    fn name(self) -> &'static str {
        match self {
            Self::Embree4 => "embree4",
            Self::Embree4Robust => "embree4-robust",
        }
    }
}

impl Row {
    fn same_rays(&self, other: &Self) -> bool {
        (&self.scene, &self.view, self.column) == (&other.scene, &other.view, other.column)
    }

    fn json(&self) -> Value {
        json!({
            "scene": self.scene, "view": self.view, "column": self.column.name(), "engine": self.engine,
            "mrays_per_sec": self.mrays_per_sec, "mrays_per_sec_best": self.mrays_per_sec_best,
            "rays": self.rays, "hits": self.hits, "t_sum": self.t_sum,
            "build_secs": self.build_secs, "bytes": self.bytes,
        })
    }
}

impl Summary {
    fn speedup(&self) -> f64 {
        stats::geometric_mean(&self.ratios())
    }

    fn ratios(&self) -> Vec<f64> {
        self.speedups.iter().map(|(_, s)| *s).collect()
    }

    fn worst(&self) -> Option<&(String, f64)> {
        self.speedups.iter().min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn json(&self) -> Value {
        let clusters: Vec<_> = self.ratios().into_iter().map(|r| vec![r]).collect();
        json!({
            "form": "single", "column": self.column.name(), "spec": self.spec,
            "profile": if self.trained { "guided" } else { "none" },
            "base": self.base.name(), "base_mode": "best", "n": self.speedups.len(), "speedup": self.speedup(),
            "ci95": stats::cluster_bootstrap(&clusters, 1),
            "worst": self.worst().map(|(_, s)| s), "worst_scene": self.worst().map(|(scene, _)| scene),
        })
    }
}

impl Report {
    /// One document on standard output.
    pub(crate) fn print_json(&self) -> Result<()> {
        let rows: Vec<_> = self.rows.iter().map(Row::json).collect();
        let summary: Vec<_> = self.summaries().iter().map(Summary::json).collect();
        let faults: Vec<_> = self.faults.iter().map(|f| &f.0).collect();
        let document = json!({"version": 1, "rows": rows, "summary": summary, "faults": faults});
        println!("{}", serde_json::to_string_pretty(&document)?);
        Ok(())
    }

    /// A table a scene and column, then the summary.
    pub(crate) fn print_table(&self) {
        println!(
            "{:<24} {:<7} {:<26} {:>8} {:>8} {:>10} {:>10} {:>9} {:>9}",
            "scene", "column", "engine", "Mrays/s", "best", "vs embree4", "hits", "build s", "MB"
        );
        for row in &self.rows {
            println!("{}", self.line(row));
        }
        println!("\nours / the base's best build, geometric mean over scenes; above 1 is better");
        for s in self.summaries() {
            let (scene, worst) = s.worst().cloned().unwrap_or_default();
            let (column, name, base, n) = (s.column.name(), &s.spec, s.base.name(), s.speedups.len());
            println!("{column:<7} {name:<26} / {base:<14} {:>6.2}  (n = {n}, worst {worst:.2}: {scene})", s.speedup());
        }
        for fault in &self.faults {
            eprintln!("FAULT: {}", fault.0);
        }
    }

    fn line(&self, row: &Row) -> String {
        let ours = row.base.is_none();
        let speedup = ours.then(|| self.speedup(row, Base::Embree4)).flatten().map(|s| format!("{s:.2}"));
        // Ours: the share of rays that hit. Others: how many more or fewer hits than our first structure has.
        let first = self.rows.iter().find(|r| r.same_rays(row)).map_or(row.hits, |r| r.hits);
        let hits = if ours {
            format!("{:.1} %", 100.0 * row.hits as f64 / row.rays as f64)
        } else {
            format!("{:+}", row.hits.cast_signed() - first.cast_signed())
        };
        format!(
            "{:<24} {:<7} {:<26} {:>8.2} {:>8.2} {:>10} {:>10} {:>9.2} {:>9.1}",
            format!("{}:{}", row.scene, row.view),
            row.column.name(),
            row.engine,
            row.mrays_per_sec,
            row.mrays_per_sec_best,
            speedup.unwrap_or_default(),
            hits,
            row.build_secs,
            row.bytes as f64 / 1e6
        )
    }

    /// Our Mrays/s over those of the base's fastest build on the same rays, by medians.
    fn speedup(&self, row: &Row, base: Base) -> Option<f64> {
        let others = self.rows.iter().filter(|r| r.same_rays(row) && r.base == Some(base));
        let best = others.map(|r| r.mrays_per_sec).max_by(f64::total_cmp)?;
        Some(row.mrays_per_sec / best)
    }

    fn summaries(&self) -> Vec<Summary> {
        let mut summaries: Vec<Summary> = Vec::new();
        for base in Base::ALL {
            for row in self.rows.iter().filter(|r| r.base.is_none()) {
                let Some(speedup) = self.speedup(row, base) else { continue };
                let place = (row.scene.clone(), speedup);
                let same = |s: &&mut Summary| s.column == row.column && s.spec == row.engine && s.base == base;
                match summaries.iter_mut().find(same) {
                    Some(summary) => summary.speedups.push(place),
                    None => summaries.push(Summary {
                        column: row.column,
                        spec: row.engine.clone(),
                        trained: row.trained,
                        base,
                        speedups: vec![place],
                    }),
                }
            }
        }
        summaries
    }
}
