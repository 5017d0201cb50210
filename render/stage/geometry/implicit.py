"""Sphere, Cube, Cylinder, Cone, Capsule and Plane as polygons.

They are cut finely enough (64 steps around) that a silhouette that fills the frame still looks round. The cut is always the same,
so a face number is as good an anchor here as on a mesh.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pxr import Usd

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.stage.geometry.polygons import FARTHEST_POINT, BadGeometry, Polygons, Values
from render.stage.values import number, schema_type

STEPS_AROUND = 64
STEPS_OVER_CAP = 16

_SHAPE_ATTRIBUTES = {
    "Sphere": ("radius",),
    "Cube": ("size",),
    "Cylinder": ("radius", "height", "axis"),
    "Cylinder_1": ("radiusBottom", "radiusTop", "height", "axis"),
    "Cone": ("radius", "height", "axis"),
    "Capsule": ("radius", "height", "axis"),
    "Capsule_1": ("radiusBottom", "radiusTop", "height", "axis"),
    "Plane": ("width", "length", "axis"),
}


def is_implicit(prim: Usd.Prim) -> bool:
    """Whether this is one of the implicit shapes."""
    return schema_type(prim) in _SHAPE_ATTRIBUTES


def shape_varies(prim: Usd.Prim) -> bool:
    """Whether the shape's measures may change over time."""
    names = _SHAPE_ATTRIBUTES[schema_type(prim)]
    return any(prim.GetAttribute(name).ValueMightBeTimeVarying() for name in names)


def implicit_polygons(prim: Usd.Prim, time: Usd.TimeCode) -> Polygons:
    """The polygons of an implicit prim at a time, in its own space and units.

    Raises:
        BadGeometry: a dimension is not one number or out of range, or the axis is invalid.
    """
    kind = schema_type(prim)
    names = _SHAPE_ATTRIBUTES[kind]
    axis = str(prim.GetAttribute("axis").Get(time)) if "axis" in names else "Z"
    return _rotate_axis(_MAKERS[kind](*(_measure(prim, name, time) for name in names if name != "axis")), axis)


def _measure(prim: Usd.Prim, name: str, time: Usd.TimeCode) -> float:
    try:
        measure = number(prim.GetAttribute(name), time)
    except TypeError as problem:
        raise BadGeometry(f"its {name} {problem}") from problem
    if not abs(measure) <= FARTHEST_POINT:
        raise BadGeometry(f"its {name} of {measure:g} is out of range, {FARTHEST_POINT:g} units")
    return measure


def _rotate_axis(polygons: Polygons, axis: str) -> Polygons:
    """Turn from the Z axis to another one.

    As in UsdGeomPlane, a plane's width stays on X for axis Y, its length stays on Y for axis X.
    """
    if axis == "Z" or polygons.normals is None:
        return polygons
    turn = {"X": ((2, 1, 0), (1, 1, -1)), "Y": ((0, 2, 1), (1, 1, -1))}.get(axis)
    if turn is None:
        raise BadGeometry(f"its axis must be X, Y or Z, got {axis}")

    def turned(vectors: FloatArray) -> FloatArray:
        return np.array(vectors[:, turn[0]] * np.array(turn[1]), np.float32)

    normals = Values(turned(polygons.normals.values), polygons.normals.interpolation)
    return Polygons(turned(polygons.points), polygons.counts, polygons.corners, normals)


def _cube(size: float) -> Polygons:
    """Points and faces in Hydra's order (OpenUSD's ``GeomUtilCuboidMeshGenerator``), which primvars of a cube follow."""
    h = size / 2
    front = [(h, h, h), (-h, h, h), (-h, -h, h), (h, -h, h)]
    back = [(-h, -h, -h), (-h, h, -h), (h, h, -h), (h, -h, -h)]
    faces = [(0, 1, 2, 3), (4, 5, 6, 7), (0, 6, 5, 1), (4, 7, 3, 2), (0, 3, 7, 6), (4, 2, 1, 5)]
    normals = np.array([[0, 0, 1], [0, 0, -1], [0, 1, 0], [0, -1, 0], [1, 0, 0], [-1, 0, 0]], np.float32)
    points = np.array(front + back, np.float32)
    return Polygons(points, np.full(6, 4, np.int32), np.array(faces, np.int32).ravel(), Values(normals, "uniform"))


def _plane(width: float, length: float) -> Polygons:
    w, h = width / 2, length / 2
    points = np.array([[-w, -h, 0], [w, -h, 0], [w, h, 0], [-w, h, 0]], np.float32)
    normals = Values(np.array([[0, 0, 1]], np.float32), "constant")
    return Polygons(points, np.array([4], np.int32), np.arange(4, dtype=np.int32), normals)


