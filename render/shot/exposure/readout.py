"""How a camera exposes: read from its prim at a time, with all that stands between the scene and the film.

What `exposure:*` multiplies radiance by is UsdGeomCamera's own scale (`render.optics.photometry.exposure`). Three things that
the schemas
say change it, and none of them by default:

- ``film:exposure:stop`` iris exposes by the stop that the iris is set to, in place of ``exposure:fStop``;
- ``lens:stopMarking`` t has that stop a T-stop: the light that the glass takes is in it already;
- ``lens:breathing`` has the image distance be the real one, and with it the bellows factor.

Light that came through the lens has lost what its glass and filters take (`render.model.lens.Lens.transmittance`) in the rays
already.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from numpy.typing import ArrayLike
from pxr import Usd

from render.errors import CameraError, SettingsError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.optics.photometry.exposure import (
    MIDDLE_GREY,
    ExposureSettings,
    equivalent,
    nd_transmittance,
    stops_of_density,
)
from render.optics.photometry.illuminance import LightPath, illuminance_lux, light_path
from render.optics.photometry.metering import Reading
from render.stage import quiet_diagnostics
from usd_schemas import LensCamera, SchemaError

ATTRIBUTES = {
    "time_s": "exposure:time",
    "iso": "exposure:iso",
    "f_stop": "exposure:fStop",
    "compensation_stops": "exposure",
    "responsivity": "exposure:responsivity",
}
"""Fields of `ExposureSettings`, and what USD calls them."""

Stop = Literal["exposure", "iris"]


@dataclass(frozen=True)
class ExposureReadout:
    """A camera's exposure at one time.

    Attributes:
        camera: prim path; empty for a camera that is no prim.
        settings: of the exposure; its f-number is the one that is exposed by.
        stop: whether that is ``exposure:fStop`` or the iris's.
        is_t_stop: whether it is a T-stop.
        glass: share of the light that the glass lets through.
        filters: share that filters let through.
        neutral_density: of the filters, optical density.
        path: what the lens is set to, without filters; None for a pinhole.
        shutter_angle_rad: of a rotating shutter that is open for as long as ``shutter:open`` and ``shutter:close`` say; 0 for a
            moment.
        shutter_time_s: how long that is.
    """

    camera: str
    settings: ExposureSettings
    stop: Stop
    is_t_stop: bool
    glass: float
    filters: float
    neutral_density: float
    path: LightPath | None
    shutter_angle_rad: float
    shutter_time_s: float

    @property
    def bellows_factor(self) -> float:
        """By how much longer the exposure has to be than at infinity."""
        return 1.0 if self.path is None else self.path.bellows_factor

    @property
    def exposure_scale(self) -> float:
        """What light that came through the lens is multiplied by; ``ComputeLinearExposureScale`` but for what the head of this
        module names."""
        paid = self.glass if self.is_t_stop and self.glass > 0 else 1.0
        return self.settings.scale / (self.bellows_factor * paid)

    @property
    def passes(self) -> float:
        """Share of the light that is left of what the stop and an image at infinity would have."""
        return self.filters * (1.0 if self.is_t_stop else self.glass) / self.bellows_factor

    @property
    def scale(self) -> float:
        """What the luminance of the scene becomes in the picture, by factor."""
        return self.settings.scale * self.passes

    @property
    def grey_nits(self) -> float:
        """The luminance that comes out as middle grey; infinite where no light passes."""
        return MIDDLE_GREY / self.scale if self.scale > 0 else math.inf

    @property
    def ev100(self) -> float:
        """Exposure value at ISO 100 of the settings, compensation and filters aside: what is dialled in."""
        return self.settings.ev100

    @property
    def nd_stops(self) -> float:
        """What the filters take."""
        return stops_of_density(self.neutral_density)

    def lux_on_film(self, luminance_nits: ArrayLike) -> DoubleArray:
        """Illuminance of the film on the axis by what is so bright.

        Args:
            luminance_nits: any shape, as seen from outside of the lens.
        """
        return illuminance_lux(luminance_nits, self._exposing)

    def reading(self, luminance_nits: float) -> Reading:
        """What a meter on the camera says of a luminance: `Reading.stops` is how far over or under middle grey it comes out.

        Args:
            luminance_nits: as seen from outside of the lens.

        Raises:
            SettingsError: no light passes.
        """
        return Reading(luminance_nits, self._metered)

    def equivalents(self, stops: Sequence[int] = range(-3, 4)) -> tuple[ExposureSettings, ...]:
        """Exposures that make the same picture, but for its depth of field and its motion, as whole stops away.

        Args:
            stops: by how many the iris is closed; the time makes up for it.
        """
        exposed = self.settings
        return tuple(equivalent(exposed, "time", f_stop=exposed.f_stop * math.sqrt(2.0) ** n) for n in stops)

    @cached_property
    def _metered(self) -> ExposureSettings:
        if not self.passes > 0:
            raise SettingsError(
                f"no light comes through the lens of {self.camera or 'the camera'}: nothing can be metered",
                code="no_light",
            )
        return replace(self.settings, responsivity=self.settings.responsivity * self.passes)

    @property
    def _exposing(self) -> LightPath:
        """The way to the film that the exposure is of: its stop need not be the iris's."""
        passes = self.filters * (1.0 if self.is_t_stop else self.glass)
        if self.path is None:
            return LightPath(self.settings.f_stop, passes)
        return replace(self.path, f_stop=self.settings.f_stop, transmittance=passes)


