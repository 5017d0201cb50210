"""A long exposure: one picture over many frames, whose shutter is opened and closed interactively."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from render.engines import check_settings
from render.errors import SettingsError
from render.film import Grade, GradeChoice
from render.film.light_accumulator import LightAccumulator
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.limits import MAX_RAYS
from render.model.moment import Moment
from render.model.shutter import GLOBAL_SHUTTER
from render.model.shutter_intervals import MAX_MOMENTS, MAX_ND_STOPS, MIN_RAYS
from render.pictures.moving import check_shutter
from render.pictures.picture import Picture, develop_picture, expose_frame
from render.pictures.travel import make_moment, measure_travel_px
from render.shot.light_meter import auto_expose
from render.shot.shot import Shot

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from collections.abc import Callable

    from render.frame import FrameRenderer, FrameSettings

_SEEDS = 2**31


@dataclass(frozen=True)
class LongExposureState:
    """Progress of a long exposure.

    Attributes:
        open_frames: time that the shutter was open, in frames.
        open_seconds: likewise, in seconds.
        intervals: number of exposed intervals.
        nd_stops: neutral density in front of the lens.
        gain: factor of the mean light; 1 where the filter takes all that the time adds.
    """

    open_frames: float
    open_seconds: float
    intervals: int
    nd_stops: float
    gain: float


class LongExposure:
    """Light gathered on one frame of film while the shot goes on.

    Each interval is exposed from its begin to its end, in moments over which its rays are spread, and the next one begins
    where it ends: a light that moves leaves a trail without gaps. The shutter's own way of opening (blades, travel) is left
    out: against the time that it is open, it opens at once.

    **Exposure.** The light is the mean over the time that the shutter was open, as if a neutral density filter took as many stops
    as the time is longer than a single frame's own opening. So what stands still is as bright as in a single frame, whenever one
    stops. With a filter of a given density the picture gets brighter for as long as the shutter is open, as it does on film. An
    exposure that is keyed counts as it is in each interval; a camera that meters does so once, before its shutter opens.

    Attributes:
        shot: the shot; it may be replaced by the same shot opened anew.
    """

    def __init__(
        self,
        renderer: FrameRenderer,
        shot: Shot,
        camera_path: str | None,
        begin: float,
        settings: FrameSettings,
        *,
        nd_stops: float | None = None,
        grade: Grade | None = None,
        stock: str | None = None,
        choice: GradeChoice | None = None,
    ) -> None:
        """Prepare the exposure; the shutter is closed.

        Args:
            renderer: of the calling thread.
            shot: the shot.
            camera_path: prim path; None for the shot's default camera.
            begin: USD time code. Film, grade and the exposure that others are measured against are those of this time.
            settings: engine, size and sampling of each interval. With a ``motion`` of 1 each interval has a moment for each pixel
                that anything moves by, up to `MAX_MOMENTS`, with `MIN_RAYS` or more each.
            nd_stops: neutral density in front of the lens; None for one that keeps the exposure.
            grade: in place of the shot's grade.
            stock: a film of the library, in place of the shot's film.
            choice: display, view and look, in place of these parts of the shot's grade.

        Raises:
            SettingsError: no engine can do this, there are AOVs besides colour, or a number or a name is out of range.
            CameraError: the prim is no camera, has impossible values, or a shutter that closes before it opens.
        """
        check_settings(settings)
        if set(settings.aovs) != {"color"}:
            raise SettingsError("a long exposure has colour alone: nothing is at one depth while it moves")
        if nd_stops is not None and not 0 <= nd_stops <= MAX_ND_STOPS:
            raise SettingsError(
                f"the neutral density of a long exposure must be from 0 to {MAX_ND_STOPS} stops, got {nd_stops:g}"
            )
        self.shot = shot
        self._renderer, self._camera_path, self._settings = renderer, camera_path, settings
        self._begin, self._nd_stops = begin, nd_stops
        self._camera = self._camera_at(begin)
        check_shutter(self._camera)
        self._finish = shot.film.finish(self._camera, begin, grade, stock, choice)
        self._metered = auto_expose(renderer, shot, self._camera, begin, settings.shading)
        self._light = LightAccumulator()
        self._prim_paths: tuple[str, ...] = ()
        self._last: tuple[float, Moment] | None = None

    def expose(self, begin: float, end: float, on_progress: Callable[[float], None] | None = None) -> None:
        """Expose an interval. Where it is interrupted, the picture stays as it was before.

        Args:
            begin: USD time code.
            end: likewise, later.
            on_progress: called with the share of the interval that is done, from 0 to 1.

        Raises:
            SettingsError: the interval ends before it begins.
            CameraError: the camera has impossible values at one of the moments, or a shutter that closes before it opens.
            GraphicsError: OpenGL reports an error.
        """
        if not end > begin:
            raise SettingsError(
                f"a shutter cannot close before it opens: it opens at {begin:g} and closes at {end:g}",
                code="bad_shutter",
            )
        settings = self._settings
        camera = self._camera_at(begin)
        check_shutter(camera)
        opened = replace(camera, shutter_open=0.0, shutter_close=end - begin, shutter=GLOBAL_SHUTTER)
        if settings.motion == 1:
            count = self._count_moments(begin, end)
            settings = replace(settings, motion=count, rays=min(max(settings.rays, MIN_RAYS * count), MAX_RAYS))
        # A seed of its own for each interval: noise averages out, and the picture does not depend on where the exposure stopped.
        seed = (settings.seed + round(begin * 1000)) % _SEEDS
        frame = expose_frame(
            self._renderer,
            self.shot,
            self._camera_path,
            opened,
            begin,
            replace(settings, seed=seed),
            on_progress,
        )
        self._prim_paths = frame.prim_paths
        is_keyed = self._metered is self._camera
        light = _match_exposure(frame.color, camera, self._camera) if is_keyed else frame.color
        self._light.add(light, end - begin)

    @property
    def state(self) -> LongExposureState:
        """Progress so far."""
        frames = self._light.frames
        own = self._camera.shutter_close - self._camera.shutter_open
        gained = math.log2(frames / (own if own > 0 else 1.0)) if frames else 0.0
        nd_stops = gained if self._nd_stops is None else self._nd_stops
        seconds = frames / self.shot.stage.GetTimeCodesPerSecond()
        return LongExposureState(frames, seconds, self._light.intervals, nd_stops, 2.0 ** (gained - nd_stops))

    def develop(self) -> Picture:
        """Develop the light on the film so far; the exposure may go on afterwards.

        Raises:
            SettingsError: the shutter was never open.
        """
        from render.frame import Frame

        state = self.state
        light = self._light.light
        light[..., :3] *= np.float32(state.gain)
        camera = replace(self._metered, shutter_open=0.0, shutter_close=state.open_frames, shutter=GLOBAL_SHUTTER)
        numbers = {"longExposureSeconds": state.open_seconds, "ndStops": state.nd_stops, "intervals": state.intervals}
        picture = develop_picture(
            self.shot, Frame(light, {}, self._prim_paths), camera, self._begin, self._settings, self._finish
        )
        metadata = replace(
            picture.metadata,
            settings={**picture.metadata.settings, **numbers},
            exposure_time_s=state.open_seconds,
        )
        return replace(picture, metadata=metadata)

    def _camera_at(self, time: float) -> Camera:
        return self.shot.camera_at(self._camera_path, time, self._settings.width, self._settings.height)

    def _count_moments(self, begin: float, end: float) -> int:
        """Count the pixels that the fastest surface moves by in an interval, within bounds."""
        before = self._last[1] if self._last is not None and self._last[0] == begin else self._moment(begin)
        after = self._moment(end)
        self._last = (end, after)
        travel = measure_travel_px(before, after, self._settings.width, self._settings.height)
        return min(max(math.ceil(travel), 2), MAX_MOMENTS)

    def _moment(self, time: float) -> Moment:
        camera = self._camera_at(time)
        return make_moment(self.shot.scene_at(time, camera.path), camera)


def _match_exposure(color: FloatArray, camera: Camera, first: Camera) -> FloatArray:
    """Scale light so that the first frame's exposure gives what the camera's own exposure would."""
    if camera.exposure_scale == first.exposure_scale or first.exposure_scale == 0:
        return color
    ratio = np.float32(camera.exposure_scale / first.exposure_scale)
    return np.concatenate([color[..., :3] * ratio, color[..., 3:]], axis=-1)
