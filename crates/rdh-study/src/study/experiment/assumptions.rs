//! SAH's two assumptions taken apart: rays spread evenly, and rays that nothing stops.

use rdh::kd::Costs;
use rdh::{Spec, StructureSpec, Training};

use super::{Experiment, Job, Lab, Record, Scope, specs};
use crate::integrate::Mode;
use crate::plan::Protocol;
use crate::rows::Curve;
use crate::run::Built;
use crate::study::bound::Segment;
use crate::study::lab::{Setting, beside_base};
use crate::study::scope::Sample;
use crate::study::skeleton::Skeleton;

pub(super) struct Assumptions;

/// Which rays teach, and how much of them counts: the four corners between SAH's assumptions and what is cast.
const CORNERS: [(&str, bool, &str); 4] = [
    ("uniform whole", true, "kd+rdh(rays=whole)"),
    ("uniform clipped", true, "kd+rdh"),
    ("real whole", false, "kd+rdh(rays=whole)"),
    ("real clipped", false, "kd+rdh"),
];
/// Test rays that are followed through the nodes.
const FOLLOWED: usize = 65_536;

impl Experiment for Assumptions {
    fn name(&self) -> &'static str {
        "assumptions"
    }

    fn question(&self) -> &'static str {
        "What does each of SAH's assumptions cost: that rays are uniform, and that nothing stops them; and how wrong are its chances and its cost?"
    }

    fn jobs(&self, scope: &Scope) -> Vec<Job> {
        scope.jobs(self.name(), Sample::FEW, &[Mode::Primary, Mode::Path])
    }

    fn run(&self, lab: &Lab<'_>, found: &mut Record) -> Result<(), String> {
        let (view, mode) = (lab.view(&found.job.view)?, found.job.mode);
        let real = lab.lesson(&view, mode, Protocol::Unseen, lab.plan.training);
        let uniform = lab.uniform_lesson(lab.plan.training);
        let mut wanted = vec![(Spec::default(), &real)];
        for (_, is_uniform, spec) in CORNERS {
            let lesson = if is_uniform { &uniform } else { &real };
            wanted.extend(specs(spec)?.into_iter().map(|spec| (spec, lesson)));
        }
        let built: Option<Vec<Built>> = lab.build(&wanted, found).into_iter().collect();
        let built = built.ok_or("not all of its trees could be built")?;
        let settings = CORNERS.map(|(name, ..)| Setting::named(name));
        lab.measure(&beside_base(&built, &settings), &lab.rays(&view, mode), found);
        let test = Segment::all(&lab.sample(&view, mode, FOLLOWED));
        for (built, tree) in built.iter().zip(["sah"].into_iter().chain(CORNERS.map(|c| c.0))) {
            let Some(kd) = built.accel.kd_tree() else { continue };
            let guesses = Guesses::new(Skeleton::of(kd), &uniform.training, &real.training, &test);
            found.curves.extend(guesses.curves(lab, found, built.spec, tree));
        }
        Ok(())
    }
}

/// What areas and samples say of a tree's nodes, and what the test rays do.
struct Guesses {
    skeleton: Skeleton,
    /// Visits of each node, in proportion, by guess.
    guessed: Vec<(&'static str, Vec<f64>)>,
    measured: Vec<f64>,
}

impl Guesses {
    fn new(skeleton: Skeleton, uniform: &Training, real: &Training, test: &[Segment]) -> Self {
        let rays = |rays: &Training, whole: bool| {
            let rays = if whole { Segment::all_whole(rays) } else { Segment::all(rays) };
            skeleton.visits(&rays)
        };
        let guessed = vec![
            ("areas", skeleton.areas()),
            ("uniform whole", rays(uniform, true)),
            ("uniform clipped", rays(uniform, false)),
            ("real whole", rays(real, true)),
            ("real clipped", rays(real, false)),
        ];
        let measured = skeleton.visits(test);
        Self { skeleton, guessed, measured }
    }

    fn curves(&self, lab: &Lab<'_>, found: &Record, spec: Spec, tree: &str) -> Vec<Curve> {
        let curve = |name: String, across: &str, points: Vec<[f64; 3]>| found.curve(name, spec, across, points);
        let mut curves = Vec::new();
        for (guess, visits) in &self.guessed {
            if let Some(ratio) = self.cost_ratio(&spec, visits) {
                let points = vec![[lab.mesh().len() as f64, ratio, 1.0]];
                curves.push(curve(
                    format!("cost predicted / measured, by {guess}, tree of {tree}"),
                    "triangles",
                    points,
                ));
            }
            // By depth in the trees of SAH and of RDH only: the others lie between.
            if tree == "sah" || tree == "real clipped" {
                let [error, ratio] = self.by_depth(visits);
                curves.push(curve(format!("|p estimated - p measured|, by {guess}, tree of {tree}"), "depth", error));
                curves.push(curve(format!("p estimated / p measured, by {guess}, tree of {tree}"), "depth", ratio));
            }
        }
        curves
    }

    fn cost_ratio(&self, spec: &Spec, visits: &[f64]) -> Option<f64> {
        let StructureSpec::Kd(kd) = spec.structure else { return None };
        let [predicted, measured] = [visits, &self.measured].map(|v| self.skeleton.cost(v, &Costs::of(kd.leaf)));
        (measured > 0.0).then(|| predicted / measured)
    }

    /// The chances to go from a node to each of its children, by the node's depth, weighed by who really goes there: the mean
    /// absolute error, and the ratio of the means. A node that a sample never saw has no chance to compare.
    fn by_depth(&self, visits: &[f64]) -> [Vec<[f64; 3]>; 2] {
        let nodes = self.skeleton.nodes();
        let depths = 1 + nodes.iter().map(|n| n.depth).max().unwrap_or(0);
        let (mut error, mut estimated, mut measured, mut weight) =
            (vec![0.0; depths], vec![0.0; depths], vec![0.0; depths], vec![0.0; depths]);
        for (i, node) in nodes.iter().enumerate() {
            let Some((_, _, right)) = node.split.filter(|_| visits[i] > 0.0 && self.measured[i] > 0.0) else {
                continue;
            };
            for child in [i + 1, right] {
                let (p, q) = (visits[child] / visits[i], self.measured[child] / self.measured[i]);
                let w = self.measured[i];
                error[node.depth] += w * (p - q).abs();
                estimated[node.depth] += w * p;
                measured[node.depth] += w * q;
                weight[node.depth] += w;
            }
        }
        let seen = || (0..depths).filter(|&d| weight[d] > 0.0);
        let error = seen().map(|d| [d as f64, error[d] / weight[d], weight[d]]).collect();
        let ratio = seen().filter(|&d| measured[d] > 0.0).map(|d| [d as f64, estimated[d] / measured[d], weight[d]]);
        [error, ratio.collect()]
    }
}
