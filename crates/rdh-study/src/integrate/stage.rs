//! A scene made ready for integrators: one mesh, what its surfaces are made of, where the lights are.

use rdh::{Aabb, Hit, Mesh, Ray, TriId, Vec3};
use rdh_scene::{Flat, Material, Scene, View};

use super::parts::connected_parts;
use super::vector::{V3, add, cross, dot, length, magnitude, narrow, scale, sub, unit, wide};

/// A scene made ready for integrators. Positions are relative to the scene's origin.
///
/// Scenes without materials are diffuse (0.8), and every eighth connected mesh is a mirror (0.3, with a diffuse part of 0.5).
/// A mesh is an instance; where there is only one instance, it is a part of it that is connected by common vertex
/// positions; parts are numbered by their first triangle. The 8th, 16th, … are mirrors, so that a scene of fewer has none.
///
/// Scenes without lights have one point light: over the centre of the scene's box, at 0.9 of its height along `up`.
#[derive(Debug, Clone)]
pub struct Stage {
    flat: Flat,
    surfaces: Surfaces,
    lights: Vec<Vec3>,
    bounds: Aabb,
    origin: [f64; 3],
    up: V3,
}

/// What each triangle is made of.
#[derive(Debug, Clone)]
enum Surfaces {
    /// The scene's materials, by instance.
    Given(Vec<Material>),
    /// Every eighth instance is a mirror.
    ByInstance,
    /// Every eighth part of the only instance is a mirror: whether a triangle is in one.
    ByPart(Vec<bool>),
}

/// A point on a surface, from which rays start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfacePoint {
    pub(crate) position: V3,
    /// The geometric normal of length 1, on the side from which the triangle's corners run anticlockwise.
    pub(crate) normal: V3,
    /// The normal, turned to the side from which the ray came.
    pub(crate) facing: V3,
    /// How far off the surface spawned rays start.
    pub(crate) offset: f64,
    pub(crate) material: Material,
}

impl Stage {
    /// The material of scenes that have none.
    pub const PLAIN: Material = Material::DIFFUSE;
    /// The material of their mirrors.
    pub const MIRROR: Material = Material { diffuse: 0.5, mirror: 0.3, transmission: 0.0, index: 1.0 };

    /// Flattens a scene.
    ///
    /// # Errors
    /// What [`Mesh::new`] says.
    pub fn new(scene: &Scene) -> rdh::Result<Self> {
        let flat = scene.flatten()?;
        let bounds = flat.mesh.bounds();
        let up = unit(scene.up).unwrap_or([0.0, 0.0, 1.0]);
        let mut lights: Vec<Vec3> = scene.lights.iter().map(|l| narrow(sub(l.position, scene.origin))).collect();
        if lights.is_empty() {
            lights.push(upper_light(&bounds, up));
        }
        let surfaces = match (scene.materials.is_empty(), scene.instances.len()) {
            (false, _) => Surfaces::Given(scene.materials.clone()),
            (true, 1) => Surfaces::ByPart(every_eighth_part(&flat.mesh)),
            (true, _) => Surfaces::ByInstance,
        };
        Ok(Self { flat, surfaces, lights, bounds, origin: scene.origin, up })
    }

    /// The mesh that structures are built for.
    pub fn mesh(&self) -> &Mesh {
        &self.flat.mesh
    }

    /// The box of all triangles.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The point lights.
    pub fn lights(&self) -> &[Vec3] {
        &self.lights
    }

    /// What `[0, 0, 0]` is in world coordinates: views are given in those.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Which direction is up, of length 1.
    pub fn up(&self) -> [f64; 3] {
        self.up
    }

    /// What a triangle is made of.
    pub fn material(&self, tri: TriId) -> Material {
        let eighth = |mirror: bool| if mirror { Self::MIRROR } else { Self::PLAIN };
        match &self.surfaces {
            Surfaces::Given(materials) => {
                let index = self.flat.material[self.flat.instance_of(tri)];
                materials.get(index).copied().unwrap_or(Self::PLAIN)
            }
            Surfaces::ByInstance => eighth(self.flat.instance_of(tri) % 8 == 7),
            Surfaces::ByPart(mirrors) => eighth(mirrors[tri.index()]),
        }
    }

