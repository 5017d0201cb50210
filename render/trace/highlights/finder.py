"""Finds the highlights of layers, and chooses those that are worth carrying.

All of it follows from the layers that are searched and from the lens, not from what is around those layers. So the highlights of
a strip are the same in each window that holds it (`render.trace.tiling`). At a strip's border, means are those of its own side.
"""

from __future__ import annotations

from collections.abc import Iterable

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.peeled import Layers
from render.model.area import Area
from render.trace.highlights.choice import CONNECTIONS_PER_RAY, choose_highlights
from render.trace.highlights.chosen import NONE, TAKEN, Highlights
from render.trace.highlights.evenness import grid_changes
from render.trace.highlights.grouping import MOST_PLACE, group_texels
from render.trace.highlights.scattering import UNEVEN
from render.trace.highlights.search import Picture, find_highlights, measure_means
from render.trace.lens_table import GridTable
from render.trace.ray_buffers import RayBuffers

_LIST, _PLANS = 0, 1  # as the shader binds them
_GROUP = 64
_PLAN = np.dtype(
    [
        ("excess", "f4", 4),
        ("box", "f4", 4),
        ("front", "f4"),
        ("cells", "u4"),
        ("base", "u4", 2),
        ("exact", "u4", 2),
        ("place", "f4", 2),
        ("area", "f4"),
        ("unused", "u4", 3),
    ]
)
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


class HighlightFinder:
    """Finds highlights.

    Args:
        ctx: context.
        programs: its programs.
        cancellation: where the work can be cancelled.
        buffers: buffers for the rays of the lens; the caller releases them.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint, buffers: RayBuffers
    ) -> None:
        self._ctx, self._programs, self._cancellation, self._buffers = ctx, programs, cancellation, buffers
        self._rows = PieceSize(8)
        self._means: tuple[Layers, moderngl.Texture] | None = None

    def search(self, pictures: Iterable[Picture]) -> NDArray[np.uint32]:
        """Search the same layers, as one or more pictures see them, for texels that are highlights in any of these.

        Args:
            pictures: at least one. Each is made when it is needed, since they may share the texture of their focal maps.

        Returns:
            ``(n, 3)`` x, y and layer.
        """
        found = [
            find_highlights(self._ctx, self._programs, picture, self._means_of(picture), self._cancellation, self._rows)
            for picture in pictures
        ]
        return found[0] if len(found) == 1 else np.unique(np.concatenate(found), axis=0)

    def find(
        self, picture: Picture, share: float, area: Area, candidates: NDArray[np.uint32] | None = None
    ) -> Highlights:
        """Find and choose highlights.

        Args:
            picture: the picture, or a strip of its layers.
            share: its share of all layers, and so of the connections.
            area: part of the picture that is traced.
            candidates: ``(n, 3)`` x, y and layer of the texels to choose from; None to search for them.
        """
        texels = self.search([picture]) if candidates is None else candidates
        if len(texels) == 0:
            return NONE
        plans = self._plan(picture, texels)
        places = texels.copy()
        places[:, :2] += np.array(picture.layers.origin, np.uint32)
        inside = (places[:, :2] < picture.layers.whole.size).all(axis=1) & (plans["box"][:, 2] > plans["box"][:, 0])
        inside &= ((plans["place"] >= 0) & (plans["place"] < MOST_PLACE)).all(axis=1)
        places, plans = places[inside], plans[inside]
        if len(places) == 0:
            return NONE
        luminance = plans["excess"][:, :3] @ _LUMINANCE
        carried, group = group_texels(places[:, 2], plans, luminance, picture.scale)
        bundle = picture.bundle
        rays = min(bundle.count, bundle.pattern.whole)
        most = share * CONNECTIONS_PER_RAY * rays * area[2] * area[3] / len(bundle.rgb)
        squares = np.bincount(group, luminance**2 / np.maximum(plans["area"], 1e-6), len(carried)).astype(np.float64)
        is_chosen = np.zeros(len(carried), bool)
        is_chosen[choose_highlights(squares, carried["box"], carried["cells"], area, most)] = True
        members = is_chosen[group]
        taken = np.zeros(int(members.sum()), TAKEN)
        taken["texel"] = places[members]
        taken["base"], taken["exact"] = plans["base"][members], plans["exact"][members]
        return Highlights(carried[is_chosen], taken)

    def release(self) -> None:
        """Release the memory."""
        if self._means is not None:
            self._means[1].release()
            self._means = None

    def _means_of(self, picture: Picture) -> moderngl.Texture:
        """Means of a picture's layers, kept for their next picture."""
        if self._means is None or self._means[0] is not picture.layers:
            self.release()
            self._means = picture.layers, measure_means(self._ctx, self._programs, picture)
        return self._means[1]

    def _plan(self, picture: Picture, texels: NDArray[np.uint32]) -> NDArray[np.void]:
        program = self._programs.compute(
            "highlights/plan.comp", picture.defines | self._buffers.defines(picture.bundle)
        )
        means = self._means_of(picture)
        unit = picture.bind(program)
        means.use(unit)
        set_uniforms(program, means=unit, count=len(texels))
        if isinstance(picture.bundle.table, GridTable):
            set_uniforms(program, grid_changes=grid_changes(picture.bundle.table))
        packed = np.stack([texels[:, 0] | texels[:, 1] << np.uint32(16), texels[:, 2]], axis=1)
        with Resources() as scope:
            places = scope.keep(self._ctx.buffer(packed.tobytes()))
            plans = scope.keep(self._ctx.buffer(reserve=_PLAN.itemsize * len(texels)))
            self._buffers.bind(program, picture.bundle, first_unit=unit + 1)
            places.bind_to_storage_buffer(_LIST)
            plans.bind_to_storage_buffer(_PLANS)
            for wavelength in range(len(picture.bundle.rgb)):
                self._buffers.choose_wavelength(program, picture.bundle, wavelength)
                set_uniforms(program, is_first=wavelength == 0)
                program.run(-(-len(texels) // _GROUP))
                self._ctx.memory_barrier()
                self._cancellation.poll()
            read = np.frombuffer(plans.read(), _PLAN).copy()
        read["cells"] = np.where(read["cells"] & UNEVEN, read["cells"] & (UNEVEN - 1), 0)
        return read
