"""The progressive frame: better and better pictures of a change, the first within the blink of an eye, the last exact.

    a small picture from layers that are kept · the same by more rays · the picture itself, piece by piece · finished as files are

Work that nobody waits for any more is left between two of its pieces. What did not change is not computed again: the scene and
still shadows (`render.layers.shadow_maps`), layers and N-buffers (`Peeler.peel`, `NBufferBuilder.build`), the light on the film
where only its development or grade changed, and the developed film where only the grade did. In a scene so large that a distant
light's shadows are resolved around the focus alone, a picture at rest draws these anew where the focus has gone far, and with
them the layers.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from functools import partial
from time import perf_counter

from render.engines import engine_of
from render.frame import Frame, FrameRenderer
from render.gl.cancellation import Cancelled
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.output import FrameMetadata
from render.pictures.image_space import ImageSpace
from render.pictures.live_finisher import LiveFinisher
from render.pictures.moving import moves
from render.pictures.picture import (
    apply_lens_effects,
    apply_vignetting,
    expose_frame,
    metadata_of,
    picture_of,
    prepare_camera,
)
from render.pictures.progressive.alike import alike
from render.pictures.progressive.aside import aside
from render.pictures.progressive.clock import Clock
from render.pictures.progressive.frames import LiveFrames
from render.pictures.progressive.pace import ENOUGH_RAYS
from render.pictures.progressive.request import PreviewRequest, Shown, Stage
from render.shot.film.finish import Finish, frame_number, gate_mm
from render.shot.shot import Shot

REFRESH_MS = 250.0
"""Between two looks at a picture that is being traced: each takes some time from the tracing."""
_FINISH_SHARE = 0.25  # of the budget, which is left for the finish


def never() -> bool:
    """Of a picture that is waited for whatever comes."""
    return False


@dataclass(frozen=True, eq=False)
class _Kept:
    """Light on the film, and what it is of."""

    scene: Scene
    lens: Camera
    settings: FrameSettings
    revision: int
    frame: Frame


@dataclass(frozen=True, eq=False)
class _Developed:
    """A developed film, and what it is of."""

    frame: Frame
    film: object
    said: tuple[object, ...]
    picture: FloatArray


class Progressive:
    """Answers what is asked of one shot, on one renderer and in its thread.

    Args:
        renderer: what draws.
        shot: the shot, which may be edited between two questions.
        finisher: finishes what is shown on the way; None has it done by the processor.
    """

    def __init__(self, renderer: FrameRenderer, shot: Shot, finisher: LiveFinisher | None = None) -> None:
        self._renderer, self._shot, self._finisher = renderer, shot, finisher
        self._frames = LiveFrames(renderer)
        self._kept: _Kept | None = None
        self._developed: _Developed | None = None

    def pictures(self, asked: PreviewRequest, *, is_stale: Callable[[], bool] = never) -> Iterator[Shown]:
        """Better and better pictures of what is asked, the last of them exact; the first alone of what is moving.

        Args:
            asked: what.
            is_stale: whether nobody waits for it any more. It is looked at every few milliseconds once the first picture is
                there; when it says so, no more pictures come.

        Raises:
            SettingsError: the time is not finite, the library has no such stock, or no such grade can be made.
            CameraError: it is no camera, or has impossible numbers.
            GraphicsError: the device refuses.
        """
        clock = Clock()
        lens, finish = prepare_camera(
            self._renderer,
            self._shot,
            asked.camera,
            asked.time,
            asked.settings,
            stock=asked.stock,
            choice=asked.choice,
        )
        scene = self._shot.scene_at(asked.time)
        clock.note("read")
        work = self._shown(asked, scene, lens, finish, clock)
        try:
            yield next(work)
            while not is_stale():
                try:
                    with self._renderer.graphics.cancellation.cancel_when(is_stale):
                        shown = next(work)
                except (StopIteration, Cancelled):
                    return
                yield shown
        finally:
            work.close()

    def release(self) -> None:
        """Forget what is kept."""
        self._kept = self._developed = None

    def _shown(
        self, asked: PreviewRequest, scene: Scene, lens: Camera, finish: Finish, clock: Clock
    ) -> Generator[Shown, None, None]:
        settings = asked.settings
        frame = self._kept_frame(asked, scene, lens)
        if frame is None:
            light, rays = self._frames.preview(
                scene, lens, settings, clock, budget_ms=(1 - _FINISH_SHARE) * asked.budget_ms
            )
            yield self._on_the_way("preview", light, lens, finish, asked, clock, rays)
            if asked.is_moving:
                return
            frame = yield from self._rendered(asked, scene, lens, finish, clock, light, rays)
            self._kept = _Kept(scene, lens, settings, self._shot.edits.revision, frame)
        else:
            graded = self._graded(frame.color, lens, finish, asked)
            clock.note("finish")
            yield Shown("preview", graded, self._metadata(lens, finish, asked), clock.timing(), settings.rays, 1.0)
            if asked.is_moving:
                return
        developed = self._on_film(frame, lens, finish, asked)
        graded = aside(lambda: finish.apply_grade(developed), self._renderer.graphics.cancellation)
        picture = picture_of(self._shot, frame, lens, asked.time, settings, finish, graded=graded)
        clock.note("finish")
        yield Shown("final", picture.graded, picture.metadata, clock.timing(), settings.rays, 1.0, picture)

    def _rendered(
        self,
        asked: PreviewRequest,
        scene: Scene,
        lens: Camera,
        finish: Finish,
        clock: Clock,
        light: FloatArray,
        rays: int,
    ) -> Generator[Shown, None, Frame]:
        """The light on the film, and what it looks like on the way."""
        settings = asked.settings
        if not engine_of(settings).draws_in_steps or moves(lens, settings):
            frame = expose_frame(self._renderer, self._shot, asked.camera, lens, asked.time, settings)
            clock.note("blur")
            return frame
        if rays < min(ENOUGH_RAYS, settings.rays) / 2:
            rays = min(ENOUGH_RAYS, settings.rays)
            light, rays = self._frames.preview(scene, lens, settings, clock, budget_ms=asked.budget_ms, rays=rays)
            yield self._on_the_way("refining", light, lens, finish, asked, clock, rays)
        work, last = self._frames.traced(scene, lens, settings), perf_counter()
        while True:
            try:
                share = next(work)
            except StopIteration as end:
                frame = end.value
                break
            if share < 1 and 1000 * (perf_counter() - last) > REFRESH_MS:
                clock.note("blur")
                whole = self._frames.so_far(settings, light)
                yield self._on_the_way("refining", whole, lens, finish, asked, clock, settings.rays, share)
                last = perf_counter()
        clock.note("blur")
        return apply_lens_effects(self._renderer, self._shot, lens, asked.time, ImageSpace(settings, settings), frame)

    def _on_the_way(
        self,
        stage: Stage,
        light: FloatArray,
        lens: Camera,
        finish: Finish,
        asked: PreviewRequest,
        clock: Clock,
        rays: int,
        share: float = 0.0,
    ) -> Shown:
        light = light.copy()
        apply_vignetting(light, lens, asked.settings)
        graded = self._graded(light, lens, finish, asked)
        clock.note("finish")
        return Shown(stage, graded, self._metadata(lens, finish, asked), clock.timing(), rays, share)

    def _metadata(self, lens: Camera, finish: Finish, asked: PreviewRequest) -> FrameMetadata:
        return metadata_of(self._shot, lens, asked.time, asked.settings, finish)

    def _graded(self, light: FloatArray, lens: Camera, finish: Finish, asked: PreviewRequest) -> FloatArray:
        """Finished for those who look at it while they work."""
        by = finish.apply if self._finisher is None else partial(self._finisher.picture, finish)
        return by(light, lens, time=asked.time, seed=asked.settings.seed)

    def _kept_frame(self, asked: PreviewRequest, scene: Scene, lens: Camera) -> Frame | None:
        """The light on the film, where nothing that it depends on has changed."""
        kept = self._kept
        if kept is None or kept.scene is not scene or kept.settings != asked.settings:
            return None
        if moves(lens, asked.settings) and kept.revision != self._shot.edits.revision:
            return None
        flares = lens.lens.ghosts > 0 or lens.lens.star > 0  # which are of what is bright as it is exposed
        return kept.frame if alike(kept.lens, lens, but=() if flares else ("exposure_scale",)) else None

    def _on_film(self, frame: Frame, lens: Camera, finish: Finish, asked: PreviewRequest) -> FloatArray:
        """The developed film; the one that is there, where nothing that it depends on has changed."""
        said = (lens.exposure_scale, frame_number(asked.time), gate_mm(lens), asked.settings.seed)
        kept = self._developed
        if kept is None or kept.frame is not frame or kept.said != said or not alike(kept.film, finish.film):
            picture = aside(
                lambda: finish.develop(frame.color, lens, time=asked.time, seed=asked.settings.seed),
                self._renderer.graphics.cancellation,
            )
            kept = self._developed = _Developed(frame, finish.film, said, picture)
        return kept.picture
