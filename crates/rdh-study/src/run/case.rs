//! One case: a view of a scene in a mode, from rays to rows.

use rdh::{Spec, Training};
use rdh_scene::View;

use super::build::Built;
use super::{Event, Prepared, Study};
use crate::clock::time_thread;
use crate::integrate::{Mode, RayBatch, Shoot};
use crate::measure::{Tally, difference, tally, time_interleaved};
use crate::plan::{Case, Plan};
use crate::rows::{Mismatch, Row};
use crate::stats::median;

impl Study<'_, '_> {
    pub(super) fn case(&mut self, on: &Prepared<'_>, view: &View, mode: Mode) {
        let case = Case { scene: on.target.entry.id.clone(), view: view.name.clone(), frame: on.frame, mode };
        (self.observer)(&Event::Started { case: &case, done: self.done, total: self.total });
        let Some(first) = on.first() else {
            return self.fail_case(on, Some(&view.name), None, "no structure to make the rays with".to_owned());
        };
        let shoot = Shoot::new(&on.stage, mode, view, self.plan);
        let batches = self.in_pool(|| shoot.batches(first));
        let needs_rays: Vec<Spec> = self.plan.specs.iter().filter(|s| s.needs_rays()).copied().collect();
        let test_rays = batches.iter().map(|b| b.rays.len()).sum();
        let (training, rrs_secs) = match needs_rays.is_empty() {
            true => (Training::none(), 0.0),
            false => time_thread(|| shoot.training(first, test_rays)),
        };
        let trained = self.build_all(on, Some(&view.name), &needs_rays, &training);
        let trees: Vec<&Built> = self.plan.specs.iter().filter_map(|s| find(&on.shared, &trained, s)).collect();
        if trees.is_empty() {
            return;
        }
        let tallies = self.tally_all(&case, &trees, &batches);
        let accels: Vec<&rdh::Accel> = trees.iter().map(|t| &t.accel).collect();
        let times = time_interleaved(&accels, &batches, self.plan.rounds_for(on.stage.mesh().len()));
        for (i, tree) in trees.iter().enumerate() {
            for (j, batch) in batches.iter().enumerate() {
                let row = row(self.plan, on, &case, tree, batch, &tallies[i][j], &times[i][j], rrs_secs);
                (self.observer)(&Event::Row(&row));
                self.document.rows.push(row);
            }
        }
    }

    /// Counts of `[tree][batch]`; disagreements with the first tree are told.
    fn tally_all(&mut self, case: &Case, trees: &[&Built], batches: &[RayBatch]) -> Vec<Vec<Tally>> {
        let mut tallies: Vec<Vec<Tally>> = trees.iter().map(|_| Vec::new()).collect();
        for batch in batches {
            let base = self.in_pool(|| tally(&trees[0].accel, batch));
            for (i, tree) in trees.iter().enumerate().skip(1) {
                let mut other = self.in_pool(|| tally(&tree.accel, batch));
                if let Some(mismatch) = mismatch(case, batch, (tree.spec, &other), (trees[0].spec, &base)) {
                    (self.observer)(&Event::Mismatch(&mismatch));
                    self.document.mismatches.push(mismatch);
                }
                other.answers = Vec::new();
                tallies[i].push(other);
            }
            tallies[0].push(Tally { answers: Vec::new(), ..base });
        }
        tallies
    }
}

fn find<'b>(shared: &'b [Built], trained: &'b [Built], spec: &Spec) -> Option<&'b Built> {
    shared.iter().chain(trained).find(|b| b.spec == *spec)
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

#[expect(clippy::too_many_arguments, reason = "a row is where everything comes together")]
fn row(
    plan: &Plan,
    on: &Prepared<'_>,
    case: &Case,
    tree: &Built,
    batch: &RayBatch,
    tally: &Tally,
    secs: &[f64],
    rrs_secs: f64,
) -> Row {
    let rays = batch.rays.len() as f64;
    let round_nanos_per_ray: Vec<f64> = secs.iter().map(|s| s * 1e9 / rays).collect();
    let (stats, trained) = (tree.accel.stats(), tree.spec.needs_rays());
    Row {
        scene: case.scene.clone(),
        view: case.view.clone(),
        frame: case.frame,
        kind: on.target.entry.kind,
        mode: case.mode,
        class: batch.class,
        spec: tree.spec,
        triangles: on.stage.mesh().len(),
        rays: batch.rays.len() as u64,
        hits: tally.hits,
        t_sum: tally.t_sum,
        trained_on: stats.trained_on,
        train_view: trained.then(|| case.view.clone()),
        train_frame: trained.then_some(case.frame),
        steps_per_ray: tally.counts.steps() as f64 / rays,
        tests_per_ray: tally.counts.tests as f64 / rays,
        empty_leaves_per_ray: tally.counts.empty_leaves as f64 / rays,
        nanos_per_ray: median(&round_nanos_per_ray),
        round_nanos_per_ray,
        build_secs: tree.build_secs,
        rrs_secs: if trained { rrs_secs } else { 0.0 },
        nodes: stats.nodes,
        references: stats.references,
        bytes: stats.bytes,
        depth: stats.depth,
        protocol: plan.protocol,
        seed: plan.seed,
        experiment: None,
        setting: None,
        x: None,
        cost_p999: None,
        depth_complexity: None,
    }
}
