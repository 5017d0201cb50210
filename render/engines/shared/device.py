"""`Device`: what the engines of one OpenGL context share."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypedDict

from render.engines.shared.layer_scale import blurred_scale, texel_offset, traced_scale
from render.engines.shared.request import ALL_RAYS, DrawRequest
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.movement import Movement
from render.layers.peel import Peeler
from render.model.arrays import FloatArray
from render.steps import step
from render.trace.adaptive import RayBudget, whole_stops
from render.trace.lens import LensTracer
from render.trace.motion_tracer import ShutterSample
from render.trace.rays import RayPattern, make_adaptive_pattern, make_ray_pattern
from render.trace.tiling.plan import LayerBudget

if TYPE_CHECKING:
    from render.postblur.focus_split import Blur
    from render.postblur.preview import Previewer
    from render.postblur.single_image import SingleImageBlur


class Device:
    """The drawing parts of one context.

    Args:
        graphics: the context; the device lives no longer.

    Attributes:
        graphics: the context.
        programs: its compiled shaders.
        peeler: holds the loaded scene and its layers.
        tracer: traces lens rays through layers.
    """

    def __init__(self, graphics: GraphicsContext) -> None:
        self.graphics = graphics
        self.programs = ProgramCache(graphics.ctx)
        self.peeler = Peeler(graphics, self.programs)
        self.tracer = LensTracer(graphics.ctx, self.programs, graphics.cancellation)
        self.tracer.budget = LayerBudget.of_device(graphics.memory_bytes)

    @cached_property
    def _blur(self) -> SingleImageBlur:
        from render.postblur.single_image import SingleImageBlur  # takes a while, and the lens engine does without

        return SingleImageBlur(self.graphics.ctx, self.programs)

    @cached_property
    def previewer(self) -> Previewer:
        """Draws previews from layers of its own."""
        from render.postblur.preview import Previewer  # takes a while, and whole pictures do without

        return Previewer(self.graphics, self.programs, self._blur)

    def trace(self, request: DrawRequest) -> FloatArray:
        """Trace the request's part of the camera's rays; as `Engine.draw`."""
        settings = request.settings
        with step("trace rays"):
            traced = self.tracer.picture(
                self.peeler,
                request.camera,
                request.view,
                _pattern(request),
                wavelengths=settings.wavelengths,
                layers=settings.layers,
                supersample=traced_scale(settings, request.part[1]),
                texel_offset=texel_offset(settings, request.part),
                unlit=request.is_unlit,
                connections=settings.connections,
                mattes=request.mattes,
                on_progress=request.on_progress,
            )
        self.tracer.release_window()
        return traced.color

    def trace_in_steps(self, request: DrawRequest) -> Generator[float, None, FloatArray]:
        """Trace the camera's rays piece by piece; as `Engine.draw_in_steps`."""
        with step("trace rays"):
            traced = yield from self.tracer.trace_steps(
                self.peeler,
                request.camera,
                request.view,
                _pattern(request),
                mattes=request.mattes,
                **_sampling(request),
            )
        self.tracer.release_window()
        return traced.color

    def keeps_layers(self, request: DrawRequest) -> bool:
        """Whether `trace_in_steps` would start with kept layers."""
        return self.tracer.keeps_layers(
            self.peeler,
            request.camera,
            request.view,
            _pattern(request),
            ids=request.mattes is not None,
            **_sampling(request),
        )

    def trace_swept(
        self, request: DrawRequest, samples: Sequence[ShutterSample], movements: Mapping[int, Movement]
    ) -> Generator[FloatArray, None, None]:
        """Trace the moments of a moving scene; as `Engine.draw_swept`."""
        settings = request.settings
        return self.tracer.motion_tracer.trace_moments(
            self.peeler,
            request.view,
            samples,
            movements,
            wavelengths=settings.wavelengths,
            layers=settings.layers,
            supersample=blurred_scale(settings),
            unlit=request.is_unlit,
            connections=settings.connections,
            mattes=request.mattes,
            on_progress=request.on_progress,
        )

    def blur(
        self, request: DrawRequest, blur: Blur, *, margin_step: int = 1, with_axis_errors: bool = False
    ) -> FloatArray:
        """Blur the view from the pupil's centre; as `Engine.draw`. With a closed iris it is traced.

        Args:
            request: the picture.
            blur: spreads each point over its circle of confusion.
            margin_step: pixels of the picture by which the margin around it grows.
            with_axis_errors: give the blur the lens's errors on its axis.
        """
        if request.camera.f_stop <= 0:
            return self.trace(request)
        picture = self._blur.draw(
            self.peeler,
            request.camera,
            request.view,
            blur,
            layers=request.settings.layers,
            supersample=blurred_scale(request.settings),
            unlit=request.is_unlit,
            margin_step=margin_step,
            with_axis_errors=with_axis_errors,
        )
        if request.on_progress is not None:
            request.on_progress(1.0)
        return picture

    def release(self) -> None:
        """Give the memory back."""
        for made in (vars(self).get("previewer"), vars(self).get("_blur")):
            if made is not None:
                made.release()
        self.tracer.release()
        self.peeler.release()


class _Sampling(TypedDict):
    """Arguments of `LensTracer.trace_steps` that settings give."""

    wavelengths: int
    layers: int
    supersample: float
    unlit: bool
    connections: bool


def _sampling(request: DrawRequest) -> _Sampling:
    settings = request.settings
    return {
        "wavelengths": settings.wavelengths,
        "layers": settings.layers,
        "supersample": traced_scale(settings),
        "unlit": request.is_unlit,
        "connections": settings.connections,
    }


def _pattern(request: DrawRequest) -> RayPattern:
    settings, camera = request.settings, request.camera
    if settings.is_adaptive and request.part == ALL_RAYS and camera.f_stop > 0:
        budget = RayBudget(settings.rays, settings.noise, whole_stops(camera.exposure_scale))
        return make_adaptive_pattern(budget, camera.iris, seed=settings.seed)
    pattern = make_ray_pattern(settings.rays, camera.iris, seed=settings.seed, tiled=settings.tiled)
    return pattern.part(*request.part)
