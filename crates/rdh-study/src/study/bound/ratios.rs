//! The bounds of one view: what each tree costs the test rays, against SAH's.

use rdh::kd::{Costs, LeafWidth, Shown};
use rdh::{Accel, BuildOptions, HeuristicSpec, KdSpec, Mesh, Probe, RdhSpec, Spec, StructureSpec, Training};

use super::grow::{Grown, Room, grow, pay};
use super::search::{Effort, search};
use super::shape::{Part, Segment};
use super::small::{Paid, SmallBound, SmallScene};

/// Scenes of up to so many triangles get the optimum over a lattice.
pub const SMALL_UP_TO: usize = 450;
/// Scenes of up to so many get the search from tree to tree.
pub const SEARCHED_UP_TO: usize = 30_000;
/// Intervals of the lattice an axis.
const INTERVALS: usize = 12;

/// `cost`, `steps` or `tests` of a tree over those of the greedy tree by areas, paid by the test rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratio {
    /// The quantity and the tree: `cost: lattice, optimal by oracle`.
    pub name: String,
    /// The structure that it is a variant of.
    pub spec: Spec,
    /// Below 1 is better than SAH.
    pub ratio: f64,
}

/// The bounds for one view. The test rays are the "oracle" that some trees know. Empty for scenes that are too large, or
/// flat.
///
/// # Errors
/// What the library says when it builds the real trees.
pub fn bounds(mesh: &Mesh, training: &Training, test: &Training) -> rdh::Result<Vec<Ratio>> {
    let mut ratios = Vec::new();
    match mesh.len() {
        0 => {}
        n if n <= SMALL_UP_TO => {
            let leaves = [LeafWidth::One, LeafWidth::Eight];
            let built = leaves.map(|leaf| RealTrees::build(mesh, leaf, training, test));
            let built = built.into_iter().collect::<rdh::Result<Vec<RealTrees>>>()?;
            let Some(scene) = SmallScene::new(Part::all(mesh), &chosen_planes(&built), INTERVALS) else {
                return Ok(ratios);
            };
            let counts = [training, test].map(|rays| scene.rays(rays));
            for (leaf, built) in leaves.into_iter().zip(&built) {
                let bound = scene.bound(&Costs::of(leaf), &counts[0], &counts[1]);
                ratios.extend(on_a_lattice(leaf, &bound, built, test));
            }
        }
        n if n <= SEARCHED_UP_TO => ratios.extend(by_search(mesh, LeafWidth::Eight, training, test)?),
        _ => {}
    }
    Ok(ratios)
}

fn on_a_lattice(leaf: LeafWidth, bound: &SmallBound, built: &RealTrees, test: &Training) -> Vec<Ratio> {
    let [sah, rdh] = specs(leaf);
    let paid = [
        ("lattice, optimal by areas", sah, bound.optimal_by_areas),
        ("lattice, greedy by rays", rdh, bound.greedy_by_rays),
        ("lattice, optimal by rays", rdh, bound.optimal_by_rays),
        ("lattice, greedy by oracle", rdh, bound.greedy_by_oracle),
        ("lattice, optimal by oracle", rdh, bound.optimal_by_oracle),
        ("lattice, built", sah, paid_by_rays(&built.sah, test)),
        ("lattice, built", rdh, paid_by_rays(&built.rdh, test)),
        ("lattice, built by oracle", rdh, paid_by_rays(&built.oracle, test)),
    ];
    of_base(&bound.greedy_by_areas, &paid)
}

/// What the library builds.
struct RealTrees {
    sah: Accel,
    rdh: Accel,
    oracle: Accel,
}

impl RealTrees {
    fn build(mesh: &Mesh, leaf: LeafWidth, training: &Training, test: &Training) -> rdh::Result<Self> {
        let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
        let [sah, rdh] = specs(leaf);
        let build = |spec: &Spec, rays: &Training| rdh::build(mesh, spec, rays, &options);
        Ok(Self { sah: build(&sah, training)?, rdh: build(&rdh, training)?, oracle: build(&rdh, test)? })
    }
}

/// The planes of real trees, from the roots down: with them in the lattice the optimum can compete with those trees.
fn chosen_planes(built: &[RealTrees]) -> Vec<(usize, f64)> {
    let mut planes: Vec<(usize, usize, f64)> = Vec::new();
    for accel in built.iter().flat_map(|trees| [&trees.sah, &trees.rdh, &trees.oracle]) {
        let Some(tree) = accel.kd_tree() else { continue };
        tree.walk(&mut |_, depth, node| {
            if let Shown::Interior { axis, plane } = node {
                planes.push((depth, axis.index(), plane.into()));
            }
        });
    }
    planes.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    planes.into_iter().map(|(_, axis, plane)| (axis, plane)).collect()
}

