//! Time to image, frame by frame: what knowing the rays costs, the build, and casting the frame's rays once.

use std::hint::black_box;

use rayon::ThreadPool;
use rdh::eye::{EyeOptions, EyeTree};
use rdh::{Accel, BuildOptions, Hit, Mesh, Query, Ray, RayClass, RaySample, Recorder, Spec, Training};
use rdh_scene::View;

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::clock::time_thread;
use crate::integrate::{Mode, RayBatch, derived_seed};
use crate::plan::{Case, Plan, path_view};
use crate::rows::Row;
use crate::run::Built;
use crate::stats::median;
use crate::study::choice::{Choice, Cost};
use crate::study::scope::Sample;

pub(super) struct Frames;

/// The base; the two that are quick to build, the second of which stays shallow; those that grow where rays come; trees in the space of
/// the frame's own eye, over one that grows.
const SPECS: &str = "kd(split=exact)+sah,bvh8(quick)+sah,kd+sah,bvh8(quick,lazy)+sah,bvh8(lazy)+rdh,kd(eye)+rdh";
/// The shallow tree's place among them, and its most levels.
const SHALLOW: (usize, usize) = (2, 16);
/// The place of the trees around the eye, and of what answers all other rays.
const PERSPECTIVE: (usize, usize) = (5, 3);
/// What `auto` chooses among, by place, in the order in which they are tried.
const CANDIDATES: [usize; 3] = [3, 1, 4];
/// What settings are called in which the quick hierarchy is the base.
pub const BESIDE_QUICK: &str = "beside the quick hierarchy";
/// Rays of the frame before that are known: a fair sample. More make building ahead slower, but nothing better.
const PROFILE: usize = 2048;
/// Frames that are looked at, evenly along the way.
const STATIONS: u32 = 5;

impl Experiment for Frames {
    fn name(&self) -> &'static str {
        "frames"
    }

    fn question(&self) -> &'static str {
        "If everything is built anew for every frame, what is the time to the whole image: rays known, structure built, rays cast?"
    }

    /// Camera paths, as pictures and as a scanner's turns; and animations seen from their first view.
    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        let mut jobs = Vec::new();
        for entry in scope.sampled(Sample::ALL) {
            let job = |view: &str, mode| Job {
                experiment: self.name().to_owned(),
                scene: entry.id.clone(),
                view: view.to_owned(),
                frame: 0,
                mode,
            };
            let moving = entry.views.first().filter(|_| entry.frames > 1);
            jobs.extend(moving.map(|view| job(&view.name, Mode::Primary)));
            let paths = entry.paths().unwrap_or_default();
            for mode in [Mode::Primary, Mode::Lidar] {
                jobs.extend(paths.iter().map(|path| job(&path.name, mode)));
            }
        }
        jobs.retain(|job| scope.modes.contains(&job.mode));
        jobs
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let way = Way::of(lab, &found.job)?;
        let plan = film(lab.plan);
        let specs = specs(SPECS)?;
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
        let mut eager = None;
        let mut choice = Choice::among(CANDIDATES.len());
        for frame in way.stations() {
            let (before, now) = (way.scene(lab, frame - 1)?, way.scene(lab, frame)?);
            let (before, now) = (before.as_ref().unwrap_or(lab), now.as_ref().unwrap_or(lab));
            let (training, _) = record(before, &rays(before, &way.view(before, frame - 1)?, found.job.mode, &plan));
            let batches = rays(now, &way.view(now, frame)?, found.job.mode, &plan);
            let (_, recording_secs) = record(now, &batches);
            if way.moves {
                eager = None;
            }
            let (mesh, rounds) = (now.mesh(), lab.plan.rounds_for(now.mesh().len()).max(1));
            let round = Round { mesh, specs: &specs, training: &training, recording_secs, alone: &alone };
            let timed = round.run(&batches, rounds, &mut eager)?;
            report(now, &way.name(frame), frame, &timed, &batches, &mut choice, found);
        }
        Ok(())
    }
}

/// From frame to frame: along a camera path through a scene at rest, or through an animation.
struct Way {
    path: String,
    frames: u32,
    moves: bool,
}

