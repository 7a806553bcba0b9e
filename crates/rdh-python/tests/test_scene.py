"""Scenes and their queries: shapes, dtypes, misses, and agreement with brute force in NumPy."""

import numpy as np
import pytest
from making import random_rays, soup

import rdh


def brute_force(vertices: np.ndarray, faces: np.ndarray, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances ``(rays, faces)``, inf for misses, and how near each ray is to an edge; in float64 by Moeller and Trumbore."""
    a, b, c = (vertices[faces[:, k]].astype(np.float64) for k in range(3))
    origins, directions = (part[:, None].astype(np.float64) for part in (rays[:, :3], rays[:, 3:6]))
    ab, ac, p = b - a, c - a, np.cross(directions, (c - a)[None])
    determinant = (ab * p).sum(-1)
    with np.errstate(all="ignore"):
        s = origins - a
        u = (s * p).sum(-1) / determinant
        q = np.cross(s, ab[None])
        v = (directions * q).sum(-1) / determinant
        t = (ac * q).sum(-1) / determinant
    hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
    edge = np.minimum(np.minimum(abs(u), abs(v)), np.minimum(abs(1 - u - v), abs(t)))
    return np.where(hit, t, np.inf), edge


@pytest.mark.parametrize("spec", ["bvh8+sah", "bvh8(high)+sah", "bvh4+sah", "sbvh8+sah", "kd+sah"])
def test_agrees_with_brute_force(spec: str) -> None:
    (vertices, faces), rays = soup(300, 2), random_rays(2000, 3)
    scene = rdh.Scene(vertices, faces, spec)
    distances, edge = brute_force(vertices, faces, rays)
    clear = (edge > 1e-4).all(axis=1)
    assert clear.mean() > 0.5
    hits = scene.cast_rays(rays)
    nearest = distances.min(axis=1)
    assert np.allclose(hits["t_hit"][clear], nearest[clear], rtol=1e-4)
    ids = np.where(np.isinf(nearest), rdh.INVALID_ID, distances.argmin(axis=1))
    assert (hits["primitive_ids"] == ids)[clear].all()
    assert (scene.test_occlusions(rays) == np.isfinite(nearest))[clear].all()
    counts = np.isfinite(distances).sum(axis=1)
    assert (scene.count_intersections(rays) == counts)[clear].all()
    listed = scene.list_intersections(rays)
    for ray in np.flatnonzero(clear)[:200]:
        own = slice(*listed["ray_splits"][ray : ray + 2])
        order = np.argsort(distances[ray])[: counts[ray]]
        assert sorted(listed["primitive_ids"][own]) == sorted(order)
        # Of nearly equal distances, rounding may decide.
        assert np.allclose(listed["t_hit"][own], distances[ray][order], rtol=1e-4)


def test_shapes_and_dtypes(small: rdh.Scene) -> None:
    for shape in [(), (0,), (1,), (7,), (3, 4), (2, 0, 5), (2, 3, 4)]:
        for columns in (6, 8):
            rays = np.ones((*shape, columns))
            hits = small.cast_rays(rays)
            assert {name: (a.shape, a.dtype) for name, a in hits.items()} == {
                "t_hit": (shape, np.float32),
                "geometry_ids": (shape, np.uint32),
                "primitive_ids": (shape, np.uint32),
                "primitive_uvs": ((*shape, 2), np.float32),
                "primitive_normals": ((*shape, 3), np.float32),
            }
            occluded, counts = small.test_occlusions(rays), small.count_intersections(rays)
            assert (occluded.shape, occluded.dtype) == (shape, np.bool_)
            assert (counts.shape, counts.dtype) == (shape, np.int32)
            assert len(small.list_intersections(rays)["ray_splits"]) == int(np.prod(shape)) + 1


def test_hits_tell_where_and_how() -> None:
    scene = rdh.Scene([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    hits = scene.cast_rays([[0.5, 0.25, 1, 0, 0, -2], [0.5, 0.25, 1, 0, 0, 2]])
    assert hits["t_hit"].tolist() == [0.5, np.inf]
    assert hits["geometry_ids"].tolist() == [0, rdh.INVALID_ID]
    assert hits["primitive_ids"].tolist() == [0, rdh.INVALID_ID]
    assert hits["primitive_uvs"].tolist() == [[0.5, 0.25], [0, 0]]
    assert hits["primitive_normals"].tolist() == [[0, 0, 1], [0, 0, 0]]


def test_intervals_are_closed() -> None:
    scene = rdh.Scene([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    ray = [0.25, 0.25, 1, 0, 0, -1]
    for t_min, t_max, is_hit in [(0, 1, True), (1, 1, True), (0, 0.999, False), (1.001, 9, False), (2, 1, False)]:
        assert scene.test_occlusions(ray, tnear=t_min, tfar=t_max) == is_hit
        assert np.isfinite(scene.cast_rays([*ray, t_min, t_max])["t_hit"]) == is_hit
        # Rays with an interval keep it.
        assert scene.test_occlusions([*ray, t_min, t_max], tnear=5, tfar=6) == is_hit


def test_only_wanted_fields(small: rdh.Scene) -> None:
    rays = random_rays(100, 4)
    everything = small.cast_rays(rays)
    for name in everything:
        only = small.cast_rays(rays, fields=[name])
        assert list(only) == [name]
        assert (only[name] == everything[name]).all()
    with pytest.raises(ValueError, match="fields: 'colour' is none of t_hit"):
        small.cast_rays(rays, fields=["t_hit", "colour"])


def test_invalid_rays_miss(small: rdh.Scene) -> None:
    bad = np.array([np.nan, np.inf, -np.inf])
    rays = np.tile(random_rays(1, 5), (18, 1))
    for row in range(18):
        rays[row, row // 3] = bad[row % 3]
    rays = np.concatenate([rays, [[0, 0, 0, 0, 0, 0]]])
    assert (small.cast_rays(rays)["primitive_ids"] == rdh.INVALID_ID).all()
    assert not small.test_occlusions(rays).any()
    assert not small.count_intersections(rays).any()


def test_far_scenes_stay_precise() -> None:
    far = np.array([4_500_000.0, 5_700_000.0, 300.0])
    vertices, faces = soup(100, 6)
    rays = random_rays(1000, 7).astype(np.float64)
    near, moved = rdh.Scene(vertices, faces), rdh.Scene(vertices + far, faces)
    assert moved.origin != (0, 0, 0)
    there = rays.copy()
    there[:, :3] += far
    hits, expected = moved.cast_rays(there), near.cast_rays(rays)
    same = hits["primitive_ids"] == expected["primitive_ids"]
    assert same.mean() > 0.995
    assert np.allclose(hits["t_hit"][same], expected["t_hit"][same], rtol=1e-4, atol=1e-4)
    assert np.allclose(moved.vertices, vertices + far, rtol=0, atol=1e-6)
    assert np.allclose(moved.bounds, near.bounds + far, rtol=0, atol=1e-6)


def test_what_is_no_mesh_is_refused() -> None:
    vertices, faces = np.eye(3), [[0, 1, 2]]
    for bad, message in [
        ([[0, 1, 3]], "faces: row 0: .* refers to more than the 3 vertices"),
        ([[0, 1, -1]], "faces: row 0: -1 is not a vertex index"),
        ([[0, 1, 2**40]], "faces: row 0: 1099511627776 is not a vertex index"),
        ([[0.0, 1.0, 2.0]], "faces: integers are needed, not float64"),
        ([[0, 1]], r"faces: the shape must be \(n, 3\), not \(1, 2\)"),
        ("abc", "faces: "),
        (None, "faces: "),
    ]:
        with pytest.raises(ValueError, match=message):
            rdh.Scene(vertices, bad)
    for bad, message in [
        ([[0, 0, np.nan]] * 3, "vertices: row 0: NaN is not a finite 32-bit float"),
        ([[0, 0, 1e300]] * 3, "vertices: row 0: .* is not a finite 32-bit float"),
        ([[0, 0]] * 3, r"vertices: the shape must be \(n, 3\), not \(3, 2\)"),
        ([["a", "b", "c"]], "vertices: real numbers are needed"),
        ([[0, 0, 1j]] * 3, "vertices: real numbers are needed, not complex128"),
        ([[0, 0, 0], [0, 0]], "vertices: "),
    ]:
        with pytest.raises(ValueError, match=message):
            rdh.Scene(bad, faces)
    with pytest.raises(ValueError, match="spec 'octree': unknown name 'octree'"):
        rdh.Scene(vertices, faces, "octree")
    with pytest.raises(ValueError, match="needs a profile"):
        rdh.Scene(vertices, faces, "bvh8+rdh")


def test_scenes_without_triangles() -> None:
    scene = rdh.Scene([], [])
    assert len(scene) == 0
    assert scene.cast_rays(random_rays(10, 8))["primitive_ids"].tolist() == [rdh.INVALID_ID] * 10


def test_rays_beyond_float32_are_refused(small: rdh.Scene) -> None:
    rays = np.tile([0.0, 0, 0, 1, 0, 0], (1000, 1))
    rays[700, 0] = 1e200
    rays[900, 4] = -1e50
    with pytest.raises(ValueError, match="rays: ray 700 is beyond the range of 32-bit floats"):
        small.cast_rays(rays)
    with pytest.raises(ValueError, match="rays: ray 0 is beyond"):
        small.test_occlusions([0, 0, 0, 1e-200, 0, 0])


def test_wrong_rays_are_refused(small: rdh.Scene) -> None:
    queries = [small.cast_rays, small.test_occlusions, small.count_intersections, small.list_intersections]
    for query in queries:
        for bad in [None, 1.0, "rays", [1, 2, 3], np.ones((3, 7)), np.ones((6, 3)), {"a": 1}, [[1, 2], [3]]]:
            with pytest.raises(ValueError, match="^rays: "):
                query(bad)
        for threads in [-1, 10**6]:
            with pytest.raises(ValueError, match="threads: "):
                query(np.ones((3, 6)), threads=threads)


def test_loading() -> None:
    scene = rdh.load("quarter", "bvh8(quick)+sah")
    assert scene.name == "quarter" and len(scene) == len(scene.faces) == scene.stats["triangles"]
    assert scene.spec == "bvh8(quick)+sah"
    assert "street" in scene.views and len(scene.paths["drive"]) == 120
    rays = scene.camera_rays(40, 30, "street")
    assert rays.shape == (30, 40, 6) and np.allclose(np.linalg.norm(rays[..., 3:], axis=-1), 1)
    assert scene.test_occlusions(rays).mean() > 0.3
    with pytest.raises(ValueError, match="view: the scene has these: street"):
        scene.camera_rays(4, 4, "nowhere")
    with pytest.raises(ValueError, match="near names: .*quarter"):
        rdh.load("quartet")
    with pytest.raises(FileNotFoundError, match="nowhere.obj"):
        rdh.load("nowhere.obj")
    assert len(rdh.load("building(floors=2,seed=3)")) > 0


def test_mesh_files(tmp_path) -> None:
    path = tmp_path / "one.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nvt 1 1\nl 1 2\n")
    scene = rdh.load(path)
    assert len(scene) == 1 and scene.cast_rays([0.2, 0.2, 1, 0, 0, -1])["t_hit"] == 1
    assert scene.notes and all(isinstance(note, str) for note in scene.notes)
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(ValueError, match="one.obj: line 4"):
        rdh.load(path)


def test_pinhole_of_nothing(small: rdh.Scene) -> None:
    with pytest.raises(ValueError, match="view: the scene has these: none"):
        small.camera_rays(4, 4)


def test_rebuilding_changes_no_answer(quarter: rdh.Scene) -> None:
    scene = rdh.load("quarter")
    rays = scene.camera_rays(128, 96)
    before, counts = scene.cast_rays(rays), scene.count_intersections(rays)
    with rdh.record(scene) as profile:
        scene.cast_rays(rays)
    for spec in ["kd+sah", "kd+rdh", "bvh8+rdh", "sbvh8+rdh", "bvh4(high)+sah"]:
        scene.rebuild(spec, profile)
        assert scene.spec == spec
        assert all((scene.cast_rays(rays)[name] == before[name]).all() for name in before)
        assert (scene.count_intersections(rays) == counts).all()
    with pytest.raises(ValueError, match="needs a profile"):
        scene.rebuild("kd+rdh")
    assert scene.spec == "bvh4(high)+sah"


@pytest.mark.parametrize("threads", [1, 3])
def test_batches_are_as_good_as_their_parts(threads: int, quarter: rdh.Scene) -> None:
    low, high = quarter.bounds
    points = np.random.default_rng(5).uniform(low, high, (2, 40_000, 3))
    rays = np.concatenate([points[0], points[1] - points[0]], axis=1)
    rays[::1000, 3] = np.nan
    parts = range(0, len(rays), 400)
    at_once, in_parts = quarter.cast_rays(rays, threads), [quarter.cast_rays(rays[k : k + 400]) for k in parts]
    for name, array in at_once.items():
        assert np.array_equal(array, np.concatenate([part[name] for part in in_parts]))
    at_once, in_parts = (
        quarter.list_intersections(rays, threads),
        [quarter.list_intersections(rays[k : k + 400]) for k in parts],
    )
    for name in ("t_hit", "primitive_ids", "primitive_uvs"):
        assert np.array_equal(at_once[name], np.concatenate([part[name] for part in in_parts]))
    counts = np.diff(at_once["ray_splits"])
    assert np.array_equal(counts, quarter.count_intersections(rays, threads))
    assert np.array_equal(at_once["ray_ids"], np.repeat(np.arange(len(rays)), counts))
