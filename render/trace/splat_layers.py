"""Gaussian splats between the layers of traced pictures. What draws them is loaded with the first scene that has some."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache
from render.layers.peeled import Layers
from render.layers.surface_hits import SurfaceHits
from render.model.splats import SplatBatch
from render.optics.view import PinholeView
from render.steps import step
from render.trace.picture_focus import PictureFocus

if TYPE_CHECKING:  # loaded where a scene has splats
    from render.trace.splats.planes import SplatPainter, SplatPlanes

Paint = Callable[[Layers], "SplatPlanes | None"]
"""Function that draws the planes of splats over layers; None where there are none."""


def paint_nothing(layers: Layers) -> None:
    """Draw no splats: `Paint` of a scene without any."""
    del layers


class SplatLayers:
    """Draws the splats of one picture after another.

    Args:
        ctx: context of the device.
        programs: its programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._painter: SplatPainter | None = None

    def painting(
        self,
        batches: Sequence[SplatBatch],
        wide: PinholeView,
        view: PinholeView,
        focus: PictureFocus,
        pupil_m: float,
        held: tuple[int, int] | None = None,
        *,
        with_mattes: bool = False,
    ) -> Paint:
        """Function that draws the splats of a picture, whose planes are valid until its next call.

        A scene without splats releases what is kept of the last one with some.

        Args:
            batches: the scene's splats.
            wide: view of all layers.
            view: view of the picture.
            focus: where it is focused.
            pupil_m: radius of the pupil.
            held: size of the layers that are traced at once; None for all.
            with_mattes: whether clouds are told apart.
        """
        if not batches:
            self.release()
            return paint_nothing
        if self._painter is None:
            from render.trace.splats.planes import SplatPainter

            self._painter = SplatPainter(self._ctx, self._programs)
        painter = self._painter
        with step("sort splats"):
            plan = painter.plan(batches, wide, view, focus, pupil_m, held, with_mattes=with_mattes)
        return paint_nothing if plan is None else lambda layers: painter.draw(plan, layers)

    def hide(self, hits: SurfaceHits, batches: Sequence[SplatBatch], view: PinholeView) -> SurfaceHits:
        """Hits of splats where these hide half of what is met behind them.

        Args:
            hits: what each pixel of a view meets.
            batches: the scene's splats.
            view: that view.
        """
        if not batches:
            return hits
        from render.layers.splats import HELD_OUT, LOW_PASS_PX2, project_splats
        from render.trace.splats.depths import find_hiding_splats

        with step("find splats"):
            splats = project_splats(batches, view, LOW_PASS_PX2)
            rows = find_hiding_splats(self._ctx, self._programs, splats)
        prims, owners = np.array([batch.prim_id for batch in batches], np.int32), np.append(splats.owners, 0)
        w, owner = np.append(splats.w.astype(np.float64) + view.base_w, 0.0)[rows], owners[rows]
        is_held = owner == HELD_OUT
        return hits.behind_splats(w, np.where(is_held, np.int32(-1), prims[np.where(is_held, 0, owner)]))

    def release(self) -> None:
        """Release the memory."""
        if self._painter is not None:
            self._painter.release()
            self._painter = None
