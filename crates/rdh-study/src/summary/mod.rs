//! From rows to ratios against a base. Needs nothing but the rows, so that merged studies are summarised alike.

mod cases;

use std::collections::{BTreeMap, BTreeSet};

use rdh::{RayClass, Spec};
use rdh_scene::Kind;

use crate::integrate::Mode;
use crate::rows::{Over, Row, Summary};
use crate::stats::{geometric_mean, median, paired_interval, ratio, stratified_bootstrap, stratified_mean};
use cases::{Cases, Cell, Groups};

/// The bootstrap's seed: summaries of the same rows are equal.
const BOOTSTRAP_SEED: u64 = 0x5eed;

/// Compares every other spec with `base`: per mode and class, and for all classes together (`class` is `None`) where a mode has
/// several. Pairs are rows of the same scene, view, frame, seed and protocol; what one of them lacks doesn't count.
/// To look at a part (a kind of scene, say), give only its rows.
pub fn summarise(rows: &[Row], base: &Spec) -> Vec<Summary> {
    summarise_over(&rows.iter().collect::<Vec<_>>(), base, Over::Pairs)
}

/// Summaries of a study: for each setting of each experiment, in order of appearance (or along their axis, where each setting of an
/// experiment has a place of its own), against the setting's first spec; over all pairs alike, over each kind of scene, and over all kinds with equal weight.
pub fn summarise_settings(rows: &[Row]) -> Vec<Summary> {
    let mut settings: Vec<Vec<&Row>> = Vec::new();
    let mut found = BTreeMap::new();
    for row in rows {
        let at = *found.entry((&row.experiment, &row.setting, row.x.map(f64::to_bits))).or_insert(settings.len());
        if at == settings.len() {
            settings.push(Vec::new());
        }
        settings[at].push(row);
    }
    for of_experiment in settings.chunk_by_mut(|a, b| a[0].experiment == b[0].experiment) {
        let xs: BTreeSet<Option<u64>> = of_experiment.iter().map(|rows| rows[0].x.map(f64::to_bits)).collect();
        if xs.len() == of_experiment.len() {
            of_experiment.sort_by(|a, b| order(a[0].x).total_cmp(&order(b[0].x)));
        }
    }
    settings.iter().flat_map(|rows| summarise_setting(rows)).collect()
}

/// A setting without a place stands behind those that have one.
fn order(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::INFINITY)
}

fn summarise_setting(rows: &[&Row]) -> Vec<Summary> {
    let Some(first) = rows.first() else { return Vec::new() };
    let mut summaries = summarise_over(rows, &first.spec, Over::Pairs);
    let kinds: Vec<Kind> = Kind::ALL.into_iter().filter(|k| rows.iter().any(|r| r.kind == *k)).collect();
    for &kind in &kinds {
        let of_kind: Vec<&Row> = rows.iter().copied().filter(|r| r.kind == kind).collect();
        summaries.extend(summarise_over(&of_kind, &first.spec, Over::Kind(kind)));
    }
    if kinds.len() > 1 {
        summaries.extend(summarise_over(rows, &first.spec, Over::Kinds));
    }
    for summary in &mut summaries {
        summary.experiment.clone_from(&first.experiment);
        summary.setting.clone_from(&first.setting);
        summary.x = first.x;
    }
    summaries
}

fn summarise_over(rows: &[&Row], base: &Spec, over: Over) -> Vec<Summary> {
    let mut specs: Vec<Spec> = Vec::new();
    for row in rows.iter().filter(|row| row.spec != *base) {
        if !specs.contains(&row.spec) {
            specs.push(row.spec);
        }
    }
    let groups = Groups::of(rows);
    let compare = |(&(mode, class), cases): (&(Mode, Option<RayClass>), &Cases)| {
        let of_spec = |&spec: &Spec| Some(summary(mode, class, spec, *base, &Pairs::of(cases, &spec, base, over)?));
        specs.iter().filter_map(of_spec).collect::<Vec<_>>()
    };
    groups.in_order().flat_map(compare).collect()
}

