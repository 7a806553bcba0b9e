//! Camera paths: from one key view smoothly to the next.

use crate::camera::View;

/// A path through key views, which are reached at even intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraPath {
    /// Its name within the scene.
    pub name: String,
    /// The key views, at least one; the angle of view and up are blended too.
    pub views: Vec<View>,
    /// How many frames it takes: frame 0 is the first key view, frame `frames - 1` the last.
    pub frames: u32,
}

impl CameraPath {
    /// The view at a frame, named `name@frame`; beyond the last frame the camera rests. `None` without key views.
    ///
    /// Eye and target follow Catmull-Rom splines (centripetal parametrisation is not needed: keys are evenly spaced).
    pub fn at(&self, frame: u32) -> Option<View> {
        let last = self.views.len().checked_sub(1)?;
        let steps = self.frames.saturating_sub(1).max(1);
        let along = f64::from(frame.min(steps)) / f64::from(steps) * last as f64;
        let from = (along.floor() as usize).min(last.saturating_sub(1));
        let t = along - from as f64;
        let key = |i: usize| &self.views[i.min(last)];
        let keys = [key(from.saturating_sub(1)), key(from), key(from + 1), key(from + 2)];
        let curve = |of: fn(&View) -> [f64; 3]| spline(keys.map(of), t);
        let blend = |of: fn(&View) -> f64| of(keys[1]) * (1.0 - t) + of(keys[2]) * t;
        let up = |axis: usize| keys[1].up[axis] * (1.0 - t) + keys[2].up[axis] * t;
        Some(View {
            name: format!("{}@{frame}", self.name),
            eye: curve(|v| v.eye),
            target: curve(|v| v.target),
            up: [up(0), up(1), up(2)],
            fov_y_degrees: blend(|v| v.fov_y_degrees),
        })
    }
}

/// Catmull and Rom's cubic through the two middle points.
fn spline([a, b, c, d]: [[f64; 3]; 4], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let (a, b, c, d) = (a[i], b[i], c[i], d[i]);
        let (quadratic, cubic) = (2.0 * a - 5.0 * b + 4.0 * c - d, 3.0 * (b - c) + d - a);
        b + 0.5 * t * ((c - a) + t * (quadratic + t * cubic))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(xs: &[f64], frames: u32) -> CameraPath {
        let view = |&x: &f64| View {
            name: String::new(),
            eye: [x, 0.0, 0.0],
            target: [x, 1.0, 0.0],
            up: [0.0, 0.0, 1.0],
            fov_y_degrees: 40.0 + x,
        };
        CameraPath { name: "walk".to_owned(), views: xs.iter().map(view).collect(), frames }
    }

    #[test]
    fn keys_are_reached_at_even_intervals() {
        let path = path(&[0.0, 10.0, 15.0], 21);
        for (frame, x) in [(0, 0.0), (10, 10.0), (20, 15.0), (99, 15.0)] {
            let view = path.at(frame).unwrap();
            assert_eq!((view.eye[0], view.fov_y_degrees), (x, 40.0 + x));
            assert_eq!(view.name, format!("walk@{frame}"));
        }
        let xs: Vec<f64> = (0..21).map(|f| path.at(f).unwrap().eye[0]).collect();
        assert!(xs.windows(2).all(|w| w[0] < w[1]), "{xs:?}");
    }

    #[test]
    fn short_paths_rest() {
        assert_eq!(path(&[], 5).at(0), None);
        assert_eq!(path(&[3.0], 5).at(4).unwrap().eye[0], 3.0);
        assert_eq!(path(&[3.0, 4.0], 1).at(0).unwrap().eye[0], 3.0);
    }
}
