"""Planes of splats between the layers of a traced picture.

The splats of a view are cut into bins of inverse depth (`render.trace.splats.bins`), and those of each bin are drawn far to near
into a plane, as the pupil's centre sees them. A ray meets each plane where it crosses the mean depth of the bin's splats, and
composites them front to back with the surfaces that it meets. What that leaves out is the parallax within a bin, which is
below a pixel of the picture near the focus, and an eighth of the blur elsewhere.

In a bin that an opaque surface cuts through, splats behind that surface are left out of its pixels, and rays pass the others in
front of it. Splats of such a bin behind a partly transparent surface count as in front of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.peeled import Layers
from render.layers.splats import HELD_OUT, LOW_PASS_PX2, ProjectedSplats, project_splats
from render.model.arrays import DoubleArray, LongArray
from render.model.splats import MOST_MATTE_CLOUDS, SplatBatch
from render.optics.view import PinholeView
from render.trace.picture_focus import PictureFocus
from render.trace.splats.bins import MOST_PLANES, bin_edges
from render.trace.splats.drawing import SplatDrawer

TEXELS_PER_PX = 2.0
"""Texels of a plane per pixel of the picture along each axis: 200,000 splats as fine as pixels are 44 dB from the reference, and
41 dB with 1.5 texels."""
LEAST_SPREAD = 0.2
"""Least variance of an ellipse along each axis, square texels: a narrower one falls between texels."""
MOST_BYTES = 768 << 20
"""Limit on the memory of the planes; beyond it they are coarser."""


@dataclass(frozen=True, eq=False)
class SplatPlan:
    """Bins of the splats of a picture.

    Attributes:
        splats: splats in the view of all layers.
        edges: ``(n + 1,)`` rows of the splats, far to near, between which the bins lie.
        places: ``(n, 3)`` mean, least and greatest w of each bin's splats, 1/m, far to near.
        texel_scale: texels of the planes per layer pixel.
        owners: clouds whose shares in the opacity are drawn too: the first of three for each slice of a plane behind its light;
            `HELD_OUT` for holdouts.
    """

    splats: ProjectedSplats
    edges: LongArray
    places: DoubleArray
    texel_scale: float
    owners: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class SplatPlanes:
    """Planes over some layers; valid until the next drawing.

    Attributes:
        texture: RGBA16F, a slice for each plane, near to far; with mattes of several clouds, as many again for each three of
            them, with their shares in the opacity.
        places: ``(n, 2)`` w of each, and the greatest w of its splats, 1/m.
        scale: texture coordinates per layer pixel.
        corner: layer pixel, counted in the whole picture's layers, at the texture's corner.
        has_holdouts: whether the first slices behind the planes' own have the opacity of holdouts.
    """

    texture: moderngl.TextureArray
    places: DoubleArray
    scale: tuple[float, float]
    corner: tuple[float, float]
    has_holdouts: bool = False

    def bind(self, program: moderngl.ComputeShader, unit: int, clouds: Sequence[int] = ()) -> None:
        """Bind the planes as ``trace/splat_planes.glsl`` reads them; ``clouds``: numbers of the clouds for mattes."""
        places = np.zeros((MOST_PLANES, 2))
        places[: len(self.places)] = self.places
        self.texture.use(unit)
        set_uniforms(program, splat_planes=unit, splat_count=len(self.places))
        set_uniforms(program, splat_scale=self.scale, splat_corner=self.corner)
        set_uniforms(program, splat_places=[tuple(place) for place in places.tolist()])
        if clouds:
            numbers = [*clouds, *[0] * (MOST_MATTE_CLOUDS - len(clouds))]
            set_uniforms(program, cloud_count=len(clouds), cloud_numbers=numbers)


class SplatPainter:
    """Draws planes of splats. The projection and the texture are kept for the next picture of the same view.

    Args:
        ctx: context of the device.
        programs: its programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx = ctx
        self._programs = programs
        self._drawer = SplatDrawer(ctx, programs, {})
        self._sharer: SplatDrawer | None = None
        self._texture: moderngl.TextureArray | None = None
        self._projected: tuple[Sequence[SplatBatch], float, ProjectedSplats] | None = None

    def plan(
        self,
        batches: Sequence[SplatBatch],
        wide: PinholeView,
        view: PinholeView,
        focus: PictureFocus,
        pupil_m: float,
        held: tuple[int, int] | None = None,
        *,
        with_mattes: bool = False,
    ) -> SplatPlan | None:
        """Cut the splats of a picture into bins; None where it sees none.

        Args:
            batches: the scene's splats.
            wide: view of all layers.
            view: view of the picture.
            focus: where it is focused.
            pupil_m: radius of the pupil.
            held: size of the layers that are traced at once; None for all.
            with_mattes: whether clouds are told apart.
        """
        owners = _owners(batches, with_mattes=with_mattes)
        w_f, pupil = focus.over_picture()
        focus_w = float(w_f.min()), float(w_f.max())
        pupil_px = max(view.fx, view.fy) * pupil_m * float(pupil.max())
        scale = wide.fx / view.fx
        width, height = held or wide.size
        texels = min(1.0, TEXELS_PER_PX / scale)
        while True:
            splats = self._project(batches, wide, _low_pass_px2(scale, texels))
            if not len(splats.w):
                return None
            edges = bin_edges((float(splats.w[0]), float(splats.w[-1])), focus_w, pupil_px)
            rows = np.searchsorted(splats.w, edges[::-1][1:-1].astype(np.float32))
            rows = np.unique(np.array([0, *rows, len(splats.w)], np.int64))
            most = float(np.sqrt(MOST_BYTES / (8.0 * (1 + len(owners)) * (len(rows) - 1) * width * height)))
            if texels <= most:
                break
            texels = 0.99 * most
        places = [_place(splats, first, last) for first, last in pairwise(rows.tolist())]
        return SplatPlan(splats, rows, np.array(places), texels, owners)

    def draw(self, plan: SplatPlan, layers: Layers) -> SplatPlanes:
        """Draw the planes over layers, which may be a part of those that were planned for."""
        texels, count = plan.texel_scale, len(plan.places)
        # whole texels from the corner of all layers: a part has the same ones
        first = [int(np.floor(place * texels)) for place in layers.origin]
        width, height = (int(np.ceil(side * texels)) + 1 for side in layers.view.size)
        corner = first[0] / texels, first[1] / texels
        texture = self._allocate((width, height, (1 + len(plan.owners)) * count))
        if plan.owners and self._sharer is None:
            self._sharer = SplatDrawer(self._ctx, self._programs, {"OWNERS": 1})
        for kind, owner in enumerate((-1, *plan.owners)):
            drawer = self._drawer if kind == 0 or self._sharer is None else self._sharer
            with drawer.drawing():
                for number in range(count):
                    far, near = plan.places[count - 1 - number, 1:]
                    rows = int(plan.edges[count - 1 - number]), int(plan.edges[count - number])
                    drawer.draw(
                        plan.splats,
                        rows,
                        texture,
                        kind * count + number,
                        {"packed_w": layers.targets.packed_w[0]},
                        corner_px=corner,
                        layers_px=tuple(map(float, layers.origin)),
                        texel_scale=texels,
                        bin=(float(far), float(near)),
                        first_owner=owner,
                    )
        scale = texels / width, texels / height
        return SplatPlanes(texture, plan.places[::-1, [0, 2]], scale, corner, HELD_OUT in plan.owners)

    def release(self) -> None:
        """Release the memory."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None
        self._projected = None
        self._drawer.release()
        if self._sharer is not None:
            self._sharer.release()

    def _project(self, batches: Sequence[SplatBatch], wide: PinholeView, low_pass_px2: float) -> ProjectedSplats:
        kept = self._projected
        if kept is None or kept[0] is not batches or kept[1] != low_pass_px2 or not kept[2].view.matches(wide):
            kept = self._projected = batches, low_pass_px2, project_splats(batches, wide, low_pass_px2)
        return kept[2]

    def _allocate(self, size: tuple[int, int, int]) -> moderngl.TextureArray:
        if self._texture is None or self._texture.size != size:
            if self._texture is not None:
                self._texture.release()
                self._texture = None
            try:
                self._texture = self._ctx.texture_array(size, 4, dtype="f2")
            except moderngl.Error as error:
                raise GraphicsError(f"the device cannot hold {size[2]} planes of splats: {error}") from error
            self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            self._texture.repeat_x = self._texture.repeat_y = False
        return self._texture


def _owners(batches: Sequence[SplatBatch], *, with_mattes: bool) -> tuple[int, ...]:
    """`SplatPlan.owners`: holdouts where there are some, and with mattes of several clouds all of them."""
    held = (HELD_OUT,) if any(batch.is_holdout for batch in batches) else ()
    return held + tuple(range(0, len(batches), 3) if with_mattes and len(batches) > 1 else ())


def _low_pass_px2(scale: float, texels: float) -> float:
    """Variance that ellipses are widened by, square layer pixels.

    Args:
        scale: layer pixels per pixel of the picture.
        texels: texels per layer pixel.
    """
    return max(LOW_PASS_PX2 * scale**2, LEAST_SPREAD / texels**2)


def _place(splats: ProjectedSplats, first: int, last: int) -> tuple[float, float, float]:
    """Mean w of some splats, by the light that they hide, and their least and greatest."""
    own = splats.records[first:last].astype(np.float64)
    weights = own[:, 3] * own[:, 4] * own[:, 6]
    return float(np.average(own[:, 2], weights=weights)), float(own[0, 2]), float(own[-1, 2])