impl Way {
    fn of(lab: &Lab<'_>, job: &Job) -> Result<Self, String> {
        let paths = lab.entry.paths().unwrap_or_default();
        let path = paths.iter().find(|p| p.name == job.view).map(|p| p.frames);
        let frames = path.unwrap_or(lab.entry.frames);
        if frames < 2 {
            return Err(format!("'{}' neither is a path nor does the scene move", job.view));
        }
        Ok(Self { path: job.view.clone(), frames, moves: path.is_none() })
    }

    /// Frames that have one before them, in order.
    fn stations(&self) -> Vec<u32> {
        let mut stations: Vec<u32> =
            (0..STATIONS).map(|i| 1 + (2 * i + 1) * (self.frames - 1) / (2 * STATIONS)).collect();
        stations.retain(|&frame| frame < self.frames);
        stations.dedup();
        stations
    }

    fn name(&self, frame: u32) -> String {
        format!("{}@{frame}", self.path)
    }

    /// The scene at a frame; nothing if it is at rest.
    fn scene<'a>(&self, lab: &Lab<'a>, frame: u32) -> Result<Option<Lab<'a>>, String> {
        if self.moves { lab.at_frame(frame).map(Some) } else { Ok(None) }
    }

    fn view(&self, lab: &Lab<'_>, frame: u32) -> Result<View, String> {
        if self.moves {
            return lab.view(&self.path);
        }
        path_view(lab.entry, &self.name(frame), 0)?.ok_or_else(|| format!("there is no path '{}'", self.path))
    }
}

/// A film of pictures: 640 × 480 where the study's has 256 × 256.
fn film(plan: &Plan) -> Plan {
    let [columns, rows] = plan.size;
    Plan { size: [columns * 5 / 2, rows * 15 / 8], ..plan.clone() }
}

/// A picture's primary rays and, for each hit that faces its light, a shadow ray; or a turn of the scanner.
fn rays(lab: &Lab<'_>, view: &View, mode: Mode, plan: &Plan) -> Vec<RayBatch> {
    let mut batches = lab.rays_on(view, mode, plan);
    if mode == Mode::Primary {
        let shadows = batches.first().map(|batch| shadows(lab, batch)).unwrap_or_default();
        batches.push(RayBatch { class: RayClass::Shadow, query: Query::Occluded, rays: shadows });
    }
    batches.retain(|batch| !batch.rays.is_empty());
    batches
}

fn shadows(lab: &Lab<'_>, primary: &RayBatch) -> Vec<rdh::Ray> {
    let lights = lab.stage.lights();
    let shadow = |(i, ray): (usize, &rdh::Ray)| {
        let point = lab.stage.surface(ray, &lab.first.closest(ray)?);
        let light = *lights.get(i % lights.len().max(1))?;
        if point.faces(light) { point.spawn_to(light) } else { None }
    };
    primary.rays.iter().enumerate().filter_map(shadow).collect()
}

/// A frame's rays as a profile, and what recording took, casting them left out.
fn record(lab: &Lab<'_>, batches: &[RayBatch]) -> (Training, f64) {
    let hits: Vec<Vec<Option<Hit>>> =
        batches.iter().map(|b| b.rays.iter().map(|ray| lab.first.closest(ray)).collect()).collect();
    let recorder = Recorder::new(PROFILE, derived_seed(lab.plan.seed, u64::from(b'A')));
    let (profile, secs) = time_thread(|| {
        for (batch, hits) in batches.iter().zip(&hits) {
            batch.rays.iter().zip(hits).for_each(|(ray, &hit)| recorder.record(ray, hit, batch.query, batch.class));
        }
        recorder.into_profile()
    });
    (Training::from_samples(profile.samples().to_vec()), secs)
}

/// Where some of a frame's own rays go, not what they hit.
fn directions(batch: &RayBatch) -> Training {
    let every = batch.rays.len().div_ceil(PROFILE).max(1);
    // Not in step with rows.
    let picked = (0..batch.rays.len() / every).map(|i| &batch.rays[i * every + i * 7 % every]);
    let sample =
        |ray: &Ray| RaySample { weight: every as u32, ..RaySample::new(*ray, None, Query::Closest, batch.class) };
    Training::from_samples(picked.map(sample).collect())
}

