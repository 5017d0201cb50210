"""The polygons of one prim at one time: a mesh, a mesh that a skeleton bends, or what is made from another kind of prim."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from pxr import Usd, UsdGeom, Vt

from render.model.arrays import FloatArray, IntArray, LongArray
from render.stage.findings import FindingLog
from render.stage.geometry.generated import generated_polygons, generated_varies, is_generated
from render.stage.geometry.points_data import (
    as_points,
    authored_normals,
    has_velocities,
    point_values,
    read_points,
    whole_numbers,
)
from render.stage.geometry.polygons import FARTHEST_POINT, BadGeometry, Polygons, check, check_counts
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.subdivision.limit_places import LimitPlaces
from render.stage.geometry.subdivision.reading import ATTRIBUTES as SUBDIVISION
from render.stage.geometry.subdivision.reading import has_sharpness, read_cage
from render.stage.geometry.subdivision.refinement import MOST_TRIANGLES, Refinement, fitting_level, sharpen_control_mesh
from render.stage.values import UNREADABLE, why_unreadable

_FACES = ("faceVertexCounts", "faceVertexIndices")
_MESH_ATTRIBUTES = ("points", *_FACES, "holeIndices", "normals", "primvars:normals", *SUBDIVISION)


def is_drawable(prim: Usd.Prim) -> bool:
    """Whether :func:`read_surface` can make polygons of this prim."""
    return is_generated(prim) or prim.IsA(UsdGeom.Mesh)


def surface_varies(prim: Usd.Prim, skeletons: Skeletons) -> bool:
    """Whether the prim's polygons may change over time in its own space."""
    if is_generated(prim):
        return generated_varies(prim)
    return _varies(prim, _MESH_ATTRIBUTES) or has_velocities(prim) or skeletons.bends(prim)


def read_surface(prim: Usd.Prim, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog, level: int = 0) -> Polygons:
    """The polygons of a drawable prim.

    Args:
        prim: for which `is_drawable` holds.
        time: when.
        skeletons: bend meshes.
        log: for findings.
        level: steps of refinement of a mesh with a subdivision scheme, whose points are on the limit surface then; 0 for its
            control mesh.

    Raises:
        BadGeometry: the values are of other types than the schema's, or are inconsistent; the message explains the fault.
    """
    with _translate_errors():
        if not is_generated(prim):
            polygons = _mesh_polygons(prim, time, skeletons, log)
            return _refine(prim, polygons, level, time, log)
        if skeletons.bends(prim):
            path = prim.GetPath()
            log.add("not_bent", path, f"{path} is drawn as at rest: a skeleton bends meshes alone")
        return generated_polygons(prim, time, log)


