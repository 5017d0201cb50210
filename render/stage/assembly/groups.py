"""Groups of surfaces that are drawn together. A group caches its draws and rebuilds only what changes over time.

Surfaces that stand still against each other and share a material become one geometry, in the space of whatever carries
them. Surfaces that occur many times, or that bend, keep a geometry of their own and a pose for each place.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.scene import Batch, Geometry, Material
from render.stage.assembly.instance_primvars import NONE_INHERITED, instance_colors
from render.stage.assembly.inventory import Occurrence
from render.stage.assembly.joining import PlacedShape, place_shapes
from render.stage.assembly.level_choice import LevelChoice
from render.stage.assembly.pieces import Piece, ShapeReader
from render.stage.assembly.poses import (
    InstanceReader,
    instance_poses,
    is_hidden,
    relative_pose,
    world_pose,
)
from render.stage.findings import FindingLog
from render.stage.geometry.distances import is_placeable
from render.stage.geometry.shape import Shape
from render.stage.limits import PlaceError
from render.stage.materials.material import BoundMaterial


@dataclass(frozen=True, eq=False)
class DrawContext:
    """Resources for drawing a group at one time.

    Attributes:
        transforms: transforms at that time.
        world: world from stage.
        scale: metres in a stage unit.
        look: the look of a material path at that time.
        shapes: reads the triangles of pieces at that time.
        instances: reads point instancers at that time.
        levels: levels of detail that are drawn.
        prim_id: the number of a prim path in ``Scene.prim_paths``.
        material_id: the number of a material path in ``Scene.material_paths``, -1 for an empty path.
        log: notes surfaces too far away to be placed well.
    """

    transforms: UsdGeom.XformCache
    world: DoubleArray
    scale: float
    look: Callable[[str], BoundMaterial]
    shapes: ShapeReader
    instances: InstanceReader
    levels: LevelChoice
    prim_id: Callable[[str], int]
    material_id: Callable[[str], int]
    log: FindingLog

    @property
    def time(self) -> Usd.TimeCode:
        """When."""
        return self.transforms.GetTime()


@dataclass(frozen=True, eq=False)
class _Places:
    """Where a group's geometry stands, as in `render.model.scene.Batch`."""

    poses: DoubleArray
    prim_ids: IntArray | None = None
    numbers: IntArray | None = None
    colors: FloatArray | None = None
    material_ids: IntArray | None = None


_Drawn = tuple[Geometry, DoubleArray | None]
"""A geometry, and ``Batch.insides`` of its surfaces."""