/// What is built and cast, over and over.
struct Round<'a> {
    mesh: &'a Mesh,
    specs: &'a [Spec],
    training: &'a Training,
    recording_secs: f64,
    /// One thread.
    alone: &'a ThreadPool,
}

/// A structure, and what each round took.
struct Timed {
    built: Built,
    build_secs: Vec<f64>,
    /// `[batch][round]`
    cast_secs: Vec<Vec<f64>>,
}

impl Round<'_> {
    /// All structures in turn, each built and cast through in every round; the base alone, whose rays change nothing, is built once and
    /// kept in `eager`.
    fn run(&self, batches: &[RayBatch], rounds: usize, eager: &mut Option<(Accel, f64)>) -> Result<Vec<Timed>, String> {
        if eager.is_none() {
            *eager = Some(self.build(0, batches)?);
        }
        let mut timed: Vec<Timed> = Vec::new();
        for round in 0..rounds {
            for turn in 0..self.specs.len() {
                // All are there after the first round, which goes in order.
                let which = (turn + round) % self.specs.len();
                let (accel, build_secs) = match eager {
                    Some((accel, secs)) if which == 0 => (accel.clone(), *secs),
                    _ => self.build(which, batches)?,
                };
                let cast_secs: Vec<f64> = batches.iter().map(|batch| self.cast_secs(&accel, batch)).collect();
                if round == 0 {
                    timed.push(self.timed(which, accel, batches.len()));
                } else {
                    timed[which].built.accel = accel;
                }
                timed[which].build_secs.push(build_secs);
                cast_secs.iter().zip(&mut timed[which].cast_secs).for_each(|(&secs, all)| all.push(secs));
            }
        }
        for timed in &mut timed {
            timed.built.build_secs = median(&timed.build_secs);
        }
        Ok(timed)
    }

    fn build(&self, which: usize, batches: &[RayBatch]) -> Result<(Accel, f64), String> {
        let spec = &self.specs[if which == PERSPECTIVE.0 { PERSPECTIVE.1 } else { which }];
        let max_depth = (which == SHALLOW.0).then_some(SHALLOW.1);
        let options = BuildOptions { threads: Some(1), max_depth, ..BuildOptions::default() };
        let own = if which == PERSPECTIVE.0 { batches.first() } else { None };
        let (accel, secs) = time_thread(|| {
            let world = rdh::build(self.mesh, spec, self.training, &options)?;
            let Some(batch) = own else { return Ok(world) };
            let eye = batch.rays[0].origin;
            EyeTree::build(world, eye, &directions(batch), &EyeOptions::default(), &options).map(Accel::from)
        });
        Ok((accel.map_err(|e: rdh::Error| e.to_string())?, secs))
    }

    /// CPU seconds for all rays together, as one thread casts them.
    fn cast_secs(&self, accel: &Accel, batch: &RayBatch) -> f64 {
        let cast = || match batch.query {
            Query::Occluded => {
                let mut found = vec![false; batch.rays.len()];
                accel.occluded_many(&batch.rays, &mut found);
                black_box(found.iter().filter(|is| **is).count());
            }
            Query::Closest | Query::All => {
                let mut hits = vec![None; batch.rays.len()];
                accel.closest_many(&batch.rays, &mut hits);
                black_box(hits.iter().flatten().map(|hit| hit.t).sum::<f32>());
            }
        };
        self.alone.install(|| time_thread(cast).1)
    }

    fn timed(&self, which: usize, accel: Accel, batches: usize) -> Timed {
        let spec = self.specs[which];
        // Where a frame's rays go is known before they are cast.
        let trained = spec.needs_rays() && which != PERSPECTIVE.0;
        let built = Built {
            spec,
            accel,
            build_secs: 0.0,
            rrs_secs: if trained { self.recording_secs } else { 0.0 },
            trained_at: None,
        };
        Timed { built, build_secs: Vec::new(), cast_secs: vec![Vec::new(); batches] }
    }
}

