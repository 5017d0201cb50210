"""Search for highlights in layers: texels far brighter than their surroundings, and so blurred that rays mostly miss them."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import CancellationPoint, PieceSize
from render.gl.resources import Construction, Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.movers import Movers
from render.layers.nbuffers import NBuffers, bind_layers
from render.layers.peeled import Layers
from render.optics.view import PinholeView
from render.trace.highlights.mipmaps import build_mipmaps
from render.trace.moment_view import MomentView
from render.trace.picture_focus import PictureFocus
from render.trace.ray_buffers import Defines, Program
from render.trace.rays import RayBundle
from render.trace.tracer import layer_uniforms

NOISE = 0.005
"""Standard deviation of a pixel's radiance relative to its surroundings from which a texel is a highlight."""
LEAST_RADIUS = 1.0
"""Smallest circle of confusion of a highlight relative to a pixel of the picture. What is in front of smaller ones
hides them from other parts of the lens at one end of a pixel than at the other, and a connection takes the pixel's
middle for all of it."""
FLOOR_SHARE = 0.1
"""Share of the mean radiance of all layers added to that around a texel, so that what is dark need not be without noise."""
PROBES, PLACES = 5, 9
"""Counts of two loops of ``highlights/connection.glsl`` and ``opening.glsl``."""
MOST_MARKS = 1 << 18
_BLOCK = 8
_MARKS, _IMAGE = 0, 2  # as the shaders bind them


@dataclass(frozen=True, eq=False)
class Picture:
    """Picture whose highlights are carried, as the shaders see it.

    Attributes:
        layers: its layers.
        nbuffers: their N-buffers; None where only the layers themselves are read.
        bundle: rays of its lens.
        focus: focal surface.
        focal_map: focal surface as a texture where it is not affine.
        view: projection of the picture.
        moment_view: the camera at a moment, where it may have moved from the position that the layers were peeled from.
        movers: moving surfaces of the layers, set to that moment.
    """

    layers: Layers
    nbuffers: NBuffers | None
    bundle: RayBundle
    focus: PictureFocus
    focal_map: moderngl.Texture | None
    view: PinholeView
    moment_view: MomentView | None = None
    movers: Movers | None = None

    @property
    def defines(self) -> Defines:
        """Defines of its layers, focus and moment."""
        given = {
            "EIGHT_LAYERS": self.layers.count > 4,
            "FOCAL_MAP": self.focal_map is not None,
            "CARRIED_CAMERA": self.moment_view is not None,
            "MOVERS": self.movers is not None,
        }
        return {name: 1 for name, is_given in given.items() if is_given}

    @property
    def blur_px(self) -> float:
        """Circle of confusion at a difference of 1/m of inverse depth, layer pixels; its radius."""
        return self.scale * max(self.view.fx, self.view.fy) * self.bundle.reach_m

    @property
    def scale(self) -> float:
        """Layer pixels per picture pixel of the camera that the layers were peeled for."""
        peeled_for = self.view if self.moment_view is None else self.moment_view.peeled_for
        return self.layers.view.fx / peeled_for.fx

    def bind(self, program: Program) -> int:
        """Bind the picture to a program, and return the first texture unit left free."""
        unit = bind_layers(program, self.layers, self.nbuffers, 0)
        if self.focal_map is not None and "focal_map" in program:
            self.focal_map.use(unit)
            program["focal_map"] = unit
        set_uniforms(program, **layer_uniforms(self.layers, self.view), focus=self.focus.affine or (0.0, 0.0, 0.0))
        if self.moment_view is not None:
            set_uniforms(program, **self.moment_view.uniforms(self.layers.view))
        if self.movers is not None:
            self.movers.bind(program, unit + 1)
            unit += 2
        least_radius = LEAST_RADIUS * max(2.0, self.scale)
        set_uniforms(program, layer_count=self.layers.count, blur_px=self.blur_px, least_radius=least_radius)
        set_uniforms(program, floor_share=FLOOR_SHARE, probes=PROBES, places=PLACES)
        return unit + 1


def measure_means(ctx: moderngl.Context, programs: ProgramCache, picture: Picture) -> moderngl.Texture:
    """Mean luminance of blocks of 8x8 layer pixels and of ever larger ones, a mipmap; the caller releases it."""
    program = programs.compute("highlights/means.comp", {"EIGHT_LAYERS": 1} if picture.layers.count > 4 else {})
    picture.bind(program)
    width, height = _blocks(picture.layers)
    with Construction() as making:
        means = making.keep(ctx.texture((width, height), 2, dtype="f4"))
        means.bind_to_image(_IMAGE, read=False, write=True)
        program.run(-(-width // _BLOCK), -(-height // _BLOCK))
        ctx.memory_barrier()
        means.repeat_x = means.repeat_y = False
        build_mipmaps(ctx, programs, means)
    return means


def find_highlights(
    ctx: moderngl.Context,
    programs: ProgramCache,
    picture: Picture,
    means: moderngl.Texture,
    cancellation: CancellationPoint,
    rows: PieceSize,
) -> NDArray[np.uint32]:
    """Find the highlights of all layers.

    Args:
        ctx: context.
        programs: its programs.
        picture: the picture.
        means: from `measure_means`.
        cancellation: where the work can be cancelled.
        rows: size of its pieces, rows of blocks.

    Returns:
        ``(n, 3)``: x, y and layer, layer by layer and block by block; at most `MOST_MARKS`, else those above a higher noise.
    """
    program = programs.compute("highlights/mark.comp", picture.defines)
    unit = picture.bind(program)
    means.use(unit)
    set_uniforms(program, means=unit, rays=picture.bundle.pattern.whole)
    width, height = _blocks(picture.layers)
    size = picture.layers.count * width * height * 2
    with Resources() as scope:
        marks = scope.keep(ctx.buffer(reserve=4 * size))
        noise = NOISE
        while True:
            marks.clear()
            marks.bind_to_storage_buffer(_MARKS)
            set_uniforms(program, noise=noise, block_count=(width, height))
            for first, end in rows.cut(height, cancellation):
                set_uniforms(program, first_row=first)
                program.run(width, end - first)
                ctx.memory_barrier()
            bits = np.frombuffer(marks.read(), np.uint32).reshape(-1, 2)
            if np.bitwise_count(bits).sum() <= MOST_MARKS:
                return _places(bits, width, height)
            noise *= 2


def _places(bits: NDArray[np.uint32], width: int, height: int) -> NDArray[np.uint32]:
    """Places ``(n, 3)`` of the bits that are set."""
    marked = np.flatnonzero(bits.any(axis=1))
    within = np.unpackbits(np.ascontiguousarray(bits[marked]).view(np.uint8), axis=1, bitorder="little")
    number, place = np.nonzero(within)
    layer, block = np.divmod(marked[number], width * height)
    y, x = np.divmod(block, width)
    places = [x * _BLOCK + place % _BLOCK, y * _BLOCK + place // _BLOCK, layer]
    return np.stack(places, axis=1).astype(np.uint32)


def _blocks(layers: Layers) -> tuple[int, int]:
    return -(-layers.view.width // _BLOCK), -(-layers.view.height // _BLOCK)
