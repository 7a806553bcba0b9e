//! Views for a scene that brings none: from before it, from above its corner, and from its middle.

use crate::camera::View;
use crate::scene::Scene;

/// `front` and `oblique`, from which the whole box is seen, and `inside`, from the box's middle along its longest level
/// axis. Empty for a scene without triangles.
pub(super) fn overview(scene: &Scene) -> Vec<View> {
    let Some((min, max)) = bounds(scene) else {
        return Vec::new();
    };
    let centre = [0, 1, 2].map(|a| scene.origin[a] + (min[a] + max[a]) / 2.0);
    let size = [0, 1, 2].map(|a| max[a] - min[a]);
    let radius = size.iter().map(|s| s * s).sum::<f64>().sqrt() / 2.0;
    // A scene of one point still needs an eye somewhere else.
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let up = (0..3).max_by(|&a, &b| scene.up[a].abs().total_cmp(&scene.up[b].abs())).unwrap_or(2);
    let level = [(up + 1) % 3, (up + 2) % 3];
    let [long, short] = if size[level[0]] >= size[level[1]] { level } else { [level[1], level[0]] };
    let fov_y_degrees = 45.0_f64;
    let distance = radius / (fov_y_degrees / 2.0).to_radians().sin();
    let view = |name: &str, eye, target, fov_y_degrees| View {
        name: name.to_owned(),
        eye,
        target,
        up: scene.up,
        fov_y_degrees,
    };
    let moved = |by: [(usize, f64); 3]| {
        by.iter().fold(centre, |mut p, &(axis, x)| {
            p[axis] += x;
            p
        })
    };
    let sky = scene.up[up].signum();
    let front = moved([(short, -distance), (long, 0.0), (up, 0.15 * sky * distance)]);
    let oblique = moved([(short, -0.6 * distance), (long, -0.6 * distance), (up, 0.5 * sky * distance)]);
    let ahead = moved([(long, radius), (short, 0.0), (up, 0.0)]);
    vec![
        view("front", front, centre, fov_y_degrees),
        view("oblique", oblique, centre, fov_y_degrees),
        view("inside", centre, ahead, 75.0),
    ]
}

/// The box of all instances' vertices, relative to the scene's origin.
fn bounds(scene: &Scene) -> Option<([f64; 3], [f64; 3])> {
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for instance in &scene.instances {
        for p in &scene.geometries[instance.geometry].positions {
            let p = instance.scene_from_object.point(p.map(f64::from));
            for a in 0..3 {
                min[a] = min[a].min(p[a]);
                max[a] = max[a].max(p[a]);
            }
        }
    }
    (min[0] <= max[0]).then_some((min, max))
}