    /// A view of the whole scene from outside, for scenes that come without one.
    pub fn overview(&self) -> View {
        let centre = if self.bounds.is_empty() { [0.0; 3] } else { wide(self.bounds.centre()) };
        let reach = f64::from(self.bounds.diagonal()).max(f64::MIN_POSITIVE);
        // A direction that is oblique to all axes, from a little above.
        let side = unit(sub([1.0, 0.6, 0.3], scale(self.up, dot(self.up, [1.0, 0.6, 0.3])))).unwrap_or([1.0, 0.0, 0.0]);
        let eye = add(centre, add(scale(side, 1.1 * reach), scale(self.up, 0.5 * reach)));
        let world = |p: V3| add(p, self.origin);
        let name = "overview".to_owned();
        View { name, eye: world(eye), target: world(centre), up: self.up, fov_y_degrees: 45.0 }
    }

    /// Where `ray` hit.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let [a, b, c] = self.mesh().corners(hit.tri).map(wide);
        let (ab, ac) = (sub(b, a), sub(c, a));
        let position = add(a, add(scale(ab, hit.u.into()), scale(ac, hit.v.into())));
        let incoming = wide(ray.direction);
        // A triangle can be hit and yet have no area in f64; it then faces the ray.
        let normal = unit(cross(ab, ac)).or_else(|| unit(scale(incoming, -1.0))).unwrap_or(self.up);
        let facing = if dot(incoming, normal) > 0.0 { scale(normal, -1.0) } else { normal };
        let reach = magnitude(position) + length(ab).max(length(ac)).max(length(sub(c, b)));
        SurfacePoint {
            position,
            normal,
            facing,
            offset: reach * SurfacePoint::OFFSET,
            material: self.material(hit.tri),
        }
    }
}

impl SurfacePoint {
    /// Of the position's size plus the triangle's, the part by which rays start off the surface: 16 half ulps.
    ///
    /// A ray that starts at a distance `δ` from a triangle's plane and leaves it can't hit that triangle unless the test's
    /// rounding moves the point found by `δ`. The test moves corners by less than 5 half ulps (2⁻²⁴) of their distance to the ray's
    /// origin in each coordinate (`rdh::geom`), 9 in all; rounding `u`, `v` and the origin itself moves the origin by
    /// less than 5 more.
    const OFFSET: f64 = 16.0 / (1u64 << 24) as f64;

    /// A ray from here along `direction` (of length 1), off the surface on the side to which it goes, so that it
    /// can't hit the triangle it leaves.
    pub(crate) fn spawn(&self, direction: V3) -> Ray {
        let direction = narrow(direction);
        let side = if dot(wide(direction), self.normal) < 0.0 { -self.offset } else { self.offset };
        Ray::new(narrow(add(self.position, scale(self.normal, side))), direction)
    }

    /// A ray from here that ends at a point; nothing if the point lies on the surface.
    pub(crate) fn spawn_to(&self, target: Vec3) -> Option<Ray> {
        let origin = self.spawn(unit(sub(wide(target), self.position))?).origin;
        // Aimed from where it really starts, so that it ends where it should.
        let way = sub(wide(target), wide(origin));
        let leaves = dot(way, self.normal) * dot(sub(wide(origin), self.position), self.normal) > 0.0;
        Some(Ray::new(origin, narrow(unit(way).filter(|_| leaves)?)).within(0.0, length(way) as f32))
    }

    /// Whether a light lies in front: on the side from which the ray came, or on the outside of what transmits, whose inside is
    /// lit through it.
    pub(crate) fn faces(&self, light: Vec3) -> bool {
        let front = if self.material.transmission > 0.0 { self.normal } else { self.facing };
        dot(sub(wide(light), self.position), front) > 0.0
    }
}

