//! From pairs to effects: a mean ratio, its interval, wins and losses.

use std::collections::BTreeMap;

use rdh_scene::Kind;

use super::pairs::{Metric, Pair};
use crate::stats::{geometric_mean, stratified_bootstrap, stratified_mean};

/// The bootstrap's seed, the same as that of the summaries: equal rows, equal intervals.
const SEED: u64 = 0x5eed;

/// What many pairs say about one metric. Ratios are ours / theirs: below 1 is better.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Effect {
    /// Pairs.
    pub n: usize,
    /// Scenes that they come from.
    pub scenes: usize,
    /// Their geometric mean.
    pub mean: f64,
    /// A 95 % interval of the mean, bootstrapped with the scene as cluster.
    pub interval: [f64; 2],
    /// The smallest ratio: the largest gain.
    pub least: f64,
    /// The largest ratio.
    pub most: f64,
    /// Pairs that are surely better: of times those whose own interval lies wholly below 1, of counts all below 1.
    pub wins: usize,
    /// Pairs that are surely worse.
    pub losses: usize,
}

/// How sure a difference is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The interval lies wholly below 1.
    Better,
    /// The interval lies wholly above 1.
    Worse,
    /// The interval is within 1 % of 1.
    Same,
    /// Neither.
    Open,
}

impl Effect {
    /// The effect over pairs; nothing if none of them has the metric.
    pub(super) fn of<'p, 'r: 'p>(pairs: impl IntoIterator<Item = &'p Pair<'r>>, metric: Metric) -> Option<Self> {
        let mut tally = Tally::new(pairs, metric)?;
        tally.effect.interval = stratified_bootstrap(&[tally.clusters()], SEED)?;
        Some(tally.effect)
    }

    /// The effect over plain ratios, each with its scene.
    pub(super) fn of_ratios<'s>(ratios: impl IntoIterator<Item = (&'s str, f64)>) -> Option<Self> {
        let mut tally = Tally::of(ratios.into_iter().map(|(scene, ratio)| (scene, ratio, [ratio; 2])))?;
        tally.effect.interval = stratified_bootstrap(&[tally.clusters()], SEED)?;
        Some(tally.effect)
    }

    /// The same with every kind of scene counting alike, however many of its scenes there are.
    pub(super) fn by_kind<'p, 'r: 'p>(pairs: impl IntoIterator<Item = &'p Pair<'r>>, metric: Metric) -> Option<Self> {
        let mut kinds: BTreeMap<Kind, Vec<&Pair<'r>>> = BTreeMap::new();
        let all: Vec<&Pair<'r>> = pairs.into_iter().inspect(|p| kinds.entry(p.kind).or_default().push(p)).collect();
        let of_kind = |pairs: Vec<&Pair<'r>>| Some(Tally::new(pairs, metric)?.clusters());
        let strata: Vec<Vec<Vec<f64>>> = kinds.into_values().filter_map(of_kind).collect();
        let effect = Tally::new(all, metric)?.effect;
        let (mean, interval) = (stratified_mean(&strata), stratified_bootstrap(&strata, SEED)?);
        Some(Self { mean, interval, ..effect })
    }

    /// A single pair shows a difference, but not how sure it is.
    pub(super) fn verdict(&self) -> Verdict {
        match self.interval {
            [low, high] if low >= 0.99 && high <= 1.01 => Verdict::Same,
            _ if self.n < 2 => Verdict::Open,
            [_, high] if high < 1.0 => Verdict::Better,
            [low, _] if low > 1.0 => Verdict::Worse,
            _ => Verdict::Open,
        }
    }
}

/// An effect in the making: its ratios by scene.
struct Tally {
    effect: Effect,
    scenes: BTreeMap<String, Vec<f64>>,
    /// Ratios one by one, as clusters of their own.
    singles: Vec<Vec<f64>>,
}

impl Tally {
    fn new<'p, 'r: 'p>(pairs: impl IntoIterator<Item = &'p Pair<'r>>, metric: Metric) -> Option<Self> {
        let ratio = |pair: &'p Pair<'r>| {
            let ratio = pair.ratio(metric)?;
            Some((pair.job.scene.as_str(), ratio, own_interval(pair, metric, ratio)))
        };
        Self::of(pairs.into_iter().filter_map(ratio))
    }

    /// From ratios with their scenes and their own intervals.
    fn of<'s>(ratios: impl Iterator<Item = (&'s str, f64, [f64; 2])>) -> Option<Self> {
        let (mut scenes, mut all) = (BTreeMap::<String, Vec<f64>>::new(), Vec::new());
        let (mut wins, mut losses) = (0, 0);
        for (scene, ratio, [low, high]) in ratios.filter(|r| r.1 > 0.0 && r.1.is_finite()) {
            scenes.entry(scene.to_owned()).or_default().push(ratio);
            all.push(ratio);
            wins += usize::from(high < 1.0);
            losses += usize::from(low > 1.0);
        }
        let mean = geometric_mean(&all);
        let (least, most) = all.iter().fold((f64::INFINITY, 0.0f64), |(a, b), &r| (a.min(r), b.max(r)));
        let (n, interval) = (all.len(), [mean; 2]);
        let effect = Effect { n, scenes: scenes.len(), mean, interval, least, most, wins, losses };
        let singles = all.iter().map(|&r| vec![r]).collect();
        (n > 0).then_some(Self { effect, scenes, singles })
    }

    /// Views of one scene are alike; where there is no other scene they stand for themselves.
    fn clusters(&self) -> Vec<Vec<f64>> {
        if self.scenes.len() > 1 { self.scenes.values().cloned().collect() } else { self.singles.clone() }
    }
}

fn own_interval(pair: &Pair<'_>, metric: Metric, ratio: f64) -> [f64; 2] {
    let rounds = if metric == Metric::Time { pair.time_interval() } else { None };
    rounds.unwrap_or([ratio; 2])
}
