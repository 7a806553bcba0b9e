//! Where the profile comes from, and when to do without.

use rdh::{Accel, Counts, Query, Spec, Training};
use rdh_scene::{Entry, View};

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::{Source, path_view};
use crate::run::{Built, Lesson};
use crate::study::bound::Segment;
use crate::study::coverage::coverage;
use crate::study::lab::{Setting, beside_base};
use crate::study::scope::Sample;

pub(super) struct WhichRays;

const BASE: &str = "kd+sah";
const SPEC: &str = "kd+rdh";
const MODES: [Mode; 2] = [Mode::Primary, Mode::Path];
/// The part of this frame's pixels that is cast in advance.
const PART: u32 = 64;
/// Frames between the rays and the frame that is built for.
const DISTANCES: [u32; 7] = [0, 1, 2, 4, 8, 16, 32];
/// Below this coverage the first rule does without the rays.
const LEAST_COVERAGE: f64 = 0.8;
/// Rays of either set that the rules look at.
const LOOKED_AT: usize = 1024;

/// The curves' names.
const RATIO: &str = "steps + tests, rdh / sah";
const BY_COVERAGE: &str = "rule: sah where less than 0.8 of the way is known; 1 if the cheaper tree was chosen";
const BY_TRIAL: &str = "rule: the tree in which 1,024 of the new rays cost less; 1 if the cheaper tree was chosen";

impl Experiment for WhichRays {
    fn name(&self) -> &'static str {
        "which-rays"
    }

    fn question(&self) -> &'static str {
        "Whose rays should it learn from: this frame's, paid for; the previous frame's, by distance; another view's; and when is SAH the better choice?"
    }

    /// Views at rest; the middle of camera paths; the last frame of animations.
    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        let mut jobs = scope.jobs(self.name(), Sample::FEW, &MODES);
        for entry in scope.sampled(Sample::MEDIUM) {
            for &mode in MODES.iter().filter(|m| scope.modes.contains(m)) {
                let job = |view: String, frame: u32| {
                    let (experiment, scene) = (self.name().to_owned(), entry.id.clone());
                    Job { experiment, scene, view, frame, mode }
                };
                jobs.extend(middles_of_paths(entry).into_iter().map(|view| job(view, 0)));
                jobs.extend(last_frame(entry).map(|(view, frame)| job(view, frame)));
            }
        }
        jobs
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let mode = found.job.mode;
        let on_path = path_view(lab.entry, &found.job.view, 0)?;
        let view = on_path.clone().map_or_else(|| lab.view(&found.job.view), Ok)?;
        let sources = match (on_path.is_some(), lab.frame) {
            (true, _) => along("camera path", &DISTANCES),
            (false, 0) => at_rest(lab, &view),
            (false, last) => {
                let mut distances: Vec<u32> = [1, 2, 4, last].into_iter().filter(|&k| k <= last).collect();
                distances.dedup();
                along("animation", &distances)
            }
        };
        let lessons =
            sources.into_iter().map(|(setting, source)| Ok((setting, lab.site().lesson(&source, &view, mode)?)));
        let lessons: Vec<(Setting, Lesson)> = lessons.collect::<Result<_, String>>()?;
        let (base, spec, none) = (specs(BASE)?, specs(SPEC)?, Lesson::none());
        let mut wanted: Vec<(Spec, &Lesson)> = base.iter().map(|&spec| (spec, &none)).collect();
        wanted.extend(lessons.iter().flat_map(|(_, lesson)| spec.iter().map(move |&spec| (spec, lesson))));
        let built: Option<Vec<Built>> = lab.build(&wanted, found).into_iter().collect();
        let built = built.ok_or("not all of its trees could be built")?;
        let settings: Vec<Setting> = lessons.iter().map(|(setting, _)| setting.clone()).collect();
        lab.measure(&beside_base(&built, &settings), &lab.rays(&view, mode), found);
        judge(lab, &view, &built, &lessons, found);
        Ok(())
    }
}

