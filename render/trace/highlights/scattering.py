"""Highlights whose blurred image is uneven or folds, scattered: the pupil's cells send their light to the pixels they reach.

A cell's image is the parallelogram of the places whose rays through the cell meet the texel. Its light is spread evenly over the
box around that, so that the light of all cells is that of the texel whatever the lens does, caustics included
(``highlights/scatter.comp``). Sums are integers, which do not depend on the order of additions.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.area import Area
from render.model.arrays import DoubleArray, FloatArray, LongArray
from render.trace.highlights.chosen import pixels_seen
from render.trace.highlights.iris_levels import bind_iris, iris_levels
from render.trace.highlights.search import Picture
from render.trace.ray_buffers import RayBuffers

UNEVEN = 0x10000
"""Flag of a plan's cells, as in ``highlights/plan.comp``."""
SPLAT_REACH_PX = 4.0
"""Distance in picture pixels to which a cell sends light, but for the few whose image is larger: tiles see as far around them."""
MOST_BYTES = 1 << 26
"""Limit on the sums of one pass over the highlights. A larger picture or tile is made in bands."""
_CELLS_PER_DISPATCH = 1 << 21
_HIGHLIGHTS, _OWNERS, _SUMS = 0, 1, 2  # as the shader binds them
_OPENINGS = 6  # in place of the iris's points, which the shader does not read; movers have 3
_GROUP = 64
_FINE_CELLS = 256  # at least so many points across the pupil are averaged
_SOLUTIONS = 4
"""Count of a loop of the shader."""
_OCTAVES = 12
"""Highlights whose cells differ less in brightness, by a power of 2, are summed in the same unit."""
_HEADROOM = 16.0
"""Largest light of a cell relative to that of a texel over its cells: rays that the lens brings closer together."""
_HIGHLIGHT = np.dtype(
    [
        ("excess", "f4", 4),
        ("place", "f4", 4),
        ("middle", "f4", 2),
        ("first_cell", "u4"),
        ("cells", "u4"),
    ]
)


