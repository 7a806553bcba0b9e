"""``python -m rdh.bench``: our queries beside embreex, trimesh and Open3D, as far as they are installed.

The same rays go to all, on one thread; every round casts all of them in turn, beginning with another contestant. Times are CPU
times of the process, a ratio is the median of the rounds' ratios. Answers are compared before times: the share of rays with
another face is printed, and more than 2 in 1,000 is an error (exit code 3). Differences below that are rays past edges and at
faces that touch, where Embree's arithmetic decides otherwise. Numbers of all hits are only printed: others count shared edges and
touching faces differently.
"""

from __future__ import annotations

import argparse
import functools
import json
import pathlib
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib import import_module
from typing import Any

import numpy as np

import rdh
import rdh.trimesh

# For each ray its face, -1 for none, or how many hits it has; or for each hit its ray.
Answer = np.ndarray[Any, Any]
Query = Callable[[], Answer]
# More rays than this share with different answers is an error.
TOLERATED = 2e-3


@dataclass
class Row:
    """One contestant in one column."""

    scene: str
    rays: str
    query: str
    engine: str
    mrays_per_sec: float
    # How many times as many rays a second we cast; above 1 we are faster.
    speedup: float
    # Share of rays whose answer is not ours.
    differ: float

    @property
    def is_wrong(self) -> bool:
        """Whether too many rays have another answer. Numbers of hits are not held to it: others count edges and touching faces twice."""
        return self.differ > TOLERATED and self.query not in ("all hits", "count")


@dataclass
class Scene:
    """A mesh, ready for all contestants."""

    name: str
    vertices: np.ndarray[Any, Any]
    faces: np.ndarray[Any, Any]
    # Rays of a camera, (n, 6) float32.
    coherent: np.ndarray[Any, Any]


def icosphere(side: int) -> Scene:
    """A ball of 81,920 triangles, seen from outside by a camera of ``side`` x ``side`` pixels."""
    mesh = import_module("trimesh").creation.icosphere(subdivisions=6)
    x, y = np.meshgrid(np.linspace(-0.42, 0.42, side), np.linspace(0.42, -0.42, side))
    directions = np.stack([x.ravel(), y.ravel(), np.full(x.size, -1.0)], axis=1)
    eyes = np.broadcast_to([0.0, 0.0, 2.8], directions.shape)
    rays = np.concatenate([eyes, directions], axis=1).astype(np.float32)
    return Scene("icosphere", np.asarray(mesh.vertices), np.asarray(mesh.faces), rays)


def loaded(name: str, folder: pathlib.Path | None, side: int) -> Scene:
    """A mesh file or a scene by name, seen by its first camera, or from a corner of its box."""
    name, _, view = name.partition(":")
    scene = rdh.load(name, "bvh8(quick)+sah", scenes=folder)
    if scene.views:
        rays = scene.camera_rays(side, side, view or None).reshape(-1, 6).astype(np.float32)
    else:
        low, high = scene.bounds
        grid = np.linspace(0, 1, side)
        x, y = (part.ravel() for part in np.meshgrid(grid, grid))
        targets = low + np.stack([x, y, 0.5 * np.ones_like(x)], axis=1) * (high - low)
        eyes = np.broadcast_to(high + (high - low) * 0.5, targets.shape)
        rays = np.concatenate([eyes, targets - eyes], axis=1).astype(np.float32)
    return Scene(name, scene.vertices, scene.faces.astype(np.int64), rays)


def incoherent(scene: Scene, seed: int = 1) -> np.ndarray[Any, Any]:
    """As many rays as ``scene.coherent`` has, between random points of the scene's box, float32."""
    rng = np.random.default_rng(seed)
    low, high = scene.vertices.min(axis=0), scene.vertices.max(axis=0)
    points = rng.uniform(low, high, (2, len(scene.coherent), 3))
    return np.concatenate([points[0], points[1] - points[0]], axis=1).astype(np.float32)


def our_queries(scene: Scene, spec: str, rays: np.ndarray[Any, Any], mesh: Any) -> dict[str, Query]:
    """What we answer, by query."""
    ours = rdh.Scene(scene.vertices, scene.faces, spec, threads=1)
    beside_trimesh = rdh.trimesh.RayMeshIntersector(mesh, spec, threads=1)
    apart = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    return {
        "closest": lambda: ours.cast_rays(rays, 1, fields=["primitive_ids"])["primitive_ids"].view(np.int32),
        "closest, all fields": lambda: ours.cast_rays(rays, 1)["primitive_ids"].view(np.int32),
        "occluded": lambda: ours.test_occlusions(rays, threads=1),
        "first": lambda: beside_trimesh.intersects_first(*apart),
        "any": lambda: beside_trimesh.intersects_any(*apart),
        "first locations": lambda: beside_trimesh.intersects_location(*apart, multiple_hits=False)[1],
        "all hits": lambda: beside_trimesh.intersects_location(*apart)[1],
        "count": lambda: ours.count_intersections(rays, 1),
    }


def trimesh_queries(rays: np.ndarray[Any, Any], mesh: Any) -> dict[str, Query]:
    """What trimesh answers by embreex."""
    theirs = import_module("trimesh.ray.ray_pyembree").RayMeshIntersector(mesh)
    apart = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    return {
        "first": lambda: theirs.intersects_first(*apart),
        "any": lambda: theirs.intersects_any(*apart),
        "first locations": lambda: theirs.intersects_location(*apart, multiple_hits=False)[1],
        "all hits": lambda: theirs.intersects_location(*apart)[1],
    }


