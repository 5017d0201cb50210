"""Bounds of parts of a stage over time, for focus points that follow them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, Vt

from render.errors import StageError
from render.model.arrays import DoubleArray
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import BadGeometry
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.splat_boxes import splat_extent
from render.stage.geometry.surface import resting_points
from render.stage.options import DRAWN_PURPOSES
from render.stage.values import SPLATS, schema_type

Box = tuple[DoubleArray, DoubleArray]
"""Least and greatest corner, ``(3,)`` each."""

MOST_SHAPES = 4096
"""Most shapes of a part whose bounds are followed: each is looked at for each picture."""

_NOTHING: Box = (np.full(3, np.inf), np.full(3, -np.inf))


class Boxes:
    """Boxes of single shapes at a time, in their own spaces: their authored extent or that of their points, and for what a
    skeleton bends that of its points as it bends them.

    Args:
        skeletons: bend meshes.
        log: for findings.
    """

    def __init__(self, skeletons: Skeletons, log: FindingLog) -> None:
        self._skeletons, self._log = skeletons, log

    def at(self, shape: Usd.Prim, time: Usd.TimeCode) -> Box | None:
        """Least and greatest corner of a shape; None where it has none."""
        try:
            corners = self._bent(shape, time) if self._bends(shape) else _extent(UsdGeom.Boundable(shape), time)
        except (BadGeometry, Tf.ErrorException, TypeError, ValueError):  # values of other types than the schema's
            return None
        is_box = corners.shape == (2, 3) and bool(np.isfinite(corners).all() and (corners[0] <= corners[1]).all())
        return (corners[0], corners[1]) if is_box else None

    def may_change(self, shape: Usd.Prim) -> bool:
        """Whether a shape's box may change over time."""
        if self._bends(shape):
            return True
        extent = UsdGeom.Boundable(shape).GetExtentAttr()
        if extent.HasAuthoredValue():
            return bool(extent.ValueMightBeTimeVarying())
        return shape.IsA(UsdGeom.PointInstancer) or any(one.ValueMightBeTimeVarying() for one in shape.GetAttributes())

    def _bends(self, shape: Usd.Prim) -> bool:
        return bool(shape.IsA(UsdGeom.Mesh)) and self._skeletons.bends(shape)

    def _bent(self, shape: Usd.Prim, time: Usd.TimeCode) -> DoubleArray:
        resting: Vt.Vec3fArray = resting_points(shape, time)
        points = self._skeletons.bend_points(shape, resting, time, self._log)
        return np.array([points.min(axis=0), points.max(axis=0)], np.float64)


def _extent(shape: UsdGeom.Boundable, time: Usd.TimeCode) -> DoubleArray:
    authored = shape.GetExtentAttr()
    extent = authored.Get(time) if authored.HasAuthoredValue() else None
    if extent is None and schema_type(shape.GetPrim()) == SPLATS:
        extent = splat_extent(shape.GetPrim(), time)
    return np.array(UsdGeom.Boundable.ComputeExtentFromPlugins(shape, time) if extent is None else extent, np.float64)


@dataclass(frozen=True)
class _Shape:
    """A shape at or below a part.

    Attributes:
        prim: the shape.
        hiders: prims from it up to the part, without that, whose visibility may change over time.
        changes: whether its box in its own space may change over time.
        moves: whether it may move against the part.
    """

    prim: Usd.Prim
    hiders: tuple[Usd.Prim, ...]
    changes: bool
    moves: bool

    @property
    def is_still(self) -> bool:
        """Whether it adds the same to the bounds at all times."""
        return not (self.hiders or self.changes or self.moves)


