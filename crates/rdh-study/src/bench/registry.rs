//! The competitors that are known: which program casts, what it is asked to build, what ours is compared with.

use serde::{Deserialize, Serialize};

/// A competitor, under the name of the base that it makes: ours are compared with the fastest of its modes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Registration {
    /// The base's name: `embree4-robust`.
    pub name: String,
    /// The program's name, in the folder of the engines.
    pub program: String,
    /// What is built, each raced by itself.
    pub modes: Vec<String>,
    /// How it is handed the rays.
    pub form: Form,
    /// How many rays it casts: slow ones get fewer.
    pub pace: Pace,
    /// Which queries it has.
    pub queries: Queries,
    /// Memory of its program once it has built, in bytes a triangle: its tree and its copies of the mesh.
    pub bytes_per_triangle: usize,
    /// It takes no part in larger scenes, where it would build for minutes.
    pub most_triangles: usize,
}

/// How rays are handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// One by one.
    Single,
    /// Eight or sixteen at a time, as wide as the instructions are; coherent rays only.
    Packets,
    /// All at once; ours alone.
    Batch,
}

/// How many rays a competitor casts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// As many as ours.
    Full,
    /// [`BenchPlan::slow_size`](super::BenchPlan::slow_size) squared; ours cast the same rays once more, to be compared.
    Slow,
}

/// Which queries a competitor has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Queries {
    /// Closest and any hit.
    Both,
    /// Only the closest: it takes no part in columns that ask for any hit.
    Closest,
}

impl Form {
    /// The word in requests, and in names.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Packets => "packets",
            Self::Batch => "batch",
        }
    }
}

/// All competitors, in the order of tables.
pub fn known_engines() -> Vec<Registration> {
    let embree = |name: &str, program: &str, form, modes: &[&str]| Registration {
        form,
        bytes_per_triangle: 110,
        ..Registration::new(name, program, modes)
    };
    let slow = |name: &str, program: &str, modes: &[&str], bytes_per_triangle| Registration {
        pace: Pace::Slow,
        bytes_per_triangle,
        ..Registration::new(name, program, modes)
    };
    let default = ["high-avx2", "high-avx512", "medium-avx2", "medium-avx512"];
    // Embree builds the same for high quality: no spatial splits where edges are to be watertight.
    let robust = ["medium-robust-avx2", "medium-robust-avx512"];
    vec![
        embree("embree4", "rdh-engine-embree4", Form::Single, &default),
        embree("embree4-robust", "rdh-engine-embree4", Form::Single, &robust),
        embree("embree4-pkt16", "rdh-engine-embree4", Form::Packets, &default),
        embree("embree3", "rdh-engine-embree3", Form::Single, &default),
        Registration::new("obvhs", "rdh-engine-obvhs", &["cwbvh-very_slow", "bvh2-very_slow", "cwbvh-medium"]),
        Registration {
            queries: Queries::Closest,
            ..Registration::new("tinybvh", "rdh-engine-tinybvh", &["bvh8", "bvh8-hq"])
        },
        slow("parry3d", "rdh-engine-parry3d", &["default"], 120),
        slow("bvh", "rdh-engine-bvh", &["default"], 270),
        Registration { most_triangles: 2_500_000, ..slow("kdtree-ray", "rdh-engine-kdtree-ray", &["default"], 700) },
    ]
}

impl Registration {
    /// A competitor that gets all rays, one by one.
    pub fn new(name: &str, program: &str, modes: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            program: program.to_owned(),
            modes: modes.iter().map(|&mode| mode.to_owned()).collect(),
            form: Form::Single,
            pace: Pace::Full,
            queries: Queries::Both,
            bytes_per_triangle: 170,
            most_triangles: usize::MAX,
        }
    }

    /// The name of one of its modes in tables: `embree4(high-avx2)`.
    pub(crate) fn label(&self, mode: &str) -> String {
        format!("{}({mode})", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let engines = known_engines();
        for (i, engine) in engines.iter().enumerate() {
            assert!(!engine.modes.is_empty() && engines[..i].iter().all(|other| other.name != engine.name));
        }
    }
}
