"""Least-squares focus between the requests of points, for many frames at once.

Sought is the focus x, in inverse depth, that minimises

    E(x) = Σ a_i · (s(x)·|w_i − x| − c_i)²            Σ a_i = 1

with s the growth of the circle of confusion, which may depend on the focus (`render.model.lens_law`), and c_i the circle that
point i
requests. With ``1/s(x) = α + β·x`` and x between two neighbouring points that want a circle, where every ``|w_i − x|`` has a
fixed sign and ``Σ a c |w − x| = σ·x + τ``, the derivative of E has one zero (μ the mean of w, V its variance, κ = σα − βτ):

    x = (μα + β(V + μ²) + ακ) / (α + βμ − βκ)

For β = 0, a thin lens, that is a parabola's vertex. So each stretch has one best place, this one or an end, and the best of those
few is the answer. σ and τ of all stretches are running sums over the points in order of w.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import BoolArray, DoubleArray
from render.model.lens_law import LensLaw

TIE = 1e-12
"""Relative difference below which energies count as equal, so that rounding does not choose."""

_ROUNDS = 4
"""Rounds of linearisation of a law that is not straight."""


@dataclass(frozen=True, eq=False)
class BestFocus:
    """Focus of least error.

    Attributes:
        w: ``(n,)`` inverse depth, 1/m, within the lens's range.
        too_near: ``(n,)`` whether the points request a nearer focus than the lens reaches.
        too_far: ``(n,)`` whether they request a farther one.
    """

    w: DoubleArray
    too_near: BoolArray
    too_far: BoolArray


@dataclass(frozen=True, eq=False)
class _Segments:
    """Energy of each segment between points that request a circle: ``(n, j)``, and ``(n, 1)`` for whole frames."""

    low: DoubleArray
    high: DoubleArray
    mean: DoubleArray
    variance: DoubleArray
    sigma: DoubleArray
    tau: DoubleArray
    rest: DoubleArray

    @classmethod
    def from_points(cls, weights: DoubleArray, w: DoubleArray, circles: DoubleArray, law: LensLaw) -> _Segments:
        """Segments for points ``(n, k)``; points of weight 0 are ignored."""
        mean = (weights * w).sum(axis=1, keepdims=True)
        variance = (weights * (w - mean) ** 2).sum(axis=1, keepdims=True)
        wanting = (weights > 0) & (circles > 0)
        some = wanting.any(axis=0)
        bounds = np.where(wanting[:, some], w[:, some], np.inf)
        order = np.argsort(bounds, axis=1)
        pulls = np.take_along_axis(np.where(wanting, weights * circles, 0.0)[:, some], order, axis=1)
        bounds = np.take_along_axis(bounds, order, axis=1)
        passed, moment = _prefix_sums(pulls), _prefix_sums(pulls * np.where(np.isfinite(bounds), bounds, 0.0))
        near, far = (np.broadcast_to(limit[:, None], mean.shape) for limit in (law.near_w, law.far_w))
        inner = np.clip(bounds, far, near)
        return cls(
            low=np.concatenate([far, inner], axis=1),
            high=np.concatenate([inner, near], axis=1),
            mean=mean,
            variance=variance,
            sigma=2 * passed - passed[:, -1:],
            tau=moment[:, -1:] - 2 * moment,
            rest=(weights * circles**2).sum(axis=1, keepdims=True),
        )

    def minimum(self, start: DoubleArray, pitch: DoubleArray) -> DoubleArray:
        """Minimum of E on each segment's unbounded parabola, for ``1/s = start + pitch·x``: ``(n, j)``."""
        kappa = self.sigma * start - pitch * self.tau
        above = self.mean * start + pitch * (self.variance + self.mean**2) + start * kappa
        below = start + pitch * (self.mean - kappa)
        middle = (self.low + self.high) / 2
        falls = below * middle < above  # E without a minimum: points nearer than the law's range
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(below > 0, above / below, np.where(falls, np.inf, -np.inf))

    def energy(self, x: DoubleArray, slope: DoubleArray) -> DoubleArray:
        """E at positions ``(n, j)`` of the segments."""
        spread = self.variance + (x - self.mean) ** 2
        return np.asarray(slope**2 * spread - 2 * slope * (self.sigma * x + self.tau) + self.rest)


def best_focus(
    weights: DoubleArray, w: DoubleArray, circles: DoubleArray, law: LensLaw, camera_w: DoubleArray
) -> BestFocus:
    """Exact minimiser of E, for every frame.

    Args:
        weights: ``(n, k)`` that add up to 1 in every frame, 0 for points that do not count.
        w: ``(n, k)`` inverse depths of the points, 1/m, finite.
        circles: ``(n, k)`` mm on the film; 0 for points that must be sharp.
        law: of the lens in the n frames, or one for all.
        camera_w: ``(n,)`` decides between places that serve equally well: the nearest to it.
    """
    stopped = np.where(law.f_stops > 0, law.f_stops, 1.0)[:, None]
    circles = circles * stopped  # as they would be at f/1, where the law is given
    stretches = _Segments.from_points(weights, w, circles, law)
    x = np.clip(np.broadcast_to(stretches.mean, stretches.low.shape), stretches.low, stretches.high)
    wish = x
    for _ in range(1 if law.slopes_at_f1_mm_m.shape[1] == 2 else _ROUNDS):
        wish = stretches.minimum(*law.reciprocal_near(x))
        x = np.clip(wish, stretches.low, stretches.high)
    slopes = law.slope_at_f1_mm_m(x)
    energies = np.where(stretches.high > stretches.low, stretches.energy(x, slopes), np.inf)
    could_be = (weights * (slopes.max(axis=1, keepdims=True) * np.abs(w) + circles) ** 2).sum(axis=1, keepdims=True)
    good = energies <= energies.min(axis=1, keepdims=True) + TIE * could_be
    chosen = np.argmin(np.where(good, np.abs(x - camera_w[:, None]), np.inf), axis=1)[:, None]
    found, wished = (np.take_along_axis(values, chosen, axis=1)[:, 0] for values in (x, wish))
    return BestFocus(
        w=found,
        too_near=(found >= law.near_w) & (wished > law.near_w),
        too_far=(found <= law.far_w) & (wished < law.far_w - TIE * np.abs(stretches.mean[:, 0])),
    )


def _prefix_sums(values: DoubleArray) -> DoubleArray:
    """Prefix sums ``(n, b + 1)`` of every row."""
    return np.concatenate([np.zeros((len(values), 1)), np.cumsum(values, axis=1)], axis=1)