fn upper_light(bounds: &Aabb, up: V3) -> Vec3 {
    if bounds.is_empty() {
        return [0.0; 3];
    }
    // The box's height along `up` is that of its projection; 0.9 of it is 0.4 above the centre.
    let extent = wide(bounds.extent());
    let height: f64 = (0..3).map(|a| up[a].abs() * extent[a]).sum();
    narrow(add(wide(bounds.centre()), scale(up, 0.4 * height)))
}

fn every_eighth_part(mesh: &Mesh) -> Vec<bool> {
    connected_parts(mesh).into_iter().map(|part| part % 8 == 7).collect()
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;
    use rdh::{BuildOptions, Spec, Training};
    use rdh_scene::{Geometry, Instance, Transform};

    /// One triangle, near or far from the origin, of any shape: from equilateral to needles.
    fn triangle(random: &mut Random) -> [Vec3; 3] {
        let size = 10f64.powf(8.0 * random.unit() - 4.0);
        let place = 10f64.powf(8.0 * random.unit() - 4.0);
        let thin = 10f64.powf(-5.0 * random.unit());
        let mut point = |by: f64| [random.unit(), random.unit(), random.unit()].map(|x| (2.0 * x - 1.0) * by);
        let (at, long, short) = (point(place), point(size), point(size * thin));
        [at, add(at, long), add(at, add(long, short))].map(narrow)
    }

    fn stage(corners: [Vec3; 3]) -> Stage {
        let geometry = Geometry { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Geometry::default() };
        let instance = Instance { geometry: 0, scene_from_object: Transform::IDENTITY };
        Stage::new(&Scene { geometries: vec![geometry], instances: vec![instance], ..Scene::default() }).unwrap()
    }

    #[test]
    fn spawned_rays_never_hit_the_triangle_they_leave() {
        let (mut met, mut cast) = (0, 0);
        for index in 0..20_000 {
            let mut random = Random::new(11, index);
            let corners = triangle(&mut random);
            let stage = stage(corners);
            let accel =
                rdh::build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
            // Aimed at a corner, an edge or the inside, from anywhere.
            let [a, b, c] = corners.map(wide);
            let (u, v) =
                [(0.0, 0.0), (random.unit(), 0.0), (0.3 * random.unit(), 0.6 * random.unit())][random.below(3)];
            let target = add(a, add(scale(sub(b, a), u), scale(sub(c, a), v)));
            let towards = random.cosine_direction([0.0, 0.0, 1.0]);
            let origin = sub(target, scale(towards, 3.0 * length(sub(b, a))));
            let ray = Ray::new(narrow(origin), narrow(towards));
            let Some(hit) = accel.closest(&ray) else { continue };
            met += 1;
            let point = stage.surface(&ray, &hit);
            for _ in 0..20 {
                let direction = random.cosine_direction(point.facing);
                // Nearly along the surface, too.
                let flat = unit(sub(direction, scale(point.normal, dot(direction, point.normal) * 0.999_999)));
                for direction in [direction, flat.unwrap_or(direction), scale(direction, -1.0)] {
                    let spawned = point.spawn(direction);
                    assert_eq!(accel.closest(&spawned), None, "{corners:?} {ray:?} {spawned:?}");
                    cast += 1;
                }
            }
        }
        assert!(met > 5_000 && cast == 60 * met, "{met}");
    }

    #[test]
    fn a_light_on_the_surface_gets_no_ray() {
        let stage = stage([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let accel = rdh::build(stage.mesh(), &Spec::default(), &Training::none(), &BuildOptions::default()).unwrap();
        let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
        let point = stage.surface(&ray, &accel.closest(&ray).unwrap());
        assert_eq!((point.position, point.facing), ([0.25, 0.25, 0.0], [0.0, 0.0, 1.0]));
        assert_eq!(point.spawn_to([0.25, 0.25, 0.0]), None);
        assert_eq!(point.spawn_to([0.25, 0.25, 1e-9]), None);
        let above = point.spawn_to([0.25, 0.25, 1.0]).unwrap();
        assert!(above.t_max <= 1.0 && above.t_max > 0.99999 && above.direction == [0.0, 0.0, 1.0]);
    }
}
