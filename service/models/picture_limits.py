"""Limits of one picture: its pixels, and the processor time that it is expected to take.

The HTTP process checks them before work begins. The worker checks them once more where the height follows from the film gate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from render.engines import all_engines
from render.engines.shared.cost import PictureWork, aovs_cost_s
from render.errors import SettingsError
from render.model.shutter_intervals import MAX_MOMENTS, MIN_RAYS
from service.models.frames import PictureQuery
from service.models.long_exposure import LongExposureBegin

SHAPE = 9 / 16
"""Height over width for which a picture is judged before its camera's film gate is known."""

PictureSettings = PictureQuery | LongExposureBegin


@dataclass(frozen=True)
class PictureCost:
    """Expected processor time of a picture on two cores of a common machine with Mesa's rasteriser (`Engine.cost_s`).

    Attributes:
        engine: name of the engine.
        work: settings that the cost depends on.
        factor: times that the shot is expected to cost as much as most.
    """

    engine: str
    work: PictureWork
    factor: float = 1.0

    @classmethod
    def of(cls, picture: PictureSettings, factor: float = 1.0, aovs: Sequence[str] = ()) -> PictureCost:
        """Return the cost of a picture; of 16:9, where its camera gives it the height.

        An interval of a long exposure that chooses its moments counts as one of the most moments, with the rays that they take.

        Args:
            picture: its settings.
            factor: as the attribute.
            aovs: measured beside the colour.
        """
        motion, rays = picture.motion, picture.rays
        if isinstance(picture, LongExposureBegin) and motion == 1:
            motion, rays = MAX_MOMENTS, max(rays, MIN_RAYS * MAX_MOMENTS)
        work = PictureWork(
            width=picture.width,
            height=picture.height or SHAPE * picture.width,
            rays=rays,
            layers=picture.layers,
            supersample=picture.supersample,
            noise=picture.noise,
            wavelengths=picture.wavelengths,
            motion=motion,
            motion_by=picture.motion_by,
            aovs=tuple(aovs),
        )
        return cls(picture.engine, work, factor)

    def with_height(self, height: int) -> PictureCost:
        """Return the cost of the same picture of another height, px, in an ordinary shot.

        What is learned of a shot includes the shape of its pictures already.
        """
        return replace(self, work=replace(self.work, height=height), factor=1.0)

    @property
    def ordinary_s(self) -> float:
        """Processor time if the shot costs as much as most, s; infinite where it is beyond all numbers."""
        engine = next(engine for engine in all_engines() if engine.name == self.engine)
        try:
            return engine.cost_s(self.work) + aovs_cost_s(self.work, engine.cost_s(replace(self.work, motion=1)))
        except OverflowError:
            return math.inf

    @property
    def expected_s(self) -> float:
        """Processor time by what is known of the shot, s."""
        return self.ordinary_s * self.factor


@dataclass(frozen=True)
class PictureLimits:
    """Limits of a picture: its pixels and its processor time.

    Attributes:
        max_px: limit of width times height.
        max_s: limit of the expected processor time, s.
        cost: what the picture is expected to cost; None for a preview, which is drawn in the time that it is given.
        path: where its settings come from, for the messages.
    """

    max_px: int
    max_s: float = math.inf
    cost: PictureCost | None = None
    path: str = "query"

    def check(self, width: int, height: int) -> None:
        """Check a picture whose camera gives it the height.

        Args:
            width: px.
            height: px.

        Raises:
            SettingsError: it has too many pixels, or is expected to take too long.
        """
        check_pixels(width, height, self.max_px, self.path)
        if self.cost is not None:
            check_cost(self.cost.with_height(height), self.max_s, self.path)


def check_pixels(width: int, height: int | None, max_px: int, path: str) -> None:
    """Check that a picture is not too large.

    Args:
        width: px.
        height: px; None where it is not known yet, which counts as 1.
        max_px: limit of width times height.
        path: where its settings come from, for the message.

    Raises:
        SettingsError: it has more pixels than are rendered.
    """
    if width * (height or 1) > max_px:
        size = f"{width} px wide" if height is None else f"of {width} × {height} px"
        detail = f"A picture {size} was requested; at most {max_px:,} px are rendered."
        raise SettingsError(detail, code="too_many_pixels", path=f"{path}.width")


def check_cost(cost: PictureCost, max_s: float, path: str) -> None:
    """Check that a picture does not take too long.

    Args:
        cost: what it is expected to cost.
        max_s: limit of the processor time, s.
        path: where its settings come from, for the message.

    Raises:
        SettingsError: it is expected to take longer.
    """
    if cost.expected_s > max_s:
        detail = (
            f"This picture is expected to take {cost.expected_s:,.0f} s of processor time; at most {max_s:,.0f} s are given. "
            "Ask for fewer rays, pixels, moments, layers, less supersampling or another engine."
        )
        raise SettingsError(detail, code="too_costly", path=path)
