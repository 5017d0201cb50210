"""Exposure of a camera at a time, with all that light passes between the scene and the film.

`exposure:*` multiplies radiance by UsdGeomCamera's own scale (`render.optics.photometry.exposure`). Three properties of the
schemas change it, none of them by default:

- ``film:exposure:stop = iris`` exposes by the f-number of the iris, in place of ``exposure:fStop``;
- ``lens:stopMarking = t`` makes that a T-stop, which includes the light that the glass absorbs;
- ``lens:breathing`` uses the physical image distance, and with it the bellows factor.

Rays through the lens are already dimmed by its glass and filters (`render.model.lens.Lens.transmittance`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
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
"""USD attributes by the fields of `ExposureSettings`."""

Stop = Literal["exposure", "iris"]


@dataclass(frozen=True)
class ExposureReadout:
    """A camera's exposure at one time.

    Attributes:
        camera: prim path; empty for a camera that is no prim.
        settings: of the exposure; its f-number is the one that exposes.
        stop: source of that f-number: ``exposure:fStop`` or the iris.
        is_t_stop: true where it is a T-stop.
        glass: transmittance of the glass.
        filters: transmittance of the filters.
        neutral_density: of the filters, optical density.
        path: light path through the lens, without filters; None for a pinhole.
        shutter_angle_rad: of a rotating shutter that is open from ``shutter:open`` to ``shutter:close``; 0 for an instant.
        shutter_time_s: time that the shutter is open.
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
        """Factor by which the exposure must be longer than at infinity."""
        return 1.0 if self.path is None else self.path.bellows_factor

    @property
    def exposure_scale(self) -> float:
        """Factor on light that came through the lens: ``ComputeLinearExposureScale`` with the changes listed above."""
        included = self.glass if self.is_t_stop and self.glass > 0 else 1.0
        return self.settings.scale / (self.bellows_factor * included)

    @property
    def transmittance(self) -> float:
        """Share of the light that remains, relative to the f-number alone and an image at infinity."""
        return self.filters * (1.0 if self.is_t_stop else self.glass) / self.bellows_factor

    @property
    def scale(self) -> float:
        """Factor from luminance of the scene to value in the picture."""
        return self.settings.scale * self.transmittance

    @property
    def grey_nits(self) -> float:
        """Luminance that is exposed to middle grey; infinite where no light passes."""
        return MIDDLE_GREY / self.scale if self.scale > 0 else math.inf

    @property
    def ev100(self) -> float:
        """Exposure value at ISO 100 of the settings, without compensation and filters."""
        return self.settings.ev100

    @property
    def nd_stops(self) -> float:
        """Stops of light that the filters absorb."""
        return stops_of_density(self.neutral_density)

    def lux_on_film(self, luminance_nits: ArrayLike) -> DoubleArray:
        """Illuminance of the film on the axis from a surface of a luminance.

        Args:
            luminance_nits: any shape, as seen from outside of the lens.
        """
        return illuminance_lux(luminance_nits, self._exposing_path)

    def reading(self, luminance_nits: float) -> Reading:
        """Reading of a meter on the camera: `Reading.stops` is how far above or below middle grey a luminance is exposed.

        Args:
            luminance_nits: as seen from outside of the lens.
        """
        return Reading(luminance_nits, self.settings, self.transmittance)

    def equivalents(self, stops: Sequence[int] = range(-3, 4)) -> tuple[ExposureSettings, ...]:
        """Exposures of the same brightness at other f-numbers, whole stops away.

        Args:
            stops: number of stops by which the iris is closed; the time compensates.
        """
        exposed = self.settings
        return tuple(equivalent(exposed, "time", f_stop=exposed.f_stop * math.sqrt(2.0) ** n) for n in stops)

    @property
    def _exposing_path(self) -> LightPath:
        """Light path at the f-number that exposes, which may differ from the iris."""
        transmittance = self.filters * (1.0 if self.is_t_stop else self.glass)
        if self.path is None:
            return LightPath(self.settings.f_stop, transmittance)
        return replace(self.path, f_stop=self.settings.f_stop, transmittance=transmittance)


def read_exposure(stage: Usd.Stage, camera: Camera, time: float) -> ExposureReadout:
    """Read the exposure of a camera.

    Args:
        stage: of the camera.
        camera: at that time, its focus and stop solved.
        time: USD time code.

    Raises:
        CameraError: a number has no meaning.
        InputError: its prescription has no focal length.
    """
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    try:
        with quiet_diagnostics():
            view = LensCamera(prim) if prim else None
            settings = ExposureSettings() if prim is None or not prim else _settings(prim, time)
            glass = view.lens.read(time) if view else None
            stop: Stop = view.film.read(time).exposure.stop if view else "exposure"
        transmittance = glass.transmittance if glass else 1.0
        path = replace(light_path(camera), transmittance=transmittance) if camera.f_stop > 0 else None
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
        glass=transmittance,
        filters=filters,
        neutral_density=density,
        path=path,
        shutter_angle_rad=2 * math.pi * open_s * stage.GetFramesPerSecond(),
        shutter_time_s=open_s,
    )


def with_exposure(stage: Usd.Stage, camera: Camera, time: float) -> Camera:
    """Return a camera whose exposure scale has every factor on its light. Most cameras need no change.

    Args:
        stage: of the camera.
        camera: at that time, its focus and stop solved, its scale UsdGeomCamera's.
        time: USD time code.

    Raises:
        CameraError: a number has no meaning.
        InputError: its prescription has no focal length.
    """
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    if not prim:
        return camera
    view = LensCamera(prim)
    is_plain = view.film.read(time).exposure.stop == "exposure" and view.lens.read(time).stop_marking == "f"
    if is_plain and not camera.breathing:
        return camera
    return replace(camera, exposure_scale=read_exposure(stage, camera, time).exposure_scale)


def _settings(prim: Usd.Prim, time: float) -> ExposureSettings:
    code = Usd.TimeCode(time)
    values = {field: prim.GetAttribute(name).Get(code) for field, name in ATTRIBUTES.items()}
    return ExposureSettings(**{field: float(value) for field, value in values.items() if value is not None})
