"""Every public function with garbage: an ordinary exception or an answer, never the end of the process."""

import inspect
import itertools
import pickle

import numpy as np
import pytest

import rdh
import rdh.trimesh

GARBAGE = [
    None,
    True,
    -1,
    0,
    2**31,
    2**64,
    -(2**63),
    10**400,
    float("nan"),
    float("inf"),
    1e308,
    "",
    "kd+rdh",
    "\0",
    "\ud800",
    "a" * 10_000,
    b"\xff\x00",
    [],
    [[]],
    [[[]]],
    (),
    {},
    set(),
    object(),
    object,
    lambda: None,
    np.array(1.0),
    np.zeros((0, 6)),
    np.zeros((2, 0)),
    np.full((2, 6), np.nan),
    np.full((2, 8), np.inf),
    np.full((3, 3), -(2**62)),
    np.full((3, 3), 2**63, np.uint64),
    np.zeros((2, 6), np.complex128),
    np.zeros((1,) * 32),
    np.broadcast_to(np.float32(0), (1 << 45, 6)),
    np.zeros(3, [("a", "f4"), ("b", "i8")]),
    np.ma.masked_all((2, 6)),
    np.array([None] * 6, object),
    memoryview(b"123456"),
    range(6),
]


class Refusal(Exception):
    """What hostile objects raise."""


ORDINARY = (ValueError, TypeError, OverflowError, OSError, MemoryError, AttributeError, Refusal)


class Hostile:
    """Claims to be an array, and isn't."""

    def __array__(self, *_args, **_kwargs):
        raise Refusal("no array after all")

    def __len__(self):
        return 1 << 60

    def __index__(self):
        raise Refusal("no number after all")


GARBAGE.append(Hostile())


def attempts(arguments: int):
    """Garbage for so many arguments: each alone, and some together."""
    yield from itertools.product(GARBAGE, repeat=1)
    rng = np.random.default_rng(arguments)
    for _ in range(300):
        yield tuple(GARBAGE[i] for i in rng.integers(len(GARBAGE), size=rng.integers(0, arguments + 2)))


def survive(function, *arguments, **named) -> None:
    """Calls it; what it raises must be ordinary, and not a panic."""
    try:
        function(*arguments, **named)
    except ORDINARY as error:
        assert str(error) or isinstance(error, (MemoryError, TypeError, AttributeError))


def scene() -> rdh.Scene:
    return rdh.Scene(np.eye(3), [[0, 1, 2]])


def methods(thing) -> list:
    return [getattr(thing, name) for name, _ in inspect.getmembers(thing, callable) if not name.startswith("__")]


def profile() -> rdh.Profile:
    one = scene()
    with rdh.record(one) as recorded:
        one.cast_rays([0, 0, 0, 1, 1, 1])
    return recorded


@pytest.mark.parametrize(
    "function",
    [
        rdh.Scene,
        rdh.load,
        rdh.record,
        *methods(scene()),
        *(f for f in methods(profile()) if f.__name__ != "save"),
        rdh.trimesh.RayMeshIntersector,
        *(getattr(rdh._rdh, name) for name in ("_first", "_any", "_count", "_meetings")),
    ],
    ids=lambda f: f"{getattr(f, '__qualname__', f)}",
)
def test_garbage_is_survived(function, tmp_path, monkeypatch) -> None:
    # Some of it is a name that a file can have.
    monkeypatch.chdir(tmp_path)
    for arguments in attempts(5):
        survive(function, *arguments)
    try:
        names = list(inspect.signature(function).parameters)
    except ValueError:
        names = []
    first = next(iter(GARBAGE))
    for name, value in itertools.product(names, GARBAGE):
        survive(function, **{**dict.fromkeys(names[:1], first), name: value})


def test_garbage_in_private_functions() -> None:
    one = scene()
    for function in (rdh._rdh._first, rdh._rdh._any, rdh._rdh._count):
        for a, b in itertools.product(GARBAGE, GARBAGE):
            survive(function, one, a, b, None)
    for a in GARBAGE:
        survive(rdh._rdh._meetings, one, a, np.ones((2, 3)), np.ones((2, 3)), 5, None)
        survive(rdh._rdh._meetings, one, np.eye(3), np.ones((2, 3)), np.ones((2, 3)), a, None)


def test_saving_where_nothing_can_be_saved(tmp_path) -> None:
    recorded = profile()
    for place in ["/nowhere/at/all.rays", tmp_path, "", "\0"]:
        with pytest.raises((OSError, ValueError)):
            recorded.save(place)
    assert not list(tmp_path.iterdir())


def test_altered_profiles_are_errors() -> None:
    make, (data,) = profile().__reduce__()
    for at in range(0, len(data), 7):
        altered = bytearray(data)
        altered[at] ^= 0x41
        with pytest.raises(ValueError, match="data: byte"):
            make(bytes(altered))
    for length in range(len(data)):
        with pytest.raises(ValueError, match="data: byte"):
            make(data[:length])
    with pytest.raises((ValueError, TypeError, pickle.UnpicklingError)):
        pickle.loads(pickle.dumps(profile())[:-40])
