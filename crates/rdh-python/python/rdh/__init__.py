"""Ray tracing that knows your rays.

``rdh.Scene`` and ``rdh.load`` make scenes of triangles, with the batch queries of Open3D's ``RaycastingScene``;
``rdh.trimesh.RayMeshIntersector`` stands in for trimesh's; ``rdh.record`` collects the rays that a program really casts, so
that the scene can be rebuilt for them; ``rdh.dask`` casts arrays of any size on many machines; ``python -m rdh.bench``
compares with what else is installed.
"""

from rdh._rdh import INVALID_ID, Profile, Record, Scene, __version__, load, open, record

# Neither imports the package that it is named for before it is needed.
from rdh import dask, trimesh  # isort: skip

__all__ = ["INVALID_ID", "Profile", "Record", "Scene", "__version__", "dask", "load", "open", "record", "trimesh"]
