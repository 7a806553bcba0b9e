//! What builds cost: CPU time of one thread, how much sooner two threads are done, and how both grow with the scene.

use std::hint::black_box;
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use rdh::{Accel, BuildOptions, Mesh, Spec, Training};
use serde::Serialize;

use crate::clock::time_process;
use crate::error::{Error, Result};
use crate::plan::Target;
use crate::rows::Failure;
use crate::stats::geometric_mean;

/// Scenes × specs, each built on one thread and on two.
#[derive(Debug, Clone)]
pub struct BuildsPlan {
    /// Which scenes; views don't matter.
    pub targets: Vec<Target>,
    /// What is built: nothing that needs rays.
    pub specs: Vec<Spec>,
    /// How often; the best time of each counts.
    pub rounds: usize,
}

/// A scene and a spec.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuildsRow {
    /// The scene.
    pub scene: String,
    /// How many triangles it has, instances counted.
    pub triangles: usize,
    /// What was built.
    pub spec: String,
    /// CPU seconds of a build on one thread.
    pub cpu_secs: f64,
    /// Elapsed seconds of a build on one thread.
    pub one_thread_secs: f64,
    /// Elapsed seconds of a build on two threads.
    pub two_threads_secs: f64,
    /// References a triangle.
    pub references: f64,
    /// Bytes of the structure.
    pub bytes: usize,
    /// Whether both have built the same tree, bit for bit: a bug if not.
    pub same_trees: bool,
}

/// A spec over all scenes: geometric means.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuildsSummary {
    /// What was built.
    pub spec: String,
    /// How many scenes.
    pub n: usize,
    /// CPU seconds per million triangles, on one thread.
    pub cpu_secs_per_million: f64,
    /// How many times as fast two threads are.
    pub speedup: f64,
}

/// How a spec's CPU time grows over the sizes of one generator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// The generator.
    pub generator: String,
    /// What was built.
    pub spec: String,
    /// The smallest and the largest number of triangles.
    pub triangles: [usize; 2],
    /// Time goes as this power of the number of triangles, from the smallest to the largest.
    pub exponent: f64,
}

/// Everything that was found out.
#[derive(Debug, Clone, Serialize)]
pub struct BuildsDocument {
    /// Of this format.
    pub version: u32,
    /// Scene by scene.
    pub rows: Vec<BuildsRow>,
    /// Over all scenes.
    pub summary: Vec<BuildsSummary>,
    /// Where a generator is there in several sizes.
    pub growth: Vec<Growth>,
    /// How many times as much arithmetic two threads do as one, in registers alone: what this machine allowed meanwhile.
    pub ceiling: f64,
    /// What could not be built.
    pub failures: Vec<Failure>,
}

impl BuildsPlan {
    /// What is built unless specs are named.
    pub const SPECS: &'static str =
        "bvh8(quick)+sah,bvh8+sah,bvh8(split=sweep)+sah,bvh8(high)+sah,sbvh8+sah,sbvh8(high)+sah,kd+sah";

