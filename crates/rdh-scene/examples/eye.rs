//! Rays through one point, by trees around that point and by a hierarchy in the world's space, side by side:
//! `cargo run --release -p rdh-scene --example eye -- [--scenes DIR] [--size N] [--rounds N] SCENE[:VIEW]…`
//!
//! Columns: camera rays in scan-line order (rows; width: with the rows' width known) and in Morton order
//! (tiles), a scanner of 64 beams and 2048 firings (lidar), any-hit
//! rays from what the camera sees to a light (shadow). Thread CPU time where the system tells, interleaved; the best round; answers
//! are compared.

use std::path::PathBuf;
use std::time::Instant;

use rdh::eye::{EyeForm, EyeOptions, EyeTree};
use rdh::{Accel, BuildOptions, Hit, Query, Ray, RayClass, RaySample, Spec, Training, Vec3};
use rdh_scene::catalog::{find, indexed, split_view};
use rdh_scene::{Camera, Scene, View};

/// Rays that are sampled for training.
const SAMPLES: usize = 16_384;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut plan = Plan { scenes: Vec::new(), folder: None, size: 1024, rounds: 5 };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} wants a value"));
        match argument.as_str() {
            "--scenes" => plan.folder = Some(value()?.into()),
            "--size" => plan.size = value()?.parse()?,
            "--rounds" => plan.rounds = value()?.parse()?,
            _ => plan.scenes.push(argument),
        }
    }
    println!(
        "ns a ray: hierarchy alone | eye alone, eye together, by areas | the same by rays; builds in ms (one thread)"
    );
    // Batches would be shared among all threads, and the clock is one thread's.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let all = || plan.scenes.iter().try_for_each(|name| plan.scene(name).map_err(|e| format!("{name}: {e}")));
    Ok(pool.install(all)?)
}

struct Plan {
    scenes: Vec<String>,
    folder: Option<PathBuf>,
    size: usize,
    rounds: usize,
}

impl Plan {
    fn scene(&self, name: &str) -> Result<(), Box<dyn std::error::Error>> {
        let extra = self.folder.as_deref().map_or(Ok(Vec::new()), indexed)?;
        let (id, view) = split_view(name);
        let entry = find(id, &extra)?;
        let scene = entry.load(0)?;
        let view = match view {
            Some(view) => entry.views.iter().find(|v| v.name == view).ok_or("no such view")?,
            None => entry.views.first().ok_or("no view")?,
        };
        let mesh = scene.flatten()?.mesh;
        let spec: Spec = "bvh8(high)+sah".parse()?;
        let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
        let (world, build) = timed(|| rdh::build(&mesh, &spec, &Training::none(), &options));
        let world = world?;
        println!("{name}: {} triangles, hierarchy {:.0} ms", mesh.len(), build / 1e6);
        let camera = Camera::new(view, scene.origin, 1.0);
        let rows: Vec<Ray> =
            (0..self.size * self.size).map(|i| self.pixel(&camera, i % self.size, i / self.size)).collect();
        let lidar = scanner(camera.eye(), scene.up, view);
        let tiles = in_tiles(&rows, self.size);
        let shadow = shadows(&scene, &world, &tiles);
        let from_eye = Kind::Closest { width: None };
        self.column("rows", &world, &rows, camera.eye(), from_eye)?;
        self.column("width", &world, &rows, camera.eye(), Kind::Closest { width: Some(self.size) })?;
        self.column("tiles", &world, &tiles, camera.eye(), from_eye)?;
        // Eight turns: one takes hardly longer than the clock's steps.
        self.column("lidar", &world, &lidar.repeat(8), camera.eye(), Kind::Closest { width: Some(64) })?;
        if let Some(last) = shadow.last() {
            let light = light(&scene, &world);
            assert!(last.t_max.is_finite());
            self.column("shadow", &world, &shadow, light, Kind::Any)?;
        }
        Ok(())
    }

    fn pixel(&self, camera: &Camera, x: usize, y: usize) -> Ray {
        let size = self.size as f64;
        camera.ray((x as f64 + 0.5) / size, (y as f64 + 0.5) / size)
    }

    fn column(&self, name: &str, world: &Accel, rays: &[Ray], eye: Vec3, kind: Kind) -> rdh::Result<()> {
        let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
        let form = if matches!(kind, Kind::Any) { EyeForm::Towards } else { EyeForm::From };
        let spec = EyeOptions { form, ..EyeOptions::default() };
        let training = training(rays, world, form);
        let mut trees = Vec::new();
        for rays in [&Training::none(), &training] {
            let (tree, build) = timed(|| EyeTree::build(world.clone(), eye, rays, &spec, &options));
            trees.push((tree?, build));
        }
        let answers = Answers::of(form, rays.len());
        let mut right = answers.clone();
        let mut best = [f64::INFINITY; 5];
        for _ in 0..self.rounds {
            let (_, nanos) = timed(|| right.alone(rays, |r| world.closest(r), |r| world.occluded(r)));
            best[0] = best[0].min(nanos);
            for (k, (tree, _)) in trees.iter().enumerate() {
                let mut own = answers.clone();
                let (_, nanos) = timed(|| own.alone(rays, |r| tree.closest(r), |r| tree.occluded(r)));
                assert!(own == right, "{name}: other answers alone");
                best[1 + 2 * k] = best[1 + 2 * k].min(nanos);
                let mut own = answers.clone();
                let (_, nanos) = timed(|| own.together(tree, rays, kind));
                assert!(own == right, "{name}: other answers together");
                best[2 + 2 * k] = best[2 + 2 * k].min(nanos);
            }
        }
        let ns = best.map(|b| b / rays.len() as f64);
        print!("  {name:7} {:6.1} |", ns[0]);
        for (k, (tree, build)) in trees.iter().enumerate() {
            let (alone, together, stats) = (ns[1 + 2 * k], ns[2 + 2 * k], tree.stats());
            print!(
                " {alone:6.1} {:5.2}x {together:6.1} {:5.2}x, {:5.0} ms {:7} tris {:8} refs {:6} kB, even at {:6.2} M |",
                ns[0] / alone,
                ns[0] / together,
                build / 1e6,
                stats.triangles,
                stats.references,
                stats.bytes / 1024,
                build / (ns[0] - together) / 1e6
            );
        }
        println!();
        Ok(())
    }
}

