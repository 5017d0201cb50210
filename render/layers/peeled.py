"""Layers of a peeled scene, as those that trace them hold them."""

from __future__ import annotations

from dataclasses import dataclass

from render.layers.targets import LayerTargets
from render.layers.umbra import HIDES_ALL
from render.model.splats import SplatBatch
from render.optics.view import PinholeView


@dataclass(frozen=True)
class Layers:
    """Layers of a peeled scene. Valid until the next peeling.

    Attributes:
        view: view of the layers' pixels.
        targets: the textures. Channels of inverse depth from ``count`` on are 0 in a texture whose first layer is below
            ``count``; textures and slices from there on hold what an earlier peeling left.
        count: number of layers with surfaces.
        may_be_translucent: whether any of their surfaces may be partly transparent.
        may_move: whether any of their surfaces may move; the targets hold the motion then.
        within: view of the whole picture's layers, of whose pixels these are a part; None where they are the whole.
        umbra: reach of an opaque surface's umbra that they were peeled with, 1/m.
        nearest_w: greatest inverse depth of what a sketch has drawn, 1/m; None where they are no sketch.
        splats: Gaussian splats of the scene that was peeled, which no layer holds.
    """

    view: PinholeView
    targets: LayerTargets
    count: int
    may_be_translucent: bool = True
    may_move: bool = False
    within: PinholeView | None = None
    umbra: float = HIDES_ALL
    nearest_w: float | None = None
    splats: tuple[SplatBatch, ...] = ()

    @property
    def whole(self) -> PinholeView:
        """View of the whole picture's layers, whose pixels the tracer counts in."""
        return self.within or self.view

    @property
    def origin(self) -> tuple[int, int]:
        """Position of the first of these pixels in the whole picture's layers."""
        return round(self.whole.cx - self.view.cx), round(self.whole.cy - self.view.cy)


@dataclass(frozen=True)
class LayerGroup:
    """Up to four layers of a pinhole's picture, near to far. Valid until the next group or peeling.

    Attributes:
        targets: the textures.
        slot: index in the targets of the first of them; a multiple of four.
        count: number of layers with surfaces.
        is_first: whether nothing is nearer.
        is_last: whether nothing is farther.
    """

    targets: LayerTargets
    slot: int
    count: int
    is_first: bool
    is_last: bool
