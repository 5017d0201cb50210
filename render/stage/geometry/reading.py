"""Reading of the surfaces of prims, small ones together."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from render import colour
from render.model.face_places import FacePlaces
from render.stage.color_spaces import to_rec709
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import UNIT_METRIC, Displacement, Metric, displace, look_up, texels_between
from render.stage.geometry.packs import Field, Pack, field_of, folded_shares, join_fields, pack_surfaces
from render.stage.geometry.polygons import BadGeometry, Polygons, Values, check, compute_normals, merge_duplicates
from render.stage.geometry.primvars import find_primvar
from render.stage.geometry.shape import PackFields, PrimvarNames, Shape, ValuePrimvar, build_shapes
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.stand_ins import StandIn, card_coordinates, stand_in_polygons
from render.stage.geometry.surface import read_surface

# Slivers of dense meshes fold by rounding; below this share of the area it is invisible.
_FOLDS_SHOW_FROM = 0.001
_PACK_CORNERS = 1 << 17
"""Corners up to which surfaces are packed: numpy runs long enough, in some ten megabytes."""

_FIELDS = ("normals", "uv", "color", "opacity")


@dataclass(frozen=True, eq=False)
class ShapeSource:
    """Surface that is to be read.

    Attributes:
        prim: a drawable prim.
        primvars: the primvars that its material reads.
        judged: whether it has a ``closed_box`` if it is closed.
        seams: whether edges with points of their own may close it where they meet.
        level: steps of refinement of a subdivision surface.
        stand_in: stand-in that is drawn in place of a model.
        displacement: by how much it is displaced, or None.
        metric: of its prim's space, for its displacement.
    """

    prim: Usd.Prim
    primvars: PrimvarNames
    judged: bool
    seams: bool
    level: int = 0
    stand_in: StandIn | None = None
    displacement: Displacement | None = None
    metric: Metric = UNIT_METRIC


@dataclass(frozen=True, eq=False)
class _Surface:
    """Surface as it is read from its prim."""

    source: ShapeSource
    polygons: Polygons
    normals: Field | None
    uv: Field | None
    color: Field | None
    opacity: Field | None
    values: tuple[Field, ...]

    @property
    def kind(self) -> Hashable:
        """Surfaces of the same kind go into one pack."""
        widths = tuple(field.values.shape[1] for field in self.values)
        fields = (getattr(self, name) is None for name in _FIELDS)
        return self.polygons.left_handed, self.polygons.smooth, widths, *fields


def read_shapes(
    sources: Sequence[ShapeSource], time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog
) -> list[Shape | None]:
    """Read surfaces at a time; None, and a finding, for each whose polygons cannot be used.

    Args:
        sources: the surfaces.
        time: when.
        skeletons: bend meshes.
        log: for findings.
    """
    shapes: list[Shape | None] = [None] * len(sources)
    waiting: dict[Hashable, list[tuple[int, _Surface]]] = defaultdict(list)
    corners: dict[Hashable, int] = defaultdict(int)

    def make(kind: Hashable) -> None:
        surfaces = waiting.pop(kind)
        corners.pop(kind)
        for (number, _), shape in zip(surfaces, _make_shapes([one for _, one in surfaces], log), strict=True):
            shapes[number] = shape

    for number, source in enumerate(sources):
        surface = _SurfaceReader(source, time, skeletons, log).read()
        if surface is None:
            continue
        kind = surface.kind
        waiting[kind].append((number, surface))
        corners[kind] += len(surface.polygons.corners)
        if corners[kind] >= _PACK_CORNERS:
            make(kind)
    for kind in list(waiting):
        make(kind)
    return shapes


def read_displaced(source: ShapeSource, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> Polygons | None:
    """Polygons of a surface at a time, displaced; None, and a finding, where they cannot be used.

    Args:
        source: the surface.
        time: when.
        skeletons: bend meshes.
        log: for findings.
    """
    return _SurfaceReader(source, time, skeletons, log).polygons()


def _make_shapes(surfaces: Sequence[_Surface], log: FindingLog) -> list[Shape | None]:
    """Shapes of surfaces of one kind."""
    pack = pack_surfaces([surface.polygons for surface in surfaces])
    for surface, share in zip(surfaces, folded_shares(pack), strict=True):
        if share > _FOLDS_SHOW_FROM:
            path = surface.source.prim.GetPath()
            message = f"{path} has concave faces, whose fans cover {share:.1%} of its area too much"
            log.add("concave_faces", path, message)
    normals, uv, color, opacity = (_join([getattr(surface, name) for surface in surfaces]) for name in _FIELDS)
    judged, seams = (np.array([getattr(surface.source, name) for surface in surfaces]) for name in ("judged", "seams"))
    values = tuple(join_fields(fields) for fields in zip(*(surface.values for surface in surfaces), strict=True))
    fields = PackFields(normals or _computed_normals(pack), uv, color, opacity, values)
    shapes: list[Shape | None] = []
    for surface, built in zip(surfaces, build_shapes(pack, fields, judged, seams), strict=True):
        shape = _on_authored_faces(built, surface.polygons)
        if surface.source.primvars.place:
            shape = replace(shape, colors=np.pad(shape.positions, ((0, 0), (0, 1)), constant_values=1))
        shapes.append(shape if len(shape.triangles) else None)
        if not len(shape.triangles):
            _note_no_faces(surface.source.prim, log)
    return shapes


def _on_authored_faces(shape: Shape, polygons: Polygons) -> Shape:
    """A shape whose triangles name the authored faces that they are parts of."""
    authored = polygons.authored
    if authored is None:
        return shape
    faces = shape.face_ids
    first = (np.cumsum(polygons.counts, dtype=np.int64) - polygons.counts)[faces]
    corners = np.stack([first, first + shape.fan_ids + 1, first + shape.fan_ids + 2], axis=1)
    places = FacePlaces(authored.places[corners], authored.sizes[faces])
    return replace(shape, face_ids=authored.faces[faces], places=places)


def _join(fields: list[Field | None]) -> Field | None:
    """Fields of surfaces of one kind: all of them have one, or none."""
    found = [field for field in fields if field is not None]
    return join_fields(found) if found else None


def _computed_normals(pack: Pack) -> Field:
    return field_of(compute_normals(pack.polygons, pack.fan), pack.polygons)


def _note_no_faces(prim: Usd.Prim, log: FindingLog) -> None:
    path = prim.GetPath()
    log.add("no_faces", path, f"{path} is not drawn: it has no face with three corners or more")


class _SurfaceReader:
    """Reads the polygons of a prim, and its primvars."""

    def __init__(self, source: ShapeSource, time: Usd.TimeCode, skeletons: Skeletons, log: FindingLog) -> None:
        self._source, self._time, self._skeletons, self._log = source, time, skeletons, log
        self._prim = source.prim

    def polygons(self) -> Polygons | None:
        """Polygons of the surface, displaced; None, and a finding, where they cannot be used."""
        try:
            polygons = self._undisplaced()
            check(polygons)
            if self._source.displacement is not None:
                polygons = self._displaced(polygons, self._source.displacement)
                check(polygons)
        except BadGeometry as problem:
            path = self._prim.GetPath()
            self._log.add("bad_geometry", path, f"{path} is not drawn: {problem}")
            return None
        return polygons

    def read(self) -> _Surface | None:
        """The surface; None, and a finding, where its polygons cannot be used."""
        polygons = self.polygons()
        if polygons is None:
            return None
        if not len(polygons.corners):
            _note_no_faces(self._prim, self._log)
            return None
        names = self._source.primvars
        return _Surface(
            self._source,
            polygons,
            self._normals(polygons),
            self._coordinates(polygons, names.uv, names.uv_fallback) if names.uv is not None else None,
            self._color(polygons, names) if names.color is not None else None,
            self._opacity(polygons, names) if names.opacity is not None else None,
            tuple(self._value(polygons, each) for each in names.values),
        )

    def _undisplaced(self) -> Polygons:
        if self._source.stand_in is not None:
            return stand_in_polygons(self._source.stand_in, self._prim, self._time)
        return read_surface(self._prim, self._time, self._skeletons, self._log, self._source.level)

    def _displaced(self, polygons: Polygons, displacement: Displacement) -> Polygons:
        width = 2 if displacement.lookup is not None else 1
        read = self._primvar(polygons, displacement.primvar, width) if displacement.primvar is not None else None
        lookup = displacement.lookup
        if read is None and lookup is not None:
            read = self._coordinates(polygons, displacement.primvar or "", (0.0, 0.0))
        if read is None:
            amounts = np.full(len(polygons.corners), displacement.amount)
        elif lookup is None:
            amounts = read.values[read.index, 0]
        else:
            step = texels_between(lookup, read.values[read.index], polygons)
            amounts = look_up(lookup, read.values, step)[read.index]
        return displace(polygons, amounts, self._source.metric)

    def _normals(self, polygons: Polygons) -> Field | None:
        """Authored normals, or None."""
        if polygons.normals is None:
            return None
        try:
            if not np.isfinite(polygons.normals.values).all():
                raise BadGeometry("not all of them are finite")
            return field_of(polygons.normals, polygons)
        except BadGeometry as problem:
            path = self._prim.GetPath()
            self._log.add("bad_normals", path, f"the normals of {path} are computed instead of read: {problem}")
            return None

    def _value(self, polygons: Polygons, read: ValuePrimvar) -> Field:
        """A further primvar, or its fallback."""
        found = self._primvar(polygons, read.name, len(read.fallback), is_color=read.is_color)
        field = found or _constant(polygons, read.fallback)
        return replace(field, values=colour.to_working(field.values)) if read.is_color else field

    def _coordinates(self, polygons: Polygons, name: str, fallback: tuple[float, ...]) -> Field:
        """Texture coordinates, or what UsdPrimvarReader falls back to everywhere for a mesh that lacks them."""
        if self._source.stand_in is not None:
            return field_of(Values(card_coordinates(self._source.stand_in), "vertex"), polygons)
        found = self._primvar(polygons, name, 2)
        if found is None:
            path = self._prim.GetPath()
            message = f"{path} has no texture coordinates {name}: its textures are read at one place"
            self._log.add("no_texture_coordinates", path, message)
        return found or _constant(polygons, fallback)

    def _color(self, polygons: Polygons, names: PrimvarNames) -> Field:
        return self._primvar(polygons, names.color, 3, is_color=True) or _constant(polygons, names.color_fallback)

    def _opacity(self, polygons: Polygons, names: PrimvarNames) -> Field:
        found = self._primvar(polygons, names.opacity, 1)
        if found is None and names.opacity_fallback == 0:
            path = self._prim.GetPath()
            message = (
                f"{path} is invisible: its material reads its opacity from the primvar {names.opacity}, which it lacks"
            )
            self._log.add("no_opacity", path, message)
        return found or _constant(polygons, (names.opacity_fallback,))

    def _primvar(self, polygons: Polygons, name: str | None, width: int, *, is_color: bool = False) -> Field | None:
        found = find_primvar(self._prim, name) if name is not None else None
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
        if is_color:
            values = replace(values, values=to_rec709(values.values, found.primvar.GetAttr(), self._log))
        values = _deduplicate(values)
        try:
            sampling = polygons.sampling
            return field_of(values if sampling is None else sampling.resample(values), polygons)
        except BadGeometry as problem:
            self._log.add(f"bad_primvar_{name}", path, f"primvar {name} of {path} is not used: {problem}")
            return None


def _constant(polygons: Polygons, value: tuple[float, ...]) -> Field:
    return Field(np.array([value], np.float32), np.zeros(len(polygons.corners), np.int64), None)


def _deduplicate(values: Values) -> Values:
    """Merge equal values of a face-varying primvar that has no indices, so that its corners can share vertices."""
    if values.interpolation != "faceVarying" or values.indices is not None:
        return values
    distinct, inverse = merge_duplicates(values.values)
    return Values(distinct, values.interpolation, inverse.astype(np.int32))