/// What a spec and the base did in the same cases.
struct Pairs<'a> {
    over: Over,
    of: Vec<(Place<'a>, &'a Cell, &'a Cell)>,
}

/// A scene, and its weight's group.
#[derive(Clone, Copy)]
struct Place<'a> {
    scene: &'a str,
    kind: Kind,
}

impl<'a> Pairs<'a> {
    /// `None` without any.
    fn of(cases: &'a Cases, spec: &Spec, base: &Spec, over: Over) -> Option<Self> {
        let (spec, base) = (spec.to_string(), base.to_string());
        let pair = |(key, case): (&'a cases::CaseKey, &'a cases::Case)| {
            let place = Place { scene: &key.0, kind: case.kind };
            Some((place, case.cells.get(&spec)?, case.cells.get(&base)?))
        };
        let of: Vec<_> = cases.iter().filter_map(pair).collect();
        (!of.is_empty()).then_some(Self { over, of })
    }

    fn ratios(&self, of: fn(&Cell) -> f64) -> Vec<f64> {
        self.of.iter().map(|(_, a, b)| ratio(of(a), of(b))).collect()
    }

    /// Medians over the rounds, whose parts ran next to each other.
    fn time_ratios(&self) -> Vec<f64> {
        self.of.iter().map(|(_, a, b)| median(&round_ratios(a, b))).collect()
    }

    fn mean(&self, ratios: &[f64]) -> f64 {
        match self.over {
            Over::Pairs | Over::Kind(_) => geometric_mean(ratios),
            Over::Kinds => stratified_mean(&self.strata(ratios)),
        }
    }

    /// Clustered by scene; where there is one scene, by its views.
    fn interval(&self, ratios: &[f64]) -> [f64; 2] {
        stratified_bootstrap(&self.strata(ratios), BOOTSTRAP_SEED).unwrap_or([f64::NAN; 2])
    }

    /// That of the times; a single pair has the interval of its rounds.
    fn time_interval(&self) -> [f64; 2] {
        if let [(_, a, b)] = &self.of[..] {
            return paired_interval(&round_ratios(a, b)).unwrap_or([f64::NAN; 2]);
        }
        self.interval(&self.time_ratios())
    }

    /// `[stratum][cluster]`: the kinds if they weigh alike, else all in one; then the scenes.
    fn strata(&self, ratios: &[f64]) -> Vec<Vec<Vec<f64>>> {
        let mut strata: BTreeMap<Option<Kind>, BTreeMap<&str, Vec<f64>>> = BTreeMap::new();
        for ((place, ..), &ratio) in self.of.iter().zip(ratios) {
            let stratum = (self.over == Over::Kinds).then_some(place.kind);
            strata.entry(stratum).or_default().entry(place.scene).or_default().push(ratio);
        }
        let clusters = |scenes: BTreeMap<&str, Vec<f64>>| -> Vec<Vec<f64>> {
            let one = scenes.len() == 1;
            let clusters = scenes.into_values();
            if one { clusters.flatten().map(|r| vec![r]).collect() } else { clusters.collect() }
        };
        strata.into_values().map(clusters).collect()
    }
}

fn summary(mode: Mode, class: Option<RayClass>, spec: Spec, base: Spec, pairs: &Pairs<'_>) -> Summary {
    let sure = |lies: fn([f64; 2]) -> bool| {
        let counts = |a, b| paired_interval(&round_ratios(a, b)).is_some_and(lies);
        pairs.of.iter().filter(|(_, a, b)| counts(a, b)).count()
    };
    let mean = |of: fn(&Cell) -> f64| pairs.mean(&pairs.ratios(of));
    let interval = |of: fn(&Cell) -> f64| pairs.interval(&pairs.ratios(of));
    Summary {
        experiment: None,
        setting: None,
        x: None,
        over: pairs.over,
        mode,
        class,
        spec,
        base,
        n: pairs.of.len(),
        steps_ratio: mean(|c| c.steps),
        steps_ratio_ci95: interval(|c| c.steps),
        tests_ratio: mean(|c| c.tests),
        tests_ratio_ci95: interval(|c| c.tests),
        cost_p999_ratio: mean(|c| c.cost_p999),
        time_ratio: pairs.mean(&pairs.time_ratios()),
        time_ratio_ci95: pairs.time_interval(),
        build_ratio: mean(|c| c.build_secs * 1e9),
        build_and_rrs_ratio: mean(|c| (c.build_secs + c.rrs_secs) * 1e9),
        references_ratio: mean(|c| c.references),
        bytes_ratio: mean(|c| c.bytes),
        slower_cases: sure(|[low, _]| low > 1.0),
        faster_cases: sure(|[_, high]| high < 1.0),
    }
}

