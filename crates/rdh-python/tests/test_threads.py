"""Threads, processes and signals."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from making import random_rays, soup

import rdh


@pytest.mark.parametrize("threads", [None, 0, 1, 2, 3, 16])
def test_any_number_of_threads_gives_the_same(threads: int | None, quarter: rdh.Scene) -> None:
    rays = quarter.camera_rays(160, 120)
    expected, found = quarter.cast_rays(rays, threads=1), quarter.cast_rays(rays, threads=threads)
    assert all(np.array_equal(expected[name], found[name]) for name in expected)
    expected, found = (quarter.list_intersections(rays, threads=n) for n in (1, threads))
    assert all(np.array_equal(expected[name], found[name]) for name in expected)


def test_other_threads_go_on_meanwhile(quarter: rdh.Scene) -> None:
    rays = np.tile(quarter.camera_rays(256, 256), (40, 1, 1))
    ticks, over = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not over.is_set():
            ticks += 1
            time.sleep(0.001)

    other = threading.Thread(target=tick)
    other.start()
    start = time.perf_counter()
    quarter.cast_rays(rays, threads=1)
    seconds = time.perf_counter() - start
    over.set()
    other.join()
    assert seconds > 0.1
    assert ticks > 20 * seconds


def test_queries_from_many_threads_agree(quarter: rdh.Scene) -> None:
    rays = quarter.camera_rays(128, 128).astype(np.float32)
    expected = quarter.cast_rays(rays)["t_hit"]
    results: list[np.ndarray] = []
    crowd = [threading.Thread(target=lambda: results.append(quarter.cast_rays(rays)["t_hit"])) for _ in range(8)]
    for thread in crowd:
        thread.start()
    for thread in crowd:
        thread.join()
    assert len(results) == 8 and all(np.array_equal(expected, result) for result in results)


INTERRUPTED = """
import numpy as np, rdh, sys, time
scene = rdh.load("quarter")
rays = np.tile(scene.camera_rays(512, 512).astype(np.float32), (300, 1, 1))
print("ready", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", time.time(), flush=True)
    # It is as good as new.
    assert scene.cast_rays(rays[:8], threads=2)["t_hit"].shape == (8, 512)
else:
    print("finished", flush=True)
"""


@pytest.mark.parametrize(
    "work",
    [
        "scene.cast_rays(rays, threads=1)",
        "scene.test_occlusions(rays, threads=2)",
        "scene.list_intersections(rays)",
        "[scene.rebuild('kd(split=exact)+sah', threads=1) for _ in range(99)]",
    ],
)
def test_interrupting(work: str) -> None:
    command = [sys.executable, "-c", INTERRUPTED.format(work=work)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        sent = time.time()
        process.send_signal(signal.SIGINT)
        word, _, at = process.stdout.readline().partition(" ")
        assert word == "interrupted", process.stderr.read()
        seconds = float(at) - sent
        assert process.wait() == 0, process.stderr.read()
    # 200 ms are promised; a machine that has more to do than it can wait for is given time.
    assert seconds < 0.2 * max(1.0, 2 * os.getloadavg()[0] / os.cpu_count())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_forked_processes_have_threads_of_their_own() -> None:
    scene, rays = rdh.Scene(*soup(500, 3)), random_rays(20_000, 4)
    expected = scene.cast_rays(rays, threads=2)["t_hit"]
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=lambda: queue.put(scene.cast_rays(rays, threads=2)["t_hit"]))
    child.start()
    assert np.array_equal(queue.get(timeout=60), expected)
    child.join()