class Group(ABC):
    """Pieces with one material that are drawn together."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self._pieces = list(pieces)
        self._batches: tuple[Batch, ...] = ()
        self._made_of: tuple[object, ...] = ()

    @abstractmethod
    def unread(self, shapes: ShapeReader) -> Sequence[Piece]:
        """Pieces whose triangles `batches` reads at the time and with the levels of a reader."""

    @abstractmethod
    def batches(self, context: DrawContext) -> tuple[Batch, ...]:
        """Batches drawn at a time; the same objects as before where nothing has changed."""

    def _make_batches(self, drawn: Sequence[_Drawn], material: Material, places: _Places) -> tuple[Batch, ...]:
        """A batch of each geometry; poses that mirror it leave its outside outside (`render.model.scene.Geometry`)."""
        made_of = (material, *vars(places).values(), *chain.from_iterable(drawn))
        if len(self._made_of) != len(made_of) or not all(map(_same, self._made_of, made_of)):
            self._made_of = made_of
            sides, first = self._pieces[0].sides, self._pieces[0].occurrence
            self._batches = tuple(
                Batch(
                    geometry,
                    material,
                    places.poses,
                    sides.double,
                    instance_prim_ids=places.prim_ids,
                    instance_numbers=places.numbers,
                    insides=insides,
                    culls_backs=sides.culled,
                    instance_colors=places.colors,
                    instance_material_ids=places.material_ids,
                    camera_role=first.camera_role,
                    links=first.links,
                )
                for geometry, insides in drawn
            )
        return self._batches


class RigidGroup(Group):
    """Surfaces that stand still against each other: one geometry of those that are open, and one of those that are closed."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        super().__init__(pieces)
        self._drawn: list[_Drawn] | None = None
        self._levels: tuple[int, ...] = ()

    def unread(self, shapes: ShapeReader) -> Sequence[Piece]:
        is_read = self._drawn is not None and self._levels == shapes.levels_of(self._pieces)
        return () if is_read or is_hidden(self._pieces[0].occurrence.hiders, shapes.time) else self._pieces

    def batches(self, context: DrawContext) -> tuple[Batch, ...]:
        first = self._pieces[0].occurrence
        if is_hidden(first.hiders, context.time) or not context.levels.shows(first.levels).all():
            return ()
        if self.unread(context.shapes):
            self._levels = context.shapes.levels_of(self._pieces)
            self._drawn = _draw([part for piece in self._pieces if (part := self._place(piece, context)) is not None])
        if not self._drawn:
            return ()
        pose = np.eye(4)
        if first.mover is not None:
            try:
                pose = world_pose(first.mover, context.transforms, context.world) @ shrink(context)
            except PlaceError as problem:
                note_problem(problem, context.log)
                return ()
        material = context.look(self._pieces[0].material).material
        return self._make_batches(self._drawn, material, _Places(pose[None]))

    def _place(self, piece: Piece, context: DrawContext) -> PlacedShape | None:
        """A piece's triangles, where it stands."""
        shape = context.shapes.shape(piece)
        if shape is None:
            return None
        prim, mover = piece.occurrence.prim, piece.occurrence.mover
        try:
            if mover is None:
                matrix = world_pose(prim, context.transforms, context.world)
            else:
                matrix = np.diag([*[context.scale] * 3, 1.0]) @ relative_pose(prim, mover, context.transforms)
        except PlaceError as problem:
            note_problem(problem, context.log)
            return None
        path = piece.occurrence.path
        if not is_placeable(shape.positions, matrix, path, context.log):
            return None
        return PlacedShape(shape, context.prim_id(path), context.material_id(piece.bound_material), matrix)


