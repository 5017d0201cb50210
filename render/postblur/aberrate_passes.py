"""Picture errors of a lens applied by compute shaders; `render.lab.reference.aberrate` is the same in numpy."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import load_source, set_uniforms
from render.model.arrays import DoubleArray, FloatArray
from render.optics.view import PinholeView
from render.postblur.picture_errors import SIGMAS, PictureErrors

COMA_POINTS = 64
"""Number of pupil points that coma's flare is drawn with."""
THREE_TAPS = 0.7
"""Width in steps below which a blur gets its exact spread from three taps."""
LEAST_COMA_PX = 0.1
"""Flare below which no coma is drawn."""

_ROWS, _FLARE = 4, 5  # as the shaders bind them
_GROUP_PX, _FIRST_PIECE = 8, 4  # side of a work group; groups of rows of the first piece
_LINES = 4  # directions of the blur: rows, columns, along the radius and across it
_DEFINES = {"ROW_LENGTH": 14, "SIGMAS": SIGMAS, "THREE_TAPS": THREE_TAPS}
_BEND, _BLUR, _COMA = "postblur/aberrate_bend.comp", "postblur/aberrate_blur.comp", "postblur/aberrate_coma.comp"


def aberrate_on_device(
    ctx: moderngl.Context,
    picture: FloatArray,
    view: PinholeView,
    errors: PictureErrors,
    cancellation: CancellationPoint = NEVER_CANCELLED,
) -> FloatArray:
    """Apply a lens's picture errors to a sharp picture on the device; nothing stays allocated there.

    Args:
        ctx: context of the calling thread.
        picture: ``(height, width, 4)`` float32 scene-linear, premultiplied, sharp everywhere.
        view: view of the picture, of the same size.
        errors: picture errors of the lens.
        cancellation: polled between pieces of the work.

    Returns:
        ``(height, width, 4)`` float32; alpha is treated as green.

    Raises:
        Cancelled: the work is stale.
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
            columns, rows = -(-view.width // _GROUP_PX), -(-view.height // _GROUP_PX)
            for start, end in PieceSize(_FIRST_PIECE).cut(rows, cancellation):
                set_uniforms(program, first_row=_GROUP_PX * start)
                program.run(columns, end - start)
                ctx.memory_barrier()
            first, second = second, first
        return np.frombuffer(first.read(), np.float32).reshape(view.height, view.width, 4).copy()


def coma_points() -> DoubleArray:
    """Points ``(COMA_POINTS, 2)`` of coma's flare, for a third of its length of 1: evenly over the pupil (Vogel 1979)."""
    index = np.arange(COMA_POINTS) + 0.5
    radius, angle = np.sqrt(index / COMA_POINTS), index * np.pi * (3 - np.sqrt(5))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([3 * x**2 + y**2, 2 * x * y], axis=1)


def _buffer(ctx: moderngl.Context, values: np.ndarray) -> moderngl.Buffer:
    return ctx.buffer(np.ascontiguousarray(values, np.float32).tobytes())
