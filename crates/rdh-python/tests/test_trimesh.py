"""``rdh.trimesh`` beside trimesh's own intersectors.

What trimesh's tests/test_ray.py (5.2.0) asks of an intersector is asked here too, of meshes that ``trimesh.creation`` can
make. Not run, since they need files of trimesh's repository: ``test_rays`` (ray_data.json and its meshes), ``test_on_edge``
(7_8ths_cube.stl; the hull of a cube without one corner stands in for it), ``test_contain_single`` (teapot.stl; a
sphere with holes does). ``test_contains_cavity`` needs a boolean engine; the cavity is made of two boxes here.
"""

import copy
import pickle
from typing import Any

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

import rdh  # noqa: E402
import rdh.trimesh  # noqa: E402

RayMeshIntersector = rdh.trimesh.RayMeshIntersector
try:
    from trimesh.ray import ray_pyembree
except ImportError:
    ray_pyembree = None
needs_embreex = pytest.mark.skipif(ray_pyembree is None, reason="embreex is not installed")


def equipped(mesh: Any, **named: Any) -> Any:
    mesh.ray = RayMeshIntersector(mesh, **named)
    return mesh


def made_meshes() -> list[Any]:
    """50 meshes of all kinds that ``trimesh.creation`` makes."""
    creation, rng = trimesh.creation, np.random.default_rng(1)
    meshes = []
    for k in range(10):
        a, b = rng.uniform(0.2, 2.0, 2)
        meshes += [
            creation.box(extents=rng.uniform(0.1, 3.0, 3)),
            creation.icosphere(subdivisions=1 + k % 4, radius=a),
            [
                lambda: creation.cylinder(radius=a, height=b, sections=5 + k),
                lambda: creation.cone(radius=a, height=b, sections=5 + k),
                lambda: creation.capsule(radius=a, height=b),
                lambda: creation.uv_sphere(radius=a, count=[8 + k, 9]),
                lambda: creation.annulus(r_min=a, r_max=a + b, height=b),
            ][k % 5](),
            creation.torus(major_radius=a + b, minor_radius=a / 2, major_sections=8 + k, minor_sections=7),
            [
                lambda: creation.random_soup(face_count=40 + k),
                lambda: trimesh.util.concatenate([creation.box(), creation.icosphere(subdivisions=2, radius=0.3)]),
                lambda: creation.axis(origin_size=a),
            ][k % 3](),
        ]
    moved = []
    for mesh in meshes:
        mesh.apply_transform(trimesh.transformations.rotation_matrix(rng.uniform(0, 6), rng.normal(size=3)))
        mesh.apply_translation(rng.uniform(-2, 2, 3))
        moved.append(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False))
    assert len(moved) == 50
    return moved


