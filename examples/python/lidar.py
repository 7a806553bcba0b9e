"""A spinning LIDAR on a car that drives through a town: 100 sweeps of 64 x 2048 beams, as point clouds.

Every tenth sweep is recorded, and the scene tuned for it; the others are cast and timed.
"""

from __future__ import annotations

import pathlib
import sys

import common
import numpy as np

import rdh

# As of a Velodyne HDL-64E, roughly: beams from 22 degrees up to 22 degrees down, at most so many metres.
ELEVATIONS = np.radians(np.linspace(22.15, -22.15, 64))
REACH = 120.0


def beams(firings: int) -> np.ndarray:
    """Directions ``(64, firings, 3)`` of a sweep; x is ahead, z is up."""
    azimuths = np.linspace(0, 2 * np.pi, firings, endpoint=False)
    flat, up = np.cos(ELEVATIONS)[:, None], np.sin(ELEVATIONS)[:, None]
    return np.stack([flat * np.cos(azimuths), flat * np.sin(azimuths), np.broadcast_to(up, (64, firings))], axis=-1)


def sweeps(scene: rdh.Scene, count: int, firings: int) -> np.ndarray:
    """Rays ``(count, 64, firings, 6)`` along the scene's path, or around the middle of a scene without one; float32."""
    path = next(iter(scene.paths.values()), None) or circle(scene, count)
    views = [path[k] for k in np.linspace(0, len(path) - 1, count).astype(int)]
    eyes = np.array([view["eye"] for view in views])
    ahead = np.array([view["target"] for view in views])[:, :2] - eyes[:, :2]
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    turns = np.zeros((count, 3, 3))
    turns[:, 0, :2], turns[:, 1, 0], turns[:, 1, 1], turns[:, 2, 2] = ahead, -ahead[:, 1], ahead[:, 0], 1
    directions = np.einsum("hwi,pij->phwj", beams(firings), turns)
    rays = np.empty((*directions.shape[:3], 6), np.float32)
    rays[..., :3], rays[..., 3:] = eyes[:, None, None], directions
    return rays


def circle(scene: rdh.Scene, count: int) -> list[dict]:
    """Places around the middle of the scene, at a third of its height."""
    low, high = scene.bounds
    angles = np.linspace(0, 2 * np.pi, count)
    middle, radius = (low + high) / 2, (high - low)[:2].min() / 6
    ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    eyes = middle + radius * ring
    eyes[:, 2] = low[2] + (high - low)[2] / 3
    return [{"eye": eye, "target": eye + step} for eye, step in zip(eyes, np.roll(ring, -1, axis=0) - ring, strict=True)]


def points_of(rays: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """Where beams end that meet something within reach, ``(n, 3)`` float32."""
    rays, distances = rays.reshape(-1, 6), distances.reshape(-1)
    met = distances <= REACH
    return rays[met, :3] + distances[met, None] * rays[met, 3:]


def write_ply(path: pathlib.Path, points: np.ndarray) -> None:
    """A point cloud, binary."""
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())


def draw(path: pathlib.Path, points: np.ndarray, eyes: np.ndarray) -> None:
    """The points of all sweeps from above, lighter where they are higher, and the way of the car."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(9, 6), dpi=110)
    order = np.argsort(points[:, 2])
    dots = axes.scatter(*points[order, :2].T, c=points[order, 2], s=0.15, linewidths=0, cmap="viridis", rasterized=True)
    axes.plot(*eyes[:, :2].T, color="tab:red", linewidth=1.5, label="way of the car")
    axes.set(aspect="equal", xlabel="x in m", ylabel="y in m", title="Points of a LIDAR that drives through a town")
    figure.colorbar(dots, label="height in m", shrink=0.7)
    axes.legend(loc="upper right")
    figure.savefig(path, bbox_inches="tight")
    pyplot.close(figure)


def main(argv: list[str] | None = None) -> common.Times:
    """Casts, writes ``sweep-NNN.ply`` and ``lidar.png``, and returns what was measured."""
    given = common.arguments(__doc__).parse_args(argv)
    count, firings = (10, 128) if given.small else (100, 2048)
    out = common.folder(given.out)
    scene = rdh.load(given.scene or "quarter")
    rays = sweeps(scene, count, firings)
    clouds = []
    for number, sweep in enumerate(rays):
        points = points_of(sweep, scene.cast_rays(sweep, fields=["t_hit"])["t_hit"])
        write_ply(out / f"sweep-{number:03}.ply", points)
        clouds.append(points)
    points = np.concatenate(clouds)
    draw(out / "lidar.png", points[:: max(1, len(points) // 400_000)], rays[:, 0, 0, :3])
    print(f"{len(points):,} points of {count} sweeps: {out}")
    every_tenth = np.arange(count) % 10 == 5
    dask = not given.no_dask
    times = common.study(scene, rays[every_tenth], rays[~every_tenth], out, occluded=False, rounds=given.rounds, dask=dask)
    times.print()
    return times


if __name__ == "__main__":
    main()
    sys.exit(0)
