"""A long exposure: one picture over many frames, whose shutter is opened and closed at will."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from render.errors import SettingsError
from render.film import Grade, GradeChoice
from render.film.gathering import GatheredLight
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.limits import MAX_RAYS
from render.model.moment import Moment
from render.model.shutter import GLOBAL_SHUTTER
from render.model.shutter_intervals import MAX_ND_STOPS
from render.pictures.moving import check_shutter
from render.pictures.picture import Picture, develop_picture, expose_frame
from render.pictures.travel import make_moment, measure_travel_px
from render.shot.light_meter import auto_expose
from render.shot.shot import Shot

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from collections.abc import Callable

    from render.frame import FrameRenderer, FrameSettings

MOST_MOMENTS = 32
"""Of an interval, where their number is found out: what moves by more pixels is looked at less often than at each of them."""
LEAST_RAYS = 4
"""Of a moment, likewise: fewer leave beads on a trail, however close its moments are."""
_SEEDS = 2**31


@dataclass(frozen=True)
class LongExposureState:
    """How far a long exposure is.

    Attributes:
        open_frames: for how long the shutter was open, in frames.
        open_seconds: likewise, in seconds.
        intervals: in how many pieces.
        nd_stops: of the neutral density before the lens.
        gain: what the mean light is multiplied by; 1 where the filter takes all that the time adds.
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
        shot: which goes on; whoever opens it anew may put it in the place of the old one.
    """

    def __init__(
        self,
        renderer: FrameRenderer,
        shot: Shot,
        camera: str | None,
        begin: float,
        settings: FrameSettings,
        *,
        nd_stops: float | None = None,
        grade: Grade | None = None,
        stock: str | None = None,
        choice: GradeChoice | None = None,
    ) -> None:
        """Put the camera on its tripod; the shutter is closed.

        Args:
            renderer: of the calling thread.
            shot: the shot.
            camera: prim path; None for the shot's default camera.
            begin: USD time code. Film, grade and the exposure that others are measured against are those of this time.
            settings: how each interval is rendered, with as many rays each; a ``motion`` of 1 lets the moments of each be as many
                as pixels that anything moves by, up to `MOST_MOMENTS`, with `LEAST_RAYS` or more each.
            nd_stops: of a filter before the lens; None for one that keeps the exposure.
            grade: for which display, in place of what the shot says.
            stock: a film of the library, likewise.
            choice: what is wanted of the grade, in place of parts of what the shot says.

        Raises:
            SettingsError: more is asked for than colour, or a number or a name makes no sense.
            CameraError: it is no camera, has impossible numbers, or a shutter that closes before it opens.
        """
        if set(settings.aovs) != {"color"}:
            raise SettingsError("a long exposure has colour alone: nothing is at one depth while it moves")
        if nd_stops is not None and not 0 <= nd_stops <= MAX_ND_STOPS:
            raise SettingsError(
                f"the neutral density of a long exposure must be from 0 to {MAX_ND_STOPS} stops, got {nd_stops:g}"
            )
        self.shot = shot
        self._renderer, self._camera, self._settings = renderer, camera, settings
        self._begin, self._nd_stops = begin, nd_stops
        self._lens = self._at(begin)
        check_shutter(self._lens)
        self._finish = shot.film.finish(self._lens, begin, grade, stock, choice)
        self._metered = auto_expose(renderer, shot, self._lens, begin, settings.shading)
        self._light = GatheredLight()
        self._prim_paths: tuple[str, ...] = ()
        self._last: tuple[float, Moment] | None = None

    def expose(self, begin: float, end: float, on_progress: Callable[[float], None] | None = None) -> None:
        """Have the shutter open over an interval. Whatever interrupts it leaves the picture as it was before.

        Args:
            begin: USD time code.
            end: likewise, later.
            on_progress: called with the share of the interval that is done, from 0 to 1.

        Raises:
            SettingsError: it ends before it begins.
            CameraError: the camera has impossible numbers at one of the moments, or a shutter that closes before it opens.
            GraphicsError: the device refuses.
        """
        if not end > begin:
            raise SettingsError(
                f"a shutter cannot close before it opens: it opens at {begin:g} and closes at {end:g}",
                code="bad_shutter",
            )
        settings = self._settings
        lens = self._at(begin)
        check_shutter(lens)
        opened = replace(lens, shutter_open=0.0, shutter_close=end - begin, shutter=GLOBAL_SHUTTER)
        if settings.motion == 1:
            count = self._moments_of(begin, end)
            settings = replace(settings, motion=count, rays=min(max(settings.rays, LEAST_RAYS * count), MAX_RAYS))
        # Another seed for each interval, the same one whenever the interval is exposed: noise averages out, and stopping changes
        # nothing.
        seed = (settings.seed + round(begin * 1000)) % _SEEDS
        frame = expose_frame(
            self._renderer,
            self.shot,
            self._camera,
            opened,
            begin,
            replace(settings, seed=seed),
            on_progress,
        )
        self._prim_paths = frame.prim_paths
        keyed = self._metered is self._lens
        self._light.add(_exposed_alike(frame.color, lens, self._lens) if keyed else frame.color, end - begin)

    @property
    def state(self) -> LongExposureState:
        """How far it is."""
        frames = self._light.frames
        own = self._lens.shutter_close - self._lens.shutter_open
        gained = math.log2(frames / (own if own > 0 else 1.0)) if frames else 0.0
        nd_stops = gained if self._nd_stops is None else self._nd_stops
        seconds = frames / self.shot.stage.GetTimeCodesPerSecond()
        return LongExposureState(frames, seconds, self._light.intervals, nd_stops, 2.0 ** (gained - nd_stops))

    def picture(self) -> Picture:
        """What is on the film so far; the exposure may go on afterwards.

        Raises:
            SettingsError: the shutter was never open.
        """
        from render.frame import Frame

        state = self.state
        light = self._light.light
        light[..., :3] *= np.float32(state.gain)
        lens = replace(self._metered, shutter_open=0.0, shutter_close=state.open_frames, shutter=GLOBAL_SHUTTER)
        said = {"longExposureSeconds": state.open_seconds, "ndStops": state.nd_stops, "intervals": state.intervals}
        picture = develop_picture(
            self.shot, Frame(light, {}, self._prim_paths), lens, self._begin, self._settings, self._finish
        )
        metadata = replace(
            picture.metadata,
            settings={**picture.metadata.settings, **said},
            exposure_time_s=state.open_seconds,
        )
        return replace(picture, metadata=metadata)

    def _at(self, time: float) -> Camera:
        return self.shot.camera_at(self._camera, time, self._settings.width, self._settings.height)

    def _moments_of(self, begin: float, end: float) -> int:
        """As many as pixels that what moves fastest moves by."""
        before = self._last[1] if self._last is not None and self._last[0] == begin else self._moment(begin)
        after = self._moment(end)
        self._last = (end, after)
        travel = measure_travel_px(before, after, self._settings.width, self._settings.height)
        return min(max(math.ceil(travel), 2), MOST_MOMENTS)

    def _moment(self, time: float) -> Moment:
        return make_moment(self.shot.scene_at(time), self._at(time))


def _exposed_alike(color: FloatArray, lens: Camera, first: Camera) -> FloatArray:
    """Light such that the exposure of the first frame makes of it what the camera's own exposure at the time would."""
    if lens.exposure_scale == first.exposure_scale or first.exposure_scale == 0:
        return color
    ratio = np.float32(lens.exposure_scale / first.exposure_scale)
    return np.concatenate([color[..., :3] * ratio, color[..., 3:]], axis=-1)
