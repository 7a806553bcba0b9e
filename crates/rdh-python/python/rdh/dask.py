"""Beyond one machine: rays in Dask arrays, and studies on a cluster.

``cast`` casts a Dask array of rays, of any size, block by block through a saved tree, which each machine maps once; ``study``
shares out the jobs of ``rdh study``. Both only name files, so these must lie where all workers find them under the same
path. Clusters without Dask (HyperQueue, Slurm) take the program's ``--shard`` and ``--range`` instead: docs/clusters.md.
"""

from __future__ import annotations

import collections
import ctypes
import functools
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import rdh
from rdh._rdh import _reopen

if TYPE_CHECKING:
    from os import PathLike

__all__ = ["cast", "study"]

# Fields of `rdh.Scene.cast_rays`: dtype, and how many numbers a ray has.
_FIELDS: dict[str, tuple[type[np.generic], int]] = {
    "t_hit": (np.float32, 0),
    "geometry_ids": (np.uint32, 0),
    "primitive_ids": (np.uint32, 0),
    "primitive_uvs": (np.float32, 2),
    "primitive_normals": (np.float32, 3),
}


def cast(
    accel_path: str | PathLike[str],
    rays: Any,
    query: Literal["closest", "occluded", "count"] = "closest",
    *,
    fields: Sequence[str] = ("t_hit", "primitive_ids"),
    threads: int = 1,
) -> Any:
    """Casts a Dask array of rays ``(..., 6)`` or ``(..., 8)`` through the tree in a ``.rdh`` file. Lazy: nothing is cast before
    results are computed.

    ``query`` is ``closest`` for a dictionary of Dask arrays, those of ``Scene.cast_rays`` that are named in ``fields``; ``occluded`` for
    one of bool, as ``Scene.test_occlusions`` returns; ``count`` for one of int32, as ``Scene.count_intersections`` does. Blocks are
    those of the rays. Results are the same bit for bit as if all rays were cast at once, wherever blocks are computed and
    however often. ``threads`` cast a block; Dask casts as many blocks at a time as its workers have threads.

    Workers open the file once and keep it open; that it is the same file everywhere is checked.

    Raises ``OSError`` or ``ValueError`` for a file that is no tree, ``ValueError`` naming any other wrong argument.

    >>> import pathlib, tempfile, dask.array, rdh.dask
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "balls.rdh"
    >>> rdh.load("balls4").save(path)
    >>> rays = dask.array.random.default_rng(1).normal(size=(10_000, 6), chunks=(1_000, 6))
    >>> hits = rdh.dask.cast(path, rays)
    >>> hits["t_hit"]
    dask.array<_field, shape=(10000,), dtype=float32, chunksize=(1000,), chunktype=numpy.ndarray>
    >>> int(rdh.dask.cast(path, rays, "occluded").sum().compute()) > 0
    True
    """
    if not isinstance(rays, import_module("dask.array").Array):
        raise ValueError("rays: a Dask array is needed; rdh.open(...).cast_rays takes others")
    if rays.ndim == 0 or rays.shape[-1] not in (6, 8):
        raise ValueError(f"rays: the shape must be (..., 6) or (..., 8), not {rays.shape}")
    if threads < 1:
        raise ValueError(f"threads: {threads} is not a number of threads")
    # What tells this file from any other, as in a pickled scene.
    _, tree = rdh.open(accel_path).__reduce__()
    # All numbers of a ray are needed together.
    rays = rays.rechunk({rays.ndim - 1: -1})
    ray = rays.ndim - 1
    one: dict[str, Any] = {"drop_axis": ray, "threads": threads}
    if query == "occluded":
        return rays.map_blocks(_occluded, tree, dtype=bool, meta=_empty(ray, bool), **one)
    if query == "count":
        return rays.map_blocks(_count, tree, dtype=np.int32, meta=_empty(ray, np.int32), **one)
    if query != "closest":
        raise ValueError(f"query: '{query}' is none of closest, occluded, count")
    unknown = [field for field in fields if field not in _FIELDS]
    if unknown:
        raise ValueError(f"fields: '{unknown[0]}' is none of {', '.join(_FIELDS)}")
    # Each block becomes a dictionary, out of which the arrays are then taken: rays are cast once for all fields.
    blocks = rays.map_blocks(_closest, tree, list(fields), dtype=object, meta=_empty(ray, object), **one)
    return {field: _column(blocks, field) for field in fields}


