"""What the examples share: the same rays, cast plainly, by trimesh, through a tuned scene, and by Dask."""

from __future__ import annotations

import argparse
import dataclasses
import pathlib
import statistics
import tempfile
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import rdh
import rdh.trimesh


@dataclasses.dataclass
class Times:
    """How fast rays were cast, and whether all said the same."""

    rays: int
    # Rays a second on one thread, by CPU time, of each way to cast.
    rays_per_sec: dict[str, float]
    # The same, over trimesh's; empty without trimesh and embreex.
    speedup: dict[str, float]
    # Share of rays of which embreex says something else: those that pass edges so near that rounding decides.
    differ: float
    # What `Scene.tune` chose, and why.
    spec: str
    reason: str
    # Rays a second of the whole cluster, by the clock; nothing without Dask.
    dask_rays_per_sec: float | None

    def print(self) -> None:
        """A table."""
        print(f"{self.rays:,} rays, one thread:")
        for way, speed in self.rays_per_sec.items():
            times = f"{self.speedup[way]:5.2f} x trimesh + embreex" if way in self.speedup else ""
            print(f"  {way:24} {speed / 1e6:7.2f} Mrays/s  {times}")
        if self.dask_rays_per_sec is not None:
            print(f"  {'Dask, 2 processes':24} {self.dask_rays_per_sec / 1e6:7.2f} Mrays/s by the clock")
        print(f"  tuned: {self.spec}: {self.reason}")
        print(f"  embreex differs in {self.differ:.6f} of the rays")


def arguments(about: str) -> argparse.ArgumentParser:
    """What all examples can be told."""
    parser = argparse.ArgumentParser(description=about.splitlines()[0])
    parser.add_argument("--scene", help="a mesh file, or a generated scene by name")
    parser.add_argument("--out", type=pathlib.Path, help="folder for results [default: a new temporary one]")
    parser.add_argument("--small", action="store_true", help="few rays, for tests")
    parser.add_argument("--rounds", type=int, default=3, help="how often rays are cast for timing [default: %(default)s]")
    parser.add_argument("--no-dask", action="store_true", help="don't start a cluster")
    return parser


def folder(out: pathlib.Path | None) -> pathlib.Path:
    """The folder for results, made if need be."""
    out = out or pathlib.Path(tempfile.mkdtemp(prefix="rdh-"))
    out.mkdir(parents=True, exist_ok=True)
    return out


def study(
    scene: rdh.Scene, training: np.ndarray, rays: np.ndarray, out: pathlib.Path, *, occluded: bool, rounds: int, dask: bool
) -> Times:
    """Tunes for ``training`` rays, casts ``rays`` ``(..., 6)`` or ``(..., 8)`` in all ways, compares answers, then times, and saves the tuned tree.

    The scene is tuned afterwards. ``occluded`` asks whether rays hit anything, else for the nearest hit.
    """
    rays = np.ascontiguousarray(rays.reshape(-1, rays.shape[-1]))
    plain = rdh.Scene(scene.vertices, scene.faces)
    with rdh.record(scene) as profile:
        cast(scene, training, occluded)
    evidence = scene.tune(profile)
    ways: dict[str, Callable[[], np.ndarray]] = {
        "rdh, plain": lambda: cast(plain, rays, occluded),
        "rdh, recorded and tuned": lambda: cast(scene, rays, occluded),
    }
    beside = beside_trimesh(scene, rays, occluded)
    ways |= beside
    answers = {way: ask() for way, ask in ways.items()}
    expected = answers["rdh, plain"]
    assert np.array_equal(answers["rdh, recorded and tuned"], expected)
    differ = float((answers["trimesh + embreex"] != expected).mean()) if beside else 0.0
    secs: dict[str, list[float]] = {way: [] for way in ways}
    for turn in range(rounds):
        order = list(ways)[turn % len(ways) :] + list(ways)[: turn % len(ways)]
        for way in order:
            start = time.process_time()
            ways[way]()
            secs[way].append(time.process_time() - start)
    speeds = {way: len(rays) / statistics.median(all_secs) for way, all_secs in secs.items()}
    speedup = {
        way: statistics.median(np.array(secs["trimesh + embreex"]) / np.array(secs[way])) for way in (ways if beside else ())
    }
    path = out / "tuned.rdh"
    scene.save(path)
    by_dask = cast_by_dask(path, rays, occluded, expected) if dask else None
    return Times(len(rays), speeds, speedup, differ, evidence["spec"], evidence["reason"], by_dask)


