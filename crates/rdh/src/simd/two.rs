//! Sixteen [`Floats`] as twice eight: what packets of sixteen rays are tried with on CPUs that have no such registers.

use super::{Eight, Floats, Hits};

/// Twice eight floats.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Two<E>([E; 2]);

impl<E: Eight> Two<E> {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(E, E) -> E) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

/// An operation lane by lane.
macro_rules! operations {
    ($($name:ident)*) => {
        $(
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.each(other, E::$name)
            }
        )*
    };
}

impl<E: Eight> Floats for Two<E> {
    const COUNT: usize = 16;

    type Eight = E;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([E::splat(x); 2])
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        self.0[lane >> 3 & 1].lane(lane)
    }

    #[inline(always)]
    fn halves(&self) -> [E; 2] {
        self.0
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, x: f32) {
        self.0[lane >> 3 & 1].set_lane(lane, x);
    }

    operations! { add sub mul div min max lt le and or xor }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self([self.0[0].mul_add(factor.0[0], term.0[0]), self.0[1].mul_add(factor.0[1], term.0[1])])
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        self.0[0].signs() | self.0[1].signs() << 8
    }

    #[inline(always)]
    fn mask(bits: u32) -> Self {
        Self([E::mask(bits & 0xff), E::mask(bits >> 8)])
    }

    #[inline(always)]
    fn select(self, yes: Self, no: Self) -> Self {
        Self([self.0[0].select(yes.0[0], no.0[0]), self.0[1].select(yes.0[1], no.0[1])])
    }

    #[inline(always)]
    fn transposed<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        let (low, high) = (E::transposed(&row), E::transposed(|i| row(i + 8)));
        std::array::from_fn(|i| Self([low[i], high[i]]))
    }

    #[inline(always)]
    fn hits(corners: &[[Self; 3]; 3], direction_z: Self, t_min: Self, t_max: Self) -> Hits<Self> {
        let half = |i: usize| {
            let corners = corners.each_ref().map(|corner| corner.each_ref().map(|x| x.0[i]));
            E::hits(&corners, direction_z.0[i], t_min.0[i], t_max.0[i])
        };
        let (low, high) = (half(0), half(1));
        let accepted = low.accepted | high.accepted << 8;
        Hits { accepted, t: Self([low.t, high.t]), u: Self([low.u, high.u]), v: Self([low.v, high.v]) }
    }
}
