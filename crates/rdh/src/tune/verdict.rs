//! Who wins: the cheapest structure of which it is sure that it beats every one by areas; else the cheapest of these.
//!
//! A structure for the rays is refused unless it is faster than *each* structure by areas that reached the last rung, hence
//! than the best of them, whichever that is in truth: no correction is due for that (Berger 1982, intersection-union test). For
//! the many structures for rays there is one, Holm's, over all that were tried, even if they didn't come so far: so it doesn't
//! matter that the same rays chose who came so far.
//!
//! Blocks of rays don't show what is wrong with a whole race, such as a neighbour that comes and goes. So time is taken in two
//! sessions, both of which must be sure; and a structure of the same kind as one by areas must need fewer steps and tests, too, which
//! are exact.

use super::Tuned;
use super::costs::StepCosts;
use super::deck::{Deck, Group};
use super::evidence::{ClassRatio, Comparison, Evidence, Measure, Outcome, RaysUsed, Trial};
use super::interval::{Paired, holm};
use super::race::{Field, Runner};
use super::score::Score;
use super::train::Workshop;
use super::words;
use crate::spec::Spec;

/// Decides by the last rung's scores.
pub(super) fn decide(shop: &Workshop<'_>, field: Field, deck: &Deck, rays: RaysUsed, mut trials: Vec<Trial>) -> Tuned {
    let [mut areas, mut knowing] = field;
    sort(&mut areas, deck);
    sort(&mut knowing, deck);
    let tried = shop.candidates.iter().filter(|s| s.needs_rays()).count();
    let (measure, margin) = match shop.clock {
        Some(_) => (Measure::Time, shop.options.margin),
        None => (Measure::Counts, 0.0),
    };
    let rule = Rule { measure, margin, interval_risk: shop.options.risk / tried.max(1) as f64 };
    let base = trials[areas[0].index].clone();
    let p: Vec<f64> = knowing.iter().map(|runner| judge(runner, &areas, deck, rule, &base, &mut trials)).collect();
    let sure = holm(&p, tried, shop.options.risk);
    let winner = sure.iter().position(|&sure| sure);
    let best = knowing.first().map(|r| trials[r.index].clone());
    let sah = areas.swap_remove(0).accel;
    let (outcome, accel, sah) = match winner {
        Some(i) => (Outcome::Rays, knowing.swap_remove(i).accel, Some(sah)),
        None => (Outcome::Areas, sah, None),
    };
    let mut evidence = Evidence {
        version: Evidence::VERSION,
        spec: accel.stats().spec,
        base: base.spec,
        outcome,
        reason: String::new(),
        measure,
        risk: shop.options.risk,
        margin,
        tried,
        rays,
        trials,
    };
    evidence.reason = words::verdict(&evidence, best.as_ref());
    Tuned { accel, sah, evidence }
}

/// How structures are compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rule {
    pub(super) measure: Measure,
    pub(super) margin: f64,
    pub(super) interval_risk: f64,
}

/// The cheapest first; of equals those that were given first.
fn sort(runners: &mut [Runner], deck: &Deck) {
    let cost = |r: &Runner| r.scores.iter().map(|score| score.nanos_per_ray(deck)).sum::<f64>();
    runners.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.index.cmp(&b.index)));
}

/// Compares a structure with all by areas, and notes how it stands to the first of them, the base. Returns its p.
fn judge(runner: &Runner, areas: &[Runner], deck: &Deck, rule: Rule, base: &Trial, trials: &mut [Trial]) -> f64 {
    let against = |area: &Runner| compare((&runner.scores, &area.scores), deck, rule, base.spec);
    let by_counts =
        |area: &Runner| match StepCosts::of(&area.accel.stats().spec) == StepCosts::of(&runner.accel.stats().spec) {
            true => Paired::new(&runner.counted.blocks(deck), &area.counted.blocks(deck)).p_below(1.0),
            false => 0.0,
        };
    let mut comparison = against(&areas[0]);
    let p = areas.iter().map(|area| against(area).p_faster.max(by_counts(area))).fold(0.0, f64::max);
    comparison.p_faster = p;
    let trial = &mut trials[runner.index];
    trial.gap = gap(trial, base);
    trial.break_even_rays = (rule.measure == Measure::Time).then(|| break_even(trial, base)).flatten();
    trial.comparison = Some(comparison);
    p
}

/// Scores against other ones on the same rays, session by session: ratios are of all sessions together, intervals hold those of each,
/// and what is sure is sure in each.
pub(super) fn compare((values, bases): (&[Score], &[Score]), deck: &Deck, rule: Rule, spec: Spec) -> Comparison {
    let sessions = || values.iter().zip(bases);
    let all = Sessions(sessions().map(|(v, b)| Paired::new(&v.blocks(deck), &b.blocks(deck))).collect());
    let class = |(i, group): (usize, &Group)| {
        let of = Sessions(sessions().map(|(v, b)| Paired::new(&v.nanos[i], &b.nanos[i])).collect());
        let (ratio, interval) = (of.ratio(), of.interval(rule.interval_risk));
        ClassRatio { class: group.class, query: group.query, rays: group.samples, ratio, interval }
    };
    Comparison {
        base: spec,
        measure: rule.measure,
        ratio: all.ratio(),
        interval: all.interval(rule.interval_risk),
        interval_risk: rule.interval_risk,
        p_faster: all.most(|session| session.p_below(1.0 - rule.margin)),
        p_slower: all.most(|session| session.p_above(1.0)),
        classes: deck.groups.iter().enumerate().map(class).collect(),
    }
}

/// The same pair in several sessions.
struct Sessions(Vec<Paired>);

impl Sessions {
    /// Their geometric mean.
    fn ratio(&self) -> f64 {
        (self.0.iter().map(|session| session.ratio().ln()).sum::<f64>() / self.0.len() as f64).exp()
    }

    fn interval(&self, risk: f64) -> Option<[f64; 2]> {
        let each: Option<Vec<[f64; 2]>> = self.0.iter().map(|session| session.interval(risk)).collect();
        each?.into_iter().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    fn most(&self, p: impl Fn(&Paired) -> f64) -> f64 {
        self.0.iter().map(p).fold(0.0, f64::max)
    }
}

/// How much of the gain on training rays held-out rays don't show.
fn gap(trial: &Trial, base: &Trial) -> Option<f64> {
    let held_out = trial.nanos_per_ray(Measure::Counts)? / base.nanos_per_ray(Measure::Counts)?;
    let training = trial.training_nanos_per_ray? / base.training_nanos_per_ray?;
    Some(held_out / training).filter(|gap| gap.is_finite())
}

/// After how many rays the longer build has paid.
fn break_even(trial: &Trial, base: &Trial) -> Option<f64> {
    let longer_secs = trial.build_secs? - base.build_secs?;
    let saved_nanos = base.nanos_per_ray(Measure::Time)? - trial.nanos_per_ray(Measure::Time)?;
    (saved_nanos > 0.0).then(|| (longer_secs * 1e9 / saved_nanos).max(0.0).ceil())
}