class Scatterer:
    """Scatters highlights.

    Args:
        ctx: context.
        programs: its programs.
        cancellation: where the work can be cancelled.
        buffers: buffers for the rays of the lens.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint, buffers: RayBuffers
    ) -> None:
        self._ctx, self._programs, self._cancellation, self._buffers = ctx, programs, cancellation, buffers
        self._piece = PieceSize(1 << 14)
        self._openings: _Openings | None = None

    def scatter(self, picture: Picture, highlights: NDArray[np.void], area: Area) -> FloatArray:
        """Light of highlights in a part of a picture, ``(height, width, 3)``.

        Args:
            picture: the picture, whose lens has a table.
            highlights: `CARRIED` of each, with the cells of the pupil across and down.
            area: the part.
        """
        bundle, (left, top, width, height) = picture.bundle, area
        highlights = highlights[pixels_seen(_widened(highlights["box"]), area) > 0]
        if len(highlights) == 0:
            return np.zeros((height, width, 3), np.float32)
        program = self._programs.compute("highlights/scatter.comp", picture.defines | self._buffers.defines(bundle))
        unit = picture.bind(program)
        light = bundle.rgb * bundle.transmittance
        ranges = _brightness_ranges(picture, highlights, light)
        set_uniforms(program, solutions=_SOLUTIONS)
        drawn = np.zeros((height, width, 3), np.float32)
        rows = max(1, min(height, MOST_BYTES // (24 * width)))
        with Resources() as scope:
            iris = bundle.pattern.iris_image
            if iris is not None:
                bind_iris(program, scope.keep(iris_levels(self._ctx, self._programs, iris)), iris, unit)
            self._buffers.bind(program, bundle, first_unit=unit + 1)
            openings = None if iris is None else self._openings_of(iris)
            sums = scope.keep(self._ctx.buffer(reserve=24 * width * rows))
            sums.bind_to_storage_buffer(_SUMS)
            for number, first in itertools.product(np.unique(ranges), range(0, height, rows)):
                alike, end = highlights[ranges == number], min(first + rows, height)
                per_unit = 2.0 ** (_OCTAVES * (int(number) + 1) - 32) * _HEADROOM
                sums.clear()
                set_uniforms(program, unit=1 / per_unit)
                set_uniforms(program, first_pixel=(left, top + first), end_pixel=(left + width, top + end))
                for wavelength, rgb in enumerate(light):
                    self._buffers.choose_wavelength(program, bundle, wavelength)
                    set_uniforms(program, light=tuple(rgb))
                    for some in self._pieces(alike["cells"].astype(np.int64) ** 2):
                        self._scatter_some(program, alike[some], openings)
                halves = np.frombuffer(sums.read(), np.uint32).reshape(rows, width, 3, 2)[: end - first]
                drawn[first:end] += ((halves[..., 1] * 2.0**32 + halves[..., 0]) * per_unit).astype(np.float32)
        return drawn

    def _openings_of(self, iris: FloatArray) -> _Openings:
        """Transmissions of an iris, kept for the next tile or picture."""
        if self._openings is None or self._openings.image is not iris:
            self._openings = _Openings(iris)
        return self._openings

    def _scatter_some(
        self, program: moderngl.ComputeShader, carried: NDArray[np.void], openings: _Openings | None
    ) -> None:
        cells = carried["cells"].astype(np.int64) ** 2
        highlights = np.zeros(len(carried), _HIGHLIGHT)
        for name in ("excess", "place", "cells"):
            highlights[name] = carried[name]
        highlights["middle"] = (carried["box"][:, :2] + carried["box"][:, 2:]) / 2
        highlights["first_cell"] = np.cumsum(cells) - cells
        owners = np.repeat(np.arange(len(carried), dtype=np.uint32), cells)
        with Resources() as scope:
            scope.keep(self._ctx.buffer(highlights.tobytes())).bind_to_storage_buffer(_HIGHLIGHTS)
            scope.keep(self._ctx.buffer(owners.tobytes())).bind_to_storage_buffer(_OWNERS)
            if openings is not None:
                held = np.concatenate([openings.of_cells(int(side)) for side in carried["cells"]])
                scope.keep(self._ctx.buffer(held.tobytes())).bind_to_storage_buffer(_OPENINGS)
            set_uniforms(program, count=len(owners))
            program.run(-(-len(owners) // _GROUP))
            self._ctx.memory_barrier()
        self._piece.learn(len(owners), self._cancellation.poll())

    def _pieces(self, cells: NDArray[np.int64]) -> Iterator[slice]:
        """Divide a list of highlights into dispatches: short enough to cancel between, or for a driver."""
        ends, first = np.cumsum(cells), 0
        while first < len(ends):
            most = (
                min(self._piece.units, _CELLS_PER_DISPATCH)
                if self._cancellation.is_cancellable
                else _CELLS_PER_DISPATCH
            )
            done = int(ends[first - 1]) if first else 0
            end = max(first + 1, int(np.searchsorted(ends, done + most, side="right")))
            yield slice(first, end)
            first = end


class _Openings:
    """Transmission of an iris over the cells of the pupil, relative to its mean.

    Attributes:
        image: ``(side, side)`` transmission over the square around the disc.
    """

    def __init__(self, image: FloatArray) -> None:
        self.image = image
        self._made: dict[int, FloatArray] = {}

    def of_cells(self, side: int) -> FloatArray:
        """Means over the cells, row by row, where there are so many across and down; their own mean is 1."""
        if side not in self._made:
            finer = 2 * -(-_FINE_CELLS // (2 * side))  # even: no point is at 0
            line = (np.arange(side * finer) + 0.5) * 2 / (side * finer) - 1
            x, y = _on_disc(*np.meshgrid(line, line))
            last = len(self.image) - 1
            column, row = (np.clip((v + 1) / 2 * (last + 1), 0, last).astype(int) for v in (x, y))
            means = self.image[row, column].reshape(side, finer, side, finer).mean(axis=(1, 3), dtype=np.float64)
            self._made[side] = (means / means.mean()).astype(np.float32).ravel()
        return self._made[side]


def _on_disc(x: DoubleArray, y: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Points of the unit disc for those of the square from -1 to 1 as in ``highlights/scatter.comp``, none of which is at 0."""
    is_wide = np.abs(x) > np.abs(y)
    radius = np.where(is_wide, x, y)
    angle = np.pi / 4 * np.where(is_wide, y, x) / radius
    along, across = radius * np.cos(angle), radius * np.sin(angle)
    return np.where(is_wide, along, across), np.where(is_wide, across, along)


def _brightness_ranges(picture: Picture, highlights: NDArray[np.void], light: DoubleArray) -> LongArray:
    """Range of brightness, `_OCTAVES` wide, that the light of each highlight's cells is in. The sums of each range have a unit of
    their own: the brightest cell takes no more than 32 bits, and the light of a highlight does not depend on others."""
    iris = picture.bundle.pattern.iris_image
    most_open = 1.0 if iris is None else float(iris.max())
    cell = highlights["excess"][:, :3].max(axis=1) / highlights["cells"].astype(np.float64) ** 2
    brightest = np.maximum(cell, 1e-30) * light.max() * most_open / picture.scale**2
    return np.asarray(np.floor(np.log2(brightest) / _OCTAVES), np.int64)


def _widened(boxes: NDArray[np.float32]) -> NDArray[np.float32]:
    """Boxes three times as wide and high: cells may send light beyond the box of their highlight."""
    size = boxes[:, 2:] - boxes[:, :2]
    return np.concatenate([boxes[:, :2] - size, boxes[:, 2:] + size], axis=1)
