"""Depth peeling from the centre of the entrance pupil: layer behind layer, each clear of the umbra of the one before.

Lee, Eisemann & Seidel 2010, section 3.1; `render.layers.umbra` has the umbra and how many layers there can be.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.index import Draw, SceneIndex
from render.layers.lighting import Lighting
from render.layers.movement import Movement
from render.layers.moving_draws import MovingDraws
from render.layers.nearest import nearest_depth_m
from render.layers.renderer import LayerPass, LayerRenderer
from render.layers.shadows import Sphere, sphere_around
from render.layers.surface_sampling import PLAIN, SurfaceSampling
from render.layers.targets import LAYERS_PER_PACK, LayerTargets, SurfaceTargets, check_layer_size
from render.layers.umbra import HIDES_ALL, layers_needed, umbra_reach
from render.model.arrays import DoubleArray
from render.model.limits import MAX_LAYERS
from render.model.scene import Scene
from render.optics.view import PinholeView

__all__ = ["HIDES_ALL", "LayerGroup", "Layers", "Peeler", "layers_needed", "umbra_reach"]

PICTURE, PREVIEW, SKETCH = "picture", "preview", "sketch"
"""Places where layers are kept: of pictures as they are asked for, of the small ones before them, and of smaller ones yet."""
MAX_PINHOLE_LAYERS = 64
"""Surfaces that are composited at most behind one pixel of a pinhole's picture."""


@dataclass(frozen=True)
class Layers:
    """A peeled scene. Valid until the next peeling.

    Attributes:
        view: what the layers' pixels see.
        targets: the textures. Channels of inverse depth from ``count`` on are 0 in a texture whose first layer is below
            ``count``; textures and slices from there on hold what an earlier peeling left.
        count: layers that hold something.
        may_be_faded: whether a surface of them may be partly transparent.
        may_move: whether a surface of them may move, and the targets keep how.
    """

    view: PinholeView
    targets: LayerTargets
    count: int
    may_be_faded: bool = True
    may_move: bool = False


@dataclass(frozen=True)
class LayerGroup:
    """Up to four layers of a pinhole's picture, near to far. Valid until the next group or peeling.

    Attributes:
        targets: the textures.
        slot: of the targets in which the first of them is; a multiple of four.
        count: how many hold something.
        is_first: whether nothing is nearer.
        is_last: whether nothing is farther.
    """

    targets: LayerTargets
    slot: int
    count: int
    is_first: bool
    is_last: bool


@dataclass(frozen=True)
class PeelKey:
    """Parameters of a peeling: equal keys give equal layers."""

    view: PinholeView
    layers: int
    umbra: float
    unlit: bool
    sampling: SurfaceSampling

    def is_like(self, other: PeelKey) -> bool:
        """Whether the same was asked."""
        return self.view.is_like(other.view) and replace(self, view=other.view) == other


