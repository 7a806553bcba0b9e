"""A stand-in for trimesh's ``RayMeshIntersector``: ``mesh.ray = rdh.trimesh.RayMeshIntersector(mesh)`` is all that changes.

Methods, shapes and dtypes are those of ``trimesh.ray.ray_pyembree``, with these differences:

- Hits come ray after ray, each nearest first; trimesh lists all first hits, then all second ones.
- All hits are found in one pass and none is left out: ``max_hits`` has no limit unless one is given.
- An edge that faces share is crossed once, not twice, so that numbers of hits through closed meshes are even.
- ``threads`` limits how many threads cast; by default all cores do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rdh import Scene
from rdh._rdh import _any, _count, _first, _meetings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["RayMeshIntersector"]

# Lines along which points are tested for being inside, one after the other while the two half-lines disagree. The first one
# is trimesh's.
_DIRECTIONS = np.array(
    [
        [0.4395064455, 0.617598629942, 0.652231566745],
        [-0.701528, 0.314159, 0.639643],
        [0.271828, -0.866025, 0.419617],
        [0.577215, 0.161803, -0.800403],
    ]
)


class RayMeshIntersector:
    """Ray queries on a mesh.

    ``geometry`` is a ``trimesh.Trimesh``, or anything with ``vertices`` ``(n, 3)`` float, ``faces`` ``(m, 3)`` int and a hash that
    changes when they do: the structure is built at the first query, and again after a change. ``spec`` says what is built
    (see ``rdh.Scene``), ``threads`` how many threads build and cast: ``None`` is all cores.

    Rays are given as ``ray_origins`` and ``ray_directions``, ``(n, 3)`` each, of any dtype; directions need not have length 1.
    All methods raise ``ValueError`` naming the argument that is wrong.

    >>> import numpy as np, trimesh, rdh.trimesh
    >>> mesh = trimesh.creation.box()
    >>> mesh.ray = rdh.trimesh.RayMeshIntersector(mesh)
    >>> mesh.ray.intersects_any([[0, 0.1, 2], [2, 2, 2]], [[0, 0, -1], [0, 0, -1]])
    array([ True, False])
    >>> mesh.ray.intersects_location([[0, 0.1, 2]], [[0, 0, -1]])[0]
    array([[ 0. ,  0.1,  0.5],
           [ 0. ,  0.1, -0.5]])
    """

    def __init__(self, geometry: Any, spec: str = "bvh8+sah", threads: int | None = None) -> None:
        self.mesh = geometry
        self._spec = spec
        self._threads = threads
        self._built: tuple[int, Scene, NDArray[np.float64]] | None = None

    @property
    def scene(self) -> Scene:
        """The ``rdh.Scene`` of the mesh as it is now: for ``rdh.record``, ``rebuild`` and ``tune``."""
        return self._current()[0]

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Where rays hit: all hits, or the nearest ones.

        Returns ``locations`` ``(m, 3)`` float64, on the planes of the faces; ``index_ray`` ``(m,)`` int64; ``index_tri`` ``(m,)`` int64.
        """
        scene, vertices = self._current()
        most = 2**31 if multiple_hits else 1
        index_tri, index_ray, locations = _meetings(scene, vertices, ray_origins, ray_directions, most, self._threads)
        return locations, index_ray, index_tri

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> (
        tuple[NDArray[np.int64], NDArray[np.int64]]
        | tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]
    ):
        """Which faces rays hit: all of them, at most the ``max_hits`` nearest ones of each ray, or only the nearest.

        Returns ``index_tri`` and ``index_ray``, ``(m,)`` int64, and with ``return_locations`` also ``locations`` ``(m, 3)`` float64.
        """
        if max_hits is not None and max_hits < 0:
            raise ValueError(f"max_hits: {max_hits} is less than none")
        scene, vertices = self._current()
        most = (2**31 if max_hits is None else max_hits) if multiple_hits else 1
        result = _meetings(scene, vertices, ray_origins, ray_directions, most, self._threads)
        return result if return_locations else result[:2]

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.int32]:
        """The first face that each ray hits: ``(n,)`` int32, -1 for a miss."""
        return _first(self.scene, ray_origins, ray_directions, self._threads)

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Whether each ray hits anything: ``(n,)`` bool."""
        return _any(self.scene, ray_origins, ray_directions, self._threads)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point is inside the mesh: ``(n,)`` bool. ``points`` is ``(n, 3)``; of points on the surface nothing is known.

        A point is inside if the two halves of a line through it cross the surface oddly often. Where one does and the other
        doesn't, the surface has a hole there, and other lines decide; if one half meets nothing, the point is outside.
        """
        points = np.asarray(points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points: the shape must be (n, 3), not {points.shape}")
        scene = self.scene
        low, high = scene.bounds
        unsure = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        inside = np.zeros(len(points), dtype=bool)
        for direction in _DIRECTIONS:
            origins, directions = points[unsure], np.tile(direction, (len(unsure), 1))
            ahead = _count(scene, origins, directions, self._threads)
            behind = _count(scene, origins, -directions, self._threads)
            agree = ahead % 2 == behind % 2
            inside[unsure[agree]] = ahead[agree] % 2 == 1
            unsure = unsure[~agree & (ahead > 0) & (behind > 0)]
        return inside

    def _current(self) -> tuple[Scene, NDArray[np.float64]]:
        """The scene, and the vertices it was made of; both anew if the mesh has changed."""
        key = hash(self.mesh)
        if self._built is None or self._built[0] != key:
            vertices = np.array(self.mesh.vertices, dtype=np.float64)
            scene = Scene(vertices, self.mesh.faces, self._spec, threads=self._threads)
            self._built = key, scene, vertices if len(scene) else vertices[:0]
        return self._built[1:]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_built": None}

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._spec, self._threads)

    def __deepcopy__(self, *_: Any) -> RayMeshIntersector:
        return self.__copy__()
