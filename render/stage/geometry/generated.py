"""Polygons that are made from prims other than meshes: implicit shapes, curves, points, tetrahedra and patches.

They are cut by what the prim holds alone, never by the view, so that a face number is as good an anchor here as on a mesh.
"""

from __future__ import annotations

from pxr import Usd

from render.stage.findings import FindingLog
from render.stage.geometry import curves, implicit, particles, patches, tetrahedra
from render.stage.geometry.points_data import has_velocities
from render.stage.geometry.polygons import Polygons
from render.stage.values import schema_type

_ATTRIBUTES = dict.fromkeys(curves.KINDS, curves.ATTRIBUTES) | {
    "Points": particles.ATTRIBUTES,
    "TetMesh": tetrahedra.ATTRIBUTES,
    "NurbsPatch": patches.ATTRIBUTES,
}


def is_generated(prim: Usd.Prim) -> bool:
    """Whether this prim is drawn by polygons that are made for it."""
    return implicit.is_implicit(prim) or schema_type(prim) in _ATTRIBUTES


def is_ribbon(prim: Usd.Prim) -> bool:
    """Whether the polygons are flat ribbons, which have no inside."""
    names = ("normals", "primvars:normals")
    return schema_type(prim) in curves.KINDS and any(prim.GetAttribute(name).HasAuthoredValue() for name in names)


def generated_varies(prim: Usd.Prim) -> bool:
    """Whether the shape may change over time."""
    if implicit.is_implicit(prim):
        return implicit.shape_varies(prim)
    found = (prim.GetAttribute(name) for name in _ATTRIBUTES[schema_type(prim)])
    return has_velocities(prim) or any(attribute and attribute.ValueMightBeTimeVarying() for attribute in found)


def generated_polygons(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> Polygons:
    """The polygons of a prim at a time, in its own space and units.

    Args:
        prim: for which `is_generated` holds.
        time: when.
        log: for findings.

    Raises:
        BadGeometry: its values do not fit; the message explains the fault.
    """
    match schema_type(prim):
        case kind if kind in curves.KINDS:
            return curves.curve_polygons(prim, time, log)
        case "Points":
            return particles.point_polygons(prim, time, log)
        case "TetMesh":
            return tetrahedra.tetrahedra_polygons(prim, time)
        case "NurbsPatch":
            return patches.patch_polygons(prim, time, log)
        case _:
            return implicit.implicit_polygons(prim, time)
