//! Surface area heuristic over every place between two primitives, in the order of their centres: what bins approximate.
//!
//! Wald, Boulos and Shirley, *Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies* (ACM TOG 2007), section 3.1.
//! Sorted anew in each node: O(n log n) a node, O(N log² N) a tree.

use rayon::prelude::*;

use super::extent::Extent;
use super::split::{Asked, Border, Split, tests};
use crate::simd::{Job, Kernels, Level};

/// A primitive's place along an axis: its doubled centre, then its id. No two primitives share one but parts of the same triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    centre: f32,
    id: u32,
}

impl Place {
    #[inline(always)]
    pub(crate) fn of(primitive: &Extent, axis: usize) -> Self {
        Self { centre: primitive.doubled_centre()[axis], id: primitive.link }
    }

    /// Whether it is another one's place, or comes before it.
    #[inline(always)]
    pub(crate) fn is_up_to(&self, other: &Self) -> bool {
        self.centre < other.centre || (self.centre == other.centre && self.id <= other.id)
    }
}

/// A place, and which of the primitives it belongs to.
type Ranked = (Place, u32);

/// Sets of more primitives take long enough that it is asked in between whether to go on.
const ASKED_ABOVE: usize = 1 << 14;

/// The cheapest split of all places on all axes, unless all primitives share one. Equal costs: the first axis, then the first place.
/// Nothing once the work is cancelled, which the watch then knows.
pub(crate) fn best(level: Level, parallel: bool, primitives: &[Extent], asked: Asked<'_>) -> Option<Split> {
    let goes_on = || match asked {
        Some(watch) if primitives.len() > ASKED_ABOVE => watch.check_cancelled().is_ok(),
        _ => true,
    };
    let on_axis = |axis| {
        if !goes_on() {
            return None;
        }
        let mut order: Vec<Ranked> = primitives.iter().zip(0..).map(|(p, i)| (Place::of(p, axis), i)).collect();
        // No two are equal: any sort gives the same.
        let compare =
            |a: &Ranked, b: &Ranked| a.0.centre.total_cmp(&b.0.centre).then(a.0.id.cmp(&b.0.id)).then(a.1.cmp(&b.1));
        if parallel {
            order.par_sort_unstable_by(compare)
        } else {
            order.sort_unstable_by(compare)
        }
        if goes_on() { level.run(Sweep { primitives, order: &order, axis }) } else { None }
    };
    let cheaper = |a: Option<Split>, b: Option<Split>| match (a, b) {
        (Some(a), Some(b)) => Some(if b.cost < a.cost { b } else { a }),
        (a, b) => a.or(b),
    };
    if parallel {
        let (x, (y, z)) = rayon::join(|| on_axis(0), || rayon::join(|| on_axis(1), || on_axis(2)));
        cheaper(cheaper(x, y), z)
    } else {
        (0..3).map(on_axis).fold(None, cheaper)
    }
}

/// Sweeps over one axis, from the right and then from the left.
struct Sweep<'a> {
    primitives: &'a [Extent],
    order: &'a [Ranked],
    axis: usize,
}

impl Job for Sweep<'_> {
    type Output = Option<Split>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Split> {
        let Self { primitives, order, axis } = self;
        let n = order.len() as u32;
        let primitive = |place: usize| &primitives[order[place].1 as usize];
        let mut right_costs = vec![0.0; order.len()];
        let mut side = Extent::EMPTY;
        for i in (1..order.len()).rev() {
            side.grow::<K>(primitive(i));
            right_costs[i - 1] = side.half_area() * tests(n - i as u32);
        }
        side = Extent::EMPTY;
        let (mut cost, mut last) = (f32::INFINITY, None);
        for i in 0..order.len().saturating_sub(1) {
            side.grow::<K>(primitive(i));
            let here = side.half_area() * tests(i as u32 + 1) + right_costs[i];
            // Parts of one triangle at one place stay together.
            if here < cost && order[i].0 != order[i + 1].0 {
                (cost, last) = (here, Some(i));
            }
        }
        let last = last?;
        let (mut left, mut right) = (Extent::EMPTY, Extent::EMPTY);
        for i in 0..order.len() {
            if i <= last { &mut left } else { &mut right }.grow::<K>(primitive(i));
        }
        Some(Split { border: Border::Place { axis, last: order[last].0 }, left, right, cost })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;

    /// Nothing but comparing all ways to part boxes along an axis, one by one.
    fn slowly(primitives: &[Extent]) -> f32 {
        let mut least = f32::INFINITY;
        for axis in 0..3 {
            for border in primitives.iter().map(|p| Place::of(p, axis)) {
                let (left, right): (Vec<Extent>, Vec<Extent>) =
                    primitives.iter().partition(|p| Place::of(p, axis).is_up_to(&border));
                let cost = |side: &[Extent]| {
                    let bounds = side.iter().fold(Aabb::EMPTY, |all, p| all.union(&p.bounds()));
                    Extent::new(&bounds, 0, 0).half_area() * tests(side.len() as u32)
                };
                if !right.is_empty() {
                    least = least.min(cost(&left) + cost(&right));
                }
            }
        }
        least
    }

    #[test]
    fn no_place_is_cheaper_than_the_one_that_is_found() {
        let mut state = 3u32;
        // Coarse numbers: many centres coincide.
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            f32::from((state >> 28) as u8)
        };
        for n in 2..40 {
            let primitives: Vec<Extent> = (0..n)
                .map(|id| {
                    let min = [random(), random(), random()];
                    Extent::new(&Aabb { min, max: min.map(|x| x + random() * 0.25) }, id, 0)
                })
                .collect();
            let found = best(Level::best(), n % 2 == 0, &primitives, None).expect("ids differ");
            assert_eq!(found.cost, slowly(&primitives), "{n} boxes");
        }
        let same = Extent::new(&Aabb { min: [0.0; 3], max: [1.0; 3] }, 7, 0);
        assert!(best(Level::best(), false, &[same, same, same], None).is_none());
    }
}
