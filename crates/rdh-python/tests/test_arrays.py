"""Arrays of any dtype, strides, byte order and alignment: the right answer, or an error that names the argument."""

import numpy as np
import pytest
from making import random_rays, soup

import rdh

FLOATS = ["f2", "f4", "f8", "g"]
INTEGERS = ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"]
OTHERS = ["c8", "c16", "S4", "U4", "M8[s]", "m8[s]", "O", "V8"]


def disguised(values: np.ndarray, dtype: str, rng: np.random.Generator) -> np.ndarray:
    """The same numbers with a dtype, in any order of bytes, any layout and any alignment; perhaps read-only."""
    dtype = np.dtype(dtype).newbyteorder(rng.choice(["<", ">"]))
    array = values.astype(dtype)
    kind = rng.integers(6)
    if kind == 1:
        array = np.asfortranarray(array)
    elif kind == 2:
        # Every second one of a larger array, in any axis.
        axis = rng.integers(array.ndim)
        wide = np.repeat(array, 2, axis=axis)
        array = np.take(wide, range(0, wide.shape[axis], 2), axis=axis) if rng.integers(2) else wide[
            (slice(None),) * axis + (slice(None, None, 2),)
        ]
    elif kind == 3:
        # Turned round twice, so that strides are negative.
        array = np.flip(np.ascontiguousarray(np.flip(array)))
    elif kind == 4:
        # At an odd address.
        room = np.zeros(array.nbytes + 64, np.uint8)
        start = int(rng.integers(1, 16))
        inner = room[start : start + array.nbytes].view(dtype).reshape(array.shape)
        inner[...] = array
        array = inner
    elif kind == 5:
        # A field of records.
        records = np.zeros(array.shape, np.dtype([("pad", "u1"), ("x", dtype)]))
        records["x"] = array
        array = records["x"]
    if rng.integers(2):
        array.flags.writeable = False
    return array


def test_any_array_gives_the_right_answer() -> None:
    """10,000 arrays."""
    rng = np.random.default_rng(1)
    vertices, faces = soup(60, 2)
    scene = rdh.Scene(vertices, faces)
    for _ in range(8_000):
        dtype = rng.choice(FLOATS + INTEGERS)
        count, columns = int(rng.integers(0, 6)), int(rng.choice([6, 8]))
        values = random_rays(count, int(rng.integers(1 << 30)))
        if columns == 8:
            values = np.concatenate([values, np.tile([0.0, 1.5], (count, 1))], axis=1)
        if dtype in INTEGERS:
            values = np.clip(np.round(values * 3), 0 if dtype[0] == "u" else -9, 9)
        given = disguised(values, dtype, rng)
        # What NumPy makes of the numbers themselves.
        plain = np.ascontiguousarray(given.astype(np.float64).astype(np.float32))
        expected, found = scene.cast_rays(plain), scene.cast_rays(given)
        for name in expected:
            assert np.array_equal(expected[name], found[name]), (given.dtype, given.strides)
        assert np.array_equal(scene.count_intersections(plain), scene.count_intersections(given))
    probe = random_rays(200, 3)
    for _ in range(2_000):
        shown = disguised(faces, rng.choice(["i2", "i4", "i8", "u1", "u2", "u4", "u8"]), rng)
        points = disguised(vertices, rng.choice(["f4", "f8", "g"]), rng)
        other = rdh.Scene(points, shown, threads=1)
        assert np.array_equal(other.cast_rays(probe)["t_hit"], scene.cast_rays(probe)["t_hit"])


@pytest.mark.parametrize("dtype", OTHERS)
def test_what_are_no_numbers_is_refused(dtype: str, small: rdh.Scene) -> None:
    array = np.zeros((4, 6), dtype)
    for query in [small.cast_rays, small.test_occlusions, small.count_intersections, small.list_intersections]:
        with pytest.raises(ValueError, match="^rays: real numbers are needed"):
            query(array)
    with pytest.raises(ValueError, match="^vertices: real numbers are needed"):
        rdh.Scene(np.zeros((3, 3), dtype), [[0, 1, 2]])
    with pytest.raises(ValueError, match="^faces: integers are needed"):
        rdh.Scene(np.eye(3), np.zeros((1, 3), dtype))


def test_arrays_are_left_as_they_were(small: rdh.Scene) -> None:
    rays = random_rays(50, 4)
    for given in [rays, rays.astype(np.float64), rays.astype(">f4")]:
        kept = given.copy()
        small.cast_rays(given)
        assert np.array_equal(given, kept)


def test_no_copy_is_made_of_what_fits(small: rdh.Scene) -> None:
    """Rays that one row stands for a million times are copied, so must fit; plain float32 ones are not."""
    tracemalloc = pytest.importorskip("tracemalloc")
    rays = random_rays(200_000, 5)
    tracemalloc.start()
    small.test_occlusions(rays)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < rays.nbytes / 4


def test_what_has_no_room_is_an_error(small: rdh.Scene) -> None:
    endless = np.broadcast_to(np.zeros(6, np.float32), (1 << 40, 6))
    with pytest.raises((MemoryError, ValueError)):
        small.cast_rays(endless)
