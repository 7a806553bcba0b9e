//! A scanner that moves through a scene: 64 beams by 2048 firings from each of 100 poses, through one structure for all of them, and
//! through trees that are built anew around every pose:
//! `cargo run --release -p rdh-study --example lidar -- [--scenes DIR] [--poses N] [--turns N] [SCENE…]`
//!
//! Without names `aws-warehouse`, which is skipped where the folder does not have it, and `quarter`. Poses lie evenly along the lines between
//! the scene's views. One thread's CPU time, in which all candidates take turns, pose by pose; a scene at rest, whose structure for all
//! rays is built once. `auto` is the choice from pose to pose by what the poses before have cost. Hits are compared, bit for bit.

use std::path::PathBuf;
use std::process::ExitCode;

use rdh::eye::{EyeOptions, EyeTree};
use rdh::{Accel, BuildOptions, Hit, Query, Ray, RayClass, RaySample, Spec, Training, Vec3};
use rdh_scene::{View, catalog};
use rdh_study::clock::time_thread;
use rdh_study::integrate::{LIDAR_AZIMUTHS, LIDAR_BEAMS, Lens, Mode, Stage};
use rdh_study::stats::median;
use rdh_study::study::choice::{Choice, Cost};

fn main() -> ExitCode {
    match Wanted::parse(std::env::args().skip(1)).and_then(|wanted| wanted.run()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Wanted {
    scenes: Vec<String>,
    folder: PathBuf,
    poses: usize,
    /// Turns of the scanner at a pose: 1 for one that moves all the time.
    turns: usize,
}

/// What all rays go through.
const WORLD: &str = "bvh8(high)+sah";
/// Every so manyth ray of a pose is what the guided trees are built for.
const SAMPLED: usize = 32;
/// No trees for a scanner were built in less, for each triangle (docs/measurements.md, "Time to image").
const LEAST_BUILD_NANOS: f64 = 800.0;
/// What is compared, in this order: the world's structure ray by ray and in batches, trees by areas and by rays in batches.
const NAMES: [&str; 4] = ["one by one", "batches", "eye, by areas", "eye, by rays"];
/// Batches in the world's structure, and the trees.
const CANDIDATES: [usize; 3] = [1, 2, 3];

impl Wanted {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut wanted = Self { scenes: Vec::new(), folder: "../shared/scenes".into(), poses: 100, turns: 1 };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
            let count = |text: String| text.parse::<usize>().ok().filter(|&n| n > 0).ok_or("a number from 1 is needed");
            match &argument[..] {
                "--scenes" => wanted.folder = value()?.into(),
                "--poses" => wanted.poses = count(value()?)?,
                "--turns" => wanted.turns = count(value()?)?,
                other if other.starts_with('-') => return Err(format!("{other} is unknown")),
                _ => wanted.scenes.push(argument),
            }
        }
        Ok(wanted)
    }

    fn run(&self) -> Result<(), String> {
        let is_there = self.folder.join("scenes.toml").is_file();
        let more = if is_there { catalog::indexed(&self.folder).map_err(|e| e.to_string())? } else { Vec::new() };
        let usual = ["aws-warehouse", "quarter"].map(str::to_owned);
        let named = !self.scenes.is_empty();
        for id in if named { &self.scenes[..] } else { &usual[..] } {
            match catalog::find(id, &more) {
                Ok(entry) => self.scene(&entry)?,
                Err(error) if named => return Err(error.to_string()),
                Err(error) => println!("{id} is skipped: {error}"),
            }
        }
        Ok(())
    }

    fn scene(&self, entry: &rdh_scene::Entry) -> Result<(), String> {
        let text = |e: &dyn std::fmt::Display| e.to_string();
        let scene = entry.load(0).map_err(|e| text(&e))?;
        let stage = Stage::new(&scene).map_err(|e| text(&e))?;
        let views = if scene.views.is_empty() { &entry.views } else { &scene.views };
        let spec: Spec = WORLD.parse().map_err(|e: rdh::Error| text(&e))?;
        let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
        let (world, build) = time_thread(|| rdh::build(stage.mesh(), &spec, &Training::none(), &options));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| text(&e))?;
        let mut drive =
            Drive { world: world.map_err(|e| text(&e))?, options, turns: self.turns, spent: Spent::default() };
        let mut choice = drive.choice(stage.mesh().len());
        for pose in 0..self.poses {
            let view = along(views, pose as f64 / self.poses.max(2).saturating_sub(1) as f64)
                .ok_or("a scene without views")?;
            let rays = turn(&stage, &view);
            pool.install(|| drive.pose(pose, &rays, &mut choice)).map_err(|e| text(&e))?;
        }
        drive.spent.print(entry, stage.mesh().len(), build, (self.poses, self.turns));
        Ok(())
    }
}

/// A place on the lines between views; the first view's again at the end, where there is but one.
fn along(views: &[View], part: f64) -> Option<View> {
    let (first, last) = (views.first()?, views.len() - 1);
    let place = part * last as f64;
    let from = (place.floor() as usize).min(last.saturating_sub(1));
    let (a, b) = (&views[from], views.get(from + 1).unwrap_or(first));
    let between = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + (place - from as f64) * (b[i] - a[i]));
    Some(View { eye: between(a.eye, b.eye), target: between(a.target, b.target), ..a.clone() })
}

