"""Places on the faces of prims, as a picture's pixels see them."""

from __future__ import annotations

from dataclasses import dataclass

from render.model.arrays import DoubleArray, IntArray


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Places on faces, one for each pixel.

    Attributes:
        mesh_ids: ``(height, width)`` int32 index in `Scene.prim_paths` of the prim whose face it is: inside a PointInstancer the
            mesh of the prototype; -1 where nothing is.
        faces: ``(height, width)`` int32 index of the authored face.
        fans: ``(height, width)`` int32 index of the triangle in the face's fan, corners ``(0, i + 1, i + 2)``.
        weights: ``(height, width, 3)`` float64 barycentric weights of those corners.
    """

    mesh_ids: IntArray
    faces: IntArray
    fans: IntArray
    weights: DoubleArray
