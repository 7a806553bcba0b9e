"""The package itself: stubs, docstrings, size."""

import doctest
import importlib.util
import inspect
import pathlib
import subprocess
import sys
import types

import pytest

import rdh
import rdh.trimesh


def test_stubs_fit_the_module() -> None:
    pytest.importorskip("mypy")
    run = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "rdh"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_python_files_fit_their_types() -> None:
    pytest.importorskip("mypy")
    folder = pathlib.Path(rdh.__file__).parent
    command = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", str(folder)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


def documented() -> dict[str, str]:
    """Docstrings of all that is public."""
    found = {"rdh": rdh.__doc__, "rdh.trimesh": rdh.trimesh.__doc__}
    things = [getattr(rdh, name) for name in rdh.__all__] + [rdh.trimesh.RayMeshIntersector]
    for thing in things:
        if not (inspect.isclass(thing) or callable(thing)):
            continue
        found[thing.__name__] = thing.__doc__
        if inspect.isclass(thing):
            for name, member in vars(thing).items():
                if not name.startswith("_"):
                    found[f"{thing.__name__}.{name}"] = inspect.getdoc(member) or getattr(member, "__doc__", None)
    return found


def test_everything_public_is_documented() -> None:
    assert not [name for name, text in documented().items() if not text or len(text) < 20]


@pytest.mark.parametrize("name", [name for name, text in documented().items() if text and ">>>" in text])
def test_examples(name: str) -> None:
    if name == "RayMeshIntersector":
        pytest.importorskip("trimesh")
    text = inspect.cleandoc(documented()[name])
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert test.examples
    runner = doctest.DocTestRunner()
    runner.run(test)
    assert runner.failures == 0


def test_the_module_is_small_and_stands_alone() -> None:
    module: types.ModuleType = rdh._rdh
    path = pathlib.Path(module.__file__)
    assert path.stat().st_size < 8_000_000
    assert (pathlib.Path(rdh.__file__).parent / "py.typed").exists()
    assert importlib.util.find_spec("rdh.trimesh")
