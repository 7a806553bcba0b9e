//! The options of a tree around an eye, as plain data.

use crate::geom::Vec3;

/// What the rays have to do with the eye.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EyeForm {
    /// They start at it: a camera, a scanner's pose.
    #[default]
    From,
    /// They end at it, or start at it: a light.
    Towards,
}

/// Trees around an eye, as a [`Spec`](crate::Spec) names them: `kd(eye=1,2,3)`, `kd(light=1,2,3)`, `kd(eye)`, `kd(light)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeSpec {
    /// Where it is. [`None`]: where most of the training rays start, those of a large weight counting more, or, for
    /// [`EyeForm::Towards`], where most of their [shadow rays](crate::rays::RayClass::Shadow) end, but for rounding.
    pub place: Option<Vec3>,
    /// What the rays have to do with it.
    pub form: EyeForm,
}

/// Parameters of a tree around an eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeOptions {
    /// What the rays have to do with the eye.
    pub form: EyeForm,
    /// How far apart neighbouring rays are in the picture, whose sides are 2 long (90°). Cells are not cut smaller than bundles
    /// of 8 × 8 rays can use. With training rays whose weights say how many were cast, [`None`] is what those say; without, 2/1024.
    pub pixel: Option<f32>,
}

impl Default for EyeOptions {
    fn default() -> Self {
        Self { form: EyeForm::From, pixel: None }
    }
}
