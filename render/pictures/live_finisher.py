"""Film and grade on the device, for pictures of the viewer; pictures of files are finished on the processor.

The two agree to less than one of 255 levels (`tests/render/film/gpu/test_developer.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import moderngl
import numpy as np

from render.errors import GraphicsError, SettingsError
from render.film import print_space
from render.film.gpu.developer import Exposure, FilmPass
from render.film.gpu.grade import DisplayPass
from render.film.gpu.scratch import Scratch, TooLargeError
from render.gl.context import GraphicsContext
from render.gl.resources import Resources
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.shot.film.finish import PRINTED, Finish, frame_number, gate_mm

if TYPE_CHECKING:
    from render.frame import FrameRenderer


class _Passes:
    """The shader passes of one context."""

    def __init__(self, graphics: GraphicsContext) -> None:
        self.graphics = graphics
        self.scratch = Scratch(graphics.ctx)
        self.film = FilmPass(graphics.ctx)
        self.display = DisplayPass(graphics.ctx)

    def release(self) -> None:
        """Give the device's memory back."""
        with Resources() as held:
            for part in (self.scratch, self.film, self.display):
                held.keep(part)


class LiveFinisher:
    """Finishes pictures on a renderer's device, in its thread. Its shader passes are kept between pictures.

    Args:
        renderer: the renderer. After an OpenGL error it has a new context, and the passes are compiled again.
    """

    def __init__(self, renderer: FrameRenderer) -> None:
        self._renderer = renderer
        self._passes: _Passes | None = None

    def finish(self, finish: Finish, radiance: FloatArray, camera: Camera, *, time: float, seed: int) -> FloatArray:
        """Expose, develop and grade a picture as `Finish.apply` does, to 256 levels. A picture that is too large for the
        device is finished on the processor.

        Args:
            finish: film and grade.
            radiance: ``(height, width, 3 or 4)`` float32 scene-linear.
            camera: as for `Finish.apply`.
            time: likewise.
            seed: likewise.

        Raises:
            SettingsError: the exposure is no number from 0 up, or the film cannot be developed.
            GraphicsError: OpenGL reports an error.
        """
        if radiance.ndim != 3 or radiance.shape[2] not in (3, 4):
            raise SettingsError(f"radiance must be (height, width, 3) or (height, width, 4), got {radiance.shape}")
        passes = self._open_passes()
        try:
            return _run_passes(
                passes, finish, radiance, Exposure(camera.exposure_scale, frame_number(time), gate_mm(camera), seed)
            )
        except TooLargeError:
            return finish.apply(radiance, camera, time=time, seed=seed)
        except moderngl.Error as error:
            self.release()
            raise GraphicsError(f"{passes.graphics.renderer} could not finish the picture: {error}") from error

    def release(self) -> None:
        """Give the device's memory back; the renderer's context must live."""
        if self._passes is not None and self._passes.graphics is self._renderer.graphics:
            self._passes.graphics.make_current()
            self._passes.release()
        self._passes = None

    def _open_passes(self) -> _Passes:
        """Return the passes of the renderer's context, compiled again if the context is a new one."""
        graphics = self._renderer.graphics
        graphics.make_current()
        if self._passes is None or self._passes.graphics is not graphics:
            self._passes = _Passes(graphics)
        return self._passes


def _run_passes(passes: _Passes, finish: Finish, radiance: FloatArray, exposure: Exposure) -> FloatArray:
    height, width, channels = radiance.shape
    light = passes.scratch.texture("light", (width, height), channels, "f4")
    shown = passes.scratch.texture("shown", (width, height), 4, "f1")
    light.write(np.ascontiguousarray(radiance, np.float32))
    if finish.film is None:
        passes.display.run(light, shown, exposure.scale, finish.grade)
    else:
        developed = passes.scratch.texture("developed", (width, height), 4, "f4")
        passes.film.run(light, developed, finish.film, exposure)
        space = print_space() if finish.film.process in PRINTED else None
        passes.display.run(developed, shown, 1.0, finish.grade, space)
    levels = np.frombuffer(shown.read(), np.uint8).reshape(height, width, 4)[..., :3]
    return np.divide(levels, np.float32(255), dtype=np.float32)
