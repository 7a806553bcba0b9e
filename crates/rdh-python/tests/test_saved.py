"""Saved trees: the same answers, small pickles, one copy in memory."""

import os
import pathlib
import pickle
import subprocess
import sys

import numpy as np
import pytest
from making import random_rays, soup

import rdh


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> pathlib.Path:
    path = tmp_path_factory.mktemp("saved") / "quarter.rdh"
    rdh.load("quarter").save(path)
    return path


def test_the_same_answers(path: pathlib.Path, quarter: rdh.Scene) -> None:
    opened = rdh.open(path)
    assert len(opened) == len(quarter) and opened.stats == quarter.stats and opened.name == "quarter"
    assert opened.views == quarter.views and opened.origin == quarter.origin
    assert np.array_equal(opened.vertices, quarter.vertices) and np.array_equal(opened.faces, quarter.faces)
    rays = quarter.camera_rays(100, 80)
    expected, found = quarter.cast_rays(rays), opened.cast_rays(rays)
    assert all(np.array_equal(expected[name], found[name]) for name in expected)


def test_far_scenes_stay_where_they_are(tmp_path) -> None:
    vertices, faces = soup(50, 1)
    far = rdh.Scene(vertices + np.array([1e6, 2e6, 0.0]), faces)
    far.save(tmp_path / "far.rdh")
    assert rdh.open(tmp_path / "far.rdh").origin == far.origin != (0, 0, 0)
    rays = random_rays(100, 2).astype(np.float64)
    rays[:, :2] += [1e6, 2e6]
    hits = rdh.open(tmp_path / "far.rdh").cast_rays(rays)["t_hit"]
    assert np.array_equal(hits, far.cast_rays(rays)["t_hit"]) and np.isfinite(hits).any()


def test_pickles(path: pathlib.Path, small: rdh.Scene) -> None:
    opened = rdh.open(os.path.relpath(path))
    sent = pickle.dumps(opened)
    assert len(sent) < 200
    rays = opened.camera_rays(20, 20)
    assert np.array_equal(pickle.loads(sent).cast_rays(rays)["t_hit"], opened.cast_rays(rays)["t_hit"])
    # One that lies in memory takes its triangles along.
    rays = random_rays(300, 3)
    assert np.array_equal(pickle.loads(pickle.dumps(small)).cast_rays(rays)["t_hit"], small.cast_rays(rays)["t_hit"])
    # So does one that is no longer what the file holds.
    opened.rebuild("kd+sah")
    assert pickle.loads(pickle.dumps(opened)).spec == "kd+sah"


def test_another_file_is_noticed(tmp_path) -> None:
    path = tmp_path / "tree.rdh"
    rdh.load("balls4").save(path)
    opened = rdh.open(path)
    sent = pickle.dumps(opened)
    rays = random_rays(100, 4, 9.0)
    before = opened.cast_rays(rays)["t_hit"]
    rdh.load("rooms").save(path)
    with pytest.raises(ValueError, match="tree.rdh is no longer the file that was pickled"):
        pickle.loads(sent)
    # Who has it open keeps it.
    assert np.array_equal(opened.cast_rays(rays)["t_hit"], before)
    path.unlink()
    with pytest.raises(FileNotFoundError):
        pickle.loads(sent)


def test_bad_files_are_errors(tmp_path, path: pathlib.Path) -> None:
    with pytest.raises(FileNotFoundError, match="nowhere.rdh"):
        rdh.open(tmp_path / "nowhere.rdh")
    bad = tmp_path / "bad.rdh"
    for content in [b"", b"RDH-TREE", b"x" * 1000, path.read_bytes()[:-1], path.read_bytes() + b"\0"]:
        bad.write_bytes(content)
        with pytest.raises(ValueError, match="bad.rdh"):
            rdh.open(bad)
    altered = bytearray(path.read_bytes())
    altered[len(altered) // 2] ^= 1
    bad.write_bytes(altered)
    with pytest.raises(ValueError, match="bad.rdh: byte 16: the checksum"):
        rdh.open(bad)
    with pytest.raises(OSError, match="nowhere"):
        rdh.load("balls4").save("/nowhere/at/all.rdh")
    with pytest.raises(OSError, match="directory"):
        rdh.open(tmp_path)


SHARED = """
import sys, rdh
scene = rdh.open(sys.argv[1])
scene.test_occlusions(scene.camera_rays(64, 64))
print("ready", flush=True)
sys.stdin.readline()
"""


def pss_of_file(process: subprocess.Popen, path: pathlib.Path) -> int:
    """The process's share of the file's pages in memory, in bytes."""
    total, inside = 0, False
    for line in pathlib.Path(f"/proc/{process.pid}/smaps").read_text().splitlines():
        if "-" in line.split(" ")[0]:
            inside = line.endswith(str(path))
        elif inside and line.startswith("Pss:"):
            total += int(line.split()[1]) * 1024
    return total


@pytest.mark.skipif(sys.platform != "linux", reason="there is no /proc/PID/smaps")
def test_processes_share_one_copy(path: pathlib.Path) -> None:
    command = [sys.executable, "-c", SHARED, str(path)]
    processes = [subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    try:
        assert all(p.stdout.readline() == "ready\n" for p in processes)
        shares = [pss_of_file(p, path) for p in processes]
    finally:
        for p in processes:
            p.communicate("\n")
    size = path.stat().st_size
    assert all(share > 0 for share in shares)
    # A third each: all of them together hold the file once.
    assert sum(shares) < 1.1 * size
    assert max(shares) < 0.5 * size
