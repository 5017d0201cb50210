"""Dependence of a lens's circle of confusion on its focus, as plain data. The lens itself is in `render.model.lens`.

A point at inverse depth w is imaged by a lens focused at w_f as a disk of diameter ``K(w_f) · |w − w_f| / N`` on the film (DESIGN
section 2). For a thin lens whose picture does not grow with focus, K is f². Others follow laws of their own: a lens that breathes
grows its picture as its image distance does, and glass that moves inside the lens changes the entrance pupil.
`render.optics.focus_law` finds K for the lens of a camera.

The law holds ``1 / K`` at even steps of w_f and joins them linearly. It is straight for a thin lens, breathing or not
(``1/v = 1/f − w_f``) and for a lens that focuses as a whole, and nearly so for others; and with it straight, the best focus has a
closed form (`render.focus.least_squares`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from render.errors import SettingsError
from render.model.arrays import DoubleArray

NO_LIMIT_W = 1e9
"""Nearness in 1/m of a lens that focuses however near: a nanometre."""

_THIN_REACH = 1 - 1e-3  # of 1/f: at it, a breathing lens would throw its image to infinity


@dataclass(frozen=True, eq=False)
class LensLaw:
    """Focus-dependent numbers of a lens, for n frames, or for one that stands for all.

    Attributes:
        slopes_at_f1_mm_m: ``(n, m)`` growth of the circle of confusion with inverse depth at f/1, mm on the film
            for each 1/m, at m even steps of the focus from ``far_w`` to ``near_w``.
        pupils_at_f1_mm: ``(n, m)`` radius of the entrance pupil at f/1.
        f_stops: ``(n,)`` f-numbers; 0 is a pinhole.
        near_w: ``(n,)`` inverse depth of the nearest focus, 1/m, from the entrance pupil.
        far_w: ``(n,)`` inverse depth of the farthest focus, 1/m; 0 is infinity.
        widest_f_stops: ``(n,)`` the smallest f-number of its glass; 0 where none is known.
    """

    slopes_at_f1_mm_m: DoubleArray
    pupils_at_f1_mm: DoubleArray
    f_stops: DoubleArray
    near_w: DoubleArray
    far_w: DoubleArray
    widest_f_stops: DoubleArray

    def __post_init__(self) -> None:
        """Check shapes and ranges.

        Raises:
            SettingsError: they are no law of a lens.
        """
        frames, steps = np.shape(self.slopes_at_f1_mm_m)
        columns = (self.f_stops, self.near_w, self.far_w, self.widest_f_stops)
        if steps < 2 or np.shape(self.pupils_at_f1_mm) != (frames, steps) or any(len(c) != frames for c in columns):
            raise SettingsError("the columns of a focus law must be as many as its frames, over two or more steps")
        if not (np.all(self.slopes_at_f1_mm_m > 0) and np.isfinite(self.slopes_at_f1_mm_m).all()):
            raise SettingsError("the circle of confusion of a focus law must grow by a finite number above 0")
        if not (np.all(self.far_w >= 0) and np.all(self.near_w > self.far_w) and np.isfinite(self.near_w).all()):
            raise SettingsError(
                "a focus law must reach from a far limit of 0 /m or more to a nearer one that is finite"
            )
        if not (np.all(self.f_stops >= 0) and np.isfinite(self.f_stops).all()):
            raise SettingsError("the f-numbers of a focus law must be finite and 0 or more")

    @classmethod
    def even(cls, coc_slopes_mm_m: ArrayLike) -> LensLaw:
        """The law of lenses whose circle grows alike wherever they are focused, and that focus anywhere.

        Args:
            coc_slopes_mm_m: ``(n,)`` `render.optics.depth_of_field.coc_slope_mm_m`; 0 is a pinhole.
        """
        slopes = np.atleast_1d(np.asarray(coc_slopes_mm_m, np.float64))
        open_ = slopes > 0
        both = np.repeat(np.where(open_, slopes, 1.0)[:, None], 2, axis=1)
        free = np.full(len(slopes), NO_LIMIT_W)
        return cls(both, np.ones_like(both), open_.astype(np.float64), free, 0 * free, 0 * free)

    @classmethod
    def thin(
        cls, focal_lengths_mm: ArrayLike, f_stops: ArrayLike, *, breathing: bool = False, near_w: ArrayLike = np.inf
    ) -> LensLaw:
        """The law of thin lenses.

        Args:
            focal_lengths_mm: ``(n,)``.
            f_stops: ``(n,)``; 0 is a pinhole.
            breathing: whether the picture grows with the image distance as the lens focuses closer.
            near_w: ``(n,)`` of the nearest focus that their mounts allow. A lens that breathes reaches almost its focal length
                in any case, where its image distance is a thousand of them.
        """
        focal, stops, near = (
            np.array(a, np.float64)
            for a in np.broadcast_arrays(*map(np.atleast_1d, (focal_lengths_mm, f_stops, near_w)))
        )
        near = np.minimum(near, _THIN_REACH * 1000 / focal if breathing else NO_LIMIT_W)
        growth = 1 / (1 - focal / 1000 * near) if breathing else np.ones_like(near)
        slopes = focal[:, None] ** 2 / 1000 * np.stack([np.ones_like(growth), growth], axis=1)
        pupils = np.repeat(focal[:, None] / 2, 2, axis=1)
        return cls(slopes, pupils, stops, near, np.zeros_like(near), np.zeros_like(near))

    @classmethod
    def stacked(cls, laws: Sequence[LensLaw]) -> LensLaw:
        """Laws of frames after each other as one, over as many steps as the one with most has.

        Args:
            laws: at least one.
        """
        steps = max(law.slopes_at_f1_mm_m.shape[1] for law in laws)
        even = [law._at_steps(steps) for law in laws]
        names = tuple(cls.__dataclass_fields__)
        return cls(*(np.concatenate([getattr(law, name) for law in even]) for name in names))

    @property
    def frames(self) -> int:
        """Number of frames; 1 may stand for all."""
        return len(self.f_stops)

    def at_stops(self, f_stops: ArrayLike) -> LensLaw:
        """The same lenses set to other f-numbers.

        Args:
            f_stops: ``(n,)``; 0 is a pinhole.
        """
        stops = np.broadcast_to(np.asarray(f_stops, np.float64), self.f_stops.shape)
        return replace(self, f_stops=stops)

    def slope_at_f1_mm_m(self, w_f: ArrayLike) -> DoubleArray:
        """Growth of the circle of confusion at f/1.

        Args:
            w_f: ``(n,)`` or ``(n, j)`` inverse depths of the focus, 1/m; beyond a limit the law at the limit holds.
        """
        start, pitch = self.reciprocal_near(w_f)
        return np.asarray(1 / (start + pitch * self._within(w_f)))

    def coc_slope_mm_m(self, w_f: ArrayLike) -> DoubleArray:
        """Diameter of the circle of confusion on the film for each 1/m off the focus, at the f-numbers set; 0 for a pinhole.

        Args:
            w_f: ``(n,)`` or ``(n, j)`` inverse depths of the focus, 1/m.
        """
        return self._stopped(self.slope_at_f1_mm_m(w_f))

    def pupil_radius_mm(self, w_f: ArrayLike) -> DoubleArray:
        """Radius of the entrance pupil at the f-numbers set; 0 for a pinhole.

        Args:
            w_f: ``(n,)`` or ``(n, j)`` inverse depths of the focus, 1/m.
        """
        step, share = self._place(w_f)
        low, high = (_taken(self.pupils_at_f1_mm, at) for at in (step, step + 1))
        return self._stopped(low + share * (high - low))

    def reciprocal_near(self, w_f: ArrayLike) -> tuple[DoubleArray, DoubleArray]:
        """The straight line ``start + pitch · w`` that 1 over the growth at f/1 follows about a focus.

        Args:
            w_f: ``(n,)`` or ``(n, j)``.
        """
        step, _ = self._place(w_f)
        reciprocals = 1 / self.slopes_at_f1_mm_m
        low, high = (_taken(reciprocals, at) for at in (step, step + 1))
        width = (self.near_w - self.far_w) / (self.slopes_at_f1_mm_m.shape[1] - 1)
        pitch = (high - low) / _beside(width, low)
        return low - pitch * (_beside(self.far_w, low) + step * _beside(width, low)), pitch

    def _place(self, w_f: ArrayLike) -> tuple[NDArray[np.intp], DoubleArray]:
        """Index of a focus's step, and its fraction."""
        w = self._within(w_f)
        last = self.slopes_at_f1_mm_m.shape[1] - 1
        along = (w - _beside(self.far_w, w)) / _beside(self.near_w - self.far_w, w) * last
        step = np.clip(along.astype(np.intp), 0, last - 1)
        return step, along - step

    def _within(self, w_f: ArrayLike) -> DoubleArray:
        w = np.asarray(w_f, np.float64)
        return np.clip(w, _beside(self.far_w, w), _beside(self.near_w, w))

    def _stopped(self, values: DoubleArray) -> DoubleArray:
        stops = _beside(self.f_stops, values)
        return np.where(stops > 0, values / np.where(stops > 0, stops, 1.0), 0.0)

    def _at_steps(self, steps: int) -> LensLaw:
        """The same law over another number of steps."""
        if steps == self.slopes_at_f1_mm_m.shape[1]:
            return self
        w = np.linspace(self.far_w, self.near_w, steps, axis=1)
        radii = replace(self, f_stops=np.ones_like(self.f_stops)).pupil_radius_mm(w)
        return replace(self, slopes_at_f1_mm_m=self.slope_at_f1_mm_m(w), pupils_at_f1_mm=radii)


def _beside(column: DoubleArray, values: DoubleArray) -> DoubleArray:
    """A column of frames, shaped to go with values ``(n,)`` or ``(n, j)``."""
    return column[:, None] if np.ndim(values) == 2 else column


def _taken(table: DoubleArray, steps: NDArray[np.intp]) -> DoubleArray:
    """Entries of a table ``(n, m)`` or ``(1, m)`` at steps ``(n,)`` or ``(n, j)``."""
    if len(table) == 1:
        return np.asarray(table[0][steps])
    rows = np.arange(len(table))
    return np.asarray(table[rows[:, None] if steps.ndim == 2 else rows, steps])
