"""Recording what is cast."""

import pickle
import threading

import numpy as np
import pytest
from making import random_rays, soup

import rdh


def test_all_queries_are_recorded(small: rdh.Scene) -> None:
    rays = random_rays(1000, 1)
    with rdh.record(small) as profile:
        small.cast_rays(rays[:500])
        small.test_occlusions(rays[500:700], tfar=3.0)
        small.count_intersections(rays[700:])
    small.cast_rays(random_rays(10, 2))
    assert profile.seen == len(profile) == 1000
    kept = profile.rays
    assert kept.shape == (1000, 8) and kept.dtype == np.float32
    order = np.lexsort(kept.T[:6])
    assert np.array_equal(kept[order, :6], rays[np.lexsort(rays.T)])
    assert (kept[:, 7] == 3.0).sum() == 200 and np.isinf(kept[:, 7]).sum() == 800


def test_recording_changes_no_answer(small: rdh.Scene) -> None:
    rays = random_rays(3000, 3)
    plain = small.cast_rays(rays), small.test_occlusions(rays), small.list_intersections(rays)
    with rdh.record(small):
        recorded = small.cast_rays(rays), small.test_occlusions(rays), small.list_intersections(rays)
    assert np.array_equal(plain[1], recorded[1])
    for before, after in (plain[::2], recorded[::2]), :
        for a, b in zip(before, after, strict=True):
            assert all(np.array_equal(a[name], b[name]) for name in a)


def test_the_sample_is_fair_and_the_same_in_any_order(small: rdh.Scene) -> None:
    rays = random_rays(20_000, 4)
    profiles = []
    for order in [slice(None), slice(None, None, -1)]:
        with rdh.record(small, capacity=500, seed=7) as profile:
            small.cast_rays(rays[order], threads=2)
        profiles.append(profile)
    assert profiles[0] == profiles[1] and len(profiles[0]) == 500 and profiles[0].seen == 20_000
    halves = []
    for half in (rays[:10_000], rays[10_000:]):
        with rdh.record(small, capacity=500, seed=7) as profile:
            small.cast_rays(half)
        halves.append(profile)
    assert rdh.Profile.merge(halves) == profiles[0]
    with rdh.record(small, capacity=500, seed=8) as other:
        small.cast_rays(rays)
    assert other != profiles[0]
    with pytest.raises(ValueError, match="seed"):
        rdh.Profile.merge([other, profiles[0]])


def test_profiles_are_complete_only_at_the_end(small: rdh.Scene) -> None:
    with rdh.record(small) as profile:
        with pytest.raises(ValueError, match="complete only when"):
            len(profile)
        with pytest.raises(ValueError, match="recorded already"), rdh.record(small):
            pass
        assert "being recorded" in repr(profile)
    assert len(profile) == 0
    with rdh.record(small) as again:
        small.cast_rays(random_rays(5, 1))
    assert len(again) == 5


def test_recording_ends_when_the_block_fails(small: rdh.Scene) -> None:
    with pytest.raises(RuntimeError, match="halfway"), rdh.record(small) as profile:
        small.cast_rays(random_rays(5, 1))
        raise RuntimeError("halfway")
    assert len(profile) == 5
    manager = rdh.record(small)
    with pytest.raises(ValueError, match="not entered"):
        manager.__exit__(None, None, None)


def test_batches_of_other_threads_are_waited_for() -> None:
    scene, rays = rdh.Scene(*soup(2000, 5)), random_rays(300_000, 6)
    manager = rdh.record(scene)
    profile = manager.__enter__()
    thread = threading.Thread(target=scene.cast_rays, args=(rays,), kwargs={"threads": 1})
    thread.start()
    manager.__exit__(None, None, None)
    thread.join()
    # The batch began before or after the end of recording: all of it is there, or nothing.
    assert profile.seen in (0, len(rays))


def test_profiles_are_saved_and_pickled(small: rdh.Scene, tmp_path) -> None:
    with rdh.record(small, ray_class="lidar") as profile:
        small.cast_rays(random_rays(100, 7))
    path = tmp_path / "drive.rays"
    profile.save(path)
    assert rdh.Profile.open(path) == profile == pickle.loads(pickle.dumps(profile))
    assert [f.name for f in tmp_path.iterdir()] == ["drive.rays"]
    with pytest.raises(FileNotFoundError, match="nothing.rays"):
        rdh.Profile.open(tmp_path / "nothing.rays")
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(ValueError, match="drive.rays: byte"):
        rdh.Profile.open(path)


def test_wrong_arguments_are_refused(small: rdh.Scene) -> None:
    for named, message in [
        ({"ray_class": "sonar"}, "ray_class: 'sonar' is none of primary"),
        ({"capacity": 0}, "capacity: "),
        ({"capacity": 2**40}, "capacity: "),
    ]:
        with pytest.raises(ValueError, match=message):
            rdh.record(small, **named)
    with pytest.raises(ValueError, match="scene: an rdh.Scene is needed"):
        rdh.record(object())
