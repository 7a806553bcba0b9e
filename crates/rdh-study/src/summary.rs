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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Protocol;
    use rdh_scene::Kind;

    /// A row of 100 rays with the given nanoseconds a ray in each round; its steps are ten times the first, its tests a tenth.
    fn row(scene: &str, view: &str, class: RayClass, spec: &str, rounds: &[f64]) -> Row {
        Row {
            scene: scene.into(),
            view: view.into(),
            frame: 0,
            kind: Kind::Open,
            mode: Mode::Whitted,
            class,
            spec: spec.parse().unwrap(),
            triangles: 12,
            rays: 100,
            hits: 50,
            t_sum: 1.0,
            trained_on: 0,
            train_view: None,
            train_frame: None,
            steps_per_ray: rounds[0] * 10.0,
            tests_per_ray: if scene == "void" { 0.0 } else { rounds[0] / 10.0 },
            empty_leaves_per_ray: 0.0,
            cost_p999: 0,
            nanos_per_ray: median(rounds),
            round_nanos_per_ray: rounds.to_vec(),
            build_secs: 2.0 * rounds[0],
            rrs_secs: if spec == "kd+sah" { 0.0 } else { rounds[0] },
            nodes: 1,
            references: 1,
            bytes: rounds[0] as usize,
            depth: 0,
            protocol: Protocol::Unseen,
            seed: 1,
            experiment: None,
            setting: None,
            x: None,
            depth_complexity: None,
        }
    }

    fn base() -> Spec {
        "kd+sah".parse().unwrap()
    }

    fn near(a: f64, b: f64) -> bool {
        (a / b - 1.0).abs() < 1e-9
    }

    #[test]
    fn ratios_by_hand() {
        use RayClass::Primary;
        let rows = [
            row("a", "1", Primary, "kd+sah", &[100.0, 100.0, 100.0]),
            row("a", "1", Primary, "kd+rdh", &[50.0, 50.0, 50.0]),
            row("void", "1", Primary, "kd+sah", &[100.0, 100.0, 100.0]),
            row("void", "1", Primary, "kd+rdh", &[200.0, 201.0, 202.0]),
            // Nothing to compare it with.
            row("c", "1", Primary, "kd+rdh", &[5.0]),
        ];
        let [s] = &summarise(&rows, &base())[..] else { panic!("one summary") };
        assert_eq!((s.n, s.class, s.slower_cases), (2, Some(Primary), 1));
        assert!(near(s.steps_ratio, 1.0), "√(0.5 · 2)");
        assert!(near(s.tests_ratio, 0.5f64.sqrt()), "0 tests against 0 count as 1");
        assert!(near(s.time_ratio, (0.5f64 * 2.01).sqrt()), "medians");
        assert!(near(s.time_ratio_ci95[0], 0.5) && near(s.time_ratio_ci95[1], 2.01), "two clusters");
        assert!(near(s.build_ratio, 1.0) && near(s.build_and_rrs_ratio, 1.5) && near(s.bytes_ratio, 1.0));
    }

    #[test]
    fn all_classes_together_are_totals_not_means_of_ratios() {
        use RayClass::{Primary, Shadow};
        let rows = [
            row("a", "1", Primary, "kd+sah", &[100.0, 110.0]),
            row("a", "1", Shadow, "kd+sah", &[300.0, 290.0]),
            row("a", "1", Primary, "kd+rdh", &[100.0, 100.0]),
            row("a", "1", Shadow, "kd+rdh", &[100.0, 100.0]),
        ];
        let summary = summarise(&rows, &base());
        let classes: Vec<_> = summary.iter().map(|s| s.class).collect();
        assert_eq!(classes, [Some(Primary), Some(Shadow), None]);
        // 200 of 400 in both rounds: the rounds of the whole are steady although the parts' are not.
        assert!(near(summary[2].time_ratio, 0.5) && near(summary[2].steps_ratio, 0.5));
        // A single pair has the interval of its rounds.
        assert!(near(summary[2].time_ratio_ci95[0], 0.5) && near(summary[2].time_ratio_ci95[1], 0.5));
        assert!(summary[1].time_ratio_ci95[0] < summary[1].time_ratio_ci95[1]);
    }

    #[test]
    fn a_case_is_slower_only_if_its_rounds_agree() {
        let slower = |rounds: &[f64]| {
            let base_row = row("a", "1", RayClass::Primary, "kd+sah", &vec![100.0; rounds.len()]);
            let rows = [base_row, row("a", "1", RayClass::Primary, "kd+rdh", rounds)];
            summarise(&rows, &base())[0].slower_cases
        };
        assert_eq!(slower(&[103.0, 103.1, 102.9]), 1);
        assert_eq!(slower(&[101.0, 130.0, 95.0]), 0);
        assert_eq!(slower(&[97.0, 97.1, 96.9]), 0);
        // One round can't say how sure it is; a loss shows all the same.
        assert_eq!(slower(&[103.0]), 1);
    }

    #[test]
    fn equal_structures_make_no_difference() {
        let rounds = [[100.0, 101.0, 99.5], [55.0, 54.0, 56.0], [70.0, 70.5, 71.0]];
        let rows: Vec<Row> = (0..3)
            .flat_map(|i| {
                let [a, b] = ["kd+sah", "kd+rdh"].map(|s| row(&format!("s{i}"), "1", RayClass::Primary, s, &rounds[i]));
                [a, b]
            })
            .collect();
        let s = &summarise(&rows, &base())[0];
        assert_eq!((s.time_ratio, s.time_ratio_ci95, s.slower_cases), (1.0, [1.0, 1.0], 0));
    }

    #[test]
    fn views_of_one_scene_are_its_clusters_where_there_is_no_other() {
        let rows: Vec<Row> = (0..6)
            .flat_map(|v| {
                let view = v.to_string();
                let ours = row("a", &view, RayClass::Primary, "kd+rdh", &[60.0 + f64::from(v) * 8.0; 3]);
                [row("a", &view, RayClass::Primary, "kd+sah", &[100.0; 3]), ours]
            })
            .collect();
        let s = &summarise(&rows, &base())[0];
        let [low, high] = s.time_ratio_ci95;
        assert!(low > 0.6 && low < s.time_ratio && s.time_ratio < high && high < 1.0, "{low} {high}");
    }

    #[test]
    fn nothing_to_compare_gives_no_summary() {
        assert!(summarise(&[], &base()).is_empty());
        assert!(summarise(&[row("a", "1", RayClass::Primary, "kd+rdh", &[1.0])], &base()).is_empty());
    }
}