def _sphere(radius: float) -> Polygons:
    angle = np.linspace(-np.pi / 2, np.pi / 2, 2 * STEPS_OVER_CAP + 1)
    return _revolve([_arc(radius, 0.0, angle)])


def _cylinder(radius: float, height: float) -> Polygons:
    return _cylinder_1(radius, radius, height)


def _cylinder_1(radius_bottom: float, radius_top: float, height: float) -> Polygons:
    h = height / 2
    side = np.hypot(height, radius_bottom - radius_top) or 1.0
    out, up = height / side, (radius_bottom - radius_top) / side
    wall = np.array([[radius_bottom, -h, out, up], [radius_top, h, out, up]])
    bottom = np.array([[0, -h, 0, -1], [radius_bottom, -h, 0, -1]])
    top = np.array([[radius_top, h, 0, 1], [0, h, 0, 1]])
    caps = [cap for cap, radius in ((bottom, radius_bottom), (top, radius_top)) if radius > 0]
    return _revolve([wall, *caps])


def _cone(radius: float, height: float) -> Polygons:
    return _cylinder_1(radius, 0.0, height)


def _capsule(radius: float, height: float) -> Polygons:
    return _capsule_1(radius, radius, height)


def _capsule_1(radius_bottom: float, radius_top: float, height: float) -> Polygons:
    quarter = np.linspace(0, np.pi / 2, STEPS_OVER_CAP + 1)
    side = np.hypot(height, radius_bottom - radius_top) or 1.0
    out, up = height / side, (radius_bottom - radius_top) / side
    wall = np.array([[radius_bottom, -height / 2, out, up], [radius_top, height / 2, out, up]])
    return _revolve(
        [_arc(radius_bottom, -height / 2, quarter - np.pi / 2), wall, _arc(radius_top, height / 2, quarter)]
    )


def _arc(radius: float, centre: float, angle: DoubleArray) -> DoubleArray:
    """``(n, 4)`` profile rows (distance from the axis, height, normal out, normal up) of an arc about the axis."""
    cos, sin = np.cos(angle), np.sin(angle)
    cos[np.abs(angle) == np.pi / 2] = 0.0
    return np.stack([radius * cos, centre + radius * sin, cos, sin], axis=1)


def _revolve(profiles: list[DoubleArray]) -> Polygons:
    """Turn profiles about Z: quads between neighbouring rows, triangles at the axis, a normal for each point."""
    around = np.arange(STEPS_AROUND) * (2 * np.pi / STEPS_AROUND)
    cos, sin = np.cos(around), np.sin(around)
    points, normals, counts, corners = [], [], [], []
    base = 0
    for profile in profiles:
        r, z, out, up = (profile[:, i, None] for i in range(4))
        points.append(np.stack([r * cos, r * sin, z + 0 * cos], axis=-1).reshape(-1, 3))
        normals.append(np.stack([out * cos, out * sin, up + 0 * cos], axis=-1).reshape(-1, 3))
        for row in range(len(profile) - 1):
            count, corner = _band(base + row * STEPS_AROUND, bool(r[row] == 0), bool(r[row + 1] == 0))
            counts.append(count)
            corners.append(corner)
        base += len(profile) * STEPS_AROUND
    return Polygons(
        np.concatenate(points).astype(np.float32),
        np.concatenate(counts),
        np.concatenate(corners),
        Values(np.concatenate(normals).astype(np.float32), "vertex"),
    )


def _band(first: int, starts_at_axis: bool, ends_at_axis: bool) -> tuple[IntArray, IntArray]:
    """Faces between two rings of points that start at ``first``; counts and corners."""
    here = first + np.arange(STEPS_AROUND)
    beside = first + (np.arange(STEPS_AROUND) + 1) % STEPS_AROUND
    above, above_beside = here + STEPS_AROUND, beside + STEPS_AROUND
    if starts_at_axis:
        ring = [here, above_beside, above]
    elif ends_at_axis:
        ring = [here, beside, above]
    else:
        ring = [here, beside, above_beside, above]
    corners = np.stack(ring, axis=1).astype(np.int32)
    return np.full(STEPS_AROUND, corners.shape[1], np.int32), corners.ravel()


_MAKERS: dict[str, Callable[..., Polygons]] = {
    "Sphere": _sphere,
    "Cube": _cube,
    "Cylinder": _cylinder,
    "Cylinder_1": _cylinder_1,
    "Cone": _cone,
    "Capsule": _capsule,
    "Capsule_1": _capsule_1,
    "Plane": _plane,
}
