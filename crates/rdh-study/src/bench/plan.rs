//! What is raced, as plain data.

use std::path::PathBuf;

use rdh::Spec;
use rdh::simd::Level;
use rdh::twin::Leak;

use super::columns::Column;
use super::registry::{Registration, known_engines};
use crate::error::{Error, Result};
use crate::plan::{Target, refuse_twice};

/// A race: scenes × columns × (our specs + engines).
#[derive(Debug, Clone)]
pub struct BenchPlan {
    /// Which scenes; of each, the first of its wanted views.
    pub targets: Vec<Target>,
    /// Our structures.
    pub specs: Vec<Spec>,
    /// The instructions that each of them is traced with, one after the other; if there are none, the best of this CPU.
    pub levels: Vec<Level>,
    /// Of which of them, a `bvh8` or `sbvh8`, leaky twins race: what its watertightness costs.
    pub twin: Option<Spec>,
    /// Kinds of rays.
    pub columns: Vec<Column>,
    /// The competitors that are wanted; those that aren't there are skipped by name.
    pub engines: Vec<Registration>,
    /// The folder of their programs; nothing where none are installed.
    pub programs: Option<PathBuf>,
    /// Pixels of the film, across and down: one primary ray each.
    pub size: usize,
    /// The same for slow competitors.
    pub slow_size: usize,
    /// The same for training rays, which lie elsewhere in their pixels.
    pub training_size: usize,
    /// How often each casts all rays, interleaved with the others.
    pub rounds: usize,
    /// Which share of our hits others may answer differently, before their times don't count.
    pub tolerance: f64,
    /// What the programs of engines may hold together, in bytes; without it, seven tenths of what the machine has free.
    pub memory_bytes: Option<u64>,
    /// Secondary and training rays come from it.
    pub seed: u64,
}

impl Default for BenchPlan {
    /// 1024 × 1024 primary rays, all columns, three of our structures, all known competitors.
    fn default() -> Self {
        Self {
            targets: Vec::new(),
            specs: Self::default_specs(),
            levels: Vec::new(),
            twin: None,
            columns: Column::ALL.to_vec(),
            engines: known_engines(),
            programs: None,
            size: 1024,
            slow_size: 256,
            training_size: 128,
            rounds: 3,
            tolerance: 0.001,
            memory_bytes: None,
            seed: 1,
        }
    }
}

impl BenchPlan {
    /// Our structures that race unless others are named.
    const SPECS: &'static str = "bvh8(high)+sah,bvh8+sah,kd+sah";

    /// The leaky twins' names among those that ours are compared with, and what leaks in them.
    pub const TWINS: [(&'static str, Leak); 3] =
        [("leaky-twin", Leak::Both), ("leaky-boxes", Leak::Boxes), ("leaky-triangles", Leak::Triangles)];

    /// Generated scenes that race beside those of files: 1.6, 1.9, 2.0 and 2.0 million triangles.
    pub const GENERATED: [&'static str; 4] = ["building", "city", "forest", "terrain-large"];
    /// The same for a quick race: 0.09, 0.14, 0.08 and 0.13 million triangles.
    pub const GENERATED_QUICK: [&'static str; 4] = ["rooms", "quarter", "grove", "terrain"];
    /// A quick race leaves out scenes of files that have more triangles.
    pub const QUICK_TRIANGLES: usize = 300_000;
    /// More primary rays than this would not fit into memory with the trees.
    pub const MAX_SIZE: usize = 8192;

    /// A quarter of the rays, and one round less: for a first look.
    pub fn quick() -> Self {
        Self { size: 512, slow_size: 128, rounds: 2, ..Self::default() }
    }

    /// Our structures that race unless others are named.
    pub fn default_specs() -> Vec<Spec> {
        // The text is a constant, and a test parses it.
        Spec::list(Self::SPECS).unwrap_or_default()
    }

    /// Refuses plans that ask for nothing or for nonsense.
    ///
    /// # Errors
    /// [`Error::Plan`], saying what to change.
    pub fn check(&self) -> Result<()> {
        let fail = |why: String| Err(Error::Plan(why));
        refuse_twice("spec", &self.specs)?;
        refuse_twice("column", self.columns.iter().map(|column| column.name()))?;
        refuse_twice("level", self.levels.iter().map(|level| level.name()))?;
        if let Some(twin) = self.twin.filter(|twin| !self.specs.contains(twin)) {
            return fail(format!("the twin's structure '{twin}' does not race itself"));
        }
        let sizes = [self.size, self.slow_size, self.training_size];
        let empty = [
            ("scenes", self.targets.is_empty()),
            ("specs", self.specs.is_empty()),
            ("columns", self.columns.is_empty()),
            ("rays", sizes.contains(&0)),
            ("rounds", self.rounds == 0),
        ];
        if let Some((what, _)) = empty.iter().find(|(_, is_empty)| *is_empty) {
            return fail(format!("nothing to do: no {what}"));
        }
        if sizes.iter().any(|&size| size > Self::MAX_SIZE) {
            return fail(format!("at most {0} x {0} primary rays are possible", Self::MAX_SIZE));
        }
        if !(0.0..=1.0).contains(&self.tolerance) {
            return fail(format!("a tolerance of {} is no share of hits", self.tolerance));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_specs_are_specs() {
        let names: Vec<_> = BenchPlan::default_specs().iter().map(ToString::to_string).collect();
        assert_eq!(names.join(","), BenchPlan::SPECS);
    }

    #[test]
    fn nonsense_is_refused() {
        let target = Target::all(rdh_scene::catalog::find("tetra5", &[]).unwrap());
        let good = BenchPlan { targets: vec![target], ..BenchPlan::default() };
        assert!(good.check().is_ok());
        let wrong = [
            BenchPlan { targets: Vec::new(), ..good.clone() },
            BenchPlan { specs: vec![Spec::default(); 2], ..good.clone() },
            BenchPlan { columns: vec![Column::Ao, Column::Ao], ..good.clone() },
            BenchPlan { levels: vec![Level::PORTABLE; 2], ..good.clone() },
            BenchPlan { twin: Some("bvh8(quick)+sah".parse().unwrap()), ..good.clone() },
            BenchPlan { size: 0, ..good.clone() },
            BenchPlan { size: 10_000, ..good.clone() },
            BenchPlan { rounds: 0, ..good.clone() },
            BenchPlan { tolerance: f64::NAN, ..good.clone() },
        ];
        assert!(wrong.iter().all(|plan| plan.check().is_err()));
    }
}
