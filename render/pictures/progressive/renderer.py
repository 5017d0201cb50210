"""The progressive renderer: pictures of a change, the first within a tenth of a second, the last exact.

    a small picture from kept layers · the same by more rays · the exact picture, piece by piece · finished as files are

The second is left out where the layers of the exact picture are kept: drawing these is what takes longest.

Work that has become stale is cancelled between two of its pieces. Kept results are used where nothing that they depend on has
changed: the scene and shadows of what stands still (`render.layers.shadow_maps`), layers and N-buffers (`Peeler.peel`,
`NBufferBuilder.build`), the light on the film where only its development or the grade changed, and the developed film where only
the grade did. In a scene so large that a distant light's shadows are resolved around the focus alone, a final picture draws these
anew where the focus has gone far, and with them the layers.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter

from render.engines import engine_class
from render.frame import Frame, FrameRenderer
from render.gl.cancellation import Cancelled
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.pictures.image_space import ImageSpace
from render.pictures.live_finisher import LiveFinisher
from render.pictures.moving import has_motion
from render.pictures.picture import (
    apply_lens_effects,
    apply_vignetting,
    describe_picture,
    develop_picture,
    expose_frame,
    prepare_camera,
)
from render.pictures.progressive.background import run_in_background
from render.pictures.progressive.clock import Clock
from render.pictures.progressive.equality import have_equal_content
from render.pictures.progressive.frames import LiveFrames
from render.pictures.progressive.planner import ENOUGH_RAYS
from render.pictures.progressive.request import PreviewRequest, ProgressivePicture, Stage
from render.shot.accepted import draw_accepted
from render.shot.film.finish import Finish, frame_number, gate_mm
from render.shot.shot import Shot
from render.trace.adaptive import whole_stops

REFRESH_MS = 250.0
"""Least time between two unfinished pictures."""
_LONGEST_WAIT_MS = 2000.0  # for an unfinished picture
_REFRESH_SHARE = 0.2  # of the time, for unfinished pictures: making and sending one takes time from the tracing
_FINISH_SHARE = 0.25  # of the budget, for the finish


def never() -> bool:
    """Tell that a picture never becomes stale."""
    return False


@dataclass(frozen=True, eq=False)
class _Job:
    """A request at work."""

    request: PreviewRequest
    scene: Scene
    camera: Camera
    finish: Finish
    clock: Clock

    @property
    def settings(self) -> FrameSettings:
        return self.request.settings


@dataclass(frozen=True, eq=False)
class _ExposedFrame:
    """Light on the film, and all that it depends on."""

    scene: Scene
    camera: Camera
    settings: FrameSettings
    revision: int
    frame: Frame


@dataclass(frozen=True, eq=False)
class _DevelopedFilm:
    """A developed film, and all that it depends on."""

    frame: Frame
    film: object
    development: tuple[object, ...]
    picture: FloatArray


class ProgressiveRenderer:
    """Draws progressive pictures of one shot, on one renderer and in its thread.

    Args:
        renderer: the renderer.
        shot: the shot, which may be edited between two requests.
        finisher: finishes the pictures before the final one; None has the processor do it.
    """

    def __init__(self, renderer: FrameRenderer, shot: Shot, finisher: LiveFinisher | None = None) -> None:
        self._renderer, self._shot, self._finisher = renderer, shot, finisher
        self._frames = LiveFrames(renderer)
        self._exposed: _ExposedFrame | None = None
        self._developed: _DevelopedFilm | None = None

    def pictures(
        self, request: PreviewRequest, *, is_stale: Callable[[], bool] = never
    ) -> Iterator[ProgressivePicture]:
        """Draw pictures of a request, each better than the last, up to the exact one; while it moves, the preview alone.

        Args:
            request: the request.
            is_stale: polled every few milliseconds once the first picture is there; no more pictures come once it returns True.

        Raises:
            SettingsError: no engine can do this, the time is not finite, the library has no such stock, or no such grade can be
                made.
            CameraError: the prim is no camera, or has impossible values.
            GraphicsError: OpenGL reports an error.
        """
        clock = Clock()
        camera, finish = prepare_camera(
            self._renderer,
            self._shot,
            request.camera_path,
            request.time,
            request.settings,
            stock=request.stock,
            choice=request.choice,
        )

        def begin() -> tuple[ProgressivePicture, Generator[ProgressivePicture, None, None]]:
            scene = self._shot.scene_at(request.time, camera.path)
            clock.note("read")
            work = self._draw(_Job(request, scene, camera, finish, clock))
            return next(work), work

        first, work = draw_accepted(begin)
        try:
            yield first
            while not is_stale():
                try:
                    with self._renderer.graphics.cancellation.cancel_when(is_stale):
                        picture = next(work)
                except (StopIteration, Cancelled):
                    return
                yield picture
        finally:
            work.close()

    def release(self) -> None:
        """Drop what is kept between pictures."""
        self._exposed = self._developed = None

    def _draw(self, job: _Job) -> Generator[ProgressivePicture, None, None]:
        frame = self._reusable_frame(job)
        if frame is None:
            budget_ms = (1 - _FINISH_SHARE) * job.request.budget_ms
            light, rays = self._frames.draw_preview(
                job.scene,
                job.camera,
                job.settings,
                job.clock,
                budget_ms=budget_ms,
                is_moving=job.request.is_moving,
                is_hurried=job.request.is_hurried,
            )
            yield self._with_focus(job, self._show(job, "preview", light, rays))
            if job.request.is_moving:
                return
            frame = yield from self._expose(job, light, rays)
            revision = self._shot.edits.revision
            self._exposed = _ExposedFrame(job.scene, job.camera, job.settings, revision, frame)
        else:
            shown = self._grade(job, "preview", frame.color, job.settings.rays, 1.0)
            yield self._with_focus(job, shown)
            if job.request.is_moving:
                return
        yield self._with_focus(job, self._finish(job, frame))

    def _expose(self, job: _Job, light: FloatArray, rays: int) -> Generator[ProgressivePicture, None, Frame]:
        """Render the light on the film, after a preview of so many rays; yields pictures before it is done."""
        settings, shot = job.settings, self._shot
        if not engine_class(settings).draws_in_steps or has_motion(job.camera, settings):
            path, time = job.request.camera_path, job.request.time
            frame = expose_frame(self._renderer, shot, path, job.camera, time, settings)
            job.clock.note("blur")
            return frame
        is_coarse = rays < min(ENOUGH_RAYS, settings.rays) / 2
        if is_coarse and not self._frames.keeps_layers(job.scene, job.camera, settings):
            light, rays = self._frames.draw_preview(
                job.scene,
                job.camera,
                settings,
                job.clock,
                budget_ms=job.request.budget_ms,
                rays=min(ENOUGH_RAYS, settings.rays),
            )
            yield self._show(job, "refining", light, rays)
        frame = yield from self._draw_in_steps(job, light)
        space = ImageSpace(settings, settings)
        return apply_lens_effects(self._renderer, shot, job.camera, job.request.time, space, frame)

    def _draw_in_steps(self, job: _Job, under: FloatArray) -> Generator[ProgressivePicture, None, Frame]:
        """Draw the frame, and show it unfinished after each `REFRESH_MS`, or less often where a picture takes long to show."""
        settings = job.settings
        work, last, wait_ms = self._frames.draw_in_steps(job.scene, job.camera, settings), perf_counter(), REFRESH_MS
        while True:
            try:
                share = next(work)
            except StopIteration as end:
                frame: Frame = end.value
                job.clock.note("blur")
                return frame
            began = perf_counter()
            if share < 1 and 1000 * (began - last) > wait_ms:
                job.clock.note("blur")
                unfinished = self._frames.partial_picture(settings, under)
                yield self._show(job, "refining", unfinished, settings.rays, share)
                last = perf_counter()
                wait_ms = min(1000 * (last - began) * (1 / _REFRESH_SHARE - 1), _LONGEST_WAIT_MS)
                wait_ms = max(REFRESH_MS, wait_ms)

    def _show(self, job: _Job, stage: Stage, light: FloatArray, rays: int, share: float = 0.0) -> ProgressivePicture:
        """Make a picture of light that the lens has not dimmed yet."""
        light = light.copy()
        apply_vignetting(light, job.camera, job.settings)
        return self._grade(job, stage, light, rays, share)

    def _grade(self, job: _Job, stage: Stage, light: FloatArray, rays: int, share: float) -> ProgressivePicture:
        """Make a picture of the light on the film, finished for the viewer."""
        finish = job.finish.apply if self._finisher is None else partial(self._finisher.finish, job.finish)
        graded = finish(light, job.camera, time=job.request.time, seed=job.settings.seed)
        job.clock.note("finish")
        metadata = describe_picture(self._shot, job.camera, job.request.time, job.settings, job.finish)
        return ProgressivePicture(stage, graded, metadata, job.clock.timing(), rays, share)

    def _finish(self, job: _Job, frame: Frame) -> ProgressivePicture:
        """Make the final picture, finished as files are."""
        developed = self._develop(job, frame)
        graded = run_in_background(lambda: job.finish.apply_grade(developed), self._renderer.graphics.cancellation)
        picture = develop_picture(
            self._shot, frame, job.camera, job.request.time, job.settings, job.finish, graded=graded
        )
        job.clock.note("finish")
        timing = job.clock.timing()
        return ProgressivePicture("final", graded, picture.metadata, timing, job.settings.rays, 1.0, picture)

    def _with_focus(self, job: _Job, shown: ProgressivePicture) -> ProgressivePicture:
        """Add a focus map to a picture where one is requested."""
        request = job.request
        if not request.maps_focus or (request.is_hurried and not shown.is_final):
            return shown
        is_preview = not shown.is_final
        focus = self._frames.map_focus(job.scene, job.camera, job.settings, is_preview=is_preview)
        return replace(shown, focus=focus)

    def _reusable_frame(self, job: _Job) -> Frame | None:
        """Give the kept light on the film, where nothing that it depends on has changed."""
        kept, lens = self._exposed, job.camera.lens
        if kept is None or kept.scene is not job.scene or kept.settings != job.settings:
            return None
        if has_motion(job.camera, job.settings) and kept.revision != self._shot.edits.revision:
            return None
        stops = [whole_stops(camera.exposure_scale) for camera in (kept.camera, job.camera)]
        if job.settings.is_adaptive and stops[0] != stops[1]:  # rays are distributed by the exposed picture
            return None
        has_flare = lens.ghosts > 0 or lens.star > 0  # whose sources are found by the exposure
        except_fields = () if has_flare else ("exposure_scale",)
        return kept.frame if have_equal_content(kept.camera, job.camera, except_fields=except_fields) else None

    def _develop(self, job: _Job, frame: Frame) -> FloatArray:
        """Develop the film, or give the kept one, where nothing that it depends on has changed."""
        camera, finish, time, seed = job.camera, job.finish, job.request.time, job.settings.seed
        development = (camera.exposure_scale, frame_number(time), gate_mm(camera), seed)
        kept = self._developed
        if (
            kept is None
            or kept.frame is not frame
            or kept.development != development
            or not have_equal_content(kept.film, finish.film)
        ):
            picture = run_in_background(
                lambda: finish.develop(frame.color, camera, time=time, seed=seed),
                self._renderer.graphics.cancellation,
            )
            kept = self._developed = _DevelopedFilm(frame, finish.film, development, picture)
        return kept.picture
