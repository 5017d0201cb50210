"""Highlights whose blurred image is uneven or folds, scattered: the pupil's cells send their light to the pixels they reach.

A cell's image is the parallelogram of the places whose rays through the cell meet the texel. Its light is spread evenly over the
box around that, so that the light of all cells is that of the texel whatever the lens does, caustics included
(``highlights/scatter.comp``). Sums are integers, which do not depend on the order of additions.
"""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.arrays import DoubleArray, FloatArray
from render.trace.highlights.iris_levels import bind_iris, iris_levels
from render.trace.highlights.search import Picture
from render.trace.ray_buffers import RayBuffers

UNEVEN = 0x10000
"""Flag of a plan's cells, as in ``highlights/plan.comp``."""
MOST_BYTES = 1 << 26
"""Limit on the sums of one pass over the highlights. A larger picture is made in bands."""
_CELLS_PER_DISPATCH = 1 << 21
_HIGHLIGHTS, _OWNERS, _SUMS = 0, 1, 2  # as the shader binds them
_GROUP = 64
_SOLUTIONS = 4
"""Count of a loop of the shader."""
_HEADROOM = 16.0
"""Largest light of a cell relative to that of a texel over its cells: rays that the lens brings closer together."""
_HIGHLIGHT = np.dtype(
    [
        ("excess", "f4", 4),
        ("middle", "f4", 2),
        ("bins", "u4", 2),
        ("place", "f4", 2),
        ("front", "u4"),
        ("first_cell", "u4"),
        ("side", "u4"),
        ("unused", "u4", 3),
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

    def scatter(self, picture: Picture, places: FloatArray, plans: NDArray[np.void]) -> FloatArray:
        """Light of highlights, ``(height, width, 3)``.

        Args:
            picture: the picture, whose lens has a table.
            places: ``(n, 2)`` their places in the layers, pixels.
            plans: their plans, with the cells of the pupil across and down.
        """
        view, bundle = picture.view, picture.bundle
        program = self._programs.compute("highlights/scatter.comp", picture.defines | self._buffers.defines(bundle))
        unit = picture.bind(program)
        light = bundle.rgb * bundle.transmittance
        per_unit = _finest_unit(picture, plans, light)
        set_uniforms(program, picture=view.size, unit=1 / per_unit, solutions=_SOLUTIONS)
        drawn = np.empty((view.height, view.width, 3), np.float32)
        rows = max(1, min(view.height, MOST_BYTES // (24 * view.width)))
        with Resources() as scope:
            iris = bundle.pattern.iris_image
            if iris is not None:
                bind_iris(program, scope.keep(iris_levels(self._ctx, iris)), iris, unit)
            self._buffers.bind(program, bundle, first_unit=unit + 1)
            sums = scope.keep(self._ctx.buffer(reserve=24 * view.width * rows))
            sums.bind_to_storage_buffer(_SUMS)
            for first in range(0, view.height, rows):
                end = min(first + rows, view.height)
                sums.clear()
                set_uniforms(program, rows=(first, end))
                for wavelength, rgb in enumerate(light):
                    self._buffers.choose_wavelength(program, bundle, wavelength)
                    set_uniforms(program, light=tuple(rgb))
                    for some in self._pieces(plans["cells"].astype(np.int64) ** 2):
                        self._scatter_some(program, places[some], plans[some])
                halves = np.frombuffer(sums.read(), np.uint32).reshape(rows, view.width, 3, 2)[: end - first]
                drawn[first:end] = (halves[..., 1] * 2.0**32 + halves[..., 0]) * per_unit
        return drawn

    def _scatter_some(self, program: moderngl.ComputeShader, places: FloatArray, plans: NDArray[np.void]) -> None:
        cells = plans["cells"].astype(np.int64) ** 2
        highlights = np.zeros(len(plans), _HIGHLIGHT)
        for name in ("excess", "bins", "front"):
            highlights[name] = plans[name]
        highlights["middle"] = (plans["box"][:, :2] + plans["box"][:, 2:]) / 2
        highlights["place"], highlights["side"] = places, plans["cells"]
        highlights["first_cell"] = np.cumsum(cells) - cells
        owners = np.repeat(np.arange(len(plans), dtype=np.uint32), cells)
        with Resources() as scope:
            scope.keep(self._ctx.buffer(highlights.tobytes())).bind_to_storage_buffer(_HIGHLIGHTS)
            scope.keep(self._ctx.buffer(owners.tobytes())).bind_to_storage_buffer(_OWNERS)
            set_uniforms(program, count=len(owners))
            program.run(-(-len(owners) // _GROUP))
            self._ctx.memory_barrier()
        self._piece.learn(len(owners), self._cancellation.poll())

    def _pieces(self, cells: NDArray[np.int64]) -> Iterator[slice]:
        """Divide a list of highlights into dispatches: short enough to cancel between, or for a driver."""
        ends, first = np.cumsum(cells), 0
        while first < len(ends):
            most = self._piece.units if self._cancellation.is_cancellable else _CELLS_PER_DISPATCH
            done = int(ends[first - 1]) if first else 0
            end = max(first + 1, int(np.searchsorted(ends, done + most, side="right")))
            yield slice(first, end)
            first = end


def _finest_unit(picture: Picture, plans: NDArray[np.void], light: DoubleArray) -> float:
    """Radiance that 1 in the sums stands for: the brightest cell's light takes no more than 32 bits."""
    iris = picture.bundle.pattern.iris_image
    most_open = 1.0 if iris is None else float(iris.max())
    brightest = (plans["excess"][:, :3].max(axis=1) / plans["cells"].astype(np.float64) ** 2).max()
    return float(max(brightest, 1e-30) * light.max() * most_open * _HEADROOM / picture.scale**2 / 2**32)
