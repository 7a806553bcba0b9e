from collections.abc import Sequence
from os import PathLike
from types import TracebackType
from typing import Any, ClassVar, Final, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "INVALID_ID",
    "Profile",
    "Record",
    "Scene",
    "__version__",
    "_any",
    "_count",
    "_first",
    "_meetings",
    "load",
    "record",
]

__version__: Final[str]
INVALID_ID: Final[int]

class _View(TypedDict):
    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float]
    fov_y: float

@final
class Scene:
    def __new__(
        cls, vertices: ArrayLike, faces: ArrayLike, spec: str = "bvh8+sah", *, threads: int | None = None
    ) -> Scene: ...
    def cast_rays(
        self, rays: ArrayLike, threads: int | None = None, *, fields: Sequence[str] | None = None
    ) -> dict[str, NDArray[Any]]: ...
    def test_occlusions(
        self, rays: ArrayLike, tnear: float = 0.0, tfar: float = ..., threads: int | None = None
    ) -> NDArray[np.bool_]: ...
    def count_intersections(self, rays: ArrayLike, threads: int | None = None) -> NDArray[np.int32]: ...
    def list_intersections(self, rays: ArrayLike, threads: int | None = None) -> dict[str, NDArray[Any]]: ...
    def rebuild(self, spec: str, profile: Profile | None = None, *, threads: int | None = None) -> None: ...
    def camera_rays(self, width: int, height: int, view: str | None = None) -> NDArray[np.float64]: ...
    @property
    def stats(self) -> dict[str, Any]: ...
    @property
    def spec(self) -> str: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def bounds(self) -> NDArray[np.float64]: ...
    @property
    def origin(self) -> tuple[float, float, float]: ...
    @property
    def name(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def views(self) -> dict[str, _View]: ...
    @property
    def paths(self) -> dict[str, list[_View]]: ...
    def __len__(self) -> int: ...

@final
class Profile:
    __hash__: ClassVar[None]  # type: ignore[assignment]
    @classmethod
    def open(cls, path: str | PathLike[str]) -> Profile: ...
    @classmethod
    def merge(cls, profiles: Sequence[Profile]) -> Profile: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    @property
    def seen(self) -> int: ...
    @property
    def seed(self) -> int: ...
    @property
    def rays(self) -> NDArray[np.float32]: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, tuple[bytes]]: ...
    @classmethod
    def _from_bytes(cls, data: bytes) -> Profile: ...

@final
class Record:
    def __enter__(self) -> Profile: ...
    def __exit__(
        self, *exception: type[BaseException] | BaseException | TracebackType | None
    ) -> None: ...

def load(
    path: str | PathLike[str],
    spec: str = "bvh8+sah",
    *,
    scenes: str | PathLike[str] | None = None,
    threads: int | None = None,
) -> Scene: ...
def record(scene: Any, *, capacity: int = 65_536, seed: int = 1, ray_class: str = "other") -> Record: ...
def _first(
    scene: Scene, origins: ArrayLike, directions: ArrayLike, threads: int | None
) -> NDArray[np.int32]: ...
def _any(
    scene: Scene, origins: ArrayLike, directions: ArrayLike, threads: int | None
) -> NDArray[np.bool_]: ...
def _count(
    scene: Scene, origins: ArrayLike, directions: ArrayLike, threads: int | None
) -> NDArray[np.int64]: ...
def _meetings(
    scene: Scene,
    vertices: ArrayLike,
    origins: ArrayLike,
    directions: ArrayLike,
    most: int,
    threads: int | None,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]: ...