fn round_ratios(spec: &Cell, base: &Cell) -> Vec<f64> {
    spec.round_nanos.iter().zip(&base.round_nanos).map(|(&a, &b)| ratio(a, b)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Protocol;

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
            chosen: None,
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

    /// A row of a study: an open scene, unless its name begins with "d".
    fn placed(experiment: &str, setting: &str, x: Option<f64>, scene: &str, spec: &str, nanos: f64) -> Row {
        let kind = if scene.starts_with('d') { Kind::Dense } else { Kind::Open };
        let (experiment, setting) = (Some(experiment.to_owned()), Some(setting.to_owned()));
        Row { experiment, setting, x, kind, ..row(scene, "1", RayClass::Primary, spec, &[nanos; 3]) }
    }

    #[test]
    fn kinds_weigh_alike_where_it_is_said_and_each_setting_has_its_own_base() {
        let mut rows = Vec::new();
        for (scene, ours) in [("a", 50.0), ("b", 50.0), ("c", 50.0), ("dense", 200.0)] {
            rows.push(placed("modes", "unseen", None, scene, "kd+sah", 100.0));
            rows.push(placed("modes", "unseen", None, scene, "kd+rdh", ours));
            rows.push(placed("blend", "one", None, scene, "kd+rdh", 80.0));
            rows.push(placed("blend", "one", None, scene, "kd+rdh(prior=1)", 40.0));
        }
        let all = summarise_settings(&rows);
        let of = |over| all.iter().find(|s| s.over == over && s.experiment.as_deref() == Some("modes")).unwrap();
        assert!(near(of(Over::Pairs).time_ratio, (0.5f64.powi(3) * 2.0).powf(0.25)));
        assert!(near(of(Over::Kinds).time_ratio, 1.0) && near(of(Over::Kinds).steps_ratio, 1.0));
        assert!(near(of(Over::Kind(Kind::Dense)).time_ratio, 2.0) && of(Over::Kind(Kind::Open)).n == 3);
        assert_eq!((of(Over::Pairs).faster_cases, of(Over::Pairs).slower_cases), (3, 1));
        let blend = all.iter().find(|s| s.experiment.as_deref() == Some("blend")).unwrap();
        assert!(blend.base == "kd+rdh".parse().unwrap() && near(blend.time_ratio, 0.5));
    }

    #[test]
    fn settings_stand_along_their_axis_if_it_tells_them_apart() {
        let rows = |xs: &[Option<f64>]| -> Vec<Row> {
            let of = |(i, &x): (usize, &Option<f64>)| {
                ["kd+sah", "kd+rdh"].map(|spec| placed("e", &format!("{i}"), x, "a", spec, 100.0))
            };
            xs.iter().enumerate().flat_map(of).collect()
        };
        let order = |xs: &[Option<f64>]| -> Vec<String> {
            let of_pairs = summarise_settings(&rows(xs)).into_iter().filter(|s| s.over == Over::Pairs);
            of_pairs.filter_map(|s| s.setting).collect()
        };
        assert_eq!(order(&[None, Some(8.0), Some(2.0)]), ["2", "1", "0"]);
        assert_eq!(order(&[Some(8.0), Some(2.0), Some(8.0)]), ["0", "1", "2"]);
    }
}
