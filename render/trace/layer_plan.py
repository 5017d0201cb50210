"""Plan of the layers that a picture is traced through."""

from __future__ import annotations

from dataclasses import dataclass

from render.layers.peel import PeelKey
from render.layers.surface_sampling import SurfaceSampling
from render.optics.view import PinholeView
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle
from render.trace.tiling.plan import TilePlan


@dataclass(frozen=True)
class LayerPlan:
    """Layers that a picture is traced through.

    Attributes:
        bundle: the lens.
        focus: focal surface.
        wide: view of all layers.
        nearest_w: greatest inverse depth in it, 1/m.
        layers: opaque ones, at most.
        sheets: with partly transparent ones, at most.
        umbra: as for `Peeler.peel`.
        unlit: likewise.
        sampling: of surfaces, from the corner of ``wide``.
        ids: hold ids of surfaces.
        tiles: parts that are peeled one after another; None for one peeling.
    """

    bundle: RayBundle
    focus: PictureFocus
    wide: PinholeView
    nearest_w: float
    layers: int
    sheets: int
    umbra: float
    unlit: bool
    sampling: SurfaceSampling
    ids: bool
    tiles: TilePlan | None

    def key_of(self, part: PinholeView) -> PeelKey:
        """Parameters of the peeling of a part of the view."""
        wide = self.wide
        sampling = self.sampling.at_corner(wide.cx - part.cx, wide.cy - part.cy)
        left, top = round(wide.cx - part.cx), round(wide.cy - part.cy)
        beyond = left > 0, top > 0, left + part.width < wide.width, top + part.height < wide.height
        return PeelKey(part, self.layers, self.umbra, self.unlit, sampling, beyond, self.sheets, ids=self.ids)