class InstancedGroup(Group):
    """One surface in many places, or one that bends: its geometry in its own space, and a pose for each place."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        super().__init__(pieces)
        self._shape: Shape | None = None
        self._drawn: _Drawn | None = None
        self._is_read = False
        self._levels: tuple[int, ...] = ()
        self._places: _Places | None = None
        self._moves = any(
            piece.occurrence.moves or piece.occurrence.hiders or piece.occurrence.levels or piece.inherited.varies
            for piece in pieces
        )

    def unread(self, shapes: ShapeReader) -> Sequence[Piece]:
        first = self._pieces[:1]
        is_same = self._is_read and self._levels == shapes.levels_of(first)
        return () if is_same and not first[0].deforms else first

    def batches(self, context: DrawContext) -> tuple[Batch, ...]:
        if self._places is None or self._moves:
            self._places = self._places_at(context)
        drawn = self._drawn_at(context) if len(self._places.poses) else None
        if drawn is None:
            return ()
        material = context.look(self._pieces[0].material).material
        return self._make_batches([drawn], material, self._places)

    def _drawn_at(self, context: DrawContext) -> _Drawn | None:
        if not self.unread(context.shapes):
            return self._drawn
        self._levels = context.shapes.levels_of(self._pieces[:1])
        shape = context.shapes.shape(self._pieces[0])
        if not self._is_read or not _same_shape(shape, self._shape):
            first_id = context.prim_id(self._pieces[0].occurrence.path)
            to_metres = np.diag([*[context.scale] * 3, 1.0])
            self._drawn = None if shape is None else _draw([PlacedShape(shape, first_id, -1, to_metres)])[0]
            self._shape = shape if self._pieces[0].deforms else None
        self._is_read = True
        return self._drawn

    def _places_at(self, context: DrawContext) -> _Places:
        """Places of all that is visible."""
        poses = [np.zeros((0, 4, 4))]
        prim_ids, numbers, material_ids = ([np.zeros(0, np.int32)] for _ in range(3))
        colors = [np.zeros((0, 4), np.float32)]
        for piece in self._pieces:
            occurrence = piece.occurrence
            if is_hidden(occurrence.hiders, context.time):
                continue
            try:
                here, number, picked_as = places_of(occurrence, context)
            except PlaceError as problem:
                note_problem(problem, context.log)
                continue
            shown = context.levels.shows(occurrence.levels, len(here))
            if piece.inherited != NONE_INHERITED:
                given = instance_colors(occurrence.chain, piece.inherited, context.instances, context.time, context.log)
                colors.append(given[shown])
            poses.append(here[shown] @ shrink(context))
            numbers.append(number[shown])
            prim_ids.append(np.full(shown.sum(), context.prim_id(picked_as), np.int32))
            material_ids.append(np.full(shown.sum(), context.material_id(piece.bound_material), np.int32))
        instanced = bool(self._pieces[0].occurrence.chain)
        return _Places(
            np.concatenate(poses),
            np.concatenate(prim_ids),
            np.concatenate(numbers) if instanced else None,
            np.concatenate(colors) if self._pieces[0].inherited != NONE_INHERITED else None,
            np.concatenate(material_ids),
        )


def places_of(occurrence: Occurrence, context: DrawContext) -> tuple[DoubleArray, IntArray, str]:
    """``(k, 4, 4)`` poses of a surface, the instance number of each, and the path of the prim that they are picked as.

    Raises:
        PlaceError: its transform is not finite, or there are too many instances.
    """
    chain = occurrence.chain
    if not chain:
        pose = world_pose(occurrence.prim, context.transforms, context.world)
        return pose[None], np.array([-1], np.int32), occurrence.path
    poses, numbers = instance_poses(chain, occurrence.prim, context.transforms, context.world, context.instances)
    return poses, numbers, str(chain[0].instancer.GetPath())


def note_problem(problem: PlaceError, log: FindingLog) -> None:
    """Note a place that cannot be used."""
    log.add(problem.code, problem.path, f"{problem.detail}: what depends on it is not drawn")


def _draw(parts: Sequence[PlacedShape]) -> list[_Drawn]:
    """Open shapes as one geometry, and closed ones as one."""
    open_parts = [part for part in parts if part.shape.closed_box is None]
    closed = [(part, part.shape.closed_box) for part in parts if part.shape.closed_box is not None]
    drawn: list[_Drawn] = [(place_shapes(open_parts), None)] if open_parts else []
    if closed:
        insides = np.stack([_inside(box, part.matrix) for part, box in closed])
        drawn.append((place_shapes([part for part, _ in closed]), insides))
    return drawn


def _inside(box: FloatArray, matrix: DoubleArray) -> DoubleArray:
    """The box ``(2, 3)`` around a box ``(2, 3)`` where a ``(4, 4)`` matrix puts it: least and greatest corners."""
    low, high = box.astype(np.float64)
    middle = matrix[:3, :3] @ (low + high) / 2 + matrix[:3, 3]
    half = np.abs(matrix[:3, :3]) @ (high - low) / 2
    return np.stack([middle - half, middle + half])


def shrink(context: DrawContext) -> DoubleArray:
    """Stage units from metres: poses act on geometry that is in metres already."""
    return np.diag([*[1 / context.scale] * 3, 1.0])


def _same(one: object, other: object) -> bool:
    """Whether two things are the same object, or arrays with the same values."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    return one is other


def _same_shape(one: Shape | None, other: Shape | None) -> bool:
    if one is None or other is None:
        return one is other
    return all(_same(value, vars(other)[name]) for name, value in vars(one).items())
