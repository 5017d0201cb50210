"""Light on the surfaces of a layer, added after they are drawn.

A rasteriser shades whole blocks of pixels for each triangle, and a triangle of a dense mesh covers one or two pixels of them.
So the colour pass stores what light falls on (``layers/reflector.glsl``), and each pixel, or quad of alike pixels, is lit
once, after it (Saito & Takahashi 1990, "Comprehensible rendering of 3-D shapes").
"""

from __future__ import annotations

from collections.abc import Mapping

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.limits import make_storage
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.drawing_space import DrawingSpace
from render.layers.lights import MAX_LIGHTS
from render.layers.shadows import MAX_SHADOW_MAPS
from render.layers.targets import MOST_RADIANCE, Slot
from render.optics.view import PinholeView

MOST_LISTED = 1 << 24
"""Pixels that are listed at once: 64 MiB."""
_QUADS = 8  # side of a work group that lists
_GROUP = 64  # pixels or quads of a work group that lights
_ROW = 1024  # work groups in a row


class SurfaceLighter:
    """Lights the surfaces of layers.

    Args:
        ctx: context.
        programs: its programs.
        cancellation: where the work can be cancelled.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._listed = PieceSize(64, least=8)
        self._lit = PieceSize(1 << 13, least=1 << 10), PieceSize(1 << 14, least=1 << 12)

    def light(
        self,
        slot: Slot,
        view: PinholeView,
        options: Mapping[str, int | float | str],
        *,
        has_clearcoat: bool,
        by_quads: bool,
    ) -> None:
        """Add the light of lamps and dome that the surfaces of a layer send to the eye to what they emit. The lighting is bound.

        Args:
            slot: the layer, which is drawn lit.
            view: view that it is drawn for.
            options: defines by what the lights need (`render.layers.lighting`).
            has_clearcoat: whether any of its surfaces may have a clear coat.
            by_quads: light 2x2 pixels at once where their surfaces are alike.

        Raises:
            Cancelled: the work is stale.
        """
        lit = slot.lit
        if lit is None:
            raise ValueError("the layer's surfaces can be drawn unlit alone")
        defines: dict[str, int | float | str] = {"MAX_LIGHTS": MAX_LIGHTS, "MAX_SHADOW_MAPS": MAX_SHADOW_MAPS}
        defines |= {"MAX_HALF": MOST_RADIANCE} | ({"CLEARCOAT": 1} if has_clearcoat else {})
        defines |= options
        program = self._programs.compute("layers/shade.comp", defines)
        finder = self._programs.compute("layers/shade_list.comp", {"LINKED": 1} if "LINKED" in options else None)
        names = ("w_map", "albedo_roughness", "reflectance_occlusion", "normal_coat")
        for unit, (name, texture) in enumerate(zip(names, (slot.w, *lit.reflectors.textures), strict=True)):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
            set_uniforms(finder, **{name: unit})
        # a pixel's ray leaves the eye with the slope (right and up for each metre ahead) of the inverse projection
        unshear = np.linalg.inv(np.reshape(view.shear, (2, 2)))
        per_px = unshear @ np.diag([1 / view.fx, -1 / view.fy])
        first_slope = -per_px @ [view.cx, view.cy]
        space = DrawingSpace.of_view(view)
        set_uniforms(program, channel=slot.channel, slice=lit.slice, eye=space.eye, far=space.far)
        set_uniforms(program, slope_per_px=tuple(per_px.T.ravel()), first_slope=tuple(first_slope), base_w=view.base_w)
        lit.radiance.bind_to_image(0, read=True, write=True)
        rows = min(view.height, max(1, MOST_LISTED // (2 * view.width)) * 2)
        with Resources() as scope:
            listed = scope.keep(make_storage(self._ctx, 4 * (2 + view.width * rows), "the list of lit pixels"))
            listed.bind_to_storage_buffer(0)
            set_uniforms(finder, channel=slot.channel, by_quads=by_quads, slope_per_px=1 / min(view.fx, view.fy))
            for first in range(0, view.height, rows):
                listed.write(bytes(8))
                end = min(first + rows, view.height)
                for top, bottom in self._listed.cut((end - first + 1) // 2, self._cancellation):
                    set_uniforms(finder, rows=(first + 2 * top, min(first + 2 * bottom, end)))
                    finder.run(-(-view.width // (2 * _QUADS)), -(-(bottom - top) // _QUADS))
                    self._ctx.memory_barrier()
                counts = np.frombuffer(listed.read(8), np.uint32)
                for number, (count, size) in enumerate(zip(counts, self._lit, strict=True)):
                    set_uniforms(program, by_quads=number == 0)
                    for some, beyond in size.cut(int(count), self._cancellation):
                        groups = -(-(beyond - some) // _GROUP)
                        set_uniforms(program, first_number=some, end_number=beyond)
                        program.run(min(groups, _ROW), -(-groups // _ROW))
                        self._ctx.memory_barrier()
