//! Boxes side by side, as wide nodes hold them.

use crate::geom::{Aabb, PlaneFrame, Ray, Scale};
use crate::mem::Plain;

/// `W` boxes, plane by plane, and two words for each: a wide node, whole cache lines without padding.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Boxes<const W: usize> {
    /// `planes[side][axis][lane]`, side 0 the lower one. Lanes without a box hold planes that no ray meets.
    pub(crate) planes: [[[f32; W]; 3]; 2],
    /// What lies in the boxes.
    pub(crate) links: [u32; W],
    /// Not used.
    pub(crate) spare: [u32; W],
}

impl<const W: usize> Boxes<W> {
    /// A plane of no box: beyond every plane of a structure (2²¹), and in `t` beyond every pad, so that no ray meets it and no
    /// comparison sees a NaN.
    const ABSENT: f32 = (1u128 << 120) as f32;

    /// No boxes.
    pub(crate) const NONE: Self =
        Self { planes: [[[Self::ABSENT; W]; 3], [[-Self::ABSENT; W]; 3]], links: [0; W], spare: [0; W] };

    /// Puts a box into a lane.
    pub(crate) fn set(&mut self, lane: usize, bounds: &Aabb, link: u32) {
        self.links[lane] = link;
        for a in 0..3 {
            self.planes[0][a][lane] = bounds.min[a];
            self.planes[1][a][lane] = bounds.max[a];
        }
    }

    /// Whether there is a box in a lane.
    pub(crate) fn is_present(&self, lane: usize) -> bool {
        self.planes[0][0][lane] != Self::ABSENT
    }

    /// Whether a lane is that of [`Self::NONE`].
    pub(crate) fn is_absent(&self, lane: usize) -> bool {
        let none = |side: usize, plane: f32| self.planes[side].iter().all(|lanes| lanes[lane] == plane);
        none(0, Self::ABSENT) && none(1, -Self::ABSENT) && self.links[lane] == 0
    }

    /// The box in a lane.
    pub(crate) fn get(&self, lane: usize) -> Aabb {
        let side = |s: usize| [0, 1, 2].map(|a| self.planes[s][a][lane]);
        Aabb { min: side(0), max: side(1) }
    }
}

// SAFETY: plain numbers without padding, since the fields' sizes add up to that of the whole for the widths there are.
unsafe impl<const W: usize> Plain for Boxes<W> {}
const _: () = assert!(size_of::<Boxes<2>>() == 64 && size_of::<Boxes<4>>() == 128 && size_of::<Boxes<8>>() == 256);

/// A ray's constants for boxes: `t = plane · inverse + enters` for the three planes it meets first, `+ leaves` for the others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxRay {
    pub(crate) inverse: [f32; 3],
    pub(crate) enters: [f32; 3],
    pub(crate) leaves: [f32; 3],
    pub(crate) t_min: f32,
    /// Where it ends.
    pub(crate) end: f32,
    /// The boxes' `t` for 1 of the ray's; 0 if that tells nothing apart.
    pub(crate) t_scale: f64,
}

impl BoxRay {
    /// Prepares a ray; nothing if it is invalid.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, scale: Scale, magnitude: f32) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let frame = PlaneFrame::new(ray, scale, magnitude);
        let ([x, y, z], [ox, oy, oz]) = (frame.inverse, frame.origin);
        // The ray is moved, not the planes: what is left to do once the reciprocals are known is one product.
        let (sx, sy, sz) = (frame.slack.copysign(x), frame.slack.copysign(y), frame.slack.copysign(z));
        Some(Self {
            inverse: [x, y, z],
            enters: [-(ox + sx) * x, -(oy + sy) * y, -(oz + sz) * z],
            leaves: [-(ox - sx) * x, -(oy - sy) * y, -(oz - sz) * z],
            t_min: frame.t_min,
            end: frame.t_max,
            t_scale: frame.t_scale(),
        })
    }

    /// A bit an axis: 1 where the ray runs down the axis and meets the upper plane first.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(crate) fn down(&self) -> usize {
        self.near(0) | self.near(1) << 1 | self.near(2) << 2
    }

    /// 1 where the ray runs down the axis and meets the upper plane first.
    #[inline(always)]
    pub(crate) fn near(&self, axis: usize) -> usize {
        (self.inverse[axis].to_bits() >> 31) as usize
    }

    /// Where a ray ends that hits something at `t`, a number, in its own units. What begins there is still met.
    #[inline(always)]
    pub(crate) fn end_for(t: f32, t_scale: f64) -> f32 {
        // Not selected: that would make all that waits for the end wait for both.
        #[cold]
        #[inline(never)]
        fn scaled(t: f32, t_scale: f64) -> f32 {
            // A step behind: it may have been rounded.
            ((f64::from(t) * t_scale) as f32).next_up()
        }
        if t_scale == 1.0 { t } else { scaled(t, t_scale) }
    }
}