def rays_for(mesh: Any, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Rays from a sphere around a mesh towards points in its box."""
    rng = np.random.default_rng(seed)
    low, high = mesh.bounds
    size = np.linalg.norm(high - low)
    origins = (low + high) / 2 + trimesh.unitize(rng.normal(size=(count, 3))) * size
    return origins, rng.uniform(low, high, (count, 3)) - origins


def shape_of(result: Any) -> list[tuple[Any, Any]]:
    arrays = result if isinstance(result, tuple) else (result,)
    return [(a.dtype, a.shape[1:]) for a in arrays]


@needs_embreex
@pytest.mark.parametrize("number", range(50))
def test_all_methods_beside_trimesh(number: int) -> None:
    mesh = made_meshes()[number]
    theirs, ours = ray_pyembree.RayMeshIntersector(mesh), RayMeshIntersector(mesh)
    origins, directions = rays_for(mesh, 400, number)
    size = np.linalg.norm(mesh.extents)

    # First hits: the same but where a ray passes an edge so near that rounding decides.
    first, expected = ours.intersects_first(origins, directions), theirs.intersects_first(origins, directions)
    assert first.dtype == expected.dtype and first.shape == expected.shape
    differ = first != expected
    assert differ.mean() <= 0.01
    any_hit, expected = ours.intersects_any(origins, directions), theirs.intersects_any(origins, directions)
    assert any_hit.dtype == expected.dtype and (any_hit != expected).mean() <= 0.005
    assert (any_hit == (first != -1)).all()

    for many in (False, True):
        a = ours.intersects_id(origins, directions, multiple_hits=many, return_locations=True)
        b = theirs.intersects_id(origins, directions, multiple_hits=many, return_locations=True)
        assert shape_of(a) == shape_of(b)
        assert shape_of(ours.intersects_id(origins, directions, many)) == shape_of(theirs.intersects_id(origins, directions, many))
        a_location, b_location = (i.intersects_location(origins, directions, multiple_hits=many) for i in (ours, theirs))
        assert shape_of(a_location) == shape_of(b_location)
        assert np.array_equal(a_location[0], a[2]) and np.array_equal(a_location[1], a[1])
        # Hits ray by ray, as sets of faces.
        sets = [{pair for pair in zip(ray.tolist(), tri.tolist(), strict=True)} for tri, ray, _ in (a, b)]
        assert len(sets[0] ^ sets[1]) <= 0.02 * max(len(sets[1]), 50)
        # Where both have a hit, they have it in the same place.
        places = {pair: place for pair, place in zip(zip(b[1].tolist(), b[0].tolist(), strict=True), b[2], strict=True)}
        for tri, ray, place in zip(*a, strict=True):
            other = places.get((ray, tri))
            assert other is None or np.linalg.norm(place - other) < 1e-6 * size
        # On the ray, and on the face's plane.
        ahead = a[2] - origins[a[1]]
        assert np.linalg.norm(np.cross(ahead, trimesh.unitize(directions[a[1]])), axis=1).max(initial=0) < 1e-5 * size

    points = np.random.default_rng(number).uniform(*mesh.bounds, (200, 3))
    inside, expected = ours.contains_points(points), theirs.contains_points(points)
    assert inside.dtype == expected.dtype
    if mesh.is_watertight:
        assert (inside != expected).mean() <= 0.01
        assert (inside == (mesh.ray.contains_points(points))).mean() >= 0.99


def test_hits_are_ordered_by_ray_and_distance() -> None:
    mesh = equipped(trimesh.creation.icosphere(subdivisions=3))
    origins, directions = rays_for(mesh, 2000, 1)
    locations, rays, _ = mesh.ray.intersects_location(origins, directions)
    assert (np.diff(rays) >= 0).all()
    distance = np.linalg.norm(locations - origins[rays], axis=1)
    assert (np.diff(distance)[np.diff(rays) == 0] >= 0).all()
    assert (np.bincount(rays) % 2 == 0).all()


def test_limits_of_hits() -> None:
    mesh = equipped(trimesh.util.concatenate([trimesh.creation.box([s, s, s]) for s in (1, 2, 3)]))
    ray = [[0.1, 0.2, 9]], [[0, 0, -1]]
    assert len(mesh.ray.intersects_id(*ray)[0]) == 6
    for most in range(8):
        tri, _ = mesh.ray.intersects_id(*ray, max_hits=most)
        assert len(tri) == min(most, 6)
    with pytest.raises(ValueError, match="max_hits"):
        mesh.ray.intersects_id(*ray, max_hits=-1)


def test_no_rays_and_no_hits() -> None:
    mesh = equipped(trimesh.creation.icosphere())
    nothing = np.zeros((0, 3))
    for origins, directions in [(nothing, nothing), ([[0, 0, 9]], [[0, 0, 1]])]:
        locations, rays, triangles = mesh.ray.intersects_location(origins, directions)
        assert locations.shape == (0, 3) and rays.shape == triangles.shape == (0,)
        assert not mesh.ray.intersects_any(origins, directions).any()
        assert (mesh.ray.intersects_first(origins, directions) == -1).all()


def test_what_is_inside() -> None:
    for mesh in [trimesh.creation.box(), trimesh.creation.icosphere(), trimesh.creation.torus(2, 0.5)]:
        equipped(mesh)
        assert not mesh.ray.contains_points(mesh.vertices * 2).any()
        assert mesh.ray.contains_points(mesh.triangles_center - mesh.face_normals * 0.05).all()
        assert not mesh.ray.contains_points(mesh.triangles_center + mesh.face_normals * 0.05).any()
        assert not mesh.ray.contains_points(np.random.default_rng(1).uniform(9, 99, (30, 3))).any()
    with pytest.raises(ValueError, match="points: the shape must be"):
        mesh.ray.contains_points([1, 2, 3])


def test_cavities_are_outside() -> None:
    outer, inner = trimesh.creation.box([1, 1, 1]), trimesh.creation.box([0.1, 0.1, 0.1])
    inner.invert()
    mesh = equipped(trimesh.util.concatenate([outer, inner]))
    assert mesh.contains([[0, 0, 0], [0.2, 0, 0]]).tolist() == [False, True]


def test_a_corner_is_cut_off() -> None:
    corners = [c for c in np.ndindex(2, 2, 2) if c != (1, 1, 1)] + [(1, 1, 0.25), (1, 0.25, 1), (0.25, 1, 1)]
    mesh = equipped(trimesh.convex.convex_hull(2.0 * np.array(corners) - 1))
    assert mesh.ray.contains_points([[0.9, 0.9, 0.9], [0.3, 0.3, 0.3], [-0.9, -0.9, -0.9], [0, 0, 1.5]]).tolist() == [
        False,
        True,
        True,
        False,
    ]


def test_open_meshes_are_survived() -> None:
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.update_faces(np.random.default_rng(1).random(len(mesh.faces)) > 0.1)
    equipped(mesh)
    grid = np.stack(np.meshgrid(*[np.linspace(-1.2, 1.2, 9)] * 3), axis=-1).reshape(-1, 3)
    inside = mesh.ray.contains_points(grid)
    depth = np.linalg.norm(grid, axis=1)
    assert inside.shape == (len(grid),)
    assert not inside[depth > 1.01].any()
    assert inside[depth < 0.9].mean() > 0.7


def test_rays_through_vertices_and_edges_hit_once() -> None:
    mesh = equipped(trimesh.creation.box())
    for targets in (mesh.vertices, mesh.vertices[mesh.edges_unique].mean(axis=1)):
        origins = np.zeros_like(targets)
        assert mesh.ray.intersects_any(origins, targets).all()
        _, rays, _ = mesh.ray.intersects_location(origins, targets)
        assert (np.bincount(rays, minlength=len(targets)) == 1).all()


def test_first_faces_of_a_picture() -> None:
    grid = np.stack(np.meshgrid(np.arange(-128, 128, 2.0), np.arange(-128, 128, 2.0)), axis=-1).reshape(-1, 2)
    directions = np.column_stack([grid, np.full(len(grid), 1000.0)])
    origins = np.tile([0, 0, -15.0], (len(grid), 1))
    mesh = equipped(trimesh.creation.box([2, 2, 2]))
    assert len(np.unique(mesh.ray.intersects_id(origins, directions, multiple_hits=False)[0])) == 2
    assert len(np.unique(mesh.ray.intersects_id(origins, directions, multiple_hits=True)[0])) > 2


def test_places_on_a_box_are_exact() -> None:
    mesh = equipped(trimesh.creation.box())
    x, y = np.meshgrid(np.linspace(-0.52, 0.52, 100), np.linspace(-0.52, 0.52, 100))
    origins = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, -100.0)])
    places, rays, _ = mesh.ray.intersects_location(origins, np.tile([0, 0, 1.0], (x.size, 1)))
    assert len(places) == 2 * (abs(origins[:, :2]) <= 0.5).all(axis=1).sum()
    assert np.array_equal(places[:, :2], origins[rays, :2])
    assert np.allclose(abs(places[:, 2]), 0.5, rtol=0, atol=1e-14)


@pytest.mark.parametrize("scale", [1e-4, 0.1, 1.0, 10, 1e4, 1e8])
def test_any_scale(scale: float) -> None:
    mesh = trimesh.creation.box().subdivide().subdivide()
    mesh.apply_scale(scale)
    equipped(mesh)
    # From the surface itself: there, and on the other side.
    assert len(mesh.ray.intersects_id([[0.0, 0, scale / 2]], [[0, 0, -1.0]])[0]) == 2
    assert len(mesh.ray.intersects_id([[0.0, 0, 1e7 * scale]], [[0, 0, -1.0]])[0]) == 2


def test_any_place() -> None:
    mesh = trimesh.creation.icosphere(subdivisions=3)
    origins, directions = rays_for(mesh, 1000, 3)
    expected = RayMeshIntersector(mesh).intersects_location(origins, directions)
    far = np.array([5e6, 5e5, 300.0])
    mesh.apply_translation(far)
    found = RayMeshIntersector(mesh).intersects_location(origins + far, directions)
    assert (np.bincount(found[1]) % 2 == 0).all()
    assert len(found[0]) == len(expected[0])
    assert np.allclose(found[0] - far, expected[0], rtol=0, atol=1e-6)


def test_a_changed_mesh_is_built_anew() -> None:
    mesh = equipped(trimesh.creation.box())
    scene = mesh.ray.scene
    assert mesh.ray.scene is scene
    ray = [[0, 0, 9.0]], [[0, 0, -1.0]]
    assert mesh.ray.intersects_any(*ray).all()
    mesh.apply_translation([50, 0, 0])
    assert not mesh.ray.intersects_any(*ray).any() and mesh.ray.scene is not scene


def test_copies_and_pickles() -> None:
    mesh = equipped(trimesh.creation.icosphere())
    ray = [[0, 0, 9.0]], [[0, 0, -1.0]]
    first = mesh.ray.intersects_first(*ray)
    for other in [copy.copy(mesh.ray), copy.deepcopy(mesh.ray), pickle.loads(pickle.dumps(mesh.ray))]:
        assert isinstance(other, RayMeshIntersector) and other.intersects_first(*ray) == first


def test_trimesh_uses_it() -> None:
    """Functions of trimesh that cast rays by ``mesh.ray`` take what it returns."""
    mesh = equipped(trimesh.creation.icosphere(subdivisions=3))
    assert mesh.contains([[0, 0, 0], [0, 0, 2]]).tolist() == [True, False]
    lengths = trimesh.proximity.longest_ray(mesh, [[0, 0, 0]], [[0, 0, 1]])
    assert abs(lengths[0] - 1) < 0.01
    thickness = trimesh.proximity.thickness(mesh, mesh.triangles_center[:10], method="ray")
    assert (abs(thickness - 2) < 0.1).all()


def test_wrong_rays_are_refused() -> None:
    mesh = equipped(trimesh.creation.box())
    queries = [mesh.ray.intersects_first, mesh.ray.intersects_any, mesh.ray.intersects_id, mesh.ray.intersects_location]
    for query in queries:
        with pytest.raises(ValueError, match="ray_directions: 1 directions for 2 origins"):
            query(np.zeros((2, 3)), np.ones((1, 3)))
        with pytest.raises(ValueError, match=r"ray_origins: the shape must be \(n, 3\), not \(3,\)"):
            query(np.zeros(3), np.ones(3))
        with pytest.raises(ValueError, match="ray_directions: real numbers"):
            query(np.zeros((1, 3)), [["x", "y", "z"]])
        with pytest.raises(ValueError, match="ray_origins, ray_directions: ray 1 is beyond"):
            query([[0, 0, 0], [1e200, 0, 0]], np.ones((2, 3)))


def test_recording_what_trimesh_casts() -> None:
    mesh = equipped(trimesh.creation.icosphere(subdivisions=4))
    origins, directions = rays_for(mesh, 3000, 9)
    before = mesh.ray.intersects_location(origins, directions)
    with rdh.record(mesh.ray) as profile:
        mesh.ray.intersects_location(origins, directions)
        mesh.ray.intersects_any(origins, directions)
    assert profile.seen == 6000
    mesh.ray.scene.rebuild("bvh8+rdh", profile)
    after = mesh.ray.intersects_location(origins, directions)
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))


def test_many_rays_are_as_good_as_few() -> None:
    mesh = equipped(trimesh.creation.icosphere(subdivisions=5))
    origins, directions = rays_for(mesh, 30_000, 4)
    at_once = mesh.ray.intersects_location(origins, directions)
    parts = [mesh.ray.intersects_location(origins[k : k + 300], directions[k : k + 300]) for k in range(0, 30_000, 300)]
    assert np.array_equal(at_once[0], np.concatenate([p[0] for p in parts]))
    assert np.array_equal(at_once[1], np.concatenate([p[1] + 300 * k for k, p in enumerate(parts)]))
    assert np.array_equal(at_once[2], np.concatenate([p[2] for p in parts]))