class PartBounds:
    """Bounds of a prim in its own space: of all shapes at and below it, of the drawn purposes, that are visible if the prim is.

    Boxes that do not change are read once, and shapes that do not move either are joined once. Each shape counts with the box of
    its own space as it is turned, and not as a part of another box, so that bounds never jump while shapes turn.

    Args:
        prim: the part.
        boxes: of single shapes.

    Raises:
        StageError: the part has more than `MOST_SHAPES` shapes.
    """

    def __init__(self, prim: Usd.Prim, boxes: Boxes) -> None:
        self._prim, self._boxes = prim, boxes
        found = list(islice(_shapes(prim), MOST_SHAPES + 1))
        if len(found) > MOST_SHAPES:
            raise StageError(
                f"{prim.GetPath()} has more than {MOST_SHAPES:,} shapes, too many to follow: follow a smaller part"
            )
        shapes = [shape for one in found if (shape := self._shape(one)) is not None]
        self._still = [shape for shape in shapes if shape.is_still]
        self._others = [shape for shape in shapes if not shape.is_still]
        self._still_box: Box | None = None
        self._kept: dict[Usd.Prim, Box | None] = {}

    def at(self, time: Usd.TimeCode, transforms: UsdGeom.XformCache) -> Box | None:
        """Least and greatest corner at a time, in the prim's own space and units; None where there are no shapes.

        Args:
            time: when.
            transforms: of that time.
        """
        if self._still_box is None:
            self._still_box = self._around(self._still, time, transforms)
        (least, most), (other_least, other_most) = self._still_box, self._around(self._others, time, transforms)
        least, most = np.minimum(least, other_least), np.maximum(most, other_most)
        return (least, most) if (least <= most).all() else None

    def _around(self, shapes: list[_Shape], time: Usd.TimeCode, transforms: UsdGeom.XformCache) -> Box:
        """Box around shapes, in the part's space."""
        found = [(shape.prim, self._box(shape, time)) for shape in shapes if not _is_hidden(shape.hiders, time)]
        boxed = [(prim, box) for prim, box in found if box is not None]
        if not boxed:
            return _NOTHING
        corners = np.array([box for _, box in boxed])
        matrices = np.array(
            [_relative(prim, self._prim, transforms) for prim, _ in boxed], np.float64
        )  # for row vectors
        usable = np.isfinite(matrices).all(axis=(1, 2))
        if not usable.any():
            return _NOTHING
        corners, matrices = corners[usable], matrices[usable]
        turns = matrices[:, :3, :3]
        middles = np.einsum("ni,nij->nj", corners.mean(axis=1), turns) + matrices[:, 3, :3]
        halves = np.einsum("ni,nij->nj", (corners[:, 1] - corners[:, 0]) / 2, np.abs(turns))
        return (middles - halves).min(axis=0), (middles + halves).max(axis=0)

    def _box(self, shape: _Shape, time: Usd.TimeCode) -> Box | None:
        """A shape's box in its own space."""
        if shape.changes:
            return self._boxes.at(shape.prim, time)
        if shape.prim not in self._kept:
            self._kept[shape.prim] = self._boxes.at(shape.prim, time)
        return self._kept[shape.prim]

    def _shape(self, prim: Usd.Prim) -> _Shape | None:
        """A shape; None where it is of a purpose that is not drawn, or always invisible."""
        if UsdGeom.Imageable(prim).ComputePurpose() not in DRAWN_PURPOSES:
            return None
        hiders: list[Usd.Prim] = []
        above, moves = prim, False
        while above != self._prim:
            imageable, xformable = UsdGeom.Imageable(above), UsdGeom.Xformable(above)
            if imageable and imageable.GetVisibilityAttr().ValueMightBeTimeVarying():
                hiders.append(above)
            elif _is_hidden([above], Usd.TimeCode.EarliestTime()):
                return None
            if xformable and (xformable.TransformMightBeTimeVarying() or xformable.GetResetXformStack()):
                moves = True
            above = above.GetParent()
        return _Shape(prim, tuple(hiders), self._boxes.may_change(prim), moves)


def _shapes(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    """Shapes at and below a prim. Those of a point instancer are its own: the instancer stands for them."""
    walk = iter(Usd.PrimRange(prim, Usd.TraverseInstanceProxies()))
    for found in walk:
        if found.IsA(UsdGeom.PointInstancer):
            walk.PruneChildren()
            yield found
        elif found.IsA(UsdGeom.Gprim):
            yield found


def _is_hidden(hiders: Iterable[Usd.Prim], time: Usd.TimeCode) -> bool:
    """Whether any of some prims is made invisible at a time."""
    imageables = [imageable for prim in hiders if (imageable := UsdGeom.Imageable(prim))]
    return any(one.GetVisibilityAttr().Get(time) == UsdGeom.Tokens.invisible for one in imageables)


def _relative(shape: Usd.Prim, part: Usd.Prim, transforms: UsdGeom.XformCache) -> Gf.Matrix4d:
    if shape == part:
        return Gf.Matrix4d(1)
    matrix, resets = transforms.ComputeRelativeTransform(shape, part)
    if resets:
        of_part = transforms.GetLocalToWorldTransform(part)
        if of_part.GetDeterminant() == 0:  # it flattens space: nothing has a place in it
            return Gf.Matrix4d(float("nan"))
        return transforms.GetLocalToWorldTransform(shape) * of_part.GetInverse()
    return matrix