def study(
    client: Any,
    arguments: Sequence[str],
    out: str | PathLike[str],
    *,
    shards: int | None = None,
    program: str = "rdh",
) -> dict[str, Any]:
    """Runs ``rdh study`` with these arguments on the workers of a ``distributed.Client``, in as many parts as ``shards`` says (four a
    worker), and joins them: the document that ``rdh merge --json`` prints.

    Each worker runs one part at a time, whatever threads it has, so that timings don't disturb each other; give every worker
    a machine of its own, or at least cores. ``out`` is a folder that all workers share: part I of N is written to ``part-I-of-N`` in it,
    job by job, and a part whose worker is lost goes on from there on another one. So does a call that is repeated.

    Raises ``ValueError`` for arguments that this function sets itself; ``RuntimeError`` with what the program printed if it fails.
    """
    mine = [a for a in arguments if a.split("=")[0] in ("--shard", "--out", "--resume", "--json")]
    if mine:
        raise ValueError(f"arguments: {mine[0]} is set by this function")
    count = shards or 4 * max(1, len(client.scheduler_info()["workers"]))
    folder = pathlib.Path(out).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    parts = [folder / f"part-{number}-of-{count}" for number in range(1, count + 1)]
    commands = [
        [program, "study", *arguments, "--shard", f"{number}/{count}", "--out", str(part), "--resume"]
        for number, part in enumerate(parts, 1)
    ]
    client.gather(client.map(_run_alone, commands, pure=False, retries=2))
    merged = _run([program, "merge", "--json", *map(str, parts)])
    return dict(json.loads(merged))


def _column(blocks: Any, field: str) -> Any:
    dtype, numbers = _FIELDS[field]
    if numbers == 0:
        return blocks.map_blocks(_field, field, dtype=dtype, meta=_empty(blocks.ndim, dtype))
    more = {"new_axis": blocks.ndim, "chunks": (*blocks.chunks, (numbers,))}
    return blocks.map_blocks(_field, field, dtype=dtype, meta=_empty(blocks.ndim + 1, dtype), **more)


def _empty(axes: int, dtype: Any) -> Any:
    return np.empty((0,) * axes, dtype)


# Trees that are open in this process, by path and checksum. A cluster that casts through many gets the last ones.
_open: collections.OrderedDict[tuple[str, int], rdh.Scene] = collections.OrderedDict()
_opening = threading.Lock()


def _opened(path: str, checksum: int) -> rdh.Scene:
    """The tree, opened once a process."""
    with _opening:
        if (path, checksum) not in _open:
            _open[path, checksum] = _reopen(path, checksum)
        _open.move_to_end((path, checksum))
        while len(_open) > 8:
            _open.popitem(last=False)
        return _open[path, checksum]


def _closest(rays: Any, tree: tuple[str, int], fields: list[str], threads: int) -> dict[str, Any]:
    return _opened(*tree).cast_rays(rays, threads, fields=fields)


def _occluded(rays: Any, tree: tuple[str, int], threads: int) -> Any:
    return _opened(*tree).test_occlusions(rays, threads=threads)


def _count(rays: Any, tree: tuple[str, int], threads: int) -> Any:
    return _opened(*tree).count_intersections(rays, threads)


def _field(block: dict[str, Any], field: str) -> Any:
    return block[field]


# Held while a part of a study runs in this process: one at a time a worker.
_timing = threading.Lock()


def _run_alone(command: list[str]) -> str:
    with _timing:
        return _run(command)


def _run(command: list[str]) -> str:
    """What a program prints; it ends with this process, even if that is killed."""
    program = shutil.which(command[0])
    if program is None:
        raise RuntimeError(f"there is no program '{command[0]}' on this machine: cargo install --path crates/rdh-cli")
    if sys.platform == "linux":
        libc = ctypes.CDLL(None)
        # PR_SET_PDEATHSIG.
        end_with_us = functools.partial(libc.prctl, 1, int(signal.SIGKILL))
        done = subprocess.run([program, *command[1:]], capture_output=True, text=True, check=False, preexec_fn=end_with_us)
    else:
        done = subprocess.run([program, *command[1:]], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr[-4000:]}")
    return done.stdout
