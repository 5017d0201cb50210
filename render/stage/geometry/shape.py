"""Surface of one prim as vertices and triangles, with the primvars that its material reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from render import colour
from render.model.arrays import FloatArray, IntArray, LongArray
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import (
    BadGeometry,
    Fan,
    Polygons,
    Values,
    check,
    compute_normals,
    fan,
    folded_share,
    merge_duplicates,
    unit,
    value_index_of_corner,
    weld,
)
from render.stage.geometry.primvars import find_primvar
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.surface import read_surface

# Hydra's colour without an authored displayColor.
FALLBACK_DISPLAY_COLOR = (0.5, 0.5, 0.5)

# Slivers of dense meshes fold by rounding; below this share of the area it is invisible.
_FOLDS_SHOW_FROM = 0.001


@dataclass(frozen=True)
class PrimvarNames:
    """The primvars that a material reads.

    Attributes:
        uv: name of the texture coordinates, or None.
        color: name of the colour that multiplies base_color, or None.
        opacity: name of the opacity that multiplies the material's, or None.
        color_fallback: linear Rec. 709 colour where the mesh has no such primvar.
        opacity_fallback: opacity where the mesh has no such primvar.
    """

    uv: str | None = "st"
    color: str | None = None
    opacity: str | None = None
    color_fallback: tuple[float, float, float] = FALLBACK_DISPLAY_COLOR
    opacity_fallback: float = 1.0


@dataclass(frozen=True, eq=False)
class Shape:
    """Vertices and triangles of one prim, in its own space and units.

    Attributes:
        positions: ``(n, 3)`` float32.
        normals: ``(n, 3)`` float32, unit length.
        triangles: ``(m, 3)`` int32, counter-clockwise seen from outside.
        face_ids: ``(m,)`` int32.
        fan_ids: ``(m,)`` int32.
        swapped: ``(m,)`` whether a triangle's last two corners stand in the other order than the fan's.
        uvs: ``(n, 2)`` float32 or None.
        colors: ``(n, 4)`` float32 in the working space, or None.
        closed_box: ``(2, 3)`` float32 least and greatest corners of the whole surface, where it is closed
            (`render.stage.geometry.closed`); None where it is open.
    """

    positions: FloatArray
    normals: FloatArray
    triangles: IntArray
    face_ids: IntArray
    fan_ids: IntArray
    swapped: NDArray[np.bool_]
    uvs: FloatArray | None = None
    colors: FloatArray | None = None
    closed_box: FloatArray | None = None


def read_shape(
    prim: Usd.Prim,
    time: Usd.TimeCode,
    primvars: PrimvarNames,
    skeletons: Skeletons,
    is_closed: Callable[[Polygons], bool],
    log: FindingLog,
) -> Shape | None:
    """Read a drawable prim, or note a finding and return None where its polygons cannot be used."""
    try:
        polygons = read_surface(prim, time, skeletons, log)
        check(polygons)
    except BadGeometry as problem:
        log.add("bad_geometry", prim.GetPath(), f"{prim.GetPath()} is not drawn: {problem}")
        return None
    fan_ = fan(polygons)
    if not len(fan_.face_ids):
        log.add("no_faces", prim.GetPath(), f"{prim.GetPath()} is not drawn: it has no face with three corners or more")
        return None
    folded = folded_share(polygons, fan_)
    if folded > _FOLDS_SHOW_FROM:
        message = f"{prim.GetPath()} has concave faces, whose fans cover {folded:.1%} of its area too much"
        log.add("concave_faces", prim.GetPath(), message)
    shape = _Builder(prim, time, polygons, fan_, log).build(primvars)
    if not is_closed(polygons):
        return shape
    return replace(shape, closed_box=np.stack([shape.positions.min(axis=0), shape.positions.max(axis=0)]))


def pick_faces(shape: Shape, keep: NDArray[np.bool_]) -> Shape:
    """The part of a shape whose triangles are marked in ``keep`` (``(m,)`` bool), with only the vertices it uses."""
    if keep.all():
        return shape
    used, triangles = np.unique(shape.triangles[keep], return_inverse=True)
    return Shape(
        shape.positions[used],
        shape.normals[used],
        triangles.reshape(-1, 3).astype(np.int32),
        shape.face_ids[keep],
        shape.fan_ids[keep],
        shape.swapped[keep],
        None if shape.uvs is None else shape.uvs[used],
        None if shape.colors is None else shape.colors[used],
        shape.closed_box,
    )


class _Builder:
    """Gathers a prim's primvars, welds its corners and makes the vertices."""

    def __init__(self, prim: Usd.Prim, time: Usd.TimeCode, polygons: Polygons, fan_: Fan, log: FindingLog) -> None:
        self._prim, self._time, self._polygons, self._fan, self._log = prim, time, polygons, fan_, log

    def build(self, primvars: PrimvarNames) -> Shape:
        normals, normal_index = self._normals()
        uv = self._coordinates(primvars.uv)
        color = self._primvar(primvars.color, 3) if primvars.color else None
        opacity = self._primvar(primvars.opacity, 1) if primvars.opacity else None
        read = [(normals, normal_index), *(p for p in (uv, color, opacity) if p)]
        splitting = [index for values, index in read if values.interpolation in ("uniform", "faceVarying")]
        corner, vertex_of_corner = weld(self._polygons, splitting)
        triangles = vertex_of_corner[self._fan.corners].astype(np.int32)
        left_handed = self._polygons.left_handed
        return Shape(
            positions=self._polygons.points[self._polygons.corners[corner]],
            normals=unit(normals.values[normal_index[corner]]),
            triangles=triangles[:, [0, 2, 1]] if left_handed else triangles,
            face_ids=self._fan.face_ids,
            fan_ids=self._fan.fan_ids,
            swapped=np.full(len(triangles), left_handed),
            uvs=np.nan_to_num(uv[0].values[uv[1][corner]]) if uv else None,
            colors=self._colors(primvars, color, opacity, corner),
        )

    def _normals(self) -> tuple[Values, LongArray]:
        authored = self._polygons.normals
        if authored is not None:
            try:
                if not np.isfinite(authored.values).all():
                    raise BadGeometry("not all of them are finite")
                return authored, value_index_of_corner(authored, self._polygons, self._fan)
            except BadGeometry as problem:
                path = self._prim.GetPath()
                self._log.add("bad_normals", path, f"the normals of {path} are computed instead of read: {problem}")
        computed = compute_normals(self._polygons, self._fan)
        return computed, value_index_of_corner(computed, self._polygons, self._fan)

    def _coordinates(self, name: str | None) -> tuple[Values, LongArray] | None:
        """Texture coordinates, or (0, 0) everywhere for a mesh that lacks them, as UsdPrimvarReader falls back to."""
        if name is None:
            return None
        found = self._primvar(name, 2)
        if found is None:
            path = self._prim.GetPath()
            message = f"{path} has no texture coordinates {name}: its textures are read at one place"
            self._log.add("no_texture_coordinates", path, message)
            found = Values(np.zeros((1, 2), np.float32), "constant"), np.zeros(len(self._polygons.corners), np.int64)
        return found

    def _primvar(self, name: str, width: int) -> tuple[Values, LongArray] | None:
        found = find_primvar(self._prim, name)
        if found is None:
            return None
        path = self._prim.GetPath()
        values = found.read(self._time, width)
        if values is None or not len(values.values):
            message = f"primvar {name} of {path} is not used: it does not hold {width} numbers for each element"
            self._log.add(f"bad_primvar_{name}", path, message)
            return None
        if not np.isfinite(values.values).all():
            message = f"primvar {name} of {path} has values that are not finite: 0 is used for them"
            self._log.add(f"bad_primvar_{name}", path, message)
            values = replace(values, values=np.nan_to_num(values.values, posinf=0.0, neginf=0.0))
        values = _deduplicate(values)
        try:
            return values, value_index_of_corner(values, self._polygons, self._fan)
        except BadGeometry as problem:
            self._log.add(f"bad_primvar_{name}", path, f"primvar {name} of {path} is not used: {problem}")
            return None

    def _colors(
        self,
        primvars: PrimvarNames,
        color: tuple[Values, LongArray] | None,
        opacity: tuple[Values, LongArray] | None,
        corner: LongArray,
    ) -> FloatArray | None:
        if primvars.color is None and primvars.opacity is None:
            return None
        out = np.ones((len(corner), 4), np.float32)
        if primvars.color is not None:
            linear = color[0].values if color else np.array([primvars.color_fallback], np.float32)
            working = colour.to_working(linear)
            out[:, :3] = working[color[1][corner]] if color else working
        if primvars.opacity is not None:
            out[:, 3] = opacity[0].values[opacity[1][corner], 0] if opacity else primvars.opacity_fallback
            if opacity is None and primvars.opacity_fallback == 0:
                path, name = self._prim.GetPath(), primvars.opacity
                message = f"{path} is invisible: its material reads its opacity from the primvar {name}, which it lacks"
                self._log.add("no_opacity", path, message)
        return np.nan_to_num(out)


def _deduplicate(values: Values) -> Values:
    """Merge equal values of a face-varying primvar that has no indices, so that its corners can share vertices."""
    if values.interpolation != "faceVarying" or values.indices is not None:
        return values
    distinct, inverse = merge_duplicates(values.values)
    return Values(distinct, values.interpolation, inverse.astype(np.int32))