    /// Generated scenes: three sizes of one, for growth, and two others.
    pub const GENERATED: [&'static str; 5] =
        ["terrain(cells=224)", "terrain(cells=707)", "terrain(cells=1581)", "rooms", "city"];

    fn check(&self) -> Result<()> {
        if self.targets.is_empty() || self.specs.is_empty() || self.rounds == 0 {
            return Err(Error::Plan("nothing to do: no scenes, no specs or no rounds".to_owned()));
        }
        match self.specs.iter().find(|spec| spec.needs_rays()) {
            Some(spec) => Err(Error::Plan(format!("{spec} needs rays: only builds without them are measured here"))),
            None => Ok(()),
        }
    }
}

/// Builds all, and tells each row as it comes.
///
/// # Errors
/// A plan that asks for nothing, or for what needs rays. What goes wrong with one scene or spec is in the document.
pub fn builds(plan: &BuildsPlan, see: &mut dyn FnMut(&BuildsRow)) -> Result<BuildsDocument> {
    plan.check()?;
    let (mut rows, mut failures, mut ceiling) = (Vec::new(), Vec::new(), Ceiling::default());
    // One pool for all, as programs have it: new threads start without memory that was used before.
    let pool = ThreadPoolBuilder::new().num_threads(2).build().map_err(|e| Error::Plan(e.to_string()))?;
    for target in &plan.targets {
        let scene = &target.entry.id;
        let mut fail = |spec: Option<Spec>, reason: String| {
            failures.push(Failure { scene: scene.clone(), view: None, spec, reason });
        };
        let flat = target.entry.load(0).map_err(|e| e.to_string()).and_then(|s| s.flatten().map_err(|e| e.to_string()));
        let mesh = match flat {
            Ok(flat) => flat.mesh,
            Err(reason) => {
                fail(None, reason);
                continue;
            }
        };
        for spec in &plan.specs {
            match row(scene, &mesh, spec, plan.rounds, &pool, &mut ceiling) {
                Ok(row) => {
                    see(&row);
                    rows.push(row);
                }
                Err(reason) => fail(Some(*spec), reason),
            }
        }
    }
    let summary = plan.specs.iter().filter_map(|spec| summary(&spec.to_string(), &rows)).collect();
    Ok(BuildsDocument { version: 1, summary, growth: growth(&rows), ceiling: ceiling.factor(), rows, failures })
}

/// The best of some rounds: whatever else runs on the machine only makes it slower.
fn row(
    scene: &str,
    mesh: &Mesh,
    spec: &Spec,
    rounds: usize,
    pool: &ThreadPool,
    ceiling: &mut Ceiling,
) -> Result<BuildsRow, String> {
    let (mut cpu_secs, mut elapsed) = (f64::INFINITY, [f64::INFINITY; 2]);
    let (mut stats, mut same_trees) = (None, true);
    for _ in 0..rounds {
        ceiling.measure();
        let ((one, secs), cpu) = time_process(|| build(mesh, spec, Some(1)));
        // Gone before the next one begins, which finds the same memory.
        let tree_of_one = one?.fingerprint();
        let (two, secs_of_two) = pool.install(|| build(mesh, spec, None));
        let two = two?;
        same_trees &= tree_of_one == two.fingerprint();
        cpu_secs = cpu_secs.min(cpu);
        elapsed = [elapsed[0].min(secs), elapsed[1].min(secs_of_two)];
        stats = Some(*two.stats());
    }
    let stats = stats.ok_or("no rounds")?;
    let triangles = mesh.len();
    Ok(BuildsRow {
        scene: scene.to_owned(),
        triangles,
        spec: spec.to_string(),
        cpu_secs,
        one_thread_secs: elapsed[0],
        two_threads_secs: elapsed[1],
        references: stats.references as f64 / triangles.max(1) as f64,
        bytes: stats.bytes,
        same_trees,
    })
}

/// A structure, and the elapsed seconds; on all threads of the pool at hand unless their number is said.
fn build(mesh: &Mesh, spec: &Spec, threads: Option<usize>) -> (Result<Accel, String>, f64) {
    let options = BuildOptions { threads, ..BuildOptions::default() };
    let start = Instant::now();
    let accel = rdh::build(mesh, spec, &Training::none(), &options).map_err(|e| e.to_string());
    (accel, start.elapsed().as_secs_f64())
}

fn summary(spec: &str, rows: &[BuildsRow]) -> Option<BuildsSummary> {
    let rows: Vec<&BuildsRow> = rows.iter().filter(|row| row.spec == spec && row.triangles > 0).collect();
    let mean = |f: fn(&BuildsRow) -> f64| geometric_mean(&rows.iter().map(|row| f(row)).collect::<Vec<_>>());
    (!rows.is_empty()).then(|| BuildsSummary {
        spec: spec.to_owned(),
        n: rows.len(),
        cpu_secs_per_million: mean(BuildsRow::cpu_secs_per_million),
        speedup: mean(BuildsRow::speedup),
    })
}

impl BuildsRow {
    /// CPU seconds per million triangles, on one thread.
    pub fn cpu_secs_per_million(&self) -> f64 {
        self.cpu_secs / self.triangles as f64 * 1e6
    }

    /// How many times as fast two threads are.
    pub fn speedup(&self) -> f64 {
        self.one_thread_secs / self.two_threads_secs
    }