/// A turn of the scanner: firing by firing, each from the top beam to the lowest.
fn turn(stage: &Stage, view: &View) -> Vec<Ray> {
    let lens = Lens::new(stage, Mode::Lidar, view, 1.0);
    let at = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let ray = |i: usize| lens.ray(at(i % LIDAR_BEAMS, LIDAR_BEAMS), at(i / LIDAR_BEAMS, LIDAR_AZIMUTHS));
    (0..LIDAR_BEAMS * LIDAR_AZIMUTHS).map(ray).collect()
}

/// What a way through a scene goes by.
struct Drive<'a> {
    world: Accel,
    options: BuildOptions<'a>,
    turns: usize,
    spent: Spent,
}

/// Seconds of all poses: of each candidate for building and casting, pose by pose, and of what was chosen.
#[derive(Default)]
struct Spent {
    build: [Vec<f64>; NAMES.len()],
    cast: [Vec<f64>; NAMES.len()],
    auto: f64,
    chosen: [usize; CANDIDATES.len()],
    rays: usize,
}

impl Drive<'_> {
    /// What can't pay is not tried.
    fn choice(&self, triangles: usize) -> Choice {
        let least = triangles as f64 * LEAST_BUILD_NANOS * 1e-9;
        Choice::with_least(vec![0.0, least, least])
    }

    fn pose(&mut self, pose: usize, rays: &[Ray], choice: &mut Choice) -> Result<(), rdh::Error> {
        let rays: Vec<Ray> = rays.repeat(self.turns);
        let eye = rays[0].origin;
        let mut expected: Option<Vec<Option<Hit>>> = None;
        let mut costs = [None; NAMES.len()];
        for step in 0..NAMES.len() {
            // In turn, so that none is always the first to meet the pose's triangles.
            let which = (step + pose) % NAMES.len();
            let mut hits = vec![None; rays.len()];
            let (built, build) = time_thread(|| self.tree(which, eye, &rays));
            let tree = built?;
            let ((), cast) = time_thread(|| match (&tree, which) {
                (Some(tree), _) => tree.closest_rows(&rays, LIDAR_BEAMS, &mut hits),
                (None, 0) => rays.iter().zip(&mut hits).for_each(|(ray, hit)| *hit = self.world.closest(ray)),
                _ => self.world.closest_many(&rays, &mut hits),
            });
            let expected = expected.get_or_insert_with(|| hits.clone());
            assert!(bits(expected).eq(bits(&hits)), "{}: other hits", NAMES[which]);
            self.spent.build[which].push(build);
            self.spent.cast[which].push(cast);
            costs[which] = Some(Cost { before_secs: build, nanos_per_ray: cast * 1e9 / rays.len() as f64 });
        }
        let chosen = choice.next(rays.len() as u64);
        if let Some(cost) = costs[CANDIDATES[chosen]] {
            choice.learn(chosen, cost);
            self.spent.auto += cost.secs(rays.len() as u64);
        }
        self.spent.chosen[chosen] += 1;
        self.spent.rays += rays.len();
        Ok(())
    }

    fn tree(&self, which: usize, eye: Vec3, rays: &[Ray]) -> Result<Option<EyeTree>, rdh::Error> {
        let training = match which {
            0 | 1 => return Ok(None),
            2 => Training::none(),
            _ => {
                let sample = |ray: &Ray| RaySample {
                    weight: SAMPLED as u32,
                    ..RaySample::new(*ray, None, Query::Closest, RayClass::Lidar)
                };
                Training::from_samples(rays.iter().step_by(SAMPLED + 1).map(sample).collect())
            }
        };
        EyeTree::build(self.world.clone(), eye, &training, &EyeOptions::default(), &self.options).map(Some)
    }
}

fn bits(hits: &[Option<Hit>]) -> impl Iterator<Item = Option<[u32; 4]>> {
    hits.iter().map(|hit| hit.map(|h| [h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.tri.0]))
}

impl Spent {
    fn print(&self, entry: &rdh_scene::Entry, triangles: usize, build: f64, (poses, turns): (usize, usize)) {
        let total = |secs: &[f64]| secs.iter().sum::<f64>();
        println!(
            "\n{}: {triangles} triangles, {poses} poses, {turns} turns each, {} rays; {WORLD} in {:.1} ms",
            entry.id,
            self.rays,
            1e3 * build
        );
        println!(
            "| | build, ms a pose | cast, ns a ray | all poses, s | beside batches | even at, million rays a pose |"
        );
        println!("|---|---|---|---|---|---|");
        let nanos = |which: usize| 1e9 * total(&self.cast[which]) / self.rays as f64;
        let all = |which: usize| build + total(&self.build[which]) + total(&self.cast[which]);
        for (which, name) in NAMES.iter().enumerate() {
            let ratios: Vec<f64> =
                self.cast[which].iter().zip(&self.build[which]).map(|(cast, build)| cast + build).collect();
            let beside: Vec<f64> = ratios.iter().zip(&self.cast[1]).map(|(own, base)| own / base).collect();
            let own = total(&self.build[which]) / poses as f64;
            let gained = nanos(1) - nanos(which);
            let even = if which < 2 {
                "–".to_owned()
            } else if gained > 0.0 {
                format!("{:.2}", own / gained * 1e3)
            } else {
                "never".to_owned()
            };
            println!(
                "| {name} | {:.1} | {:.1} | {:.3} | {:.2} (median of poses {:.2}) | {even} |",
                1e3 * own,
                nanos(which),
                all(which),
                all(which) / all(1),
                median(&beside)
            );
        }
        let auto = build + self.auto;
        println!("| auto | | | {auto:.3} | {:.3} | |", auto / all(1));
        let names = CANDIDATES.map(|i| NAMES[i]);
        println!("auto took {:?}", names.iter().zip(self.chosen).collect::<Vec<_>>());
    }
}
