"""Gaussian splats between the layers of traced pictures. What draws them is loaded with the first scene that has some."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import moderngl

from render.gl.shaders import ProgramCache
from render.layers.peeled import Layers
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
    ) -> Paint:
        """Function that draws the splats of a picture, whose planes are valid until its next call.

        Args:
            batches: the scene's splats.
            wide: view of all layers.
            view: view of the picture.
            focus: where it is focused.
            pupil_m: radius of the pupil.
            held: size of the layers that are traced at once; None for all.
        """
        if not batches:
            return paint_nothing
        if self._painter is None:
            from render.trace.splats.planes import SplatPainter

            self._painter = SplatPainter(self._ctx, self._programs)
        painter = self._painter
        with step("sort splats"):
            plan = painter.plan(batches, wide, view, focus, pupil_m, held)
        return paint_nothing if plan is None else lambda layers: painter.draw(plan, layers)

    def release(self) -> None:
        """Release the memory."""
        if self._painter is not None:
            self._painter.release()
            self._painter = None
