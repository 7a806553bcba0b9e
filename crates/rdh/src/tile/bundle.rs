//! A tile on its way through a kind of tree.

use super::{Choice, Class, Effort, PACKETS, Packed, Prices, Reach, Tile};
use crate::geom::{Aabb, Ray, Scale};
use crate::simd::{Floats, Kernels};

/// A tree that tiles walk through.
pub(crate) trait Tiled: Sized {
    /// What leads a tile through it.
    type Lead<R: Floats>: Lead<R>;
    /// What its steps cost.
    type Costs: Prices;

    /// What tiles have to know of it.
    fn space(&self) -> Space;

    /// Leads a tile through it; not to the end if that becomes too dear.
    fn walk<K: Kernels, C: Packed>(&self, bundle: &mut Bundle<K::Rays, Self>) -> bool;
}

/// Where a tree lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Space {
    pub(crate) scale: Scale,
    /// In scaled space.
    pub(crate) bounds: Aabb,
    pub(crate) magnitude: f32,
    /// Whether its triangles have masks.
    pub(crate) has_masks: bool,
}

/// The beam around a tile's rays, or those around its packets.
pub(crate) trait Lead<R: Floats> {
    /// What it has to know of them.
    type Reaches: Reaches<R>;

    /// Of rays of a class.
    fn new(reaches: &Self::Reaches, class: Class) -> Self;
}

/// What packets reach: all together, or each.
pub(crate) trait Reaches<R> {
    /// Before the first packet.
    fn nothing() -> Self;

    /// What is widened by a packet.
    fn of_packet(&mut self, packet: usize) -> &mut Reach<R>;
}

impl<R: Floats> Reaches<R> for Reach<R> {
    #[inline(always)]
    fn nothing() -> Self {
        Self::nothing()
    }

    #[inline(always)]
    fn of_packet(&mut self, _packet: usize) -> &mut Self {
        self
    }
}

impl<R: Floats> Reaches<R> for [Reach<R>; PACKETS] {
    #[inline(always)]
    fn nothing() -> Self {
        [Reach::nothing(); PACKETS]
    }

    #[inline(always)]
    fn of_packet(&mut self, packet: usize) -> &mut Reach<R> {
        &mut self[packet & (PACKETS - 1)]
    }
}

/// A tile, what leads it, and what that has cost.
pub(crate) struct Bundle<R: Floats, T: Tiled> {
    pub(crate) tile: Tile<R>,
    pub(crate) lead: T::Lead<R>,
    pub(crate) effort: Effort<T::Costs>,
}

impl<R: Floats, T: Tiled> Bundle<R, T> {
    /// Without rays.
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        let tile = Tile::empty();
        Self { lead: T::Lead::new(&Reaches::nothing(), tile.class), tile, effort: Effort::of(0) }
    }

    /// Takes over rays, if they are usual ones of one class.
    #[inline(always)]
    pub(crate) fn fill(&mut self, rays: &[Ray], choice: &Choice, space: &Space) -> bool {
        let mut reaches = <T::Lead<R> as Lead<R>>::Reaches::nothing();
        if !self.tile.fill(rays, choice, space, &mut reaches) {
            return false;
        }
        self.effort = Effort::of(choice.rays().len());
        self.lead = T::Lead::new(&reaches, self.tile.class);
        true
    }
}
