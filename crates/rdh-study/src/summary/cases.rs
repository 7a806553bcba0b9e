//! Rows sorted into cases: what each spec did with the same rays.

use std::collections::BTreeMap;

use rdh::RayClass;
use rdh_scene::Kind;

use crate::integrate::Mode;
use crate::rows::Row;

/// Which rows belong together: scene, view, frame, seed, protocol.
pub(super) type CaseKey = (String, String, u32, u64, String);
pub(super) type Cases = BTreeMap<CaseKey, Case>;

/// The same rays through several structures.
pub(super) struct Case {
    pub(super) kind: Kind,
    /// By the specs' text.
    pub(super) cells: BTreeMap<String, Cell>,
}

/// What one spec did in one case, in totals over its rays.
#[derive(Clone, Default)]
pub(super) struct Cell {
    pub(super) steps: f64,
    pub(super) tests: f64,
    /// The worst of the classes.
    pub(super) cost_p999: f64,
    pub(super) round_nanos: Vec<f64>,
    pub(super) build_secs: f64,
    pub(super) rrs_secs: f64,
    pub(super) references: f64,
    pub(super) bytes: f64,
}

/// Cases by mode and class; `None` is all classes together.
pub(super) struct Groups(BTreeMap<(Mode, Option<RayClass>), Cases>);

impl Groups {
    pub(super) fn of(rows: &[&Row]) -> Self {
        let mut groups: BTreeMap<(Mode, Option<RayClass>), Cases> = BTreeMap::new();
        for row in rows {
            for class in [Some(row.class), None] {
                let cases = groups.entry((row.mode, class)).or_default();
                let new = || Case { kind: row.kind, cells: BTreeMap::new() };
                let case = cases.entry(key(row)).or_insert_with(new);
                case.cells.entry(row.spec.to_string()).or_default().add(row);
            }
        }
        Self(groups)
    }

    /// Modes in order, each with its classes in order and "all" last; "all" only where there are several.
    pub(super) fn in_order(&self) -> impl Iterator<Item = (&(Mode, Option<RayClass>), &Cases)> {
        let classes = |mode: Mode| self.0.keys().filter(|k| k.0 == mode && k.1.is_some()).count();
        let mut keys: Vec<_> = self.0.iter().filter(|(k, _)| k.1.is_some() || classes(k.0) > 1).collect();
        keys.sort_by_key(|(k, _)| (k.0, k.1.is_none(), k.1));
        keys.into_iter()
    }
}

impl Cell {
    fn add(&mut self, row: &Row) {
        let rays = row.rays as f64;
        self.steps += row.steps_per_ray * rays;
        self.tests += row.tests_per_ray * rays;
        self.cost_p999 = self.cost_p999.max(row.cost_p999 as f64);
        let rounds: Vec<f64> = row.round_nanos_per_ray.iter().map(|n| n * rays).collect();
        if self.round_nanos.is_empty() {
            self.round_nanos = rounds;
        } else {
            // The rounds of a case ran together: their sums are rounds of the whole.
            self.round_nanos = self.round_nanos.iter().zip(rounds).map(|(a, b)| a + b).collect();
        }
        // Classes share the structure.
        self.build_secs = row.build_secs;
        self.rrs_secs = row.rrs_secs;
        self.references = row.references as f64;
        self.bytes = row.bytes as f64;
    }
}

fn key(row: &Row) -> CaseKey {
    (row.scene.clone(), row.view.clone(), row.frame, row.seed, row.protocol.to_string())
}
