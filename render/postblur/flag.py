"""FLAG: a blur of any convex shape in time linear in its radius (Moersch & Hamilton 2014).

"Variable-Sized, Circular Bokeh Depth of Field Effects". The paper's 3D texture of row contributions is called
*contributions* here.

Beyond the paper: the near and the far field are blurred apart, which removes the hard edges of its foregrounds and the
halos around its backgrounds; shapes need not be symmetric; rows are searched by tiles whose largest radius is known
(its future work, by squares); and only the rows that reach the next finished ones are stored. Contributions take `BAND_BYTES`
at most; where the fewest rows need more, they grow with the picture's width and the square of the radius. The point spread
takes 20 bytes for each pixel beside them.
"""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.limits import check_texture_array
from render.gl.resources import Construction, Resources
from render.gl.shaders import Defines, ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape
from render.postblur.point_spread import ALL_RADII, OUTLINE_DEFINES, Field, PointSpreadPass, RadiusWindow

BAND_BYTES = 64 << 20
"""Limit on the memory of the contributions, unless the fewest possible rows need more."""
CONTRIBUTION_BYTES = 16
"""Bytes of one texel of the contributions."""
CANCELLABLE_ROWS = 64
"""Rows blurred between two cancellation points."""
_TILE = 16
_HEIGHT_BYTES, _POINT_BYTES = 4, 20  # of a height; of a point's intensity and radius