fn middles_of_paths(entry: &Entry) -> Vec<String> {
    let paths = entry.paths().unwrap_or_default();
    paths.iter().map(|path| format!("{}@{}", path.name, path.frames / 2)).collect()
}

fn last_frame(entry: &Entry) -> Option<(String, u32)> {
    let view = entry.views.first().filter(|_| entry.frames > 1)?;
    Some((view.name.clone(), entry.frames - 1))
}

/// Rays of this frame and of other views.
fn at_rest(lab: &Lab<'_>, view: &View) -> Vec<(Setting, Source)> {
    let mut sources = vec![
        (Setting::named(format!("this frame, 1/{PART} of it, paid for")), Source::Frame(PART)),
        (Setting::named("this view, from before"), Source::View(view.name.clone())),
    ];
    if let Some(other) = lab.another_view(&view.name) {
        sources.push((Setting::named("another view"), Source::View(other.name)));
        sources.push((Setting::named("all views"), Source::All));
    }
    sources
}

fn along(way: &str, distances: &[u32]) -> Vec<(Setting, Source)> {
    let at = |&k: &u32| (Setting::at(format!("{way}, {k} frames before"), k.into()), Source::Previous(k));
    distances.iter().map(at).collect()
}

/// Would the rules have chosen well? Both know a few of the new rays; the first knows neither tree, the second casts the
/// rays through both.
fn judge(lab: &Lab<'_>, view: &View, built: &[Built], lessons: &[(Setting, Lesson)], found: &mut Record) {
    let new = lab.sample(view, found.job.mode, LOOKED_AT);
    let new_way = Segment::all(&new);
    let [mut ratios, mut by_coverage, mut by_trial] = [Vec::new(), Vec::new(), Vec::new()];
    for ((setting, lesson), built_from) in lessons.iter().zip(built.iter().skip(1)) {
        let samples = lesson.training.samples();
        let few = Training::from_samples(samples[..samples.len().min(LOOKED_AT)].to_vec());
        let known = coverage(&lab.stage.bounds(), &Segment::all(&few), &new_way);
        let Some(ratio) = cost_ratio(found, setting) else { continue };
        let is_right = |chosen: bool| f64::from(u8::from(chosen == (ratio < 1.0)));
        ratios.push([known, ratio, 1.0]);
        by_coverage.push([known, is_right(known >= LEAST_COVERAGE), 1.0]);
        by_trial.push([known, is_right(trial(&built_from.accel, &new) < trial(&built[0].accel, &new)), 1.0]);
    }
    for (name, points) in [(RATIO, ratios), (BY_COVERAGE, by_coverage), (BY_TRIAL, by_trial)] {
        let spec = built.last().map(|b| b.spec).unwrap_or_default();
        found.curves.push(found.curve(name, spec, "part of the new rays' way that is known", points));
    }
}

/// Steps and tests of some rays.
fn trial(accel: &Accel, rays: &Training) -> u64 {
    let mut counts = Counts::default();
    for sample in rays.samples() {
        if sample.query == Query::Occluded {
            accel.occluded_counted(&sample.ray, &mut counts);
        } else {
            let _ = accel.closest_counted(&sample.ray, &mut counts);
        }
    }
    counts.steps() + counts.tests
}

/// Steps and tests of all classes, against the base's, under a setting.
fn cost_ratio(found: &Record, setting: &Setting) -> Option<f64> {
    let base: Spec = specs(BASE).ok()?.first().copied()?;
    let rows = || found.rows.iter().filter(|r| r.setting.as_deref() == Some(setting.text.as_str()));
    let cost = |is_base: bool| -> f64 {
        let of = rows().filter(|r| (r.spec == base) == is_base);
        of.map(|r| r.rays as f64 * (r.steps_per_ray + r.tests_per_ray)).sum()
    };
    let (spec, base) = (cost(false), cost(true));
    (spec > 0.0 && base > 0.0).then(|| spec / base)
}
