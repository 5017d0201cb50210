"""Highlights: what is small, bright and blurred is carried from its texel to the pixels of its blurred image.

A ray that goes out to find a small lamp mostly misses it, and the lamp's blurred image is made of dots. The excess of such a
texel over its surroundings is taken out of what rays see, and is added to each pixel of its blurred image along the one ray that
joins pixel and texel through the pupil (``highlights/carry.frag``): through any iris, and through lens tables by Newton's method,
wavelength by wavelength. Where a table's blurred image is uneven or folds (caustics), the pupil is divided into cells, and each
sends its light to the pixels under its image (`render.trace.highlights.scattering`). The expectation of the picture stays the
same. Pictures in tiles and motion by velocities are left to the rays.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TypeVar

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.nbuffers import NBuffers
from render.layers.peel import Layers
from render.model.arrays import FloatArray
from render.optics.view import PinholeView
from render.trace.focal_map import FocalMaps
from render.trace.highlights.choice import CONNECTIONS_PER_RAY, choose_highlights
from render.trace.highlights.evenness import grid_changes
from render.trace.highlights.grouping import group_highlights
from render.trace.highlights.iris_levels import bind_iris, iris_levels
from render.trace.highlights.light_balance import balance_light
from render.trace.highlights.scattering import UNEVEN, Scatterer
from render.trace.highlights.search import Picture, find_highlights, measure_means
from render.trace.lens_table import GridTable, PolynomialTable
from render.trace.picture_focus import PictureFocus
from render.trace.ray_buffers import RayBuffers
from render.trace.rays import RayBundle

_LIST, _PLANS, _IMAGE = 0, 1, 2  # as the shaders bind them
_GROUP = 64
_PLAN = np.dtype(
    [
        ("excess", "f4", 4),
        ("box", "f4", 4),
        ("bins", "u4", 2),
        ("front", "u4"),
        ("cells", "u4"),
        ("base", "u4", 2),
        ("exact", "u4", 2),
    ]
)
_INSTANCE = np.dtype([("box", "f4", 4), ("excess", "f4", 4), ("place", "f4", 2), ("front", "u4"), ("bins", "u4", 2)])
_ATTRIBUTES = ("in_box", "in_excess", "in_place", "in_front", "in_bins")

Step = TypeVar("Step")


class CarriedHighlights:
    """Highlights of one picture, drawn.

    Attributes:
        light: ``(height, width, 3)`` radiance that they add to the picture; None where there are none.
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
        """Run a generator that traces rays through the layers, which lack the highlights while a step of it runs."""
        while True:
            with self._taken_out():
                try:
                    step = next(work)
                except StopIteration:
                    return
            yield step

    def add_to(self, picture: FloatArray) -> FloatArray:
        """Add the highlights' light to a picture ``(height, width, 4)`` of the rays."""
        if self.light is not None:
            picture[..., :3] += self.light
        return picture

    @contextmanager
    def _taken_out(self) -> Iterator[None]:
        """Replace the highlights in the layers; they are put back whatever happens."""
        if self._taken is None:
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
        self._buffers = RayBuffers(ctx)
        self._scatterer = Scatterer(ctx, programs, cancellation, self._buffers)
        self.nothing = CarriedHighlights(ctx, programs)

    def carry(
        self, layers: Layers, nbuffers: NBuffers, bundle: RayBundle, focus: PictureFocus, view: PinholeView
    ) -> CarriedHighlights:
        """Find the highlights of a picture, and draw the light that they add to it.

        Args:
            layers: layers from the picture's own eye, at any resolution and with any margin.
            nbuffers: N-buffers of those layers.
            bundle: rays of the lens.
            focus: focal surface.
            view: projection of the picture.
        """
        if bundle.pattern.whole == 1 or bundle.reach_m <= 0 or layers.count == 0:
            return self.nothing
        if isinstance(bundle.table, PolynomialTable) and bundle.pattern.iris_points is None:
            bundle = replace(bundle, table=balance_light(bundle.table))
        focal_map = None if focus.affine is not None else self._maps.draw(focus)
        picture = Picture(layers, nbuffers, bundle, focus, focal_map, view)
        with Resources() as scope:
            means = scope.keep(measure_means(self._ctx, self._programs, picture))
            texels = find_highlights(self._ctx, self._programs, picture, means)
            self._cancellation.poll()
            if len(texels) == 0:
                return self.nothing
            scope.callback(self._buffers.release)
            plans = self._plan(picture, means, texels)
            rays = min(bundle.count, bundle.pattern.whole)
            most = CONNECTIONS_PER_RAY * rays * view.width * view.height / len(bundle.rgb)
            groups = group_highlights(texels, plans, picture.group_side, picture.blur_px)
            corners, grouped = (0, 0, view.width, view.height), groups.plans
            choice = choose_highlights(grouped["excess"][:, :3], grouped["box"], grouped["cells"], corners, most)
            if len(choice.numbers) == 0:
                return self.nothing
            chosen = groups.places[choice.numbers], grouped[choice.numbers]
            light = self._light(picture, *chosen, choice.connections)
        is_taken = np.isin(groups.owners, choice.numbers)
        texels, plans = texels[is_taken], plans[is_taken]
        taken = np.concatenate([_packed(texels), plans["base"], plans["exact"]], axis=1)
        return CarriedHighlights(self._ctx, self._programs, layers, taken, light)

    def release(self) -> None:
        """Release the memory."""
        self._maps.release()
        self._buffers.release()

    def _plan(self, picture: Picture, means: moderngl.Texture, texels: NDArray[np.uint32]) -> NDArray[np.void]:
        program = self._programs.compute(
            "highlights/plan.comp", picture.defines | self._buffers.defines(picture.bundle)
        )
        unit = picture.bind(program)
        means.use(unit)
        set_uniforms(program, means=unit, count=len(texels))
        if isinstance(picture.bundle.table, GridTable):
            set_uniforms(program, grid_changes=grid_changes(picture.bundle.table))
        with Resources() as scope:
            places = scope.keep(self._ctx.buffer(_packed(texels).tobytes()))
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

    def _light(
        self, picture: Picture, places: FloatArray, plans: NDArray[np.void], connections: NDArray[np.float64]
    ) -> FloatArray:
        """Light of highlights at places of the layers, ``(height, width, 3)``."""
        scattered = plans["cells"] > 0
        light = np.zeros((picture.view.height, picture.view.width, 3), np.float32)
        if not scattered.all():
            even = ~scattered
            light += self._draw(picture, places[even], plans[even], connections[even])
        if scattered.any():
            light += self._scatterer.scatter(picture, places[scattered], plans[scattered])
        return light

    def _draw(
        self, picture: Picture, places: FloatArray, plans: NDArray[np.void], connections: NDArray[np.float64]
    ) -> FloatArray:
        """Draw the blurred images of highlights, ``(height, width, 3)``."""
        view, bundle = picture.view, picture.bundle
        program = self._programs.drawing(
            "highlights/carry.vert", "highlights/carry.frag", picture.defines | self._buffers.defines(bundle)
        )
        unit = picture.bind(program)
        set_uniforms(program, picture=(view.width, view.height))
        with Resources() as scope:
            iris = bundle.pattern.iris_image
            if iris is not None:
                bind_iris(program, scope.keep(iris_levels(self._ctx, iris)), iris, unit)
            self._buffers.bind(program, bundle, first_unit=unit + 1)
            canvas = scope.keep(self._ctx.texture((view.width, view.height), 4, dtype="f4"))
            target = scope.keep(self._ctx.framebuffer(color_attachments=[canvas]))
            scope.callback(self._stop_drawing, self._ctx.detect_framebuffer())
            target.use()
            target.viewport = (0, 0, view.width, view.height)
            target.clear(0.0, 0.0, 0.0, 0.0)
            self._ctx.enable_only(moderngl.BLEND)
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE
            for wavelength, rgb in enumerate(bundle.rgb * bundle.transmittance):
                self._buffers.choose_wavelength(program, bundle, wavelength)
                set_uniforms(program, light=tuple(rgb))
                for some in self._pieces(connections):
                    self._draw_some(program, _instances(places[some], plans[some]))
                    self._piece.learn(int(connections[some].sum()), self._cancellation.poll())
            self._ctx.memory_barrier()
            drawn = np.frombuffer(canvas.read(), np.float32).reshape(view.height, view.width, 4)
        return drawn[..., :3].copy()

    def _draw_some(self, program: moderngl.Program, instances: NDArray[np.void]) -> None:
        with Resources() as scope:
            buffer = scope.keep(self._ctx.buffer(instances.tobytes()))
            layout = (buffer, "4f4 4f4 2f4 1u4 2u4 /i", *_ATTRIBUTES)
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


def _packed(texels: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Texels ``(n, 2)`` as the shaders read them: x and y, layer."""
    return np.stack([texels[:, 0] | texels[:, 1] << np.uint32(16), texels[:, 2]], axis=1)


def _instances(places: FloatArray, plans: NDArray[np.void]) -> NDArray[np.void]:
    instances = np.zeros(len(places), _INSTANCE)
    instances["place"] = places
    for name in ("box", "excess", "front", "bins"):
        instances[name] = plans[name]
    return instances
