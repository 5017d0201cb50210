"""The light meter of a shot: its reading at a time, and the compensation that it sets.

It renders a small, sharp picture of the scene as seen from outside of the lens: blur spreads light and keeps its mean. Its
settings are `Metering`: spot, centre or average, the position of the spot, compensation and smoothing.

So that a frame is exposed alike whichever frames are rendered, readings are taken at fixed times of the shot: even steps from
time code 0 within its frame range, as far on either side as the smoothing reaches. Their logarithms are smoothed, and
compensated with the exposure settings at the frame itself, so that an f-number that changes within the shot is met at once.
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from render.engines import sharp_engine
from render.errors import CameraError, SettingsError
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.lens import Lens
from render.near_names import hint
from render.optics.distortion import distort_positions, undistort_position
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS, ExposureSettings
from render.optics.photometry.metering import SPOT_ANGLE_RAD, MeterMode, meter, smoothed_keys
from render.optics.view import PinholeView
from render.shot.accepted import draw_accepted
from render.shot.exposure.metering import Metered, Place, check_metering
from render.shot.exposure.readout import ExposureReadout
from render.shot.shot import Shot
from render.stage import read_camera
from usd_schemas import Metering

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import FrameRenderer

PICTURE_PX = 96
SPOT_PX = 12
_QUICK = FrameSettings(PICTURE_PX, 1, engine=sharp_engine(), rays=4, layers=1)
_REACH = 4.0  # standard deviations of the smoothing, beyond which readings do not count


@dataclass(frozen=True)
class _Spot:
    """Position of a spot in the picture, and its position through a lens without distortion."""

    shown: Place
    straight: Place


class LightMeter:
    """Meters one camera of a shot. Luminances are cached with the shot until its scene changes."""

    def __init__(
        self,
        renderer: FrameRenderer,
        shot: Shot,
        camera_path: str | None,
        shading: str = "lit",
        **changes: Any,
    ) -> None:
        """Meter through a camera.

        Args:
            renderer: of the calling thread.
            shot: the shot.
            camera_path: prim path; None for the shot's default camera.
            shading: of the picture that is metered.
            changes: to the shot's metering settings, by the fields of `Metering`.

        Raises:
            CameraError: there is no such camera.
            SettingsError: a setting has no meaning.
        """
        choice = shot.default_camera() if camera_path is None else None
        path = choice.path if choice else camera_path
        if path is None:
            raise CameraError("a light meter needs a camera, and the stage has none to prefer", code="no_camera")
        check_metering(Metering(**changes))
        self._renderer, self._shot, self._path, self._changes = renderer, shot, path, changes
        self._settings = replace(_QUICK, shading=shading)

    def metering(self, time: float) -> Metering:
        """Metering settings at a time.

        Raises:
            CameraError: a setting of the shot has no meaning.
        """
        return replace(self._shot.exposure.metering(self._path, time), **self._changes)

    def read(self, time: float) -> Metered:
        """Meter the scene at a time.

        Args:
            time: USD time code.

        Raises:
            SettingsError: the mode is manual, or the camera has no such focus point.
            CameraError: the camera has impossible values.
            GraphicsError: OpenGL reports an error.
        """
        metering = self.metering(time)
        if metering.mode == "manual":
            raise SettingsError("a meter looks at a spot, the center or the average of the picture, got manual")
        exposure = self._shot.exposure.read(self._path, time)
        luminance = self._luminance(time)
        spot = self._spot(time, metering)
        return Metered(
            time=time,
            mode=metering.mode,
            place=spot.shown if spot else None,
            reading=exposure.reading(0.0 if math.isnan(luminance) else luminance),
            exposure=exposure,
            compensation_stops=self._compensation(time, metering, exposure),
        )

    def _compensation(self, time: float, metering: Metering, exposure: ExposureReadout) -> float:
        times = self._times(time, metering.smoothing_s)
        luminances = np.array([self._luminance(at) for at in times])
        lit = luminances > 0
        if not lit.any():
            return math.nan
        stops = np.log2(luminances, where=lit, out=np.full(len(luminances), math.nan))
        rate = self._shot.stage.GetTimeCodesPerSecond()
        seconds = np.nan_to_num([*times, time]) / rate
        light = float(smoothed_keys(seconds[:-1], stops, metering.smoothing_s, at_s=seconds[-1:])[0])
        needed_stops = exposure.reading(2**light).compensation_stops + metering.compensation_stops
        return float(np.clip(needed_stops, -MAX_COMPENSATION_STOPS, MAX_COMPENSATION_STOPS))

    def _times(self, time: float, smoothing_s: float) -> list[float]:
        """Times of the readings that count at a time, an odd number of time codes apart so that alternating flicker averages."""
        if math.isnan(time):  # no times lie beside the default one
            return [time]
        sigma = smoothing_s / 4 * self._shot.stage.GetTimeCodesPerSecond()
        step = max(1, (int(sigma) - 1) // 2 * 2 + 1)
        frames = self._shot.frame_range
        first = max(time - _REACH * sigma, min(frames.start, time))
        last = min(time + _REACH * sigma, max(frames.end, time))
        return [float(step * n) for n in range(math.ceil(first / step), math.floor(last / step) + 1)] or [time]

    def _luminance(self, time: float) -> float:
        """Metered luminance in nits; NaN where the spot is not in the picture."""
        metering = self.metering(time)
        mode = cast(MeterMode, metering.mode)
        camera = replace(read_camera(self._shot.stage, self._path, time), lens=Lens(), f_stop=0.0)
        width = PICTURE_PX
        if metering.mode == "spot":
            spot = self._spot(time, metering)
            if spot is None:
                return math.nan
            camera, width = _crop_to_spot(camera, spot.straight), SPOT_PX
        height = max(1, round(width * camera.vertical_aperture_mm / camera.horizontal_aperture_mm))
        settings = replace(self._settings, width=width, height=height)
        cache, key = self._shot.exposure.meter_cache, (time, metering.mode, settings, _pinhole_key(camera))
        if key not in cache:
            frame = draw_accepted(
                lambda: self._renderer.render(self._shot.scene_at(time, self._path), camera, settings)
            )
            cache[key] = _mean(frame.color, mode)
        return cache[key]

    def _spot(self, time: float, metering: Metering) -> _Spot | None:
        """Position of the spot; None where it is not in the picture, or the mode has none."""
        if metering.mode != "spot":
            return None
        camera = read_camera(self._shot.stage, self._path, time)
        view = PinholeView.from_camera(camera, 1, 1)
        if metering.focus_point:
            straight = self._point(time, metering.focus_point, view)
            shown = distort_positions(view, camera, np.array([straight]))[0].tolist()
        else:
            straight, shown = undistort_position(view, camera, *metering.spot), list(metering.spot)
        return _Spot((shown[0], shown[1]), straight) if all(0 <= side <= 1 for side in shown) else None

    def _point(self, time: float, name: str, view: PinholeView) -> Place:
        points = {placed.point.name: placed for placed in self._shot.focus.points(self._path, time)}
        if name not in points:
            raise SettingsError(f"no focus point to meter is named {name!r}: {hint(name, points)}", code="bad_meter")
        position_m = points[name].position_m
        places, _ = view.project(np.array([position_m if position_m is not None else [math.nan] * 3]))
        return float(places[0, 0]), float(places[0, 1])


def auto_expose(renderer: FrameRenderer, shot: Shot, camera: Camera, time: float, shading: str = "lit") -> Camera:
    """Return a camera with the meter's exposure, where its metering mode is not manual.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera: as the shot has it at that time.
        time: USD time code.
        shading: of the picture.

    Raises:
        CameraError: a metering setting has no meaning.
        GraphicsError: OpenGL reports an error.
    """
    if not camera.path:
        return camera
    metering = shot.exposure.metering(camera.path, time)
    if metering.mode == "manual":
        return camera
    try:
        metered = LightMeter(renderer, shot, camera.path, shading).read(time)
    except SettingsError as error:  # the settings are the shot's, not the caller's
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error
    return replace(camera, exposure_scale=metered.exposed.exposure_scale)


def _mean(picture: FloatArray, mode: MeterMode) -> float:
    """Mean luminance by a mode; for a spot, of the disc that fills the picture."""
    height, width = picture.shape[:2]
    middle = width / 2, height / 2
    return meter(picture, ExposureSettings(), mode, spot_px=middle, spot_radius_px=width / 2).luminance_nits


def _pinhole_key(camera: Camera) -> tuple[Hashable, ...]:
    """Properties of a camera that its pinhole picture depends on."""
    gate = camera.horizontal_aperture_mm, camera.vertical_aperture_mm, camera.focal_length_mm
    offsets = camera.horizontal_offset_mm, camera.vertical_offset_mm
    breathes = camera.focus_distance_m if camera.breathing else None
    return camera.world_from_camera.tobytes(), gate, offsets, camera.near_m, camera.far_m, camera.clip_planes, breathes


def _crop_to_spot(camera: Camera, place: Place) -> Camera:
    """Crop the film gate to the spot meter's angle around a position."""
    view = PinholeView.from_camera(camera, 1, 1)
    right, up = (place[0] - view.cx) / view.fx, (view.cy - place[1]) / view.fy
    # a spot of an orthographic camera is as large in its picture as in that of a normal lens
    seen_from_mm = camera.focal_length_mm if camera.orthographic is None else camera.covered_mm
    side_mm = 2 * math.tan(SPOT_ANGLE_RAD / 2) * seen_from_mm
    return replace(
        camera,
        horizontal_aperture_mm=side_mm,
        vertical_aperture_mm=side_mm,
        horizontal_offset_mm=right * camera.focal_length_mm,
        vertical_offset_mm=up * camera.focal_length_mm,
        breathing=False,
    )
