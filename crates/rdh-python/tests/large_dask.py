"""10^8 rays on a cluster of two processes, one of which is killed on the way: as if one process had cast them all, and the tree in
memory once. Run by hand (about five minutes on 2 cores): python large_dask.py [TREE.rdh] [--rays N]
"""

import argparse
import os
import pathlib
import signal
import sys
import tempfile
import threading
import time
import zlib

import dask.array as da
import numpy as np
from dask.distributed import Client, LocalCluster

import rdh
import rdh.dask

BLOCK = 1_000_000


def rays_of(first: int, last: int, bounds: np.ndarray) -> np.ndarray:
    """Rays ``(last - first, 6)`` float32 between points of the scene's box; their seed is where they begin."""
    points = np.random.default_rng(first).random((2, last - first, 3), np.float32)
    low, size = bounds[0].astype(np.float32), (bounds[1] - bounds[0]).astype(np.float32)
    return np.concatenate([low + points[0] * size, (points[1] - points[0]) * size], axis=1)


def make(bounds: np.ndarray, block_info: dict | None = None) -> np.ndarray:
    """A block of rays."""
    first, last = block_info[None]["array-location"][0]
    return rays_of(first, last, bounds)


def digest(t_hit: np.ndarray, ids: np.ndarray) -> np.ndarray:
    """A block's number of rays, number of hits, and checksum of all bits: ``(1, 3)``."""
    return np.array([[len(ids), np.isfinite(t_hit).sum(), zlib.crc32(t_hit.tobytes() + ids.tobytes())]], np.int64)


def pss(pid: int, path: pathlib.Path) -> float:
    """Mebibytes of a file that are in memory on a process's account."""
    total, inside = 0, False
    for line in pathlib.Path(f"/proc/{pid}/smaps").read_text().splitlines():
        if "-" in line.split(" ")[0]:
            inside = line.endswith(str(path))
        elif inside and line.startswith("Pss:"):
            total += int(line.split()[1])
    return total / 1024


def main() -> int:
    """Casts twice and compares block by block."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tree", nargs="?", type=pathlib.Path)
    parser.add_argument("--rays", type=int, default=100_000_000)
    given = parser.parse_args()
    path = given.tree or pathlib.Path(tempfile.mkdtemp()) / "kitchen.rdh"
    if not given.tree:
        rdh.load("country-kitchen", scenes=pathlib.Path(__file__).parents[4] / "shared" / "scenes").save(path)
    path = path.resolve()
    scene = rdh.open(path)
    print(f"{scene}: {path.stat().st_size / 2**20:.0f} MiB")
    chunks = da.core.normalize_chunks((BLOCK, 6), (given.rays, 6))
    rays = da.map_blocks(make, scene.bounds, chunks=chunks, dtype=np.float32)
    hits = rdh.dask.cast(path, rays)
    digests = da.map_blocks(
        digest, hits["t_hit"], hits["primitive_ids"], dtype=np.int64, new_axis=1, chunks=((1,) * len(chunks[0]), (3,))
    )
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        shares: list[list[float]] = []

        def disturb() -> None:
            time.sleep(15)
            pids = list(client.run(os.getpid).values())
            shares.append([pss(pid, path) for pid in (*pids, os.getpid())])
            os.kill(pids[0], signal.SIGKILL)

        disturber = threading.Thread(target=disturb)
        disturber.start()
        start = time.perf_counter()
        by_cluster = digests.compute()
        secs = time.perf_counter() - start
        disturber.join()
    print(f"cluster: {given.rays:,} rays in {secs:.1f} s; a worker was killed")
    print(f"the file's share in memory, MiB: workers and client {[round(s) for s in shares[0]]}, together {sum(shares[0]):.0f}")
    start = time.perf_counter()
    by_one = []
    for first in range(0, given.rays, BLOCK):
        block = rays_of(first, min(first + BLOCK, given.rays), scene.bounds)
        found = scene.cast_rays(block, fields=["t_hit", "primitive_ids"], threads=1)
        by_one.append(digest(found["t_hit"], found["primitive_ids"])[0])
    print(f"one process, one thread: {time.perf_counter() - start:.1f} s")
    same = np.array_equal(by_cluster, by_one)
    print(f"{by_cluster[:, 0].sum():,} rays, {by_cluster[:, 1].sum():,} hits; {len(by_one)} blocks, all the same bits: {same}")
    return 0 if same else 3


if __name__ == "__main__":
    sys.exit(main())
