"""Pieces of surfaces, each with one material, and the reading of their triangles."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, replace

from pxr import Usd

from render.stage.assembly.instance_primvars import InstancePrimvars
from render.stage.assembly.inventory import Occurrence
from render.stage.assembly.subdivision_levels import Levels
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import Metric
from render.stage.geometry.reading import ShapeSource, read_shapes
from render.stage.geometry.shape import PrimvarNames, Shape, pick_faces
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.stand_ins import StandIn
from render.stage.materials.bindings import bound_parts, face_owner
from render.stage.materials.material import DEFAULT_LOOK, BoundMaterial


@dataclass(frozen=True)
class Sides:
    """Sides of a surface that are drawn.

    Attributes:
        double: whether both sides are outsides.
        culled: whether back faces are left out otherwise.
        opaque: whether all parts of the surface by material are opaque, or there is only one part, so that front faces may hide
            back faces of other parts.
    """

    double: bool
    culled: bool
    opaque: bool


@dataclass(frozen=True, eq=False)
class Piece:
    """The faces of one surface at one place that wear one material.

    Attributes:
        occurrence: the surface and its place.
        material: path of the material prim that it is drawn with, or empty.
        bound_material: path of the material prim that it is bound to, which may look the same, or empty.
        part: which of the surface's parts by material this is.
        part_count: number of such parts.
        sides: sides that are drawn.
        deforms: whether the surface's polygons or primvars vary.
        primvars: primvars that the material reads.
        inherited: primvars that it takes from its point instancers.
        shape_key: the same for pieces whose surfaces have the same triangles and primvars.
        stand_in: stand-in that is drawn in place of a model.
        metric: metric of its prim's space, where its material displaces it; else None.
    """

    occurrence: Occurrence
    material: str
    bound_material: str
    part: int
    part_count: int
    sides: Sides
    deforms: bool
    primvars: PrimvarNames
    inherited: InstancePrimvars
    shape_key: Hashable
    stand_in: StandIn | None = None
    metric: Metric | None = None


class ShapeReader:
    """Reads the triangles of pieces at one time, each surface once.

    Args:
        skeletons: bend meshes.
        binding_purposes: of materials (`render.stage.materials.bindings.binding_purposes`).
        time: when.
        log: notes surfaces that cannot be used.

    Attributes:
        time: when.
        levels: steps of refinement of subdivision surfaces; they may be set anew before any read.
        look: the look of a material path, for its displacement; it is set before any read.
    """

    def __init__(
        self, skeletons: Skeletons, binding_purposes: Sequence[str], time: Usd.TimeCode, log: FindingLog
    ) -> None:
        self._skeletons, self._binding_purposes, self._log = skeletons, binding_purposes, log
        self.time = time
        self.levels: Levels = {}
        self.look: Callable[[str], BoundMaterial] = lambda _: DEFAULT_LOOK
        self._shapes: dict[Hashable, Shape | None] = {}

    def levels_of(self, pieces: Sequence[Piece]) -> tuple[int, ...]:
        """Steps of refinement of pieces; empty where nothing is refined."""
        levels = self.levels
        return tuple(levels.get(piece.occurrence.source, 0) for piece in pieces) if levels else ()

    def shape(self, piece: Piece) -> Shape | None:
        """Triangles of a piece, in the prim's space and units; None where there are none or they cannot be used."""
        whole, linked = self.whole(piece), piece.occurrence.linked_faces
        if whole is None or (piece.part_count == 1 and linked is None):
            return whole
        prim, count = piece.occurrence.prim, int(whole.face_ids.max(initial=0)) + 1
        if piece.stand_in is not None:
            owner = piece.stand_in.part_of_faces()
        else:
            owner = face_owner(bound_parts(prim, self._binding_purposes, self.time, self._log), count)
        keep = owner[whole.face_ids] == piece.part
        if linked is not None:
            keep &= linked.held(prim, count, self.time, self._log)[whole.face_ids]
        return pick_faces(whole, keep) if keep.any() else None

    def whole(self, piece: Piece) -> Shape | None:
        """The triangles of the whole surface that a piece is part of."""
        key = self._key(piece)
        if key not in self._shapes:
            self.prepare([piece])
        return self._shapes[key]

    def prepare(self, pieces: Iterable[Piece]) -> None:
        """Read the surfaces of many pieces, which is faster together than one by one."""
        new = {key: piece for piece in pieces if (key := self._key(piece)) not in self._shapes}
        sources = [self._source(piece) for piece in new.values()]
        shapes = read_shapes(sources, self.time, self._skeletons, self._log)
        self._shapes.update(zip(new, shapes, strict=True))

    def _key(self, piece: Piece) -> Hashable:
        level = self.levels.get(piece.occurrence.source, 0)
        return (piece.shape_key, level) if level else piece.shape_key

    def _source(self, piece: Piece) -> ShapeSource:
        """A piece's surface. It is judged where back faces that it hides may be left out: they are seen from within alone.

        Surfaces that bend may come apart at their seams: those must be closed without them.
        """
        judged = not piece.sides.culled and piece.sides.opaque
        level = self.levels.get(piece.occurrence.source, 0)
        source = ShapeSource(
            piece.occurrence.prim, piece.primvars, judged, seams=not piece.deforms, level=level, stand_in=piece.stand_in
        )
        if piece.metric is None:
            return source
        return replace(source, displacement=self.look(piece.material).displacement, metric=piece.metric)
