"""Blend shapes of UsdSkel at one time, with their in-betweens: offsets of points and of authored normals."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd, UsdSkel, Vt

from render.model.arrays import DoubleArray
from render.stage.geometry.polygons import BadGeometry, Polygons, Values, value_index_of_corner
from render.stage.geometry.primvars import as_rows


@dataclass(frozen=True, eq=False)
class ActiveShapes:
    """Shapes with a weight.

    Attributes:
        query: all blend shapes of a mesh.
        weights: weight of each shape or in-between that has one.
        shapes: which shape each belongs to.
        subshapes: which shape or in-between each is.
    """

    query: UsdSkel.BlendShapeQuery
    weights: Vt.FloatArray
    shapes: Vt.UIntArray
    subshapes: Vt.UIntArray

    def move(self, points: Vt.Vec3fArray) -> bool:
        """Add the shapes' offsets to points, in place. Returns whether that could be done."""
        return bool(
            self.query.ComputeDeformedPoints(
                self.weights,
                self.shapes,
                self.subshapes,
                self.query.ComputeBlendShapePointIndices(),
                self.query.ComputeSubShapePointOffsets(),
                points,
            )
        )

    def normal_offsets(self, count: int) -> DoubleArray | None:
        """``(count, 3)`` offsets of the normals at points; None where no shape that has a weight has any.

        Args:
            count: number of points.

        Raises:
            BadGeometry: they do not fit the points, or are not finite.
        """
        indices = self.query.ComputeBlendShapePointIndices()
        total = None
        for weight, shape, subshape in zip(self.weights, self.shapes, self.subshapes, strict=True):
            offsets = as_rows(self._stated(shape, subshape), 3)
            if offsets is None or not len(offsets):
                continue
            rows = np.asarray(indices[shape], np.int64) if len(indices[shape]) else np.arange(count)
            if len(rows) != len(offsets) or not 0 <= rows.min() <= rows.max() < count:
                raise BadGeometry(f"a blend shape has {len(offsets)} normalOffsets, for {len(rows)} of {count} points")
            total = np.zeros((count, 3)) if total is None else total
            np.add.at(total, rows, weight * offsets.astype(np.float64))
        if total is not None and not np.isfinite(total).all():
            raise BadGeometry("the normalOffsets of a blend shape, or their weights, are not finite")
        return total

    def _stated(self, shape: int, subshape: int) -> object:
        inbetween = self.query.GetInbetween(subshape)
        if inbetween:
            return inbetween.GetNormalOffsets()
        return self.query.GetBlendShape(shape).GetNormalOffsetsAttr().Get()


def active_shapes(
    skeleton: UsdSkel.SkeletonQuery, skinning: UsdSkel.SkinningQuery, time: Usd.TimeCode
) -> ActiveShapes | None:
    """Blend shapes of a mesh that have a weight at a time; None for none. Shapes without an animation rest at weight 0."""
    if not skinning.HasBlendShapes():
        return None
    animation, mapper = skeleton.GetAnimQuery(), skinning.GetBlendShapeMapper()
    if not animation or mapper is None:
        return None
    weights = mapper.Remap(animation.ComputeBlendShapeWeights(time))
    query = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(skinning.GetPrim()))
    return ActiveShapes(query, *query.ComputeSubShapeWeights(weights))


def shape_normals(polygons: Polygons, offsets: DoubleArray) -> Polygons:
    """Polygons whose authored normals have the offsets ``(n, 3)`` of their points added.

    Raises:
        BadGeometry: the normals do not fit the polygons.
    """
    if polygons.normals is None:
        return polygons
    at_corners = polygons.normals.values[value_index_of_corner(polygons.normals, polygons)]
    moved = at_corners.astype(np.float64) + offsets[polygons.corners]
    return replace(polygons, normals=Values(moved.astype(np.float32), "faceVarying"))
