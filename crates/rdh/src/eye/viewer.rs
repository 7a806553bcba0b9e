//! What an eye sees of a mesh's triangles.

use super::cell::Cell;
use super::project::{Point, Projected, Tolerance, project};
use super::side::Side;
use super::spec::EyeForm;
use crate::geom::{TriId, Vec3};
use crate::mesh::Mesh;
use crate::simd::{Corners, Passing, Sight};

/// A mesh and an eye.
pub(super) struct Viewer<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) form: EyeForm,
    pub(super) passing: &'a Passing,
}

impl Viewer<'_> {
    /// A triangle's corners along the axes of a side.
    pub(super) fn corners(&self, side: Side, id: u32) -> Corners {
        self.mesh.corners(TriId(id)).map(|c| {
            let [x, y, z] = side.along(&c);
            [x, y, z, f32::from_bits(id)]
        })
    }

    /// A triangle in a side's window, and its box; nothing if it can't be hit there.
    pub(super) fn look_at(&self, side: Side, id: u32, window: &Cell) -> Option<(Sight, Cell)> {
        let [a, b, c] = self.mesh.triangles()[id as usize];
        if a == b || b == c || a == c {
            return None;
        }
        let corners = self.mesh.corners(TriId(id)).map(|corner| self.relative(side, &corner));
        let Projected { sight, low, high } = project(&corners, id, &self.tolerance())?;
        let place = Cell { low, high };
        (place.meets(window) && window.may_see(&sight)).then_some((sight, place))
    }

    fn tolerance(&self) -> Tolerance {
        match self.form {
            EyeForm::From => Tolerance::default(),
            EyeForm::Towards => self.passing.tolerance(),
        }
    }

    /// A corner relative to the eye, with the side in front.
    fn relative(&self, side: Side, corner: &Vec3) -> Point {
        let (corner, eye) = (side.along(corner), side.along(&self.passing.eye));
        let sign = if side.is_down() { -1.0 } else { 1.0 };
        match self.form {
            // As THE triangle test rounds it.
            EyeForm::From => [0, 1, 2].map(|a| sign * f64::from(corner[a] - eye[a])),
            EyeForm::Towards => [0, 1, 2].map(|a| sign * (f64::from(corner[a]) - f64::from(eye[a]))),
        }
    }
}
