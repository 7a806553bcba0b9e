//! Sampled rays side by side: hierarchies ask of many boxes how many of a node's rays meet them.

use crate::geom::{Aabb, Vec3};
use crate::simd::{Job, Kernels, Level};

/// Rays in a rank: enough for vectors of any width, few enough that a node of few rays wastes little.
const N: usize = 32;

/// A ray stands for at most so many here, so that sums of those that are tracked are exact in 32 bits.
const HEAVIEST: f32 = (1 << 19) as f32;

/// A ray, or the part of one that lies in a node.
pub(super) struct Piece {
    pub(super) origin: Vec3,
    pub(super) inverse: Vec3,
    pub(super) t_in: f32,
    pub(super) t_out: f32,
    pub(super) weight: f32,
}

/// Rays side by side; what is left of the last rank weighs nothing.
#[derive(Debug, Clone)]
pub(crate) struct Ranks {
    ranks: Vec<Rank>,
    /// What all of them weigh.
    weight: u32,
    level: Level,
}

#[derive(Debug, Clone)]
struct Rank {
    origin: [[f32; N]; 3],
    inverse: [[f32; N]; 3],
    t_in: [f32; N],
    t_out: [f32; N],
    weight: [u32; N],
}

impl Rank {
    const EMPTY: Self =
        Self { origin: [[0.0; N]; 3], inverse: [[1.0; N]; 3], t_in: [0.0; N], t_out: [0.0; N], weight: [0; N] };

    /// The weight of the rays that meet a box: as [`Rdh::clip`](super::Rdh) decides it.
    #[inline(always)]
    fn weigh(&self, bounds: &Aabb) -> u32 {
        let mut sum = 0;
        for i in 0..N {
            let (mut t_in, mut t_out) = (self.t_in[i], self.t_out[i]);
            for a in 0..3 {
                let t0 = (bounds.min[a] - self.origin[a][i]) * self.inverse[a][i];
                let t1 = (bounds.max[a] - self.origin[a][i]) * self.inverse[a][i];
                let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
                t_in = if t_in > near { t_in } else { near };
                t_out = if t_out < far { t_out } else { far };
            }
            sum += if t_in <= t_out + t_out.abs() * 3e-7 { self.weight[i] } else { 0 };
        }
        sum
    }
}

impl Ranks {
    pub(super) fn new(pieces: impl Iterator<Item = Piece>, level: Level) -> Self {
        let (mut ranks, mut weight, mut i) = (Vec::new(), 0, N);
        for piece in pieces {
            if i == N {
                ranks.push(Rank::EMPTY);
                i = 0;
            }
            if let Some(rank) = ranks.last_mut() {
                for a in 0..3 {
                    (rank.origin[a][i], rank.inverse[a][i]) = (piece.origin[a], piece.inverse[a]);
                }
                (rank.t_in[i], rank.t_out[i]) = (piece.t_in, piece.t_out);
                rank.weight[i] = piece.weight.min(HEAVIEST) as u32;
                weight += rank.weight[i];
            }
            i += 1;
        }
        Self { ranks, weight, level }
    }

    /// What all rays weigh.
    pub(crate) fn weight(&self) -> f32 {
        self.weight as f32
    }

    /// What the rays that meet each of some boxes weigh. O(R B), in lanes.
    pub(crate) fn weigh(&self, boxes: &[Aabb], weights: &mut [f32]) {
        self.level.run(Weigh { ranks: &self.ranks, boxes, weights });
    }

    /// The same, summed over boxes of which each holds the one before.
    pub(crate) fn weigh_nest(&self, boxes: &[Aabb]) -> i64 {
        self.level.run(WeighNest { ranks: &self.ranks, boxes })
    }
}

struct Weigh<'a> {
    ranks: &'a [Rank],
    boxes: &'a [Aabb],
    weights: &'a mut [f32],
}

impl Job for Weigh<'_> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        for (bounds, weight) in self.boxes.iter().zip(self.weights) {
            let mut sum = 0;
            for rank in self.ranks {
                sum += rank.weigh(bounds);
            }
            *weight = sum as f32;
        }
    }
}

struct WeighNest<'a> {
    ranks: &'a [Rank],
    boxes: &'a [Aabb],
}

impl Job for WeighNest<'_> {
    type Output = i64;

    #[inline(always)]
    fn run<K: Kernels>(self) -> i64 {
        let mut sum = 0;
        for rank in self.ranks {
            for bounds in self.boxes.iter().rev() {
                let met = rank.weigh(bounds);
                if met == 0 {
                    break;
                }
                sum += i64::from(met);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays along x at y = z = 0.5, 1.5, …, each from 0 to its own number, and as heavy.
    fn ranks(n: u32, level: Level) -> Ranks {
        let piece = |i: u32| Piece {
            origin: [0.0, i as f32 + 0.5, i as f32 + 0.5],
            inverse: [1.0, 1e15, 1e15],
            t_in: 0.0,
            t_out: i as f32 + 1.0,
            weight: i as f32 + 1.0,
        };
        Ranks::new((0..n).map(piece), level)
    }

    fn up_to(x: f32, y: f32) -> Aabb {
        Aabb { min: [x, 0.0, 0.0], max: [x + 1.0, y, y] }
    }

    #[test]
    fn rays_are_weighed_alike_at_all_levels_and_padding_weighs_nothing() {
        for level in Level::available() {
            // More than one rank, and not a whole one.
            let rays = ranks(40, level);
            assert_eq!(rays.weight(), 820.0);
            let mut weights = [0.0; 3];
            rays.weigh(&[up_to(-1.0, 100.0), up_to(34.5, 100.0), up_to(34.5, 36.0)], &mut weights);
            // All start in the first; 35 and longer reach x = 34.5, of which the third box holds one.
            assert_eq!(weights, [820.0, (35..=40).sum::<u32>() as f32, 35.0 + 36.0]);
        }
    }

    #[test]
    fn nests_are_summed() {
        for level in Level::available() {
            let nest = [up_to(0.0, 1.0), up_to(0.0, 2.0), up_to(0.0, 9.0)];
            assert_eq!(ranks(3, level).weigh_nest(&nest), 1 + (1 + 2) + (1 + 2 + 3));
            assert_eq!(ranks(3, level).weigh_nest(&[up_to(50.0, 1.0)]), 0);
        }
    }
}
