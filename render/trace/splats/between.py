"""Splats of a pinhole's picture, drawn between the surfaces of each pixel: exact, for the accumulation of views."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.layers.peeled import LayerGroup
from render.layers.splats import HELD_OUT, LOW_PASS_PX2, ProjectedSplats, project_splats
from render.layers.targets import LAYERS_PER_PACK
from render.model.splats import SplatBatch
from render.optics.view import PinholeView
from render.trace.splats.drawing import SplatDrawer

_HELD: dict[str, int | float | str] = {"BETWEEN": 1, "OWNERS": 1}


class SplatsBetweenLayers(Resources):
    """Draws the splats of one view after another. Use it as a context.

    Args:
        ctx: context of the device.
        programs: its programs.
        batches: the scene's splats.
        size: of the views, pixels.

    Attributes:
        texture: RGBA32F array of light and opacity, premultiplied: in front of each layer of a group, and behind the last;
            then as many slices again with the opacity of holdouts, where there are some.
        has_holdouts: whether there are.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, batches: Sequence[SplatBatch], size: tuple[int, int]
    ) -> None:
        super().__init__()
        self._batches = batches
        self._drawer = self.keep(SplatDrawer(ctx, programs, {"BETWEEN": 1}))
        self.has_holdouts = any(batch.is_holdout for batch in batches)
        self._held_drawer = self.keep(SplatDrawer(ctx, programs, _HELD)) if self.has_holdouts else None
        slices = (1 + self.has_holdouts) * (LAYERS_PER_PACK + 1)
        self.texture = self.keep(ctx.texture_array((*size, slices), 4, dtype="f4"))
        self.texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._splats: ProjectedSplats | None = None

    def begin(self, view: PinholeView) -> None:
        """Project the splats for a view."""
        self._splats = project_splats(self._batches, view, LOW_PASS_PX2)

    def draw(self, group: LayerGroup) -> None:
        """Draw the splats in front of each layer of a group, behind those before, and behind the last one of all."""
        self._draw(self._drawer, group, 0)
        if self._held_drawer is not None:
            self._draw(self._held_drawer, group, LAYERS_PER_PACK + 1)

    def _draw(self, drawer: SplatDrawer, group: LayerGroup, first: int) -> None:
        """Draw the slices from the first on."""
        splats = self._splats
        if splats is None:
            return
        packs = group.targets.packed_w
        with drawer.drawing():
            for number in range(group.count + group.is_last):
                before, channel = self._before(group, number)
                drawer.draw(
                    splats,
                    (0, len(splats.w)),
                    self.texture,
                    first + number,
                    {"packed_w": packs[group.slot // LAYERS_PER_PACK], "before_w": packs[before]},
                    channel=number if number < group.count else -1,
                    before_channel=channel,
                    corner_px=(0.0, 0.0),
                    texel_scale=1.0,
                    first_owner=HELD_OUT,
                )

    def _before(self, group: LayerGroup, number: int) -> tuple[int, int]:
        """Texture and channel of the w of the layer before; channel -1 for none."""
        pack = group.slot // LAYERS_PER_PACK
        if number > 0:
            return pack, number - 1
        if group.is_first:
            return pack, -1
        return (pack - 1) % len(group.targets.packed_w), LAYERS_PER_PACK - 1
