//! From rows to ratios against a base. Needs nothing but the rows, so that merged studies are summarised alike.

use std::collections::BTreeMap;

use rdh::{RayClass, Spec};

use crate::integrate::Mode;
use crate::rows::{Row, Summary};
use crate::stats::{cluster_bootstrap, geometric_mean, median, paired_interval, ratio};

/// The bootstrap's seed: summaries of the same rows are equal.
const BOOTSTRAP_SEED: u64 = 0x5eed;

/// Compares every other spec with `base`: per mode and class, and for all classes together (`class` is `None`) where a mode has
/// several. Pairs are rows of the same scene, view, frame, seed and protocol; what one of them lacks doesn't count.
/// To look at a part (a kind of scene, say), give only its rows.
pub fn summarise(rows: &[Row], base: &Spec) -> Vec<Summary> {
    let mut specs: Vec<Spec> = Vec::new();
    for row in rows.iter().filter(|row| row.spec != *base) {
        if !specs.contains(&row.spec) {
            specs.push(row.spec);
        }
    }
    let groups = Groups::of(rows);
    let compare = |(&(mode, class), cases): (&(Mode, Option<RayClass>), &Cases)| {
        let of_spec = |&spec: &Spec| summary(mode, class, spec, *base, cases);
        specs.iter().filter_map(of_spec).collect::<Vec<_>>()
    };
    groups.in_order().flat_map(compare).collect()
}

/// Which rows belong together: scene, view, frame, seed, protocol.
type CaseKey = (String, String, u32, u64, String);
/// Per case and spec (by its text), what was measured.
type Cases = BTreeMap<CaseKey, BTreeMap<String, Cell>>;

/// What one spec did in one case, in totals over its rays.
#[derive(Clone, Default)]
struct Cell {
    steps: f64,
    tests: f64,
    nanos: f64,
    round_nanos: Vec<f64>,
    build_secs: f64,
    rrs_secs: f64,
    bytes: f64,
}

struct Groups(BTreeMap<(Mode, Option<RayClass>), Cases>);

impl Groups {
    fn of(rows: &[Row]) -> Self {
        let mut groups: BTreeMap<(Mode, Option<RayClass>), Cases> = BTreeMap::new();
        for row in rows {
            for class in [Some(row.class), None] {
                let cases = groups.entry((row.mode, class)).or_default();
                let cells = cases.entry(key(row)).or_default();
                cells.entry(row.spec.to_string()).or_default().add(row);
            }
        }
        Self(groups)
    }

    /// Modes in order, each with its classes in order and "all" last; "all" only where there are several.
    fn in_order(&self) -> impl Iterator<Item = (&(Mode, Option<RayClass>), &Cases)> {
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
        let rounds: Vec<f64> = row.round_nanos_per_ray.iter().map(|n| n * rays).collect();
        if self.round_nanos.is_empty() {
            self.nanos = row.nanos_per_ray * rays;
            self.round_nanos = rounds;
        } else {
            // The rounds of a case ran together: their sums are rounds of the whole.
            self.round_nanos = self.round_nanos.iter().zip(rounds).map(|(a, b)| a + b).collect();
            self.nanos = median(&self.round_nanos);
        }
        // Classes share the structure.
        self.build_secs = row.build_secs;
        self.rrs_secs = row.rrs_secs;
        self.bytes = row.bytes as f64;
    }
}

fn key(row: &Row) -> CaseKey {
    (row.scene.clone(), row.view.clone(), row.frame, row.seed, row.protocol.to_string())
}

fn summary(mode: Mode, class: Option<RayClass>, spec: Spec, base: Spec, cases: &Cases) -> Option<Summary> {
    let (spec_text, base_text) = (spec.to_string(), base.to_string());
    let pair = |(key, cells): (&CaseKey, &BTreeMap<String, Cell>)| {
        Some((key.0.clone(), cells.get(&spec_text)?.clone(), cells.get(&base_text)?.clone()))
    };
    let pairs: Vec<(String, Cell, Cell)> = cases.iter().filter_map(pair).collect();
    if pairs.is_empty() {
        return None;
    }
    let mean = |of: fn(&Cell) -> f64| geometric_mean(&ratios(&pairs, of));
    Some(Summary {
        mode,
        class,
        spec,
        base,
        n: pairs.len(),
        steps_ratio: mean(|c| c.steps),
        tests_ratio: mean(|c| c.tests),
        time_ratio: mean(|c| c.nanos),
        time_ratio_ci95: time_interval(&pairs),
        build_ratio: mean(|c| c.build_secs * 1e9),
        build_and_rrs_ratio: mean(|c| (c.build_secs + c.rrs_secs) * 1e9),
        bytes_ratio: mean(|c| c.bytes),
        slower_cases: pairs.iter().filter(|(_, a, b)| is_slower(a, b)).count(),
    })
}

fn ratios(pairs: &[(String, Cell, Cell)], of: fn(&Cell) -> f64) -> Vec<f64> {
    pairs.iter().map(|(_, a, b)| ratio(of(a), of(b))).collect()
}

/// Clustered by scene; with one scene by its views; a single pair has the interval of its rounds.
fn time_interval(pairs: &[(String, Cell, Cell)]) -> [f64; 2] {
    let times = ratios(pairs, |c| c.nanos);
    if let [(_, a, b)] = pairs {
        return paired_interval(&round_ratios(a, b)).unwrap_or([times[0]; 2]);
    }
    let mut scenes: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for ((scene, ..), &time) in pairs.iter().zip(&times) {
        scenes.entry(scene).or_default().push(time);
    }
    let clusters: Vec<Vec<f64>> =
        if scenes.len() > 1 { scenes.into_values().collect() } else { times.iter().map(|&t| vec![t]).collect() };
    cluster_bootstrap(&clusters, BOOTSTRAP_SEED).unwrap_or([f64::NAN; 2])
}

fn is_slower(spec: &Cell, base: &Cell) -> bool {
    paired_interval(&round_ratios(spec, base)).is_some_and(|[low, _]| low > 1.0)
}

fn round_ratios(spec: &Cell, base: &Cell) -> Vec<f64> {
    spec.round_nanos.iter().zip(&base.round_nanos).map(|(&a, &b)| ratio(a, b)).collect()
}
