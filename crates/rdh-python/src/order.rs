//! In which order the rays of a window are cast: neighbours together, so that they find in caches what the last ones needed.
//!
//! Results don't depend on it. Rays that come in a good order, as those of cameras and scanners do, are left in it.

use rdh::{Aabb, Ray};

/// How finely origins are told apart: 2⁴ cells along each axis of the scene.
const ORIGIN_BITS: u32 = 4;
/// How finely directions are told apart: 2³ cells along each axis of a cube.
const DIRECTION_BITS: u32 = 3;
/// Sorting a few rays costs more than it saves.
const FEWEST: usize = 4096;

/// Numbers of a window's rays in the order in which to cast them; nothing if they are to stay as they are.
pub(crate) fn order(count: usize, bounds: &Aabb, ray: impl Fn(usize) -> Ray) -> Option<Vec<u32>> {
    if count < FEWEST {
        return None;
    }
    let grid = Grid::over(bounds);
    let mut keys = Vec::new();
    keys.try_reserve_exact(count).ok()?;
    keys.extend((0..count).map(|row| u64::from(grid.key(&ray(row))) << 32 | row as u64));
    let changes = keys.windows(2).filter(|pair| pair[0] >> 32 != pair[1] >> 32).count();
    if changes * 2 < count {
        return None;
    }
    keys.sort_unstable();
    Some(keys.into_iter().map(|key| key as u32).collect())
}

/// Cells of the scene's box.
struct Grid {
    min: [f32; 3],
    cells_per_unit: [f32; 3],
}

impl Grid {
    fn over(bounds: &Aabb) -> Self {
        let cells = (1 << ORIGIN_BITS) as f32;
        Self { min: bounds.min, cells_per_unit: [0, 1, 2].map(|a| cells / (bounds.max[a] - bounds.min[a])) }
    }

    /// Where a ray begins and goes, from the coarsest bits to the finest, all axes alike: a Morton code.
    fn key(&self, ray: &Ray) -> u32 {
        let longest = ray.direction.iter().fold(f32::MIN_POSITIVE, |most, d| most.max(d.abs()));
        let half = (1 << (DIRECTION_BITS - 1)) as f32;
        // What is no number, or outside, ends in a cell at the border.
        let direction = ray.direction.map(|d| cell(half + d / longest * half, DIRECTION_BITS));
        let origin = [0, 1, 2].map(|a| cell((ray.origin[a] - self.min[a]) * self.cells_per_unit[a], ORIGIN_BITS));
        let mut key = 0;
        for level in (0..ORIGIN_BITS).rev() {
            if level < DIRECTION_BITS {
                direction.iter().for_each(|d| key = key << 1 | d >> level & 1);
            }
            origin.iter().for_each(|o| key = key << 1 | o >> level & 1);
        }
        key
    }
}

fn cell(place: f32, bits: u32) -> u32 {
    (place as u32).min((1 << bits) - 1)
}
