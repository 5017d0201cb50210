"""Primvars of prims whose polygons are made from other elements than their own, such as tubes along curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray, IntArray, LongArray
from render.stage.geometry.polygons import BadGeometry, Blend, Sampling, Values


def own_places(count: int) -> Blend:
    """Return places that are the elements themselves.

    Args:
        count: number of elements.
    """
    return Blend(np.arange(count)[:, None], np.ones((count, 1)))


def resample(values: Values, sampling: Sampling | None) -> Values:
    """Values of a prim's primvar at the polygons that are made from it.

    Args:
        values: of the prim's elements.
        sampling: of the polygons; None where their elements are the prim's.

    Raises:
        BadGeometry: there are fewer values than elements.
    """
    match values.interpolation:
        case _ if sampling is None:
            return values
        case "uniform":
            return replace(values, indices=_chosen(values, sampling.element_of_face))
        case "vertex" | "varying" | "faceVarying" as interpolation:
            blend = sampling.vertex if interpolation == "vertex" else sampling.varying
            blended = blend.of(_rows(values)).astype(np.float32)
            return Values(blended, "vertex", sampling.place_of_point.astype(np.int32))
        case _:
            return values


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
