"""The package itself: stubs, docstrings, size."""

import doctest
import importlib.util
import inspect
import json
import pathlib
import shutil
import subprocess
import sys
import types

import pytest

import rdh
import rdh.bench
import rdh.trimesh


def test_stubs_fit_the_module() -> None:
    pytest.importorskip("mypy")
    run = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "rdh"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_python_files_fit_their_types(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("mypy")
    # Away from where it is installed: what lies beside it there is not ours.
    shutil.copytree(pathlib.Path(rdh.__file__).parent, tmp_path / "rdh", ignore=shutil.ignore_patterns("*.so"))
    command = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "rdh"]
    run = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
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


def test_importing_it_imports_nothing_else_that_is_large() -> None:
    code = "import rdh, sys; assert rdh.trimesh and rdh.dask; assert not {'trimesh', 'dask', 'open3d'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_race_is_run(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    for needed in ("trimesh", "embreex"):
        pytest.importorskip(needed)
    monkeypatch.chdir(tmp_path)
    assert rdh.bench.main(["--side", "48", "--rounds", "1", "--spec", "bvh8(quick)+sah", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    raced = {(row["rays"], row["query"]) for row in rows if row["engine"] in ("embreex", "trimesh")}
    queries = ("closest", "closest, all fields", "occluded", "first", "any", "first locations", "all hits")
    assert raced == {(rays, query) for rays in ("coherent", "incoherent") for query in queries}
    assert all(row["mrays_per_sec"] > 0 and row["speedup"] > 0 for row in rows)
    with pytest.raises(SystemExit):
        rdh.bench.main(["--side", "0"])


def test_the_readme_runs(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the README shows of scenes, recording and saving, block after block."""
    trimesh = pytest.importorskip("trimesh")
    text = (pathlib.Path(__file__).parents[1] / "README.md").read_text()
    blocks = [part.partition("```")[0] for part in text.split("```python\n")[1:]]
    assert len(blocks) == 4
    monkeypatch.chdir(tmp_path)
    names = {"mesh": trimesh.creation.box(), "rdh": rdh}
    for block in blocks[:3]:
        exec(block, names)
    assert (tmp_path / "quarter.rdh").is_file()
    assert isinstance(names["mesh"].ray, rdh.trimesh.RayMeshIntersector)
