"""Hours of sunlight on the facades of a town: rays from points on walls to the 145 patches of the sky.

The directions are the same for all points: just what a tree can be built for. A tenth of the points is recorded; the others
are cast and timed.
"""

from __future__ import annotations

import pathlib
import sys

import common
import numpy as np

import rdh

# Tregenza's sky: patches in each ring of 12 degrees, from the horizon up, and one at the zenith. 145 in all.
RINGS = [30, 30, 24, 24, 18, 12, 6, 1]
LATITUDE = np.radians(48.0)


def sky_patches() -> np.ndarray:
    """Directions ``(145, 3)`` to the middles of the patches; x is east, y north, z up."""
    directions = []
    for ring, count in enumerate(RINGS):
        elevation = np.radians(90.0 if count == 1 else 6.0 + 12.0 * ring)
        azimuths = 2 * np.pi * np.arange(count) / count
        flat = np.cos(elevation)
        directions += [(flat * np.sin(a), flat * np.cos(a), np.sin(elevation)) for a in azimuths]
    return np.array(directions)


def hours_by_patch(patches: np.ndarray) -> np.ndarray:
    """For how many hours of a year the sun stands in each patch, at 48 degrees north, ``(145,)``."""
    day, hour = (part.ravel() for part in np.meshgrid(np.arange(365), np.arange(0, 24, 0.25)))
    declination = np.radians(-23.44) * np.cos(2 * np.pi * (day + 10) / 365)
    angle = np.radians(15 * (hour - 12))
    up = np.sin(LATITUDE) * np.sin(declination) + np.cos(LATITUDE) * np.cos(declination) * np.cos(angle)
    east = -np.cos(declination) * np.sin(angle)
    north = np.cos(LATITUDE) * np.sin(declination) - np.sin(LATITUDE) * np.cos(declination) * np.cos(angle)
    sun = np.stack([east, north, up], axis=1)[up > 0]
    nearest = (sun @ patches.T).argmax(axis=1)
    return np.bincount(nearest, minlength=len(patches)) * 0.25


def facade_points(scene: rdh.Scene, count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Points spread evenly over walls (faces that stand upright to within 10 degrees) and their normals, ``(n, 3)`` each."""
    a, b, c = (scene.vertices[scene.faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    upright = (abs(cross[:, 2]) < np.sin(np.radians(10)) * area) & (area > 0)
    rng = np.random.default_rng(seed)
    chosen = rng.choice(np.flatnonzero(upright), count, p=area[upright] / area[upright].sum())
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    normals = cross[chosen] / area[chosen, None]
    return a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen] + 1e-3 * normals, normals


def rays_to_sky(points: np.ndarray, patches: np.ndarray) -> np.ndarray:
    """Rays ``(points, patches, 6)`` from each point to each patch, float32."""
    rays = np.empty((len(points), len(patches), 6), np.float32)
    rays[..., :3], rays[..., 3:] = points[:, None], patches
    return rays


def draw(path: pathlib.Path, scene: rdh.Scene, points: np.ndarray, hours: np.ndarray) -> None:
    """The points that a bird in the south-west sees, coloured by their hours."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    low, high = scene.bounds
    bird = (low + high) / 2 + np.array([-0.55, -1.0, 0.9]) * np.linalg.norm((high - low)[:2]) * 0.6
    towards = bird - points
    seen = ~scene.test_occlusions(np.concatenate([points, towards], axis=1), tfar=1.0)
    ahead = (low + high) / 2 - bird
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    depth = -towards[seen] @ ahead
    x, y = -towards[seen] @ right / depth, -towards[seen] @ np.cross(right, ahead) / depth
    figure, axes = pyplot.subplots(figsize=(9, 6), dpi=110)
    axes.set_facecolor("#202020")
    order = np.argsort(-depth)
    dots = axes.scatter(x[order], y[order], c=hours[seen][order], s=4, linewidths=0, cmap="inferno", rasterized=True)
    axes.set(aspect="equal", xticks=[], yticks=[], title="Hours of sunlight a year on the facades of a town at 48 degrees north")
    figure.colorbar(dots, label="hours a year", shrink=0.7)
    figure.savefig(path, bbox_inches="tight")
    pyplot.close(figure)


def main(argv: list[str] | None = None) -> common.Times:
    """Casts, writes ``hours.npy`` (x, y, z, hours) and ``sunlight.png``, and returns what was measured."""
    given = common.arguments(__doc__).parse_args(argv)
    out = common.folder(given.out)
    scene = rdh.load(given.scene or "quarter")
    points, normals = facade_points(scene, 1_000 if given.small else 60_000)
    patches = sky_patches()
    rays = rays_to_sky(points, patches)
    # Patches behind the wall itself are out of sight without any ray.
    ahead = normals @ patches.T > 0
    visible = ahead & ~scene.test_occlusions(rays)
    hours = visible @ hours_by_patch(patches)
    np.save(out / "hours.npy", np.column_stack([points, hours]))
    draw(out / "sunlight.png", scene, points, hours)
    lit = hours > 0
    print(f"{len(points):,} points, {lit.sum():,} of them see the sun, {hours[lit].mean():.0f} hours a year on average: {out}")
    recorded = np.arange(len(points)) % 10 == 0
    training, test = rays[recorded][ahead[recorded]], rays[~recorded][ahead[~recorded]]
    times = common.study(scene, training, test, out, occluded=True, rounds=given.rounds, dask=not given.no_dask)
    times.print()
    return times


if __name__ == "__main__":
    main()
    sys.exit(0)