def embreex_queries(scene: Scene, rays: np.ndarray[Any, Any]) -> dict[str, Query]:
    """What embreex answers, as it is set by default (robust)."""
    theirs = import_module("embreex.rtcore_scene").EmbreeScene()
    import_module("embreex.mesh_construction").TriangleMesh(theirs, scene.vertices.astype(np.float32), scene.faces.astype(np.int32))
    apart = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    return {
        "closest": lambda: theirs.run(*apart),
        "closest, all fields": lambda: theirs.run(*apart, output=True)["primID"],
        "occluded": lambda: theirs.run(*apart, query="OCCLUDED") != -1,
    }


def open3d_queries(scene: Scene, rays: np.ndarray[Any, Any]) -> dict[str, Query]:
    """What Open3D answers."""
    open3d = import_module("open3d")
    theirs = open3d.t.geometry.RaycastingScene(nthreads=1)
    tensor = open3d.core.Tensor
    theirs.add_triangles(tensor(scene.vertices.astype(np.float32)), tensor(scene.faces.astype(np.uint32)))
    shown = tensor(rays)
    return {
        "closest, all fields": lambda: theirs.cast_rays(shown, nthreads=1)["primitive_ids"].numpy().view(np.int32),
        "occluded": lambda: theirs.test_occlusions(shown, nthreads=1).numpy(),
        "count": lambda: theirs.count_intersections(shown, nthreads=1).numpy(),
    }


def contestants(scene: Scene, rays: np.ndarray[Any, Any], mesh: Any) -> Iterator[tuple[str, dict[str, Query]]]:
    """All that are installed; those that aren't are named on standard error."""
    makers: list[tuple[str, Callable[[], dict[str, Query]]]] = [
        ("embreex", lambda: embreex_queries(scene, rays)),
        ("trimesh", lambda: trimesh_queries(rays, mesh)),
        ("open3d", lambda: open3d_queries(scene, rays)),
    ]
    for name, make in makers:
        try:
            yield name, make()
        except ImportError as error:
            print(f"{name} is left out: {error}", file=sys.stderr)


def cpu_secs(query: Query) -> float:
    """CPU time of the whole process, so that it doesn't matter on which thread work is done."""
    start = time.process_time()
    query()
    return time.process_time() - start


def race(scene: Scene, kind: str, rays: np.ndarray[Any, Any], spec: str, rounds: int) -> Iterator[Row]:
    """Compares answers, then times, query by query."""
    mesh = import_module("trimesh").Trimesh(scene.vertices, scene.faces, process=False)
    ours = our_queries(scene, spec, rays, mesh)
    others = list(contestants(scene, rays, mesh))
    for query, ask in ours.items():
        field = [(f"rdh {spec}", ask)] + [(name, asked[query]) for name, asked in others if query in asked]
        of_hits = query in ("first locations", "all hits")
        answers = [np.bincount(a(), minlength=len(rays)) if of_hits else a() for _, a in field]
        differ = [float((answer != answers[0]).mean()) for answer in answers]
        times = np.zeros((rounds, len(field)))
        for turn in range(rounds):
            for k in range(len(field)):
                place = (turn + k) % len(field)
                times[turn, place] = cpu_secs(field[place][1])
        for place, (name, _) in enumerate(field):
            speedup = statistics.median(times[:, place] / times[:, 0])
            speed = len(rays) / statistics.median(times[:, place]) / 1e6
            yield Row(scene.name, kind, query, name, speed, speedup, differ[place])


def main(arguments: list[str] | None = None) -> int:
    """Runs the race; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m rdh.bench", description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--mesh", action="append", help="a mesh file, or a scene by name or name:view; may be repeated")
    parser.add_argument("--scenes", type=pathlib.Path, help="folder with a scenes.toml that names more scenes")
    parser.add_argument("--spec", default="bvh8(high)+sah", help="what we build (default: %(default)s)")
    parser.add_argument("--side", type=int, default=512, help="side x side rays (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="rounds of casting (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    given = parser.parse_args(arguments)
    if given.side < 1 or given.rounds < 1:
        parser.error("--side and --rounds must be 1 or more")
    try:
        import_module("trimesh")
    except ImportError:
        parser.error("trimesh is needed to compare with: pip install trimesh embreex")
    beside = pathlib.Path("../shared/scenes")
    folder = given.scenes or (beside if (beside / "scenes.toml").is_file() else None)
    names = given.mesh or (["country-kitchen"] if folder else [])
    scenes: list[Callable[[], Scene]] = [functools.partial(icosphere, given.side)]
    scenes += [functools.partial(loaded, name, folder, given.side) for name in names]
    rows: list[Row] = []
    if not given.json:
        print(f"{'scene':16} {'rays':10} {'query':20} {'engine':20} {'Mrays/s':>8} {'speed-up':>8} {'differ':>8}")
    for make in scenes:
        scene = make()
        for kind, rays in [("coherent", scene.coherent), ("incoherent", incoherent(scene))]:
            for row in race(scene, kind, rays, given.spec, given.rounds):
                rows.append(row)
                if not given.json:
                    print(
                        f"{row.scene:16} {row.rays:10} {row.query:20} {row.engine:20} {row.mrays_per_sec:8.2f} "
                        f"{row.speedup:8.2f} {row.differ:8.5f}",
                        flush=True,
                    )
    if given.json:
        print(json.dumps({"version": 1, "rows": [asdict(row) for row in rows]}, indent=1))
    return 3 if any(row.is_wrong for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
