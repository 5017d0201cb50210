"""Depth at which splats hide half of what lies behind, at each pixel of a view.

The splats that a pixel sees are searched near to far: what each of sixteen runs of them hides is added up, then each of sixteen
runs of the run that passes one half, and so on to a single splat.
"""

from __future__ import annotations

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.splats import ProjectedSplats
from render.model.arrays import LongArray
from render.trace.splats.drawing import SplatQuads

RUNS = 16
"""Runs of a pass; as in ``splats/opacity_bins.frag``."""

STRIP_PX = 1 << 22
"""Pixels that are searched at once, at most, or one line: 72 bytes each."""


def find_hiding_splats(ctx: moderngl.Context, programs: ProgramCache, splats: ProjectedSplats) -> LongArray:
    """Find the splat at which opacity passes one half, from the view's eye, at each pixel's centre.

    Args:
        ctx: context of the device.
        programs: its programs.
        splats: splats in a view.

    Returns:
        ``(height, width)`` rows of the splats; -1 where all of them hide less.

    Raises:
        GraphicsError: the device cannot hold the sums of so large a view.
    """
    (width, height), count = splats.view.size, len(splats.w)
    found = np.full((height, width), -1, np.int64)
    if not count:
        return found
    lines = max(1, min(height, STRIP_PX // width))
    size = width, lines
    with Resources() as scope:
        try:
            known = scope.keep(ctx.texture(size, 2, dtype="f4"))
            runs = [scope.keep(ctx.texture(size, 4, dtype="f4")) for _ in range(RUNS // 4)]
        except moderngl.Error as error:
            raise GraphicsError(f"the device cannot hold the depths of splats of {width}x{lines}: {error}") from error
        target = scope.keep(ctx.framebuffer(runs))
        scope.callback(_stop_drawing, ctx, ctx.detect_framebuffer())
        quads = scope.keep(SplatQuads(ctx, programs, "splats/opacity_bins.frag", {"NUMBERED": 1}))
        narrow = programs.compute("splats/narrow.comp")
        for top in range(0, height, lines):
            known.write(bytes(8 * width * lines))
            length = 1
            while RUNS * length < count:
                length *= RUNS
            is_first = True
            while length:
                _add_up(ctx, quads, splats, target, known, length, top)
                for unit, texture in enumerate(runs):
                    texture.use(unit)
                    set_uniforms(narrow, **{f"runs_{unit}": unit})
                known.bind_to_image(0, read=True, write=True)
                set_uniforms(narrow, run_length=float(length), is_first=is_first)
                narrow.run(-(-width // 8), -(-lines // 8))
                ctx.memory_barrier()
                length, is_first = length // RUNS, False
            nearer = np.frombuffer(known.read(), np.float32).reshape(lines, width, 2)[: height - top, :, 0]
            found[top : top + lines] = np.where(nearer < 0, -1, count - 1 - nearer.astype(np.int64))
    return found


def _add_up(
    ctx: moderngl.Context,
    quads: SplatQuads,
    splats: ProjectedSplats,
    target: moderngl.Framebuffer,
    known: moderngl.Texture,
    length: int,
    top: int,
) -> None:
    """Add up what the runs of each pixel hide, of this many splats each, from a line of the view on."""
    target.use()
    GL.glColorMask(True, True, True, True)
    target.clear()
    ctx.enable_only(moderngl.BLEND)
    ctx.blend_func = moderngl.ONE, moderngl.ONE
    uniforms: dict[str, object] = {"corner_px": (0.0, float(top)), "texel_scale": 1.0, "run_length": float(length)}
    quads.draw(splats, (0, len(splats.w)), target.size, {"known": known}, **uniforms)
    ctx.memory_barrier()


def _stop_drawing(ctx: moderngl.Context, before: moderngl.Framebuffer) -> None:
    ctx.enable_only(moderngl.NOTHING)
    before.use()