fn by_search(mesh: &Mesh, leaf: LeafWidth, training: &Training, test: &Training) -> rdh::Result<Vec<Ratio>> {
    let (costs, [_, rdh]) = (Costs::of(leaf), specs(leaf));
    let built = RealTrees::build(mesh, leaf, training, test)?;
    let [train_rays, test_rays] = [training, test].map(Segment::all);
    let room = |rays: &[Segment]| Room::new(Part::all(mesh), rays);
    let oracle = room(&test_rays);
    let (low, high) = (oracle.low, oracle.high);
    let paid_in = |tree: &Grown| {
        let n = oracle.rays.len().max(1) as f64;
        let [cost, steps, tests] = pay(tree, &costs, &oracle.rays, low, high).map(|x| x / n);
        Paid { cost, steps, tests }
    };
    let effort = Effort::default();
    let paid = [
        ("search, built", rdh, paid_by_rays(&built.rdh, test)),
        ("search, built by oracle", rdh, paid_by_rays(&built.oracle, test)),
        ("search, greedy by oracle", rdh, paid_in(&grow(&oracle, &costs, 0, 0))),
        ("search, searched by rays", rdh, paid_in(&search(room(&train_rays), &costs, &effort))),
        ("search, searched by oracle", rdh, paid_in(&search(oracle.clone(), &costs, &effort))),
    ];
    Ok(of_base(&paid_by_rays(&built.sah, test), &paid))
}

fn of_base(base: &Paid, paid: &[(&str, Spec, Paid)]) -> Vec<Ratio> {
    let of = |(tree, spec, paid): &(&str, Spec, Paid)| {
        let quantities =
            [("cost", paid.cost, base.cost), ("steps", paid.steps, base.steps), ("tests", paid.tests, base.tests)];
        let sound = quantities.into_iter().filter(|(_, _, base)| *base > 0.0);
        let ratio =
            |(quantity, value, base)| Ratio { name: format!("{quantity}: {tree}"), spec: *spec, ratio: value / base };
        sound.map(ratio).collect::<Vec<_>>()
    };
    paid.iter().flat_map(of).collect()
}

/// SAH and RDH, searching all planes.
fn specs(leaf: LeafWidth) -> [Spec; 2] {
    let structure = StructureSpec::Kd(KdSpec { leaf, ..KdSpec::default() });
    [HeuristicSpec::Sah, HeuristicSpec::Rdh(RdhSpec::default())].map(|heuristic| Spec { structure, heuristic })
}

/// What the test rays that meet the scene's box pay in a tree of the library, each as far as its nearest hit.
fn paid_by_rays(accel: &Accel, test: &Training) -> Paid {
    let mut bill = Bill::default();
    if let (Some(tree), StructureSpec::Kd(kd)) = (accel.kd_tree(), accel.stats().spec.structure) {
        for sample in test.samples() {
            let mut one = Bill { costs: Some(Costs::of(kd.leaf)), ..Bill::default() };
            let ray = sample.ray.within(sample.ray.t_min, sample.t_end());
            let _ = tree.closest(&ray, &mut one);
            if one.steps > 0.0 {
                bill = Bill {
                    rays: bill.rays + 1.0,
                    cost: bill.cost + one.cost,
                    steps: bill.steps + one.steps,
                    tests: bill.tests + one.tests,
                    costs: None,
                };
            }
        }
    }
    let n = bill.rays.max(1.0);
    Paid { cost: bill.cost / n, steps: bill.steps / n, tests: bill.tests / n }
}

/// What rays pay while they walk a tree.
#[derive(Clone, Copy, Debug, Default)]
struct Bill {
    costs: Option<Costs>,
    rays: f64,
    cost: f64,
    steps: f64,
    tests: f64,
}

impl Probe for Bill {
    fn interior(&mut self) {
        self.steps += 1.0;
        self.cost += self.costs.map_or(0.0, |c| f64::from(c.traverse));
    }

    fn leaf(&mut self, triangles: u32) {
        self.steps += 1.0;
        self.tests += f64::from(triangles);
        self.cost += self.costs.map_or(0.0, |c| f64::from(c.leaf(triangles as usize)));
    }
}