/// What is asked.
#[derive(Clone, Copy)]
enum Kind {
    Closest { width: Option<usize> },
    Any,
}

/// Answers of either kind.
#[derive(Clone, PartialEq)]
enum Answers {
    Closest(Vec<Option<Hit>>),
    Any(Vec<bool>),
}

impl Answers {
    fn of(form: EyeForm, n: usize) -> Self {
        match form {
            EyeForm::From => Self::Closest(vec![None; n]),
            EyeForm::Towards => Self::Any(vec![false; n]),
        }
    }

    fn alone(&mut self, rays: &[Ray], closest: impl Fn(&Ray) -> Option<Hit>, any: impl Fn(&Ray) -> bool) {
        match self {
            Self::Closest(hits) => hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = closest(ray)),
            Self::Any(found) => found.iter_mut().zip(rays).for_each(|(found, ray)| *found = any(ray)),
        }
    }

    fn together(&mut self, tree: &EyeTree, rays: &[Ray], kind: Kind) {
        match self {
            Self::Closest(hits) => match kind {
                Kind::Closest { width: Some(width) } => tree.closest_rows(rays, width, hits),
                _ => tree.closest_many(rays, hits),
            },
            Self::Any(found) => tree.occluded_many(rays, found),
        }
    }
}

/// Rays of which every few are sampled, and how many each stands for.
fn training(rays: &[Ray], world: &Accel, form: EyeForm) -> Training {
    let every = rays.len().div_ceil(SAMPLES).max(1);
    // Not in step with rows.
    let picked = (0..rays.len() / every).map(|i| &rays[i * every + i * 7 % every]);
    let sample = |ray: &Ray| match form {
        EyeForm::From => RaySample::new(*ray, world.closest(ray), Query::Closest, RayClass::Primary),
        EyeForm::Towards => RaySample::new(*ray, None, Query::Occluded, RayClass::Shadow),
    };
    Training::from_samples(picked.map(|r| RaySample { weight: every as u32, ..sample(r) }).collect())
}

/// Rays in Morton order.
fn in_tiles(rows: &[Ray], size: usize) -> Vec<Ray> {
    let spread = |x: usize| (0..16).fold(0, |s, b| s | (x >> b & 1) << (2 * b));
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by_key(|i| spread(i % size) | spread(i / size) << 1);
    order.into_iter().map(|i| rows[i]).collect()
}

/// 64 beams, 45° from top to bottom, in 2048 firings.
fn scanner(eye: Vec3, up: [f64; 3], view: &View) -> Vec<Ray> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |a: [f64; 3]| a.map(|x| x / dot(a, a).sqrt());
    let up = unit(up);
    let look = [0, 1, 2].map(|a| view.target[a] - view.eye[a]);
    let level = [0, 1, 2].map(|a| look[a] - dot(look, up) * up[a]);
    let forward = unit(if dot(level, level) > 1e-12 { level } else { [0.3 + up[1], up[2] - 0.1, up[0]] });
    let right = cross(forward, up);
    let mut rays = Vec::new();
    for firing in 0..2048 {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(firing) / 2048.0).sin_cos();
        for beam in 0..64 {
            let elevation = ((0.5 - (f64::from(beam) + 0.5) / 64.0) * 45.0).to_radians();
            let d = [0, 1, 2].map(|a| (forward[a] * cos + right[a] * sin) * elevation.cos() + up[a] * elevation.sin());
            rays.push(Ray::new(eye, d.map(|x| x as f32)));
        }
    }
    rays
}

/// The scene's first light, or a place in the upper part of its box.
fn light(scene: &Scene, world: &Accel) -> Vec3 {
    let bounds = world.bounds();
    let in_box = [0, 1, 2].map(|a| {
        let part = 0.5 + 0.4 * scene.up[a].clamp(-1.0, 1.0) as f32;
        bounds.min[a] + part * (bounds.max[a] - bounds.min[a])
    });
    scene.lights.first().map_or(in_box, |l| [0, 1, 2].map(|a| (l.position[a] - scene.origin[a]) as f32))
}

/// Rays from what is seen to the light.
fn shadows(scene: &Scene, world: &Accel, primary: &[Ray]) -> Vec<Ray> {
    let light = light(scene, world);
    let to_light = |ray: &Ray| {
        let hit = world.closest(ray)?;
        let start = world.mesh().spawn(&hit, ray.direction.map(|x| -x));
        let to = [0, 1, 2].map(|a| f64::from(light[a]) - f64::from(start.origin[a]));
        let distance = to.iter().map(|x| x * x).sum::<f64>().sqrt();
        (distance > 0.0).then(|| Ray::new(start.origin, to.map(|x| (x / distance) as f32)).within(0.0, distance as f32))
    };
    primary.iter().filter_map(to_light).collect()
}

/// What some work returns, and the thread's CPU time for it in nanoseconds.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let cpu = || -> Option<f64> {
        std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split(' ').next()?.parse().ok()
    };
    let (start, clock) = (cpu(), Instant::now());
    let result = work();
    let elapsed = clock.elapsed().as_nanos() as f64;
    match (start, cpu()) {
        (Some(start), Some(end)) => (result, end - start),
        _ => (result, elapsed),
    }
}
