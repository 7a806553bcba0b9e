"""Dask arrays of rays on a cluster of processes."""

import json
import os
import pathlib
import shutil
import signal
import stat
import subprocess
import sys
import time

import numpy as np
import pytest

pytest.importorskip("distributed")
import dask.array as da  # noqa: E402
from dask.distributed import Client, LocalCluster  # noqa: E402

import rdh  # noqa: E402
import rdh.dask  # noqa: E402

RAYS = 1_000_000
BLOCK = 50_000


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> pathlib.Path:
    """The kitchen where it is to be had, else a part of a town."""
    path = tmp_path_factory.mktemp("dask") / "tree.rdh"
    folder = pathlib.Path(__file__).parents[4] / "shared" / "scenes"
    scene = rdh.load("country-kitchen", scenes=folder) if (folder / "scenes.toml").is_file() else rdh.load("quarter")
    scene.save(path)
    return path


@pytest.fixture(scope="module")
def client():
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, Client(cluster) as client:
        yield client


def rays_of(path: pathlib.Path, count: int = RAYS, block: int = BLOCK) -> da.Array:
    """Rays between random points of the scene's box; each block has its own seed."""
    low, high = rdh.open(path).bounds

    def make(block_info=None) -> np.ndarray:
        (first, last), _ = block_info[None]["array-location"]
        a, b = np.random.default_rng(first).uniform(low, high, (2, last - first, 3))
        return np.concatenate([a, b - a], axis=1).astype(np.float32)

    return da.map_blocks(make, chunks=(da.core.normalize_chunks(block, (count,))[0], (6,)), dtype=np.float32)


def test_as_if_cast_at_once_although_a_worker_is_killed(path: pathlib.Path, client: Client) -> None:
    rays = rays_of(path)
    hits = rdh.dask.cast(path, rays, fields=list(rdh.dask._FIELDS))
    wanted = {name: client.persist(array) for name, array in hits.items()}
    pid = next(iter(client.run(os.getpid).values()))
    os.kill(pid, signal.SIGKILL)
    found = {name: array.compute() for name, array in wanted.items()}
    expected = rdh.open(path).cast_rays(rays.compute(scheduler="synchronous"), threads=1)
    assert all(np.array_equal(expected[name], found[name]) for name in expected)
    # Another worker has taken the place of the lost one.
    deadline = time.time() + 60
    while len(client.run(os.getpid)) < 2 and time.time() < deadline:
        time.sleep(0.1)
    assert pid not in client.run(os.getpid).values() and len(client.run(os.getpid)) == 2


def test_other_queries_and_shapes(path: pathlib.Path, client: Client) -> None:
    rays = rays_of(path, 20_000, 3_000).reshape(40, 500, 6)
    scene, plain = rdh.open(path), rays.compute()
    occluded, count = rdh.dask.cast(path, rays, "occluded"), rdh.dask.cast(path, rays, "count")
    assert occluded.dtype == bool and count.dtype == np.int32 and occluded.chunks == rays.chunks[:-1]
    assert np.array_equal(occluded.compute(), scene.test_occlusions(plain))
    assert np.array_equal(count.compute(), scene.count_intersections(plain))
    uvs = rdh.dask.cast(path, rays.rechunk((40, 100, 2)), fields=["primitive_uvs"])["primitive_uvs"]
    assert uvs.shape == (40, 500, 2)
    assert np.array_equal(uvs.compute(), scene.cast_rays(plain)["primitive_uvs"])


def test_unaligned_blocks(path: pathlib.Path, client: Client) -> None:
    """Blocks that come over the network may lie anywhere in memory."""
    rays = rays_of(path, 1_000, 1_000).compute()
    room = np.zeros(rays.nbytes + 1, np.uint8)
    odd = room[1:].view(np.float32).reshape(rays.shape)
    odd[...] = rays
    assert not odd.flags.aligned
    found = rdh.dask.cast(path, da.from_array(odd, chunks=(100, 6)))["t_hit"].compute()
    assert np.array_equal(found, rdh.open(path).cast_rays(rays)["t_hit"])


def test_wrong_arguments_are_refused(path: pathlib.Path, tmp_path) -> None:
    rays = da.zeros((10, 6))
    for bad, message in [
        (lambda: rdh.dask.cast(path, np.zeros((1, 6))), "rays: a Dask array"),
        (lambda: rdh.dask.cast(path, da.zeros((10, 7))), "rays: the shape"),
        (lambda: rdh.dask.cast(path, rays, "nearest"), "query: 'nearest'"),
        (lambda: rdh.dask.cast(path, rays, fields=["colour"]), "fields: 'colour'"),
        (lambda: rdh.dask.cast(path, rays, threads=0), "threads: 0"),
        (lambda: rdh.dask.study(None, ["--shard", "1/2"], tmp_path), "arguments: --shard"),
    ]:
        with pytest.raises(ValueError, match=message):
            bad()
    with pytest.raises(FileNotFoundError):
        rdh.dask.cast(tmp_path / "nothing.rdh", rays)


STUDY = """#!{python}
import json, os, pathlib, sys, time
arguments = sys.argv[1:]
if arguments[0] == "study":
    out = pathlib.Path(arguments[arguments.index("--out") + 1])
    out.mkdir(exist_ok=True)
    start = time.time()
    time.sleep(0.3)
    log = {{"shard": arguments[arguments.index("--shard") + 1], "worker": os.getppid(), "from": start, "to": time.time()}}
    (out / "log").write_text(json.dumps(log))
else:
    print(json.dumps({{"parts": [json.loads((pathlib.Path(p) / "log").read_text()) for p in arguments[2:]]}}))
"""


def test_parts_of_a_study_run_one_at_a_time_a_worker(client: Client, tmp_path) -> None:
    """By a stand-in for the program, which notes when and for whom it ran."""
    program = tmp_path / "stand-in"
    program.write_text(STUDY.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    document = rdh.dask.study(client, ["--quick"], tmp_path / "out", shards=6, program=str(program))
    parts = document["parts"]
    assert sorted(part["shard"] for part in parts) == [f"{k}/6" for k in range(1, 7)]
    for worker in {part["worker"] for part in parts}:
        spans = sorted((part["from"], part["to"]) for part in parts if part["worker"] == worker)
        assert all(end <= start for (_, end), (start, _) in zip(spans, spans[1:], strict=False))
    with pytest.raises(RuntimeError, match="there is no program"):
        rdh.dask.study(client, [], tmp_path / "other", shards=1, program="no-such-program")


@pytest.mark.skipif(shutil.which("rdh") is None, reason="the program rdh is not on the path")
def test_a_study_on_a_cluster_is_the_study(client: Client, tmp_path) -> None:
    arguments = ["tetra5", "rooms", "--quick", "--size", "16x16", "--training", "64", "--rounds", "1", "--experiment", "paper"]
    document = rdh.dask.study(client, arguments, tmp_path / "parts", shards=3)
    whole = tmp_path / "whole"
    subprocess.run(["rdh", "study", *arguments, "--out", str(whole)], check=True, capture_output=True)
    merged = subprocess.run(["rdh", "merge", "--json", str(whole)], check=True, capture_output=True)
    counted = ("scene", "view", "class", "spec", "rays", "hits", "t_sum", "steps_per_ray", "tests_per_ray")
    rows = [[{key: row[key] for key in counted} for row in d["rows"]] for d in (document, json.loads(merged.stdout))]
    assert rows[0] == rows[1] and len(rows[0]) > 0
    # A second call finds all of it done.
    again = rdh.dask.study(client, arguments, tmp_path / "parts", shards=3)
    assert again["rows"] == document["rows"]
