"""What a walker sees of the country: lines of sight from a path over terrain to a grid of places on the ground.

Every tenth place of the path is recorded; lines from the others are cast and timed.
"""

from __future__ import annotations

import pathlib
import sys

import common
import numpy as np

import rdh


def on_ground(scene: rdh.Scene, places: np.ndarray, height: float) -> np.ndarray:
    """Points ``(n, 3)`` so high above the ground at places ``(n, 2)``: the ground is what a plumb line meets first."""
    low, high = scene.bounds
    top = high[2] + 1.0
    rays = np.column_stack([places, np.full(len(places), top), np.zeros((len(places), 2)), np.full(len(places), -1.0)])
    depth = scene.cast_rays(rays, fields=["t_hit"])["t_hit"]
    ground = np.where(np.isfinite(depth), top - depth, low[2])
    return np.column_stack([places, ground + height])


def path_across(scene: rdh.Scene, count: int) -> np.ndarray:
    """Places ``(count, 2)`` of a winding path from one side to the other."""
    low, high = scene.bounds[:, :2]
    along = np.linspace(0.08, 0.92, count)
    across = 0.5 + 0.2 * np.sin(2 * np.pi * along) + 0.05 * np.sin(14 * along)
    return low + np.column_stack([along, across]) * (high - low)


def grid(scene: rdh.Scene, side: int) -> np.ndarray:
    """Places ``(side * side, 2)`` all over the scene, row by row."""
    low, high = scene.bounds[:, :2]
    x, y = np.meshgrid(np.linspace(0.01, 0.99, side), np.linspace(0.01, 0.99, side))
    return low + np.column_stack([x.ravel(), y.ravel()]) * (high - low)


def lines(eyes: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Rays ``(eyes, targets, 8)`` that end at the target, at t = 1; float32."""
    rays = np.empty((len(eyes), len(targets), 8), np.float32)
    rays[..., :3], rays[..., 3:6], rays[..., 6:] = eyes[:, None], targets - eyes[:, None], [0, 1]
    return rays


def draw(path: pathlib.Path, scene: rdh.Scene, targets: np.ndarray, share: np.ndarray, eyes: np.ndarray) -> None:
    """A map: from which share of the path each place is seen."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    side = round(len(targets) ** 0.5)
    (left, bottom), (right, top) = scene.bounds[:, :2]
    heights = targets[:, 2].reshape(side, side)
    figure, axes = pyplot.subplots(figsize=(8, 6.5), dpi=110)
    image = axes.imshow(100 * share.reshape(side, side), origin="lower", extent=(left, right, bottom, top), cmap="viridis")
    axes.contour(heights, extent=(left, right, bottom, top), colors="white", linewidths=0.4, levels=12, alpha=0.7)
    axes.plot(*eyes[:, :2].T, color="tab:red", linewidth=1.8, label="path")
    axes.set(xlabel="x in m", ylabel="y in m", title="From how much of the path each place is seen")
    axes.legend(loc="upper right")
    figure.colorbar(image, label="% of the path", shrink=0.8)
    figure.savefig(path, bbox_inches="tight")
    pyplot.close(figure)


def main(argv: list[str] | None = None) -> common.Times:
    """Casts, writes ``seen.npy`` (x, y, z, share of the path) and ``sight.png``, and returns what was measured."""
    given = common.arguments(__doc__).parse_args(argv)
    steps, side = (20, 24) if given.small else (200, 160)
    out = common.folder(given.out)
    scene = rdh.load(given.scene or "terrain")
    # Eyes 1.7 m and places 0.5 m above the ground; in scenes of another size, as much smaller or larger.
    unit = np.linalg.norm((scene.bounds[1] - scene.bounds[0])[:2]) / 3000
    eyes = on_ground(scene, path_across(scene, steps), 1.7 * unit)
    targets = on_ground(scene, grid(scene, side), 0.5 * unit)
    rays = lines(eyes, targets)
    seen = ~scene.test_occlusions(rays)
    share = seen.mean(axis=0)
    np.save(out / "seen.npy", np.column_stack([targets, share]))
    draw(out / "sight.png", scene, targets, share, eyes)
    print(f"{rays[..., 0].size:,} lines of sight, {100 * seen.mean():.1f} % are free: {out}")
    every_tenth = np.arange(steps) % 10 == 5
    training, test = rays[every_tenth], rays[~every_tenth]
    times = common.study(scene, training, test, out, occluded=True, rounds=given.rounds, dask=not given.no_dask)
    times.print()
    return times


if __name__ == "__main__":
    main()
    sys.exit(0)
