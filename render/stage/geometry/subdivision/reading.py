"""Rules of subdivision as a UsdGeom.Mesh states them."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import LongArray
from render.stage.geometry.points_data import real_numbers, whole_numbers
from render.stage.geometry.polygons import BadGeometry
from render.stage.geometry.subdivision.refinement import Cage
from render.stage.geometry.subdivision.topology import Sharpness

ATTRIBUTES = ("creaseIndices", "creaseLengths", "creaseSharpnesses", "cornerIndices", "cornerSharpnesses")
"""Attributes of a mesh that its refined polygons depend on, beside those of the polygons."""
_SCHEMES = (UsdGeom.Tokens.catmullClark, UsdGeom.Tokens.loop, UsdGeom.Tokens.bilinear)


def scheme_of(prim: Usd.Prim) -> str:
    """Subdivision scheme of a prim: ``none`` where it is no mesh or names none that USD knows."""
    if not prim.IsA(UsdGeom.Mesh):
        return "none"
    scheme = UsdGeom.Mesh(prim).GetSubdivisionSchemeAttr().Get()
    return str(scheme) if scheme in _SCHEMES else "none"


def is_refined(prim: Usd.Prim, complexity: str) -> bool:
    """Whether a prim may be refined. Automatic refinement leaves bilinear surfaces out, which it would hardly change.

    Args:
        prim: any prim.
        complexity: one of `render.stage.options.COMPLEXITIES`.
    """
    scheme = scheme_of(prim) if complexity != "low" else "none"
    return scheme != "none" and (scheme != "bilinear" or complexity != "auto")


def has_sharpness(prim: Usd.Prim) -> bool:
    """Whether a mesh states creases or corners."""
    return any(prim.GetAttribute(name).HasAuthoredValue() for name in ("creaseIndices", "cornerIndices"))


def read_cage(prim: Usd.Prim, time: Usd.TimeCode) -> Cage:
    """Rules of a mesh whose scheme is not none.

    Raises:
        BadGeometry: the arrays of creases or corners contradict each other, or have values of other types.
    """
    mesh = UsdGeom.Mesh(prim)
    scheme = scheme_of(prim)
    return Cage(
        "loop" if scheme == "loop" else "bilinear" if scheme == "bilinear" else "catmullClark",
        str(mesh.GetInterpolateBoundaryAttr().Get(time)),
        str(mesh.GetFaceVaryingLinearInterpolationAttr().Get(time)),
        mesh.GetTriangleSubdivisionRuleAttr().Get(time) == UsdGeom.Tokens.smooth,
        _read_sharpness(mesh, time),
    )


def _read_sharpness(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> Sharpness | None:
    indices = whole_numbers(mesh.GetCreaseIndicesAttr(), time).astype(np.int64)
    lengths = whole_numbers(mesh.GetCreaseLengthsAttr(), time).astype(np.int64)
    points = whole_numbers(mesh.GetCornerIndicesAttr(), time).astype(np.int64)
    of_points = real_numbers(mesh.GetCornerSharpnessesAttr(), time)
    if not len(indices) and not len(points):
        return None
    if len(points) != len(of_points):
        raise BadGeometry(f"it has {len(points)} cornerIndices and {len(of_points)} cornerSharpnesses")
    creases, crease = _crease_edges(indices, lengths)
    stated = real_numbers(mesh.GetCreaseSharpnessesAttr(), time)
    if len(stated) == len(lengths):
        stated = stated[crease]
    elif len(stated) != len(creases):
        raise BadGeometry(
            f"it has {len(lengths)} creases of {len(creases)} edges, and {len(stated)} creaseSharpnesses: one for each is needed"
        )
    return Sharpness(creases, stated, points, of_points)


def _crease_edges(indices: LongArray, lengths: LongArray) -> tuple[LongArray, LongArray]:
    """``(k, 2)`` ends of the edges of creases, and ``(k,)`` the crease that each belongs to."""
    if len(lengths) and lengths.min() < 2:
        raise BadGeometry("creaseLengths has a crease of fewer than two points")
    if int(lengths.sum()) != len(indices):
        raise BadGeometry(f"creaseLengths add up to {lengths.sum()} points, but there are {len(indices)} creaseIndices")
    crease = np.repeat(np.arange(len(lengths)), lengths)
    ends = np.stack([indices[:-1], indices[1:]], axis=1)
    inside = crease[:-1] == crease[1:]
    return ends[inside], crease[:-1][inside]