    fn generator(&self) -> &str {
        self.scene.split('(').next().unwrap_or_default()
    }
}

/// For each generator and spec: from the smallest to the largest scene.
fn growth(rows: &[BuildsRow]) -> Vec<Growth> {
    let mut all: Vec<Growth> = Vec::new();
    for row in rows {
        let alike = |other: &&BuildsRow| other.generator() == row.generator() && other.spec == row.spec;
        let known = |growth: &Growth| growth.generator == row.generator() && growth.spec == row.spec;
        let smallest = rows.iter().filter(alike).min_by_key(|row| row.triangles);
        let largest = rows.iter().filter(alike).max_by_key(|row| row.triangles);
        let (Some(small), Some(large)) = (smallest, largest) else { continue };
        if small.triangles == 0 || small.triangles == large.triangles || all.iter().any(known) {
            continue;
        }
        all.push(Growth {
            generator: row.generator().to_owned(),
            spec: row.spec.clone(),
            triangles: [small.triangles, large.triangles],
            exponent: (large.cpu_secs / small.cpu_secs).ln() / (large.triangles as f64 / small.triangles as f64).ln(),
        });
    }
    all
}

/// Arithmetic on one thread and on two at once: the best seconds of each.
struct Ceiling([f64; 2]);

impl Default for Ceiling {
    fn default() -> Self {
        Self([f64::INFINITY; 2])
    }
}

impl Ceiling {
    /// Some 10 ms.
    const STEPS: u64 = 1 << 23;

    fn measure(&mut self) {
        let timed = |work: &dyn Fn()| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        };
        let one = timed(&|| spin());
        let two = timed(&|| {
            std::thread::scope(|scope| {
                scope.spawn(spin);
                spin();
            });
        });
        self.0 = [self.0[0].min(one), self.0[1].min(two)];
    }

    /// How many times as much two threads do.
    fn factor(&self) -> f64 {
        2.0 * self.0[0] / self.0[1]
    }
}

/// A chain of multiplications, in registers.
fn spin() {
    let chain = |x: u64, step: u64| (x ^ step).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    black_box((0..Ceiling::STEPS).fold(1, chain));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(scenes: &[&str], specs: &str) -> BuildsPlan {
        let find = |name: &&str| Target::all(rdh_scene::catalog::find(name, &[]).unwrap());
        BuildsPlan { targets: scenes.iter().map(find).collect(), specs: Spec::list(specs).unwrap(), rounds: 1 }
    }

    #[test]
    fn every_scene_is_built_with_every_spec_and_sizes_of_a_generator_show_growth() {
        let mut seen = 0;
        let plan = plan(&["terrain(cells=10)", "terrain(cells=40)", "tetra5"], "kd+sah,bvh8(split=sweep)+sah");
        let document = builds(&plan, &mut |_| seen += 1).unwrap();
        assert_eq!((document.rows.len(), seen, document.failures.len()), (6, 6, 0));
        assert!(document.rows.iter().all(|row| row.cpu_secs > 0.0 && row.speedup() > 0.0 && row.references >= 1.0));
        assert!(document.rows.iter().all(|row| row.same_trees));
        assert_eq!((document.summary.len(), document.summary[1].n), (2, 3));
        let growth: Vec<_> =
            document.growth.iter().map(|g| (g.generator.as_str(), g.spec.as_str(), g.triangles)).collect();
        assert_eq!(growth, [("terrain", "kd+sah", [200, 3200]), ("terrain", "bvh8(split=sweep)+sah", [200, 3200])]);
        assert!(document.ceiling > 0.0);
    }

    #[test]
    fn the_default_specs_are_specs_and_what_needs_rays_is_refused() {
        let names: Vec<_> = Spec::list(BuildsPlan::SPECS).unwrap().iter().map(ToString::to_string).collect();
        assert_eq!(names.join(","), BuildsPlan::SPECS);
        assert!(builds(&plan(&["tetra5"], "kd+rdh"), &mut |_| {}).is_err());
        assert!(builds(&plan(&[], "kd+sah"), &mut |_| {}).is_err());
    }
}
