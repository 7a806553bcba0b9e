"""Choosing a structure for recorded rays."""

import pathlib

import numpy as np
import pytest
from making import random_rays

import rdh


@pytest.fixture(scope="module")
def recorded() -> tuple[rdh.Scene, rdh.Profile]:
    scene = rdh.load("rooms")
    with rdh.record(scene) as profile:
        scene.cast_rays(scene.camera_rays(150, 150))
    return scene, profile


def test_the_choice_is_taken_and_explained(recorded, tmp_path: pathlib.Path) -> None:
    _, profile = recorded
    scene = rdh.load("rooms")
    rays = scene.camera_rays(64, 64)
    before = scene.cast_rays(rays)
    assert scene.evidence is None
    evidence = scene.tune(profile, by="counts")
    assert scene.spec == evidence["spec"] and evidence["reason"] and len(evidence["trials"]) > 3
    assert scene.evidence == evidence
    after = scene.cast_rays(rays)
    assert all(np.array_equal(before[name], after[name]) for name in before)
    scene.save(tmp_path / "tuned.rdh")
    assert rdh.open(tmp_path / "tuned.rdh").evidence == evidence
    # By counts, it is the same wherever and however often it is made.
    again = rdh.load("rooms")
    assert again.tune(profile, by="counts", threads=1) == evidence


def test_by_time_and_among_few(recorded) -> None:
    _, profile = recorded
    scene = rdh.load("rooms")
    evidence = scene.tune(profile, candidates="bvh8+sah,bvh8+rdh")
    assert scene.spec in ("bvh8+sah", "bvh8+rdh")
    assert [trial["spec"] for trial in evidence["trials"]] == ["bvh8+sah", "bvh8+rdh"]
    assert evidence["measure"] in ("time", "counts")


def test_too_few_rays_are_said_to_be_too_few(small: rdh.Scene) -> None:
    with rdh.record(small) as profile:
        small.cast_rays(random_rays(3, 1))
    scene = rdh.load("balls4")
    evidence = scene.tune(profile)
    assert evidence["outcome"] == "too_few_rays" and "rdh" not in scene.spec


def test_wrong_arguments_are_refused(recorded) -> None:
    scene, profile = recorded
    kept = scene.spec
    for named in [{"by": "luck"}, {"candidates": ""}, {"candidates": "octree"}, {"candidates": "bvh8+rdh"}]:
        with pytest.raises(ValueError):
            scene.tune(profile, **named)
    with pytest.raises(TypeError):
        scene.tune(None)
    assert scene.spec == kept
