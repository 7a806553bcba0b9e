"""The examples run, and what they write is there and sensible."""

import pathlib

import common
import lidar
import numpy as np
import pytest
import sight
import sunlight

import rdh

pytest.importorskip("matplotlib")


def run(example, out: pathlib.Path) -> common.Times:
    times = example.main(["--small", "--rounds", "1", "--out", str(out)])
    assert times.rays > 5_000 and times.rays_per_sec["rdh, plain"] > 0
    # All said the same, but past edges.
    assert times.differ < 2e-3
    assert rdh.open(out / "tuned.rdh").spec == times.spec
    return times


def test_lidar(tmp_path: pathlib.Path) -> None:
    run(lidar, tmp_path)
    assert (tmp_path / "lidar.png").stat().st_size > 10_000
    clouds = sorted(tmp_path.glob("sweep-*.ply"))
    assert len(clouds) == 10
    header, _, body = clouds[3].read_bytes().partition(b"end_header\n")
    points = np.frombuffer(body, "<f4").reshape(-1, 3)
    assert f"element vertex {len(points)}\n".encode() in header and len(points) > 2_000
    low, high = rdh.load("quarter").bounds
    assert ((points >= low - 0.01) & (points <= high + 0.01)).all()


def test_sunlight(tmp_path: pathlib.Path) -> None:
    patches = sunlight.sky_patches()
    assert patches.shape == (145, 3) and np.allclose(np.linalg.norm(patches, axis=1), 1)
    hours = sunlight.hours_by_patch(patches)
    # The sun is up for half of the year, wherever one is.
    assert hours.sum() == pytest.approx(365 * 12, rel=0.02)
    # In the north it is rarely high, and never stands in the zenith.
    assert hours[-1] == 0
    run(sunlight, tmp_path)
    assert (tmp_path / "sunlight.png").stat().st_size > 10_000
    table = np.load(tmp_path / "hours.npy")
    assert table.shape == (1_000, 4) and 0 <= table[:, 3].min() < table[:, 3].max() < hours.sum()


def test_sunlight_of_a_wall_alone() -> None:
    """A wall that faces south sees half of the sky, and all of the winter's sun."""
    scene = rdh.Scene([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    points, normals = sunlight.facade_points(scene, 50)
    assert np.allclose(normals, [0, -1, 0])
    patches = sunlight.sky_patches()
    assert not scene.test_occlusions(sunlight.rays_to_sky(points, patches))[:, normals[0] @ patches.T > 0].any()


def test_sight(tmp_path: pathlib.Path) -> None:
    run(sight, tmp_path)
    assert (tmp_path / "sight.png").stat().st_size > 10_000
    table = np.load(tmp_path / "seen.npy")
    assert table.shape == (24 * 24, 4) and 0 <= table[:, 3].min() < table[:, 3].max() <= 1


def test_sight_on_a_plain_is_free() -> None:
    scene = rdh.Scene([[0, 0, 0], [100, 0, 0], [100, 100, 0], [0, 100, 0]], [[0, 1, 2], [0, 2, 3]])
    eyes, targets = sight.on_ground(scene, sight.path_across(scene, 5), 1.7), sight.on_ground(scene, sight.grid(scene, 8), 0.5)
    assert np.allclose(eyes[:, 2], 1.7) and np.allclose(targets[:, 2], 0.5)
    assert not scene.test_occlusions(sight.lines(eyes, targets)).any()
