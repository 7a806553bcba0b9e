//! Does [`rdh::tune()`] keep its word? It is asked for a choice on all scenes, for rays of each class and for profiles that make no
//! sense, and each choice is judged on unseen rays beside every structure that needs no rays, not just the one it was chosen against.
//!
//! A choice is wrong if it answers other than a structure by areas does, if it can't be made, if it claims to know what too few rays
//! don't tell, or if it is surely slower than a structure by areas. With many choices some look slower by chance: the risk is
//! that of one such verdict in the whole audit.

mod lessons;

use rdh::tune::{Clock, Comparison, Confirmed, Outcome, confirm_against};
use rdh::{Accel, BuildOptions, Query, RaySample, Spec, Training, TuneOptions, Unseen};
use rdh_scene::{Entry, View};

use self::lessons::{Lesson, Promise, Seen};
use crate::clock::process_nanos;
use crate::integrate::Stage;

/// What is audited.
#[derive(Debug, Clone)]
pub struct Audit {
    /// What is chosen from.
    pub candidates: Vec<Spec>,
    /// Whether the clock decides; else steps and tests do, and all is repeatable.
    pub by_time: bool,
    /// Pixels across and down of the film, whose primary rays all others follow from.
    pub size: usize,
    /// How many views of a scene are looked at, the first ones.
    pub views: usize,
    /// Scenes with more triangles are spared the profiles that make no sense.
    pub adversarial_up_to: usize,
    /// What all randomness comes from.
    pub seed: u64,
}

impl Default for Audit {
    fn default() -> Self {
        Self {
            candidates: Spec::candidates(),
            by_time: false,
            size: 128,
            views: 1,
            adversarial_up_to: 200_000,
            seed: 1,
        }
    }
}

/// A choice, and how it stands on unseen rays.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Scene and view.
    pub place: String,
    /// Which rays.
    pub rays: &'static str,
    /// Rays to learn from, to choose by, to judge by.
    pub sets: [usize; 3],
    /// What was taken, and how the choice ended; nothing if it failed.
    pub taken: Option<(Spec, Outcome)>,
    /// What it promised: its ratio to the best by areas on held-out rays.
    pub held_out: Option<Comparison>,
    /// Beside every structure by areas, on unseen rays; none if there are too few of these, or nothing was promised.
    pub unseen: Vec<Confirmed>,
    /// That the rays have changed since was said: their drift.
    pub warned: Option<f64>,
    /// What is wrong, whatever chance does.
    pub faults: Vec<String>,
}

/// By so much a choice must be slower at least to be called so, where time decides: what equal trees scatter by.
const MARGIN: f64 = 0.02;

impl Finding {
    /// The structure by areas that stands best beside what was taken.
    pub fn hardest(&self) -> Option<&Comparison> {
        self.unseen.iter().map(measured).max_by(|a, b| a.ratio.total_cmp(&b.ratio))
    }

    /// What is wrong, if chances below `risk` are none. Who was warned is not wrong.
    pub fn violations(&self, risk: f64) -> Vec<String> {
        let slower = self.unseen.iter().map(measured).filter(|c| self.warned.is_none() && is_slower(c, risk));
        let text = |c: &Comparison| {
            format!("takes {:.4} of what {} takes on unseen rays (p = {:.1e})", c.ratio, c.base, c.p_slower)
        };
        self.faults.iter().cloned().chain(slower.map(text)).collect()
    }
}

/// By time where there is a clock, else by counts.
fn measured(confirmed: &Confirmed) -> &Comparison {
    confirmed.time.as_ref().unwrap_or(&confirmed.counts)
}

fn is_slower(comparison: &Comparison, risk: f64) -> bool {
    let margin = if comparison.measure == rdh::tune::Measure::Time { MARGIN } else { 0.0 };
    comparison.p_slower < risk && comparison.ratio > 1.0 + margin
}

/// The risk of each comparison, so that all together err at `risk` (Bonferroni).
pub fn each_risk(findings: &[Finding], risk: f64) -> f64 {
    risk / findings.iter().map(|finding| finding.unseen.len()).sum::<usize>().max(1) as f64
}

/// Audits the choices for a scene; `see` gets each finding as it comes.
///
/// # Errors
/// A scene that can't be read, or candidates none of which needs no rays. What goes wrong with a choice is a finding.
pub fn audit(entry: &Entry, audit: &Audit, see: &mut dyn FnMut(Finding)) -> Result<(), String> {
    let scene = entry.load(0).map_err(|e| e.to_string())?;
    let stage = Stage::new(&scene).map_err(|e| e.to_string())?;
    let views = if scene.views.is_empty() { vec![stage.overview()] } else { scene.views.clone() };
    let court = Court::new(&stage, audit)?;
    for (i, view) in views.iter().take(audit.views).enumerate() {
        let seen = |view: &View| Seen::of(&stage, &court.areas[0], view, audit.size, audit.seed);
        let here = seen(view);
        let mut lessons = lessons::usual(&here);
        if stage.mesh().len() <= audit.adversarial_up_to {
            let other = views.get((i + 1) % views.len()).filter(|_| views.len() > 1).map(&seen);
            lessons.extend(lessons::adversarial(&here, other.as_ref(), &stage));
        }
        lessons.into_iter().for_each(|lesson| see(court.judge(&format!("{}:{}", entry.id, view.name), &lesson)));
    }
    Ok(())
}

