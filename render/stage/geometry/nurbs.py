"""Non-uniform B-splines: knots, and the basis at places (Piegl & Tiller 1997, "The NURBS book")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, IntArray, LongArray


@dataclass(frozen=True, eq=False)
class SplineBasis:
    """Basis of a spline at n places.

    Attributes:
        index: ``(n, order)`` control points.
        basis: ``(n, order)`` their shares, which add up to 1.
        span: ``(n,)`` number of the span in which each place lies, from 0.
        share: ``(n,)`` where in its span it lies, from 0 to 1.
    """

    index: LongArray
    basis: DoubleArray
    span: LongArray
    share: DoubleArray


def even_knots(counts: IntArray, orders: IntArray) -> DoubleArray:
    """Knots at even steps, repeated at the ends so that curves begin at their first point and end at their last.

    Args:
        counts: ``(c,)`` number of points of each curve.
        orders: ``(c,)`` their orders.
    """
    own = [
        np.clip(np.arange(count + order) - (order - 1.0), 0.0, max(count - order + 1.0, 0.0))
        for count, order in zip(counts.tolist(), orders.tolist(), strict=True)
    ]
    return np.concatenate(own) if own else np.zeros(0)


def knot_places(knots: DoubleArray, count: int, order: int, low: float, high: float, steps: int) -> DoubleArray:
    """Places at even steps of each span, ascending; the only place where the range is empty.

    Args:
        knots: ``(count + order,)`` ascending.
        count: number of control points.
        order: degree and one.
        low: where the range begins, within the knots that span curves.
        high: where it ends.
        steps: of each span.
    """
    inner = np.unique(knots[order - 1 : count + 1])
    bounds = np.unique(np.concatenate([[low], inner[(inner > low) & (inner < high)], [high]])) if high > low else [low]
    places = np.interp(np.arange((len(bounds) - 1) * steps + 1) / steps, np.arange(len(bounds)), bounds)
    return np.asarray(places, np.float64)


def spline_at(knots: DoubleArray, count: int, order: int, places: DoubleArray) -> SplineBasis:
    """Basis at places, by de Boor's recurrence (algorithm A2.2).

    Args:
        knots: ``(count + order,)`` ascending.
        count: number of control points, at least the order.
        order: degree and one.
        places: ``(n,)`` within the knots that span curves.
    """
    span = np.clip(np.searchsorted(knots, places, side="right") - 1, order - 1, count - 1)
    basis = np.zeros((len(places), order))
    basis[:, 0] = 1.0
    for degree in range(1, order):
        saved = np.zeros(len(places))
        for j in range(degree):
            right, left = knots[span + j + 1], knots[span + j + 1 - degree]
            width = right - left
            term = np.divide(basis[:, j], width, out=np.zeros(len(places)), where=width > 0)
            basis[:, j] = saved + (right - places) * term
            saved = (places - left) * term
        basis[:, degree] = saved
    width = knots[span + 1] - knots[span]
    share = np.divide(places - knots[span], width, out=np.zeros(len(places)), where=width > 0)
    return SplineBasis(span[:, None] - (order - 1) + np.arange(order), basis, span - (order - 1), share)
