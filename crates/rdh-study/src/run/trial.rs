//! The same rays through several structures: counts, answers and times, as rows.

use rayon::ThreadPool;
use rdh::{Accel, Spec};
use rdh_scene::Kind;

use super::build::Built;
use crate::integrate::RayBatch;
use crate::measure::{Tally, difference, tally, time_interleaved};
use crate::plan::{Case, Plan};
use crate::rows::{Mismatch, Row};
use crate::stats::median;

/// Where a trial takes place, and how.
#[derive(Debug, Clone, Copy)]
pub struct Trial<'a> {
    /// Scene, view, frame and mode.
    pub case: &'a Case,
    /// The scene's kind.
    pub kind: Kind,
    /// The scene's triangles.
    pub triangles: usize,
    /// How often is timed, and what rows say of protocol and seed.
    pub plan: &'a Plan,
    /// The threads that count; `None` is rayon's current pool.
    pub pool: Option<&'a ThreadPool>,
}

/// What a trial found.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Rows of `[structure][batch]`.
    pub rows: Vec<Vec<Row>>,
    /// Where a structure answered otherwise than the first one.
    pub mismatches: Vec<Mismatch>,
}

impl Trial<'_> {
    /// Casts all batches through all structures: once counted, and as often as the plan says on the clock.
    pub fn run(&self, trees: &[&Built], batches: &[RayBatch]) -> Outcome {
        let (tallies, mismatches) = self.tally_all(trees, batches);
        let accels: Vec<&Accel> = trees.iter().map(|t| &t.accel).collect();
        let times = time_interleaved(&accels, batches, self.plan.rounds_for(self.triangles));
        let row = |i: usize, j: usize| self.row(trees[i], &batches[j], &tallies[i][j], &times[i][j]);
        let rows = (0..trees.len()).map(|i| (0..batches.len()).map(|j| row(i, j)).collect());
        Outcome { rows: rows.collect(), mismatches }
    }

    /// Counts of `[tree][batch]`, without the answers, which have been compared with the first tree's.
    fn tally_all(&self, trees: &[&Built], batches: &[RayBatch]) -> (Vec<Vec<Tally>>, Vec<Mismatch>) {
        let mut tallies: Vec<Vec<Tally>> = trees.iter().map(|_| Vec::new()).collect();
        let mut mismatches = Vec::new();
        let Some((first, others)) = trees.split_first() else { return (tallies, mismatches) };
        for batch in batches {
            let base = in_pool(self.pool, || tally(&first.accel, batch));
            for (tree, tallies) in others.iter().zip(&mut tallies[1..]) {
                let mut other = in_pool(self.pool, || tally(&tree.accel, batch));
                mismatches.extend(mismatch(self.case, batch, (tree.spec, &other), (first.spec, &base)));
                other.answers = Vec::new();
                tallies.push(other);
            }
            tallies[0].push(Tally { answers: Vec::new(), ..base });
        }
        (tallies, mismatches)
    }

    fn row(&self, tree: &Built, batch: &RayBatch, tally: &Tally, secs: &[f64]) -> Row {
        let rays = batch.rays.len() as f64;
        let round_nanos_per_ray: Vec<f64> = secs.iter().map(|s| s * 1e9 / rays).collect();
        let stats = tree.accel.stats();
        let (train_view, train_frame) = tree.trained_at.clone().unzip();
        Row {
            scene: self.case.scene.clone(),
            view: self.case.view.clone(),
            frame: self.case.frame,
            kind: self.kind,
            mode: self.case.mode,
            class: batch.class,
            spec: tree.spec,
            chosen: Some(stats.spec).filter(|&spec| spec != tree.spec),
            triangles: self.triangles,
            rays: batch.rays.len() as u64,
            hits: tally.hits,
            t_sum: tally.t_sum,
            trained_on: stats.trained_on,
            train_view,
            train_frame,
            steps_per_ray: tally.counts.steps() as f64 / rays,
            tests_per_ray: tally.counts.tests as f64 / rays,
            empty_leaves_per_ray: tally.counts.empty_leaves as f64 / rays,
            cost_p999: tally.cost_p999,
            nanos_per_ray: median(&round_nanos_per_ray),
            round_nanos_per_ray,
            build_secs: tree.build_secs,
            rrs_secs: tree.rrs_secs,
            nodes: stats.nodes,
            references: stats.references,
            bytes: stats.bytes,
            depth: stats.depth,
            protocol: self.plan.protocol,
            seed: self.plan.seed,
            experiment: None,
            setting: None,
            x: None,
            depth_complexity: None,
        }
    }
}

/// Runs work on the pool, or where it stands.
pub(crate) fn in_pool<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

fn mismatch(case: &Case, batch: &RayBatch, other: (Spec, &Tally), base: (Spec, &Tally)) -> Option<Mismatch> {
    let difference = difference(other.1, base.1)?;
    let ray = &batch.rays[difference.first];
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    Some(Mismatch {
        scene: case.scene.clone(),
        view: case.view.clone(),
        mode: case.mode,
        class: batch.class,
        spec: other.0,
        base: base.0,
        rays: difference.rays,
        first_ray: difference.first,
        ray: [ox, oy, oz, dx, dy, dz],
        t_max: Some(ray.t_max).filter(|t| t.is_finite()),
        answer: other.1.answers[difference.first].hit(),
        base_answer: base.1.answers[difference.first].hit(),
    })
}
