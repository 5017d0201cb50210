"""Bounds of parts of a stage over time, for focus points that follow them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, Vt

from render.model.arrays import DoubleArray
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import BadGeometry
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.surface import resting_points
from render.stage.options import DRAWN_PURPOSES
from render.stage.world import column_matrix

Box = tuple[DoubleArray, DoubleArray]
"""Least and greatest corner, ``(3,)`` each."""

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
        is_box = corners.shape == (2, 3) and bool((corners[0] <= corners[1]).all())
        return (corners[0], corners[1]) if is_box else None

    def may_change(self, shape: Usd.Prim) -> bool:
        """Whether a shape's box may change over time."""
        if shape.IsA(UsdGeom.PointInstancer) or self._bends(shape):
            return True
        return any(attribute.ValueMightBeTimeVarying() for attribute in shape.GetAttributes())

    def _bends(self, shape: Usd.Prim) -> bool:
        return bool(shape.IsA(UsdGeom.Mesh)) and self._skeletons.bends(shape)

    def _bent(self, shape: Usd.Prim, time: Usd.TimeCode) -> DoubleArray:
        resting: Vt.Vec3fArray = resting_points(shape, time)
        points = self._skeletons.bend_points(shape, resting, time, self._log)
        return np.array([points.min(axis=0), points.max(axis=0)], np.float64)


def _extent(shape: UsdGeom.Boundable, time: Usd.TimeCode) -> DoubleArray:
    authored = shape.GetExtentAttr()
    extent = authored.Get(time) if authored.HasAuthoredValue() else None
    return np.array(UsdGeom.Boundable.ComputeExtentFromPlugins(shape, time) if extent is None else extent, np.float64)


@dataclass(frozen=True)
class _Shape:
    """A shape at or below a part.

    Attributes:
        prim: the shape.
        hiders: prims from it up to the part, without that, whose visibility may change over time.
        changes: whether its box in the part's space may change over time, or whether it counts.
    """

    prim: Usd.Prim
    hiders: tuple[Usd.Prim, ...]
    changes: bool


class PartBounds:
    """Bounds of a prim in its own space: of all shapes at and below it, of the drawn purposes, that are visible if the prim is.

    Shapes that neither move against the prim nor change are read once. Each shape counts with the box of its own space as it is
    turned, and not as a part of another box, so that bounds never jump while shapes turn.

    Args:
        prim: the part.
        boxes: of single shapes.
    """

    def __init__(self, prim: Usd.Prim, boxes: Boxes) -> None:
        self._prim, self._boxes = prim, boxes
        shapes = [shape for found in _shapes(prim) if (shape := self._shape(found)) is not None]
        self._still = [shape for shape in shapes if not shape.changes]
        self._changing = [shape for shape in shapes if shape.changes]
        self._still_box: Box | None = None

    def at(self, time: Usd.TimeCode, transforms: UsdGeom.XformCache) -> Box | None:
        """Least and greatest corner at a time, in the prim's own space and units; None where there are no shapes.

        Args:
            time: when.
            transforms: of that time.
        """
        if self._still_box is None:
            self._still_box = self._around(self._still, time, transforms)
        least, most = _joined([self._still_box, self._around(self._changing, time, transforms)])
        return (least, most) if (least <= most).all() else None

    def _around(self, shapes: list[_Shape], time: Usd.TimeCode, transforms: UsdGeom.XformCache) -> Box:
        return _joined([box for shape in shapes if (box := self._box(shape, time, transforms)) is not None])

    def _box(self, shape: _Shape, time: Usd.TimeCode, transforms: UsdGeom.XformCache) -> Box | None:
        """A shape's box in the part's space."""
        if any(_is_invisible(hider, time) for hider in shape.hiders):
            return None
        box = self._boxes.at(shape.prim, time)
        if box is None:
            return None
        matrix = column_matrix(_relative(shape.prim, self._prim, transforms))
        middle, half = (box[0] + box[1]) / 2, (box[1] - box[0]) / 2
        middle, half = matrix[:3, :3] @ middle + matrix[:3, 3], np.abs(matrix[:3, :3]) @ half
        return middle - half, middle + half

    def _shape(self, prim: Usd.Prim) -> _Shape | None:
        """A shape; None where it is of a purpose that is not drawn, or always invisible."""
        if UsdGeom.Imageable(prim).ComputePurpose() not in DRAWN_PURPOSES:
            return None
        hiders: list[Usd.Prim] = []
        changes = self._boxes.may_change(prim)
        above = prim
        while above != self._prim:
            imageable, xformable = UsdGeom.Imageable(above), UsdGeom.Xformable(above)
            if imageable and imageable.GetVisibilityAttr().ValueMightBeTimeVarying():
                hiders.append(above)
            elif _is_invisible(above, Usd.TimeCode.Default()):
                return None
            moves = xformable and (xformable.TransformMightBeTimeVarying() or xformable.GetResetXformStack())
            changes = changes or bool(moves)
            above = above.GetParent()
        return _Shape(prim, tuple(hiders), changes or bool(hiders))


def _shapes(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    """Shapes at and below a prim. Those of a point instancer are its own: the instancer stands for them."""
    walk = iter(Usd.PrimRange(prim, Usd.TraverseInstanceProxies()))
    for found in walk:
        if found.IsA(UsdGeom.PointInstancer):
            walk.PruneChildren()
            yield found
        elif found.IsA(UsdGeom.Gprim):
            yield found


def _is_invisible(prim: Usd.Prim, time: Usd.TimeCode) -> bool:
    imageable = UsdGeom.Imageable(prim)
    return bool(imageable) and imageable.GetVisibilityAttr().Get(time) == UsdGeom.Tokens.invisible


def _relative(shape: Usd.Prim, part: Usd.Prim, transforms: UsdGeom.XformCache) -> Gf.Matrix4d:
    if shape == part:
        return Gf.Matrix4d(1)
    matrix, resets = transforms.ComputeRelativeTransform(shape, part)
    if resets:
        return transforms.GetLocalToWorldTransform(shape) * transforms.GetLocalToWorldTransform(part).GetInverse()
    return matrix


def _joined(boxes: list[Box]) -> Box:
    least, most = zip(_NOTHING, *boxes, strict=True)
    return np.min(least, axis=0), np.max(most, axis=0)
