"""Surfaces of prims as vertices and triangles, with the primvars that their materials read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from render import colour
from render.model.arrays import BoolArray, FloatArray, IntArray, LongArray
from render.model.face_places import FacePlaces
from render.model.scene import VALUES_WIDTH
from render.stage.geometry.closed import find_closed
from render.stage.geometry.packs import Field, Pack
from render.stage.geometry.polygons import unit, weld

Scalar = TypeVar("Scalar", bound=np.generic)

# Hydra's colour without an authored displayColor.
FALLBACK_DISPLAY_COLOR = (0.5, 0.5, 0.5)


@dataclass(frozen=True)
class ValuePrimvar:
    """Further primvar that a material reads.

    Attributes:
        name: of the primvar.
        fallback: its numbers where a prim has no such primvar; as many as are read.
        is_color: whether it is a colour, whose fallback is linear Rec. 709.
    """

    name: str
    fallback: tuple[float, ...]
    is_color: bool = False


@dataclass(frozen=True)
class PrimvarNames:
    """The primvars that a material reads.

    Attributes:
        uv: name of the texture coordinates, or None.
        color: name of the colour that multiplies base_color, or None.
        opacity: name of the opacity that multiplies the material's, or None.
        color_fallback: linear Rec. 709 colour where the mesh has no such primvar.
        opacity_fallback: opacity where the mesh has no such primvar.
        place: whether it reads the place in the prim's own space, in its units, which is held in place of the colours.
        uv_fallback: texture coordinates where the mesh has none.
        values: further ones, at most `render.model.scene.VALUES_WIDTH` numbers together.
    """

    uv: str | None = "st"
    color: str | None = None
    opacity: str | None = None
    color_fallback: tuple[float, float, float] = FALLBACK_DISPLAY_COLOR
    opacity_fallback: float = 1.0
    place: bool = False
    uv_fallback: tuple[float, float] = (0.0, 0.0)
    values: tuple[ValuePrimvar, ...] = ()

    @property
    def all_names(self) -> tuple[str, ...]:
        """Names of all of them."""
        return *(name for name in (self.uv, self.color, self.opacity) if name), *(each.name for each in self.values)


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
        places: places of triangles that are finer than the fans of their faces, or None.
        values: ``(n, VALUES_WIDTH)`` float32 further primvars, colours in the working space, or None.
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
    places: FacePlaces | None = None
    values: FloatArray | None = None


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
        None if shape.places is None else shape.places.pick(keep),
        None if shape.values is None else shape.values[used],
    )


@dataclass(frozen=True, eq=False)
class PackFields:
    """Primvars of a pack that are read, at its corners.

    Attributes:
        normals: their normals.
        uv: texture coordinates, or None where no material reads any.
        color: colours in linear Rec. 709, or None.
        opacity: opacities, or None.
        values: further ones, colours in the working space.
    """

    normals: Field
    uv: Field | None
    color: Field | None
    opacity: Field | None
    values: tuple[Field, ...] = ()


def build_shapes(pack: Pack, fields: PackFields, judged: BoolArray, seams: BoolArray) -> Iterator[Shape]:
    """Weld the corners of surfaces and make their vertices.

    Args:
        pack: the surfaces.
        fields: what is read of their primvars.
        judged: ``(k,)`` which of them have a ``closed_box`` if they are closed.
        seams: ``(k,)`` whether edges with points of their own may close a surface where they meet.

    Yields:
        The shape of each surface, in order.
    """
    polygons, fan = pack.polygons, pack.fan
    read = [
        field
        for field in (fields.normals, fields.uv, fields.color, fields.opacity, *fields.values)
        if field is not None
    ]
    corner, vertex_of_corner = weld(polygons, [field.splits for field in read if field.splits is not None])
    vertices = np.searchsorted(polygons.corners[corner], pack.points)
    owner = pack.owners(pack.triangles)
    triangles = (vertex_of_corner[fan.corners] - vertices[owner, None]).astype(np.int32)
    positions = polygons.points[polygons.corners[corner]]
    normals = unit(fields.normals.values[fields.normals.index[corner]])
    uvs = np.nan_to_num(fields.uv.values[fields.uv.index[corner]]) if fields.uv else None
    colors = _colors(fields, corner)
    values = _values(fields, corner)
    if polygons.left_handed:
        triangles = triangles[:, [0, 2, 1]]
    face_ids = fan.face_ids - pack.faces[owner].astype(np.int32)
    closed = judged & find_closed(pack, seams) if judged.any() else judged
    for number in range(pack.count):
        own, its = slice(*vertices[number : number + 2]), slice(*pack.triangles[number : number + 2])
        place = _cut(positions, own)
        yield Shape(
            positions=place,
            normals=_cut(normals, own),
            triangles=_cut(triangles, its),
            face_ids=_cut(face_ids, its),
            fan_ids=_cut(fan.fan_ids, its),
            swapped=np.full(its.stop - its.start, polygons.left_handed),
            uvs=None if uvs is None else _cut(uvs, own),
            colors=None if colors is None else _cut(colors, own),
            closed_box=np.stack([place.min(axis=0), place.max(axis=0)]) if closed[number] else None,
            values=None if values is None else _cut(values, own),
        )


def _colors(fields: PackFields, corner: LongArray) -> FloatArray | None:
    if fields.color is None and fields.opacity is None:
        return None
    out = np.ones((len(corner), 4), np.float32)
    if fields.color is not None:
        out[:, :3] = colour.to_working(fields.color.values)[fields.color.index[corner]]
    if fields.opacity is not None:
        out[:, 3] = fields.opacity.values[fields.opacity.index[corner], 0]
    return np.nan_to_num(out)


def _values(fields: PackFields, corner: LongArray) -> FloatArray | None:
    if not fields.values:
        return None
    out = np.zeros((len(corner), VALUES_WIDTH), np.float32)
    first = 0
    for field in fields.values:
        own = field.values[field.index[corner]]
        out[:, first : first + own.shape[1]] = own
        first += own.shape[1]
    return np.nan_to_num(out)


def _cut(rows: NDArray[Scalar], own: slice) -> NDArray[Scalar]:
    """Rows of one surface, which do not keep those of the others in memory."""
    return rows if own.stop - own.start == len(rows) else rows[own].copy()