/// What choices are judged by.
struct Court<'a> {
    stage: &'a Stage,
    audit: &'a Audit,
    /// All candidates that need no rays.
    areas: Vec<Accel>,
}

impl<'a> Court<'a> {
    fn new(stage: &'a Stage, audit: &'a Audit) -> Result<Self, String> {
        let by_areas = audit.candidates.iter().filter(|spec| !spec.needs_rays());
        let build = |spec| rdh::build(stage.mesh(), spec, &Training::none(), &BuildOptions::default());
        let areas: Vec<Accel> = by_areas.map(build).collect::<rdh::Result<_>>().map_err(|e| e.to_string())?;
        if areas.is_empty() {
            return Err("a candidate is needed that needs no rays".to_owned());
        }
        Ok(Self { stage, audit, areas })
    }

    fn judge(&self, place: &str, lesson: &Lesson) -> Finding {
        let options = TuneOptions::default();
        let clock = || process_nanos();
        let clock: Option<Clock<'_>> = if self.audit.by_time { Some(&clock) } else { None };
        let mut finding = Finding {
            place: place.to_owned(),
            rays: lesson.name,
            sets: [lesson.training.len(), lesson.held_out.len(), lesson.unseen.len()],
            taken: None,
            held_out: None,
            unseen: Vec::new(),
            warned: lesson.promise.warning(),
            faults: Vec::new(),
        };
        let (mesh, candidates) = (self.stage.mesh(), &self.audit.candidates);
        match rdh::tune(mesh, candidates, &lesson.training, &lesson.held_out, &options, clock) {
            Err(error) => finding.faults.push(format!("can't be tuned: {error}")),
            Ok(tuned) => {
                let evidence = &tuned.evidence;
                finding.taken = Some((evidence.spec, evidence.outcome));
                finding.held_out = evidence.taken().and_then(|trial| trial.comparison.clone());
                finding.faults.extend(claim(lesson.promise, evidence.outcome));
                finding.faults.extend(self.answers(&tuned.accel, &lesson.unseen));
                if evidence.outcome != Outcome::TooFewRays {
                    self.compare(&tuned.accel, &lesson.unseen, &options, clock, &mut finding);
                }
            }
        }
        finding
    }

    /// Beside every structure by areas.
    fn compare(
        &self,
        taken: &Accel,
        unseen: &Unseen,
        options: &TuneOptions<'_>,
        clock: Option<Clock<'_>>,
        finding: &mut Finding,
    ) {
        for areas in self.areas.iter().filter(|areas| areas.stats().spec != taken.stats().spec) {
            match confirm_against(taken, areas, unseen, options, clock) {
                Ok(found) => finding.unseen.extend(found),
                Err(error) => finding.faults.push(format!("can't be judged: {error}")),
            }
        }
    }

    /// The first unseen ray that is answered otherwise than by areas.
    fn answers(&self, taken: &Accel, unseen: &Unseen) -> Option<String> {
        let other = |s: &&RaySample| answer(taken, s) != answer(&self.areas[0], s);
        let sample = unseen.samples().iter().find(other)?;
        Some(format!("answers {:?} otherwise than {}", sample.ray, self.areas[0].stats().spec))
    }
}

impl Promise {
    /// The drift, if it is surely one.
    fn warning(self) -> Option<f64> {
        match self {
            Self::NotSlowerOrWarned(drift) if drift.p_value < 0.01 => Some(drift.distance),
            _ => None,
        }
    }
}

/// What is wrong with the outcome, if so.
fn claim(promise: Promise, outcome: Outcome) -> Option<String> {
    let wrong = promise == Promise::TooFew && outcome != Outcome::TooFewRays;
    wrong.then(|| format!("too few rays, and yet the choice ended by {outcome:?}"))
}

/// All bits of an answer: `t`, `u`, `v` and the triangle of each hit.
fn answer(accel: &Accel, sample: &RaySample) -> Vec<[u32; 4]> {
    let mut hits = Vec::new();
    match sample.query {
        Query::Closest => hits.extend(accel.closest(&sample.ray)),
        Query::Occluded => return vec![[u32::from(accel.occluded(&sample.ray)); 4]],
        Query::All => accel.all_hits(&sample.ray, &mut hits),
    }
    hits.iter().map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.tri.0]).collect()
}