def mesh_faces(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[IntArray, IntArray]:
    """Corner counts of a mesh's faces, and the point index of each corner.

    Raises:
        BadGeometry: the arrays contradict each other, or are not integers.
    """
    mesh = UsdGeom.Mesh(prim)
    with _translate_errors():
        counts = whole_numbers(mesh.GetFaceVertexCountsAttr(), time)
        corners = whole_numbers(mesh.GetFaceVertexIndicesAttr(), time)
    check_counts(counts, corners)
    return counts, corners


def limit_places(prim: Usd.Prim, time: Usd.TimeCode) -> LimitPlaces:
    """Places on the limit surface of a mesh with a subdivision scheme.

    Raises:
        BadGeometry: its faces or its rules cannot be used, or it is too large to be refined.
    """
    counts, corners = mesh_faces(prim, time)
    if not fitting_level(len(corners), 1):
        raise BadGeometry(f"it has more than {MOST_TRIANGLES:,} triangles once it is refined")
    polygons = Polygons(np.zeros((len(resting_points(prim, time)), 3), np.float32), counts, corners)
    check(polygons)
    with _translate_errors():
        return LimitPlaces(read_cage(prim, time), polygons)


def faces_vary(prim: Usd.Prim) -> bool:
    """Whether a mesh's faces, or its rules of subdivision, may change over time."""
    return _varies(prim, (*_FACES, *SUBDIVISION))


def _varies(prim: Usd.Prim, names: Sequence[str]) -> bool:
    return any(attribute and attribute.ValueMightBeTimeVarying() for attribute in map(prim.GetAttribute, names))


def resting_points(prim: Usd.Prim, time: Usd.TimeCode) -> Vt.Vec3fArray:
    """The points of a mesh in its own space, before a skeleton bends them.

    Raises:
        BadGeometry: there are no points, or they are not valid.
    """
    with _translate_errors():
        value = point_values(prim, time)
        whole = isinstance(value, Vt.Vec3fArray) and len(value) > 0
        return value if whole else Vt.Vec3fArray.FromNumpy(as_points(value))


def mesh_points(
    prim: Usd.Prim, resting: Vt.Vec3fArray, rows: LongArray, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog
) -> FloatArray:
    """Where some of a mesh's points are, in its own space, as `read_surface` has them all.

    Args:
        prim: a mesh.
        resting: its points, as `resting_points` gives them at the time.
        rows: ``(n,)`` which of them.
        time: when.
        skeletons: bend meshes.
        log: for findings.

    Returns:
        ``(n, 3)``.

    Raises:
        BadGeometry: the mesh does not have them, or they are not finite.
    """
    if not 0 <= rows.min() <= rows.max() < len(resting):
        raise BadGeometry(f"its face has the points {rows.min()} to {rows.max()}, and there are {len(resting)}")
    found = skeletons.bend_points(prim, resting, time, log, rows)
    if not (np.abs(found) <= FARTHEST_POINT).all():
        raise BadGeometry(f"a point of its face is not finite or out of range, {FARTHEST_POINT:g} units")
    return found


@contextmanager
def _translate_errors() -> Iterator[None]:
    """Raise the errors of reading a value of the wrong type as `BadGeometry`."""
    try:
        yield
    except BadGeometry:
        raise
    except UNREADABLE as problem:
        raise BadGeometry(why_unreadable(problem)) from problem


def _mesh_polygons(prim: Usd.Prim, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> Polygons:
    mesh = UsdGeom.Mesh(prim)
    polygons = Polygons(
        points=read_points(prim, time),
        counts=whole_numbers(mesh.GetFaceVertexCountsAttr(), time),
        corners=whole_numbers(mesh.GetFaceVertexIndicesAttr(), time),
        normals=authored_normals(prim, time),
        left_handed=mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded,
        smooth=_is_subdivided(mesh, time),
        holes=whole_numbers(mesh.GetHoleIndicesAttr(), time),
    )
    _note_holes(prim, polygons, log)
    return skeletons.bend(prim, polygons, time, log)


def _refine(prim: Usd.Prim, polygons: Polygons, level: int, time: Usd.TimeCode, log: FindingLog) -> Polygons:
    """Polygons on the limit surface; the control mesh at level 0, and, with a finding, where its rules cannot be used."""
    level = fitting_level(len(polygons.corners), level)  # chosen for the faces of another time
    is_sharp = polygons.smooth and polygons.normals is None and has_sharpness(prim)
    if not level and not is_sharp:
        return polygons
    check(polygons)
    try:
        cage = read_cage(prim, time)
        return Refinement(cage, polygons, level).refine() if level else sharpen_control_mesh(cage, polygons)
    except UNREADABLE as problem:
        path = prim.GetPath()
        log.add("subdivision", path, f"{path} is drawn as its control mesh: {why_unreadable(problem)}")
        return polygons


def _note_holes(prim: Usd.Prim, polygons: Polygons, log: FindingLog) -> None:
    holes, count = polygons.holes, len(polygons.counts)
    if holes is not None and len(holes) and not 0 <= holes.min() <= holes.max() < count:
        path = prim.GetPath()
        message = f"holeIndices of {path} run from {holes.min()} to {holes.max()}, but there are {count} faces"
        log.add("bad_holes", path, f"{message}: those of faces alone are honoured")


def _is_subdivided(mesh: UsdGeom.Mesh, time: Usd.TimeCode) -> bool:
    return mesh.GetSubdivisionSchemeAttr().Get(time) in (UsdGeom.Tokens.catmullClark, UsdGeom.Tokens.loop)
