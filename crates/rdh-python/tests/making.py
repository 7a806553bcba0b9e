"""Rays and triangles to test with."""

import numpy as np


def random_rays(count: int, seed: int, reach: float = 2.0) -> np.ndarray:
    """Rays from a box around the origin in all directions, float32."""
    rng = np.random.default_rng(seed)
    origins, directions = rng.uniform(-reach, reach, (count, 3)), rng.normal(size=(count, 3))
    return np.concatenate([origins, directions], axis=1).astype(np.float32)


def soup(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles anywhere in a cube of side 2: float32 vertices and int64 faces."""
    vertices = np.random.default_rng(seed).uniform(-1, 1, (3 * count, 3)).astype(np.float32)
    return vertices, np.arange(3 * count).reshape(count, 3)
