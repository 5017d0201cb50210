"""Traces a picture tile by tile, each through a window of its layers."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import Literal

import moderngl

from render.layers.matte_numbers import MatteNumbers
from render.layers.nbuffers import NBufferBuilder, NBuffers
from render.layers.peeled import Layers
from render.layers.window import LayerWindow, PeelStrip
from render.model.area import Area
from render.model.arrays import FloatArray
from render.model.mattes import MatteSum
from render.optics.view import PinholeView
from render.trace.highlights.carrier import CarriedHighlights, HighlightCarrier
from render.trace.highlights.chosen import Highlights, join_highlights
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle
from render.trace.splat_layers import Paint, paint_nothing
from render.trace.tiling.picture import TiledPicture
from render.trace.tiling.plan import Tile, TilePlan
from render.trace.tracer import Tracer

OnTileStage = Callable[[Literal["peel", "nbuffers", "highlights", "trace"]], None]


@dataclass(frozen=True)
class TileWork:
    """Settings of a picture that is traced in tiles, the same for all of them.

    Attributes:
        plan: the tiles.
        peel: peels a strip of the layers.
        layers: at most this many layers.
        bundle: rays of the lens.
        focus: focal surface.
        view: view of the picture.
        nearest_w: largest inverse depth of any surface in view, 1/m.
        connections: carry highlights.
        bound_by_rays: see `Tracer.passes`.
        mattes: sum to add what the rays meet to, and numbers of the surfaces; None for no mattes.
        paint: draws the splats between the layers of a window.
    """

    plan: TilePlan
    peel: PeelStrip
    layers: int
    bundle: RayBundle
    focus: PictureFocus
    view: PinholeView
    nearest_w: float
    connections: bool
    bound_by_rays: bool
    mattes: tuple[MatteSum, MatteNumbers] | None
    paint: Paint = paint_nothing


class TileTracer:
    """Traces pictures in tiles.

    Args:
        ctx: context of the device.
        nbuffers: builds the N-buffers of windows.
        tracer: traces the rays of tiles.
        carrier: carries highlights.
    """

    def __init__(
        self, ctx: moderngl.Context, nbuffers: NBufferBuilder, tracer: Tracer, carrier: HighlightCarrier
    ) -> None:
        self._nbuffers, self._tracer, self._carrier = nbuffers, tracer, carrier
        self._window = LayerWindow(ctx)
        self._at_work: tuple[TiledPicture, Area, CarriedHighlights] | None = None

    def trace(
        self, work: TileWork, on_stage: OnTileStage
    ) -> Generator[float, None, tuple[FloatArray, Layers, NBuffers]]:
        """Trace a picture tile by tile.

        Its pixels are those of one window that holds all of the layers, as long as nothing here depends on a window: what is
        added between layers and rays must be a function of the layers that a pixel's rays reach, and must leave the window's
        textures as they were, since the next window takes them over. So highlights are found and chosen strip by strip, as each
        is peeled, with a share of the connections in proportion to its length; those of a window are taken out of it only while
        rays are traced.

        Yields:
            The share of the tracing that is done.

        Returns:
            The picture, ``(height, width, 4)`` float32, premultiplied, and the layers and N-buffers of its last window.
        """
        plan, view = work.plan, work.view
        sums, numbers = work.mattes or (None, None)
        picture, done, found = TiledPicture(*view.size), 0.0, _StripHighlights(work, self._carrier)
        self._window.clear()
        try:
            for tile in plan.tiles:
                area = plan.area(tile, view)
                self._at_work = picture, area, self._carrier.nothing
                layers = self._window.move(
                    plan.whole,
                    plan.axis,
                    tile.window,
                    plan.window,
                    plan.strip,
                    work.layers,
                    found.peel,
                    ids=sums is not None,
                )
                on_stage("peel")
                nbuffers = self._nbuffers.build(layers, work.nearest_w)
                on_stage("nbuffers")
                carried = self._carrier.carry(found.within(tile), layers, nbuffers, work.bundle, work.focus, view, area)
                on_stage("highlights")
                self._at_work = picture, area, carried
                share = area[2] * area[3] / (view.width * view.height)
                passes = self._tracer.passes(
                    layers,
                    nbuffers,
                    work.bundle,
                    work.focus,
                    view,
                    bound_by_rays=work.bound_by_rays,
                    area=area,
                    mattes=numbers,
                    splats=work.paint(layers),
                )
                for step in carried.without(passes):
                    if step.share < 1 or tile.stop < view.size[plan.axis]:
                        yield done + share * step.share
                picture.put(area, carried.add_to(self._tracer.picture()))
                if sums is not None:
                    sums.put(area, *self._tracer.read_mattes())
                on_stage("trace")
                done += share
            yield 1.0
            return picture.color, layers, nbuffers
        finally:
            self._at_work = None

    @property
    def is_at_work(self) -> bool:
        """Whether a picture is being traced."""
        return self._at_work is not None

    def with_unfinished(self, picture: FloatArray, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Picture so far and the share of each pixel's rays, where a picture is being traced.

        Args:
            picture: tile at work, from the tracer.
            shares: those of its pixels.
        """
        if self._at_work is None:
            return picture, shares
        whole, area, carried = self._at_work
        return whole.with_unfinished(area, carried.add_to(picture), shares)

    def release_window(self) -> bool:
        """Release the layers of the last tile; false where there are none."""
        was_held = self._window.is_held
        self._window.release()
        return was_held


class _StripHighlights:
    """Highlights of the strips that are held by a window, found when a strip is peeled first."""

    def __init__(self, work: TileWork, carrier: HighlightCarrier) -> None:
        self._work, self._carrier = work, carrier
        self._found: dict[int, Highlights] = {}

    def peel(self, part: PinholeView) -> Layers:
        """Peel a strip and find its highlights."""
        work, plan = self._work, self._work.plan
        peeled = work.peel(part)
        strip = replace(peeled, within=plan.whole)
        first = strip.origin[plan.axis]
        if work.connections and first not in self._found:
            length = plan.whole.size[plan.axis]
            share = min(plan.strip, length - first) / length
            self._found[first] = self._carrier.find(strip, work.bundle, work.focus, work.view, share)
        return peeled

    def within(self, tile: Tile) -> Highlights:
        """Highlights of the strips from a tile's window on; those before it are forgotten."""
        for first in [first for first in self._found if first + self._work.plan.strip <= tile.window]:
            del self._found[first]
        return join_highlights(self._found[first] for first in sorted(self._found))