@dataclass(frozen=True)
class Ring:
    """Ring buffer of rows: a band of the picture is finished once the contributions of all rows that reach it are stored.

    Attributes:
        new: rows of a band.
        ahead: rows that must be stored on either side of the band.
        slices: slices of the contributions: distances from the row, for each half of the shape.
    """

    new: int
    ahead: int
    slices: int

    @classmethod
    def for_picture(cls, size: tuple[int, int], most: int, *, two_sided: bool, is_cancellable: bool = False) -> Ring:
        """Choose the largest band that the memory limit allows.

        Args:
            size: width and height of the picture in pixels.
            most: greatest number of rows that light reaches up or down.
            two_sided: whether the shape is not symmetric, which needs twice the slices.
            is_cancellable: whether the work may be cancelled, which takes smaller bands.
        """
        slices = (most + 1) * (2 if two_sided else 1)
        ahead = _TILE * -(-most // _TILE)
        fitting = BAND_BYTES // (size[0] * slices * CONTRIBUTION_BYTES) - 2 * ahead
        wanted = min(size[1], CANCELLABLE_ROWS) if is_cancellable else size[1]
        return cls(_TILE * max(1, min(fitting, wanted + _TILE - 1) // _TILE), ahead, slices)

    @property
    def rows(self) -> int:
        """Rows stored at once."""
        return self.new + 2 * self.ahead


def flag_bytes(size: tuple[int, int], most_px: float, *, two_sided: bool) -> int:
    """Device memory of a blur in bytes: contributions of the stored rows, and the point spread of each pixel.

    Args:
        size: width and height of the picture in pixels.
        most_px: largest radius.
        two_sided: whether the shape is not symmetric.
    """
    ring = Ring.for_picture(size, int(np.ceil(most_px)) + 1, two_sided=two_sided)
    return size[0] * ring.rows * (ring.slices * CONTRIBUTION_BYTES + _HEIGHT_BYTES) + size[0] * size[1] * _POINT_BYTES


class Flag:
    """Blurs fields by FLAG, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._point_spread = PointSpreadPass(ctx, programs)

    def reduce(self, field: Field, shrink: int, window: RadiusWindow) -> Field:
        """Reduce a field's light in a window to less resolution. The caller releases its textures.

        Args:
            field: field of the picture.
            shrink: pixels per pixel of the new field, along each axis.
            window: range of radii that is included.
        """
        width, height = (-(-side // shrink) for side in field.light.size)
        with Construction() as making:
            light = making.keep(self._ctx.texture((width, height), 4, dtype="f4"))
            radii = making.keep(self._ctx.texture((width, height), 2, dtype="f4"))
        program = self._programs.compute("flag/flag_reduce.comp")
        field.light.use(0)
        field.radii.use(1)
        set_uniforms(program, light=0, radii=1, channel=field.channel, shrink=shrink)
        window.set_uniforms(program)
        light.bind_to_image(0, read=False, write=True)
        radii.bind_to_image(1, read=False, write=True)
        program.run(-(-width // 8), -(-height // 8))
        self._ctx.memory_barrier()
        return Field(light, radii, 0)

    def blur(
        self, field: Field, shape: BlurShape, most_px: float, target: moderngl.Texture, window: RadiusWindow = ALL_RADII
    ) -> None:
        """Blur a field: the light of each pixel is spread evenly over its circle of confusion, without loss.

        Args:
            field: what to blur.
            shape: shape of the blur.
            most_px: upper bound on the radii in the window.
            target: RGBA32F as large as the field: receives light and coverage.
            window: range of radii that is included.
        """
        width, height = field.light.size
        most = int(np.ceil(most_px)) + 1
        two_sided = not shape.is_symmetric
        ring = Ring.for_picture(
            (width, height), most, two_sided=two_sided, is_cancellable=self._cancellation.is_cancellable
        )
        across = int(np.ceil(most_px * shape.wide)) + 1
        rows, columns = self._compile(two_sided)
        shape.set_uniforms(rows)
        with Resources() as scope:
            spread = self._point_spread.run(field, shape, window, scope)
            tile_radius = self._tile_maxima(spread.radii, (1, 0), scope)
            check_texture_array(self._ctx, (width, ring.rows, ring.slices), "a blur of this radius")
            contributions = scope.keep(self._ctx.texture_array((width, ring.rows, ring.slices), 4, dtype="f4"))
            heights = scope.keep(self._ctx.texture((width, ring.rows), 1, dtype="f4"))
            stored = 0
            for first in range(0, height, ring.new):
                end = first + ring.new + ring.ahead
                for unit, texture in enumerate((spread.intensity, spread.radii, tile_radius, spread.outline)):
                    texture.use(unit)
                set_uniforms(rows, intensity=0, radii=1, tile_radius=2, outline=3, ring=ring.rows)
                set_uniforms(rows, first_row=stored, rows=end - stored, most=most, across=across)
                contributions.bind_to_image(0, read=True, write=True)
                heights.bind_to_image(1, read=False, write=True)
                rows.run(-(-width // 32), -(-(end - stored) // 2))
                self._ctx.memory_barrier()
                self._cancellation.poll()
                stored = end
                with Resources() as inner_scope:
                    tile_height = self._tile_maxima(heights, (0, 1), inner_scope)
                    for unit, table in enumerate((heights, tile_height)):
                        table.use(unit)
                    contributions.use(2)
                    set_uniforms(columns, heights=0, tile_height=1, contributions=2, most=most, ring=ring.rows)
                    set_uniforms(columns, first_row=first, rows=ring.new)
                    target.bind_to_image(0, read=False, write=True)
                    columns.run(-(-width // 32), -(-ring.new // 2))
                    self._ctx.memory_barrier()
                    self._cancellation.poll()

    def _tile_maxima(self, values: moderngl.Texture, along: tuple[int, int], scope: Resources) -> moderngl.Texture:
        """Maximum of each tile of a row or of a column."""
        size = [-(-side // _TILE) if step else side for side, step in zip(values.size, along, strict=True)]
        maxima = scope.keep(self._ctx.texture((size[0], size[1]), 1, dtype="f4"))
        program = self._programs.compute("flag/flag_tile_max.comp", {"TILE": _TILE})
        values.use(0)
        set_uniforms(program, values=0, along=along)
        maxima.bind_to_image(0, read=False, write=True)
        program.run(-(-size[0] // 8), -(-size[1] // 8))
        self._ctx.memory_barrier()
        return maxima

    def _compile(self, two_sided: bool) -> tuple[moderngl.ComputeShader, moderngl.ComputeShader]:
        defines: Defines = {"TILE": _TILE} | OUTLINE_DEFINES | ({"TWO_SIDED": 1} if two_sided else {})
        return self._programs.compute("flag/flag_rows.comp", defines), self._programs.compute(
            "flag/flag_columns.comp", defines
        )