/// Rows of all structures, and of what `auto` would have chosen by the frames before: beside the base, and beside the quick ones.
fn report(
    lab: &Lab<'_>,
    place: &str,
    frame: u32,
    timed: &[Timed],
    batches: &[RayBatch],
    choice: &mut Choice,
    found: &mut Record,
) {
    let mut rows = rows(lab, place, timed, batches, found);
    let rays: u64 = batches.iter().map(|b| b.rays.len() as u64).sum();
    let chosen = choice.next(rays);
    choice.learn(chosen, timed[CANDIDATES[chosen]].cost(rays));
    let taken = &rows[CANDIDATES[chosen]];
    let auto = taken.iter().map(|row| Row { spec: Spec::AUTO, chosen: Some(row.spec), ..row.clone() }).collect();
    rows.push(auto);
    let [all, quick] = settings(&found.job, frame);
    for (setting, skipped) in [(all, 0), (quick, 1)] {
        for row in rows.iter().skip(skipped).flatten() {
            let experiment = Some(found.job.experiment.clone());
            found.rows.push(Row { experiment, setting: Some(setting.clone()), x: Some(frame.into()), ..row.clone() });
        }
    }
}

/// Beside the base, and beside the quick structures. What differs in the frame alone is summarised together.
fn settings(job: &Job, frame: u32) -> [String; 2] {
    let way = format!("{} {}, {}", job.scene, job.view, job.mode);
    [format!("{way}, frame {frame}"), format!("{way}, {BESIDE_QUICK}, frame {frame}")]
}

/// Counts, answers and times; `[structure][batch]`.
fn rows(lab: &Lab<'_>, place: &str, timed: &[Timed], batches: &[RayBatch], found: &mut Record) -> Vec<Vec<Row>> {
    let case = Case { scene: found.job.scene.clone(), view: place.to_owned(), frame: lab.frame, mode: found.job.mode };
    // What is timed has been.
    let plan = Plan { rounds: 0, small_rounds: 0, ..lab.plan.clone() };
    let trial = lab.trial(&case, &plan);
    let trees: Vec<&Built> = timed.iter().map(|t| &t.built).collect();
    let outcome = trial.run(&trees, batches);
    found.mismatches.extend(outcome.mismatches);
    let with_times = |(timed, rows): (&Timed, Vec<Row>)| {
        let row = |(row, secs): (Row, &Vec<f64>)| {
            let round_nanos_per_ray: Vec<f64> = secs.iter().map(|s| s * 1e9 / row.rays as f64).collect();
            Row { nanos_per_ray: median(&round_nanos_per_ray), round_nanos_per_ray, ..row }
        };
        rows.into_iter().zip(&timed.cast_secs).map(row).collect()
    };
    timed.iter().zip(outcome.rows).map(with_times).collect()
}

impl Timed {
    fn cost(&self, rays: u64) -> Cost {
        let cast: f64 = self.cast_secs.iter().map(|secs| median(secs)).sum();
        Cost {
            before_secs: self.built.build_secs + self.built.rrs_secs,
            nanos_per_ray: cast * 1e9 / rays.max(1) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_lie_along_the_way_and_have_a_frame_before_them() {
        let way = |frames| Way { path: "walk".to_owned(), frames, moves: false };
        assert_eq!(way(120).stations(), [12, 36, 60, 84, 108]);
        assert_eq!(way(8).stations(), [1, 3, 4, 5, 7]);
        assert_eq!(way(2).stations(), [1]);
    }

    #[test]
    fn the_places_are_those_of_the_specs_that_are_meant() {
        let specs = specs(SPECS).unwrap();
        assert_eq!(specs[SHALLOW.0], Spec::default());
        assert!(CANDIDATES.iter().all(|&i| i > 0 && i != SHALLOW.0 && i < specs.len()));
        assert_eq!(specs[PERSPECTIVE.0].to_string(), "kd(eye)+rdh");
        assert_eq!(specs[PERSPECTIVE.1].to_string(), "bvh8(quick,lazy)+sah");
    }
}