class Peeler:
    """Peels scenes: owns the render index, the renderer, the lighting and the layers' textures of one context."""

    def __init__(self, graphics: GraphicsContext, programs: ProgramCache) -> None:
        self._ctx = graphics.ctx
        # on a CPU, anisotropic look-ups triple the time of a textured layer, and the layers are supersampled anyway
        self.index = SceneIndex(anisotropy=1.0 if graphics.is_software else 8.0)
        self._renderer = LayerRenderer(self.index, graphics.cancellation)
        self._lighting = Lighting(self._renderer, programs)
        self._targets: dict[str, LayerTargets] = {}
        self._kept: dict[str, tuple[PeelKey, Layers]] = {}
        self._surfaces: SurfaceTargets | None = None
        self._scene: Scene | None = None
        self._interest: Sphere | None = None

    def load(self, scene: Scene, interest: Sphere | None = None, *, is_preview: bool = False) -> None:
        """Upload a scene: what is new in it, its lights and its shadows. Does nothing for the scene that is loaded.

        Args:
            scene: what to upload.
            interest: where a distant light's shadows are wanted; everywhere, where the scene is no larger.
            is_preview: whether those of about the same place will do, so that they need not follow each turn of the focus.
        """
        if is_preview and interest is not None and self._interest is not None and interest.is_about(self._interest):
            interest = self._interest
        if scene is self._scene and interest == self._interest:
            return
        is_new, self._scene = scene is not self._scene, None  # nothing is loaded until all of it is
        if is_new:
            self.index.update(scene)
            self._renderer.upload()
            self._lighting.load(scene)
            self._kept = {}
        if self._lighting.cast_shadows(sphere_around(self._all_corners()), interest, self.index.draws):
            self._kept = {}
        self._scene, self._interest = scene, interest

    def holds(self, scene: Scene) -> bool:
        """Whether a scene is loaded, whatever it is that its shadows are wanted for.

        Args:
            scene: as `load` takes it.
        """
        return scene is self._scene

    @property
    def is_opaque(self) -> bool:
        """Whether no surface of the loaded scene can be seen through; cut-outs, which are there or are not, cannot."""
        return not _any_faded(self.index.draws)

    def nearest_w(self, view: PinholeView) -> float:
        """The largest inverse depth of anything in view, 1/m: at most ``1 / view.near_m``, 0 where nothing is.

        It is that of a triangle, found by a search through boxes without drawing (`render.layers.nearest`): never too small,
        and a little too large only where the nearest triangle is cut by a corner of the view, is a hole or shows its back.
        """
        return 1.0 / nearest_depth_m(self.index, view)

    def peel(
        self,
        view: PinholeView,
        *,
        layers: int,
        umbra: float,
        unlit: bool = False,
        sampling: SurfaceSampling = PLAIN,
        moves: Mapping[int, Movement] | None = None,
        cache_slot: str = PICTURE,
    ) -> Layers:
        """Peel the loaded scene; where that is what was peeled there last, nothing is drawn, and the answer is the same object.

        Surfaces that are partly transparent hide nothing and are peeled one by one; the last layer skips them where something
        opaque is behind, so that where they are more than the layers, some of them are lost and never what is solid.

        Args:
            view: the picture that the layers are drawn for, guard band included.
            layers: at most this many, up to `MAX_LAYERS`; fewer where the scene is opaque and `layers_needed` says so.
            umbra: reach of an opaque surface's umbra in inverse depth, 1/m: `umbra_reach`, or `HIDES_ALL`; shorter by itself
                where surfaces move apart.
            unlit: take base colour for radiance.
            sampling: how finely the finished picture samples surfaces.
            moves: how batches move (`render.layers.movement`), where the layers shall keep it.
            cache_slot: a name for where the layers are kept. Those of one place are valid until the next peeling there.
        """
        asked = PeelKey(view, layers, umbra, unlit, sampling)
        kept = self._kept.pop(cache_slot, None)
        if kept is not None and not moves and kept[0].is_like(asked):
            self._kept[cache_slot] = kept
            return kept[1]
        made = self._peeled(asked, moves or {}, cache_slot)
        if not moves:
            self._kept[cache_slot] = asked, made
        return made

    def keeps(self, view: PinholeView, *, unlit: bool, cache_slot: str) -> bool:
        """Whether layers of this view are kept at a cache_slot, however many and for whatever pupil."""
        kept = self._kept.get(cache_slot)
        return kept is not None and kept[0].unlit == unlit and kept[0].view.is_like(view)

    def _peeled(self, asked: PeelKey, moves: Mapping[int, Movement], cache_slot: str) -> Layers:
        view, layers, umbra, unlit, sampling = asked.view, asked.layers, asked.umbra, asked.unlit, asked.sampling
        self._light(view)
        draws = self._renderer.seen(view)
        layers = min(layers, MAX_LAYERS)
        faded = _any_faded(draws)
        if not faded and not any(id(draw.batch) in moves for draw in draws):
            layers = min(layers, layers_needed(1 / umbra, self.nearest_w(view)))
        with MovingDraws(self._ctx, draws, moves, view.camera_from_world) as moving:
            targets = self._sized_targets(view, layers, cache_slot, motion=moving.any)
            self._lighting.draw_background(view, targets)
            slots = targets.slots
            layer = LayerPass(view, draws, slots[0], umbra, None, layers == 1, unlit, sampling)
            if targets.motion is not None and moving.any:
                layer = replace(layer, moving=moving, motion=targets.motion)
            count = 0
            while self._draw_counted(layer):
                count += 1
                if count == layers:
                    break
                solid_first = count + 1 == layers
                layer = replace(layer, slot=slots[count], previous=layer.slot, number=count, solid_first=solid_first)
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
            self._ctx.memory_barrier()
        return Layers(view, targets, count, faded, moving.any)

    def groups(
        self, view: PinholeView, *, unlit: bool = False, sampling: SurfaceSampling = PLAIN
    ) -> Iterator[LayerGroup]:
        """Peel all that a pinhole sees of the loaded scene, four layers at a time, until nothing is left.

        Where `MAX_PINHOLE_LAYERS` are not enough, the last one skips what is transparent, as in `peel`.

        Args:
            view: from the pinhole.
            unlit: take base colour for radiance.
            sampling: how finely the finished picture samples surfaces.
        """
        self._light(view)
        draws = self._renderer.seen(view)
        layers = MAX_PINHOLE_LAYERS if _any_faded(draws) else 1
        self._kept.pop(PICTURE, None)
        targets = self._sized_targets(view, min(layers, 2 * LAYERS_PER_PACK), PICTURE)
        self._lighting.draw_background(view, targets)
        previous = None
        for first in range(0, layers, LAYERS_PER_PACK):
            count = 0
            for number in range(first, min(first + LAYERS_PER_PACK, layers)):
                slot = targets.slots[number % len(targets.slots)]
                solid = number + 1 == layers
                if not self._draw_counted(LayerPass(view, draws, slot, HIDES_ALL, previous, solid, unlit, sampling)):
                    break
                count, previous = count + 1, slot
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
            self._ctx.memory_barrier()
            last = count < LAYERS_PER_PACK or first + LAYERS_PER_PACK >= layers
            yield LayerGroup(targets, first % len(targets.slots), count, first == 0, last)
            if last:
                return

    def surfaces(self, view: PinholeView) -> SurfaceTargets:
        """Where and what the nearest surfaces are, at each pixel's centre. Valid until the next call."""
        self._light(view)
        targets = self._surfaces
        if targets is None or (targets.width, targets.height) != (view.width, view.height):
            check_layer_size(self._ctx, view.width, view.height)
            if targets is not None:
                targets.release()
                self._surfaces = None
            targets = self._surfaces = SurfaceTargets.make(self._ctx, view.width, view.height)
        targets.clear_ids()
        self._renderer.draw_layer(LayerPass(view, self._renderer.seen(view), targets.slot, unlit=True))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        return targets

    def forget(self) -> None:
        """Have the next peeling draw, whatever was peeled last: for who measures it."""
        self._kept = {}

    def release(self) -> None:
        """Give all memory on the device back."""
        self._kept = {}
        for targets in (*self._targets.values(), self._surfaces):
            if targets is not None:
                targets.release()
        self._lighting.release()
        self._renderer.delete()

    def _all_corners(self) -> DoubleArray:
        corners = [draw.corners for draw in self.index.draws]
        return np.concatenate(corners) if corners else np.zeros((0, 3))

    def _light(self, view: PinholeView) -> None:
        if self._scene is None:
            raise GraphicsError("no scene is loaded: call load() first")
        self._lighting.bind(view)

    def _draw_counted(self, layer: LayerPass) -> bool:
        """Draw a layer and say whether any pixel of it was filled (an occlusion query)."""
        query = GL.glGenQueries(1)
        name = int(np.ravel(query)[0])
        GL.glBeginQuery(GL.GL_ANY_SAMPLES_PASSED, name)
        try:
            self._renderer.draw_layer(layer)
        finally:
            GL.glEndQuery(GL.GL_ANY_SAMPLES_PASSED)
            # Mesa 22's rasteriser takes a query's result for ready, and its memory for its own, while scenes are still drawn
            self._ctx.finish()
            passed = int(np.ravel(GL.glGetQueryObjectuiv(name, GL.GL_QUERY_RESULT))[0])
            GL.glDeleteQueries(1, [name])
        return passed != 0

    def _sized_targets(self, view: PinholeView, layers: int, cache_slot: str, *, motion: bool = False) -> LayerTargets:
        """Targets of the view's size for so many layers, or for more where more were asked before."""
        targets = self._targets.get(cache_slot)
        if targets is None or not targets.hold(view.width, view.height, layers, motion=motion):
            check_layer_size(self._ctx, view.width, view.height)
            if targets is not None:
                targets.release()
                del self._targets[cache_slot]
            targets = self._targets[cache_slot] = LayerTargets.make(
                self._ctx, view.width, view.height, layers, motion=motion
            )
        return targets


def _any_faded(draws: list[Draw]) -> bool:
    return any(draw.may_be_faded for draw in draws)