def read_exposure(stage: Usd.Stage, camera: Camera, time: float) -> ExposureReadout:
    """The exposure of a camera.

    Args:
        stage: of the camera.
        camera: at that time, its focus and stop solved.
        time: USD time code.

    Raises:
        CameraError: a number has no meaning.
        InputError: its prescription is no lens.
    """
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    try:
        with quiet_diagnostics():
            view = LensCamera(prim) if prim else None
            settings = ExposureSettings() if prim is None or not prim else _settings(prim, time)
            glass = view.lens.read(time) if view else None
            stop: Stop = view.film.read(time).exposure.stop if view else "exposure"
        passes = glass.transmittance if glass else 1.0
        path = replace(light_path(camera), transmittance=passes) if camera.f_stop > 0 else None
        density = glass.neutral_density if glass else 0.0
        if stop == "iris" and path is not None:
            settings = replace(settings, f_stop=path.f_stop)
        filters = nd_transmittance(density)
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error
    except SchemaError as error:
        raise CameraError(str(error), path=camera.path) from error
    open_s = max(camera.shutter_close - camera.shutter_open, 0.0) / stage.GetTimeCodesPerSecond()
    return ExposureReadout(
        camera=camera.path,
        settings=settings,
        stop=stop,
        is_t_stop=bool(glass and glass.stop_marking == "t"),
        glass=passes,
        filters=filters,
        neutral_density=density,
        path=path,
        shutter_angle_rad=2 * math.pi * open_s * stage.GetFramesPerSecond(),
        shutter_time_s=open_s,
    )


def with_exposure(stage: Usd.Stage, camera: Camera, time: float) -> Camera:
    """A camera with all that its light is multiplied by in its exposure scale. Most need not be looked at for it.

    Args:
        stage: of the camera.
        camera: at that time, its focus and stop solved, its scale UsdGeomCamera's.
        time: USD time code.

    Raises:
        CameraError: a number has no meaning.
        InputError: its prescription is no lens.
    """
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    if not prim:
        return camera
    view = LensCamera(prim)
    plain = view.film.read(time).exposure.stop == "exposure" and view.lens.read(time).stop_marking == "f"
    if plain and not camera.breathing:
        return camera
    return replace(camera, exposure_scale=read_exposure(stage, camera, time).exposure_scale)


def _settings(prim: Usd.Prim, time: float) -> ExposureSettings:
    code = Usd.TimeCode(time)
    said = {field: prim.GetAttribute(name).Get(code) for field, name in ATTRIBUTES.items()}
    return ExposureSettings(**{field: float(value) for field, value in said.items() if value is not None})
