"""The image-space passes on the device: `render.postblur.aberrate` as compute shaders."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import load_source, set_uniforms
from render.model.arrays import FloatArray
from render.optics.view import PinholeView
from render.postblur.aberrate import COMA_POINTS, LEAST_COMA_PX, THREE_TAPS, coma_points
from render.postblur.picture_errors import SIGMAS, PictureErrors

_ROWS, _FLARE = 4, 5  # as the shaders bind them
_LINES = 4  # directions of the blur: rows, columns, along the radius and across it
_DEFINES = {"ROW_LENGTH": 14, "SIGMAS": SIGMAS, "THREE_TAPS": THREE_TAPS}
_BEND, _BLUR, _COMA = "postblur/aberrate_bend.comp", "postblur/aberrate_blur.comp", "postblur/aberrate_coma.comp"


def aberrate_on_device(
    ctx: moderngl.Context, picture: FloatArray, view: PinholeView, errors: PictureErrors
) -> FloatArray:
    """Apply a lens's picture errors to a sharp picture on the device; nothing stays allocated there.

    Args:
        ctx: context of the calling thread.
        picture: ``(height, width, 4)`` float32 scene-linear, premultiplied, sharp everywhere.
        view: view of the picture, of the same size.
        errors: picture errors of the lens.

    Returns:
        As `render.postblur.aberrate.aberrate`, in single precision.
    """
    size = (view.width, view.height)
    has_coma = float(np.abs(errors.coma).max()) * max(view.fx / errors.squeeze, view.fy) >= LEAST_COMA_PX
    with Resources() as scope:
        first, second = (scope.keep(ctx.texture(size, 4, dtype="f4")) for _ in range(2))
        first.write(np.ascontiguousarray(picture, np.float32).tobytes())
        scope.keep(_buffer(ctx, errors.rows)).bind_to_storage_buffer(_ROWS)
        scope.keep(_buffer(ctx, coma_points())).bind_to_storage_buffer(_FLARE)
        bend, blur, coma = (
            scope.keep(ctx.compute_shader(load_source(name, _DEFINES))) for name in (_BEND, _BLUR, _COMA)
        )
        set_uniforms(coma, flare_points=COMA_POINTS if has_coma else 0)
        for program, line in ((bend, 0), *((blur, line) for line in range(_LINES)), (coma, 0)):
            set_uniforms(program, row_count=len(errors.source), last=errors.last, squeeze=errors.squeeze)
            set_uniforms(program, centre=(view.cx, view.cy), focal_px=(view.fx, view.fy), line=line, picture=0)
            first.use(0)
            second.bind_to_image(0, read=False, write=True)
            program.run(-(-view.width // 8), -(-view.height // 8))
            ctx.memory_barrier()
            first, second = second, first
        return np.frombuffer(first.read(), np.float32).reshape(view.height, view.width, 4).copy()


def _buffer(ctx: moderngl.Context, values: np.ndarray) -> moderngl.Buffer:
    return ctx.buffer(np.ascontiguousarray(values, np.float32).tobytes())
