"""Highlights: what is small, bright and blurred is carried from its texel to the pixels of its blurred image.

A ray that goes out to find a small lamp mostly misses it, and the lamp's blurred image is made of dots. The excess of such a
texel over its surroundings is taken out of what rays see, and is added to each pixel of its blurred image along the one ray that
joins pixel and texel through the pupil (``highlights/carry.frag``): through any iris, and through lens tables by Newton's method,
wavelength by wavelength. Neighbouring texels that are small beside that image are carried as one
(`render.trace.highlights.grouping`). Where a table's blurred image is uneven or folds (caustics), the pupil is divided into
cells, and each sends its light to the pixels under its image (`render.trace.highlights.scattering`). The expectation of the
picture stays the same. A picture in tiles finds the highlights of each strip of its layers once, and carries them to the pixels
of each tile in turn. In motion by velocities they are chosen and carried anew for each moment: texels, and what is in front of
them, are where they have moved to, as the moment's camera sees them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from time import perf_counter
from typing import TypeVar

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.movers import Movers
from render.layers.nbuffers import NBuffers
from render.layers.peeled import Layers
from render.model.area import Area
from render.model.arrays import FloatArray
from render.optics.view import PinholeView
from render.trace.focal_map import FocalMaps
from render.trace.highlights.chosen import NONE, Highlights, pixels_seen
from render.trace.highlights.finder import HighlightFinder
from render.trace.highlights.iris_levels import bind_iris, iris_levels
from render.trace.highlights.light_balance import balance_light
from render.trace.highlights.scattering import Scatterer
from render.trace.highlights.search import Picture
from render.trace.lens_table import PolynomialTable
from render.trace.moment_view import MomentView
from render.trace.picture_focus import PictureFocus
from render.trace.ray_buffers import RayBuffers
from render.trace.rays import RayBundle

STEP_MS = 100.0
"""Time of a step of work between which highlights are put back into the layers: to replace them for each of its pieces would take
longer than the pieces."""
_LIST, _IMAGE = 0, 2  # as the shaders bind them
_GROUP = 64
_INSTANCE = np.dtype([("box", "f4", 4), ("excess", "f4", 4), ("place", "f4", 4)])
_ATTRIBUTES = ("in_box", "in_excess", "in_place")

Step = TypeVar("Step")
SeenMoment = tuple[RayBundle, PictureFocus, MomentView]
"""A moment of the exposure: rays of its lens, focal surface and camera."""


class CarriedHighlights:
    """Highlights of one picture or of one tile, drawn.

    Attributes:
        light: ``(height, width, 3)`` radiance that they add to it; None where there are none.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        layers: Layers | None = None,
        taken: NDArray[np.uint32] | None = None,
        light: FloatArray | None = None,
    ) -> None:
        self._ctx, self._programs, self._layers = ctx, programs, layers
        self._taken, self.light = taken, light

    def without(self, work: Iterator[Step]) -> Iterator[Step]:
        """Run a generator that traces rays through the layers, which lack the highlights while it runs and have them between two
        steps. A step takes up its pieces until `STEP_MS` are over.
        """
        is_done = False
        while not is_done:
            last: list[Step] = []
            with self._taken_out():
                is_done, until = True, perf_counter() + STEP_MS / 1000
                for step in work:
                    last = [step]
                    if self._is_empty or perf_counter() >= until:
                        is_done = False
                        break
            yield from last

    def add_to(self, picture: FloatArray) -> FloatArray:
        """Add the highlights' light to a picture ``(height, width, 4)`` of the rays."""
        if self.light is not None:
            picture[..., :3] += self.light
        return picture

    @property
    def _is_empty(self) -> bool:
        return self._taken is None or len(self._taken) == 0

    @contextmanager
    def _taken_out(self) -> Iterator[None]:
        """Replace the highlights in the layers; they are put back whatever happens."""
        if self._taken is None or self._is_empty:
            yield
            return
        with Resources() as scope:
            taken = scope.keep(self._ctx.buffer(self._taken.tobytes()))
            try:
                self._write(taken, put_back=False)
                yield
            finally:
                self._write(taken, put_back=True)

    def _write(self, taken: moderngl.Buffer, *, put_back: bool) -> None:
        if self._taken is None or self._layers is None:
            return
        program = self._programs.compute("highlights/take.comp")
        taken.bind_to_storage_buffer(_LIST)
        self._layers.targets.radiance.bind_to_image(_IMAGE, read=False, write=True)
        set_uniforms(program, count=len(self._taken), put_back=put_back)
        program.run(-(-len(self._taken) // _GROUP))
        self._ctx.memory_barrier()


class HighlightCarrier:
    """Finds the highlights of pictures and draws their blurred images.

    Attributes:
        nothing: for a picture whose highlights are left to the rays.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._cancellation, self._piece = cancellation, PieceSize(1 << 16)
        self._maps = FocalMaps(ctx, programs)
        self._mapped: tuple[PictureFocus, moderngl.Texture] | None = None
        self._buffers = RayBuffers(ctx)
        self._finder = HighlightFinder(ctx, programs, cancellation, self._buffers)
        self._scatterer = Scatterer(ctx, programs, cancellation, self._buffers)
        self.nothing = CarriedHighlights(ctx, programs)

    def search(self, layers: Layers, moments: Iterable[SeenMoment], movers: Movers | None) -> NDArray[np.uint32] | None:
        """Search layers for texels that are highlights at any of some moments: ``(n, 3)`` x, y and layer. None without blur.

        Args:
            layers: peeled in the middle of the exposure.
            moments: the moments.
            movers: moving surfaces of the layers.
        """
        blurred = [moment for moment in moments if _is_blurred(layers, moment[0])]
        if not blurred:
            return None
        return self._finder.search(
            self._picture(layers, None, bundle, focus, moment_view.view, moment_view, movers)
            for bundle, focus, moment_view in blurred
        )

    def search_focused(
        self, layers: Layers, bundle: RayBundle, focused: Iterable[PictureFocus], view: PinholeView
    ) -> NDArray[np.uint32] | None:
        """Search layers for texels that are highlights with any of some focal surfaces; as `search`.

        Args:
            layers: as for `find`.
            bundle: rays of the lens.
            focused: the focal surfaces.
            view: projection of the picture.
        """
        if not _is_blurred(layers, bundle):
            return None
        return self._finder.search(self._picture(layers, None, bundle, focus, view, None, None) for focus in focused)

    def find(
        self,
        layers: Layers,
        bundle: RayBundle,
        focus: PictureFocus,
        view: PinholeView,
        share: float = 1.0,
        *,
        moment_view: MomentView | None = None,
        movers: Movers | None = None,
        area: Area | None = None,
        candidates: NDArray[np.uint32] | None = None,
    ) -> Highlights:
        """Find the highlights of layers, and choose those to be carried.

        Args:
            layers: layers from the picture's own eye (or that of ``moment_view``), at any resolution and with any margin, or a
                strip of them.
            bundle: rays of the lens.
            focus: focal surface.
            view: projection of the picture.
            share: share that these layers have in all of the picture's, and so in its connections.
            moment_view: the camera at a moment, where it may have moved from the position that the layers were peeled from.
            movers: moving surfaces of the layers, set to that moment.
            area: part of the picture that is traced; None for all of it.
            candidates: texels to choose from; None to search for them.
        """
        if not _is_blurred(layers, bundle):
            return NONE
        with Resources() as scope:
            scope.callback(self._buffers.release)
            picture = self._picture(layers, None, bundle, focus, view, moment_view, movers)
            return self._finder.find(picture, share, area or (0, 0, view.width, view.height), candidates)

    def carry(
        self,
        found: Highlights,
        layers: Layers,
        nbuffers: NBuffers,
        bundle: RayBundle,
        focus: PictureFocus,
        view: PinholeView,
        area: Area | None = None,
        *,
        moment_view: MomentView | None = None,
        movers: Movers | None = None,
    ) -> CarriedHighlights:
        """Draw the light that highlights add to a picture or to a part of it.

        Args:
            found: the highlights of all layers that the part's rays reach.
            layers: those layers.
            nbuffers: N-buffers of these.
            bundle: rays of the lens.
            focus: focal surface.
            view: projection of the picture.
            area: the part; None for all of the picture.
            moment_view: as for `find`.
            movers: as for `find`.
        """
        if len(found.carried) == 0:
            return self.nothing
        area = area or (0, 0, view.width, view.height)
        picture = self._picture(layers, nbuffers, bundle, focus, view, moment_view, movers)
        scattered, light = found.carried["cells"] > 0, np.zeros((area[3], area[2], 3), np.float32)
        with Resources() as scope:
            scope.callback(self._buffers.release)
            for carried, draw in ((~scattered, self._draw), (scattered, self._scatterer.scatter)):
                if carried.any():
                    light += draw(picture, found.carried[carried], area)
        taken = found.taken_within(layers.origin, layers.view.size)
        return CarriedHighlights(self._ctx, self._programs, layers, taken, light)

    def release(self) -> None:
        """Release the memory."""
        self._mapped = None
        self._finder.release()
        self._maps.release()
        self._buffers.release()

    def _picture(
        self,
        layers: Layers,
        nbuffers: NBuffers | None,
        bundle: RayBundle,
        focus: PictureFocus,
        view: PinholeView,
        moment_view: MomentView | None,
        movers: Movers | None,
    ) -> Picture:
        if isinstance(bundle.table, PolynomialTable) and bundle.pattern.iris_points is None:
            bundle = replace(bundle, table=balance_light(bundle.table))
        return Picture(layers, nbuffers, bundle, focus, self._focal_map(focus), view, moment_view, movers)

    def _focal_map(self, focus: PictureFocus) -> moderngl.Texture | None:
        """Focal surface of the whole picture, which its tiles share; None where it is affine."""
        if focus.affine is not None:
            return None
        if self._mapped is None or self._mapped[0] is not focus:
            self._mapped = focus, self._maps.draw(focus)
        return self._mapped[1]

    def _draw(self, picture: Picture, highlights: NDArray[np.void], area: Area) -> FloatArray:
        """Draw the blurred images of highlights that are joined to pixels, ``(height, width, 3)`` of the area."""
        bundle, (left, top, width, height) = picture.bundle, area
        connections = pixels_seen(highlights["box"], area)
        highlights, connections = highlights[connections > 0], connections[connections > 0]
        if len(highlights) == 0:
            return np.zeros((height, width, 3), np.float32)
        program = self._programs.drawing(
            "highlights/carry.vert", "highlights/carry.frag", picture.defines | self._buffers.defines(bundle)
        )
        unit = picture.bind(program)
        set_uniforms(program, area_first=(left, top), area_size=(width, height))
        with Resources() as scope:
            iris = bundle.pattern.iris_image
            if iris is not None:
                bind_iris(program, scope.keep(iris_levels(self._ctx, self._programs, iris)), iris, unit)
            self._buffers.bind(program, bundle, first_unit=unit + 1)
            canvas = scope.keep(self._ctx.texture((width, height), 4, dtype="f4"))
            target = scope.keep(self._ctx.framebuffer(color_attachments=[canvas]))
            scope.callback(self._stop_drawing, self._ctx.detect_framebuffer())
            target.use()
            target.viewport = (0, 0, width, height)
            target.clear(0.0, 0.0, 0.0, 0.0)
            self._ctx.enable_only(moderngl.BLEND)
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE
            for wavelength, rgb in enumerate(bundle.rgb * bundle.transmittance):
                self._buffers.choose_wavelength(program, bundle, wavelength)
                set_uniforms(program, light=tuple(rgb))
                for some in self._pieces(connections):
                    self._draw_some(program, _instances(highlights[some]))
                    self._piece.learn(int(connections[some].sum()), self._cancellation.poll())
            self._ctx.memory_barrier()
            drawn = np.frombuffer(canvas.read(), np.float32).reshape(height, width, 4)
        return drawn[..., :3].copy()

    def _draw_some(self, program: moderngl.Program, instances: NDArray[np.void]) -> None:
        with Resources() as scope:
            buffer = scope.keep(self._ctx.buffer(instances.tobytes()))
            layout = (buffer, "4f4 4f4 4f4 /i", *_ATTRIBUTES)
            vertices = scope.keep(self._ctx.vertex_array(program, [layout]))
            vertices.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(instances))

    def _pieces(self, connections: NDArray[np.float64]) -> Iterator[slice]:
        """Divide a list of highlights: where the work can be cancelled, into pieces of some connections."""
        total, first = np.cumsum(connections), 0
        while first < len(total):
            end = len(total)
            if self._cancellation.is_cancellable:
                done = total[first - 1] if first else 0.0
                end = max(first + 1, int(np.searchsorted(total, done + self._piece.units, side="right")))
            yield slice(first, end)
            first = end

    def _stop_drawing(self, before: moderngl.Framebuffer) -> None:
        self._ctx.enable_only(moderngl.NOTHING)
        before.use()


def _is_blurred(layers: Layers, bundle: RayBundle) -> bool:
    return bundle.pattern.whole > 1 and bundle.reach_m > 0 and layers.count > 0


def _instances(highlights: NDArray[np.void]) -> NDArray[np.void]:
    instances = np.zeros(len(highlights), _INSTANCE)
    instances["excess"], instances["place"] = highlights["excess"], highlights["place"]
    instances["box"][:, :2], instances["box"][:, 2:] = (
        np.floor(highlights["box"][:, :2]),
        np.ceil(highlights["box"][:, 2:]),
    )
    return instances
