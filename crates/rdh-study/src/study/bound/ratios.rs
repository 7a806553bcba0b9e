//! The bounds of one view: what each tree costs the test rays, against SAH's.

use rdh::kd::{Costs, LeafWidth};
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
            let Some(scene) = SmallScene::new(Part::all(mesh), INTERVALS) else { return Ok(ratios) };
            let counts = [training, test].map(|rays| scene.rays(rays));
            for leaf in [LeafWidth::One, LeafWidth::Eight] {
                let bound = scene.bound(&Costs::of(leaf), &counts[0], &counts[1]);
                ratios.extend(on_a_lattice(mesh, leaf, &bound, training, test)?);
            }
        }
        n if n <= SEARCHED_UP_TO => ratios.extend(by_search(mesh, LeafWidth::Eight, training, test)?),
        _ => {}
    }
    Ok(ratios)
}

fn on_a_lattice(
    mesh: &Mesh,
    leaf: LeafWidth,
    bound: &SmallBound,
    training: &Training,
    test: &Training,
) -> rdh::Result<Vec<Ratio>> {
    let [sah, rdh] = specs(leaf);
    let real = |spec: &Spec, rays: &Training| real_tree(mesh, spec, rays, test);
    let paid = [
        ("lattice, optimal by areas", sah, bound.optimal_by_areas),
        ("lattice, greedy by rays", rdh, bound.greedy_by_rays),
        ("lattice, optimal by rays", rdh, bound.optimal_by_rays),
        ("lattice, greedy by oracle", rdh, bound.greedy_by_oracle),
        ("lattice, optimal by oracle", rdh, bound.optimal_by_oracle),
        ("lattice, built", sah, real(&sah, training)?),
        ("lattice, built", rdh, real(&rdh, training)?),
        ("lattice, built by oracle", rdh, real(&rdh, test)?),
    ];
    Ok(ratios(&bound.greedy_by_areas, &paid))
}

fn by_search(mesh: &Mesh, leaf: LeafWidth, training: &Training, test: &Training) -> rdh::Result<Vec<Ratio>> {
    let (costs, [sah, rdh]) = (Costs::of(leaf), specs(leaf));
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
        ("search, built", rdh, real_tree(mesh, &rdh, training, test)?),
        ("search, built by oracle", rdh, real_tree(mesh, &rdh, test, test)?),
        ("search, greedy by oracle", rdh, paid_in(&grow(&oracle, &costs, 0, 0))),
        ("search, searched by rays", rdh, paid_in(&search(room(&train_rays), &costs, &effort))),
        ("search, searched by oracle", rdh, paid_in(&search(oracle.clone(), &costs, &effort))),
    ];
    Ok(ratios(&real_tree(mesh, &sah, training, test)?, &paid))
}

fn ratios(base: &Paid, paid: &[(&str, Spec, Paid)]) -> Vec<Ratio> {
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
fn real_tree(mesh: &Mesh, spec: &Spec, rays: &Training, test: &Training) -> rdh::Result<Paid> {
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let accel = rdh::build(mesh, spec, rays, &options)?;
    Ok(paid_by_rays(&accel, test))
}

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
