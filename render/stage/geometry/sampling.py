"""Primvars of prims whose polygons are made from other elements than their own, such as tubes along curves."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray, IntArray, LongArray
from render.stage.geometry.polygons import BadGeometry, Values


@dataclass(frozen=True, eq=False)
class Blend:
    """Places between elements of a prim.

    Attributes:
        index: ``(n, k)`` int64 elements that each place lies between.
        weight: ``(n, k)`` float64 their weights.
    """

    index: LongArray
    weight: DoubleArray

    def of(self, values: NDArray[np.floating]) -> DoubleArray:
        """Blend values ``(m, c)`` of the elements. Returns ``(n, c)``.

        Raises:
            BadGeometry: there are fewer values than elements.
        """
        if self.index.size and self.index.max() >= len(values):
            raise BadGeometry(f"it needs {int(self.index.max()) + 1} values and has {len(values)}")
        blended = np.zeros((len(self.index), values.shape[1]))
        for index, weight in zip(self.index.T, self.weight.T, strict=True):  # one at a time, to save memory
            blended += weight[:, None] * values[index]
        return blended


@dataclass(frozen=True, eq=False)
class Sampling:
    """Places of polygons on the prim that they are made from.

    Attributes:
        vertex: places between the prim's points.
        varying: the same places between the elements of primvars that vary, such as the ends of a curve's segments.
        place_of_point: ``(n,)`` place of each of the polygons' points.
        element_of_face: ``(f,)`` curve or other uniform element of each face.
    """

    vertex: Blend
    varying: Blend
    place_of_point: LongArray
    element_of_face: LongArray

    def resample(self, values: Values) -> Values:
        """Values of a prim's primvar at the polygons that are made from it.

        Raises:
            BadGeometry: there are fewer values than elements.
        """
        match values.interpolation:
            case "uniform":
                return replace(values, indices=_chosen(values, self.element_of_face))
            case "vertex" | "varying" | "faceVarying" as interpolation:
                blend = self.vertex if interpolation == "vertex" else self.varying
                blended = blend.of(_rows(values)).astype(np.float32)
                return Values(blended, "vertex", self.place_of_point.astype(np.int32))
            case _:
                return values


def own_places(count: int) -> Blend:
    """Return places that are the elements themselves.

    Args:
        count: number of elements.
    """
    return Blend(np.arange(count)[:, None], np.ones((count, 1)))


def sample_widths(values: Values, sampling: Sampling, element_of_place: LongArray) -> FloatArray:
    """Widths ``(n,)`` at the places of a sampling.

    Args:
        values: widths of the prim.
        sampling: of its polygons.
        element_of_place: ``(n,)`` curve or other uniform element of each place.

    Raises:
        BadGeometry: they are too few, or not finite and at least 0.
    """
    found: DoubleArray
    match values.interpolation:
        case "constant":
            found = np.repeat(_rows(values)[:1].astype(np.float64), len(element_of_place), axis=0)
        case "uniform":
            found = Blend(element_of_place[:, None], np.ones((len(element_of_place), 1))).of(_rows(values))
        case "vertex":
            found = sampling.vertex.of(_rows(values))
        case _:
            found = sampling.varying.of(_rows(values))
    if not len(found) or not np.isfinite(found).all():
        raise BadGeometry("its widths must be finite numbers")
    return np.maximum(found[:, 0], 0.0).astype(np.float32)


def _rows(values: Values) -> FloatArray:
    return values.values if values.indices is None else values.values[_in_range(values.indices, len(values.values))]


def _chosen(values: Values, element: LongArray) -> IntArray:
    if values.indices is None:
        return element.astype(np.int32)
    chosen: IntArray = values.indices[_in_range(element, len(values.indices))].astype(np.int32)
    return chosen


def _in_range(index: NDArray[np.integer], size: int) -> NDArray[np.integer]:
    if len(index) and (index.min() < 0 or index.max() >= size):
        raise BadGeometry(f"it needs {int(index.max()) + 1} values and has {size}")
    return index