def cast(scene: rdh.Scene, rays: np.ndarray, occluded: bool) -> np.ndarray:
    """On one thread: faces of the nearest hits, or whether there are any."""
    if occluded:
        return scene.test_occlusions(rays, threads=1)
    return scene.cast_rays(rays, threads=1, fields=["primitive_ids"])["primitive_ids"].view(np.int32)


def beside_trimesh(scene: rdh.Scene, rays: np.ndarray, occluded: bool) -> dict[str, Callable[[], np.ndarray]]:
    """The same by trimesh with embreex, and with our intersector in its place; nothing if they are not installed."""
    try:
        import trimesh
        from trimesh.ray.ray_pyembree import RayMeshIntersector
    except ImportError as error:
        print(f"trimesh with embreex is left out: {error}")
        return {}
    mesh = trimesh.Trimesh(scene.vertices, scene.faces, process=False)
    theirs, ours = RayMeshIntersector(mesh), rdh.trimesh.RayMeshIntersector(mesh, threads=1)
    apart = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:6])
    if rays.shape[1] == 8:
        # Of trimesh's methods none takes an end of rays: where they hit first is compared with it.
        return {
            "trimesh + embreex": lambda: blocked(theirs, *apart, rays[:, 7]),
            "trimesh + rdh": lambda: blocked(ours, *apart, rays[:, 7]),
        }
    if occluded:
        return {
            "trimesh + embreex": lambda: theirs.intersects_any(*apart),
            "trimesh + rdh": lambda: ours.intersects_any(*apart),
        }
    return {
        "trimesh + embreex": lambda: theirs.intersects_first(*apart),
        "trimesh + rdh": lambda: ours.intersects_first(*apart),
    }


def blocked(intersector: Any, origins: np.ndarray, directions: np.ndarray, t_max: np.ndarray) -> np.ndarray:
    """Whether rays hit something before their end, by any intersector of trimesh's kind."""
    places, ray, _ = intersector.intersects_location(origins, directions, multiple_hits=False)
    result = np.zeros(len(origins), bool)
    length = np.linalg.norm(directions[ray], axis=1) * t_max[ray]
    result[ray] = np.linalg.norm(places - origins[ray], axis=1) <= length
    return result


def cast_by_dask(path: pathlib.Path, rays: np.ndarray, occluded: bool, expected: np.ndarray) -> float | None:
    """Casts on two processes, checks that the answers are the same, and returns rays a second."""
    try:
        import dask.array as da
        from dask.distributed import Client, LocalCluster
    except ImportError as error:
        print(f"Dask is left out: {error}")
        return None
    import rdh.dask

    # Workers read their blocks themselves; on a cluster, the file lies where all find it.
    file = path.with_name("rays.npy")
    np.save(file, rays)
    chunks = da.core.normalize_chunks((len(rays) // 32 + 1, -1), rays.shape)
    blocks = da.map_blocks(read_block, str(file), chunks=chunks, dtype=np.float32)
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster),
    ):
        start = time.perf_counter()
        if occluded:
            found = rdh.dask.cast(path, blocks, "occluded").compute()
        else:
            found = rdh.dask.cast(path, blocks, fields=["primitive_ids"])["primitive_ids"].compute().view(np.int32)
        secs = time.perf_counter() - start
    file.unlink()
    assert np.array_equal(found, expected)
    return len(rays) / secs


def read_block(file: str, block_info: Any = None) -> np.ndarray:
    """The rays of a block, out of the file with all of them."""
    first, last = block_info[None]["array-location"][0]
    return np.load(file, mmap_mode="r")[first:last]
