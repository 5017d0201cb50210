"""Extended-umbra depth peeling from the centre of the entrance pupil (Lee, Eisemann & Seidel 2010, section 3.1).

Each layer holds the nearest surfaces outside the umbra of the layer before; see `render.layers.umbra`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.drawing_space import DrawingSpace
from render.layers.index import Draw, SceneIndex
from render.layers.levels.sketch_index import SketchIndex
from render.layers.lighting import Lighting
from render.layers.matte_numbers import MatteNumbers, number_surfaces
from render.layers.movement import Movement
from render.layers.moving_draws import MovingDraws
from render.layers.nearest import nearest_depth_m, nearest_drawn_depth_m
from render.layers.peeled import LayerGroup, Layers
from render.layers.reach import OpenSides, ReachBounder
from render.layers.renderer import LayerPass, LayerRenderer
from render.layers.rest import RestMerger
from render.layers.selection import seen_draws
from render.layers.shading import SurfaceLighter
from render.layers.shadows import Sphere, sphere_around
from render.layers.surface_sampling import PLAIN, SurfaceSampling
from render.layers.targets import LAYERS_PER_PACK, LayerTargets, SurfaceTargets, check_layer_size
from render.layers.texture_budget import TextureBudget
from render.layers.umbra import HIDES_ALL, layers_needed, umbra_reach
from render.model.arrays import DoubleArray
from render.model.limits import MAX_LAYERS
from render.model.mattes import MatteSum
from render.model.scene import Scene
from render.model.splats import SplatBatch
from render.optics.view import PinholeView

__all__ = ["HIDES_ALL", "Peeler", "layers_needed", "umbra_reach"]

PICTURE, PREVIEW, SKETCH = "picture", "preview", "sketch"
"""Cache slots of layers: for pictures, for their small previews, and for even smaller sketches."""
MAX_PINHOLE_LAYERS = 64
"""Limit on the layers of a pinhole's picture; what is behind them is merged into the last two (`render.layers.rest`)."""


@dataclass(frozen=True)
class PeelKey:
    """Parameters of a peeling: equal keys give equal layers."""

    view: PinholeView
    layers: int
    umbra: float
    unlit: bool
    sampling: SurfaceSampling
    reachable: OpenSides | None
    sheets: int
    is_sketch: bool = False
    ids: bool = False

    def matches(self, other: PeelKey) -> bool:
        """Whether a peeling with the other key gives the same layers."""
        return self.view.matches(other.view) and replace(self, view=other.view) == other


class Peeler:
    """Peels scenes. Owns the render index, the renderer, the lighting and the layers' textures of one context.

    Attributes:
        index: the render index.
        sketches: draws of sketches.
        textures: budget of the surfaces' textures.
    """

    def __init__(self, graphics: GraphicsContext, programs: ProgramCache) -> None:
        self._ctx = graphics.ctx
        # on a CPU, anisotropic look-ups triple the time of a textured layer, and the layers are supersampled anyway
        self.index = SceneIndex(anisotropy=1.0 if graphics.is_software else 8.0)
        self.sketches = SketchIndex(self.index)
        self.textures = TextureBudget(self.index, graphics.memory_bytes)
        self._renderer = LayerRenderer(self.index, self.sketches, graphics.ctx, programs, graphics.cancellation)
        self._lighting = Lighting(self._renderer, programs, graphics.ctx)
        self._targets: dict[str, LayerTargets] = {}
        self._kept: dict[str, tuple[PeelKey, Layers]] = {}
        self._surfaces: SurfaceTargets | None = None
        self._reach = ReachBounder(graphics.ctx, programs)
        self._rest = RestMerger(graphics.ctx, programs)
        self._lighter = SurfaceLighter(graphics.ctx, programs, graphics.cancellation)
        self._scene: Scene | None = None
        self._shadow_region: Sphere | None = None

    def load(self, scene: Scene, region: Sphere | None = None, *, is_preview: bool = False) -> None:
        """Upload a scene's changes, its lights and its shadows. Does nothing for the loaded scene.

        Args:
            scene: what to upload.
            region: where a distant light's shadows are resolved; None, or a region larger than the scene, for all of it.
            is_preview: accept shadow maps of nearly the same region, so that they need not follow each change of the focus.
        """
        if (
            is_preview
            and region is not None
            and self._shadow_region is not None
            and region.is_close_to(self._shadow_region)
        ):
            region = self._shadow_region
        if self.has_shadows(scene, region):
            return
        is_new, self._scene = scene is not self._scene, None  # until all of the scene is loaded
        if is_new:
            self.index.update(scene)
            self.sketches.drop()
            self.textures.prepare()
            self._renderer.upload()
            self._lighting.load(scene)
            self._kept = {}
        casting = [draw for draw in self.index.draws if not draw.batch.material.unlit]
        if self._lighting.cast_shadows(sphere_around(_all_corners(casting)), region, casting):
            self._kept = {}
        self._scene, self._shadow_region = scene, region

    def has_scene(self, scene: Scene) -> bool:
        """Whether a scene is loaded, with shadow maps of any region.

        Args:
            scene: scene as passed to `load`.
        """
        return scene is self._scene

    def has_shadows(self, scene: Scene, region: Sphere | None) -> bool:
        """Whether a scene is loaded with shadow maps of this very region, so that `load` would do nothing."""
        return self.has_scene(scene) and region == self._shadow_region

    def number_surfaces(self, mattes: MatteSum) -> MatteNumbers:
        """Number the surfaces of the loaded scene for mattes."""
        if self._scene is None:
            raise GraphicsError("no scene is loaded: call load() first")
        return number_surfaces(self.index.draws, self._scene, mattes)

    @property
    def splats(self) -> tuple[SplatBatch, ...]:
        """Gaussian splats of the loaded scene."""
        return () if self._scene is None else self._scene.splats

    @property
    def is_opaque(self) -> bool:
        """Whether no surface of the loaded scene that the camera sees is partly transparent; cut-outs are not."""
        return not _any_translucent(seen_draws(self.index.draws))

    def nearest_w(self, view: PinholeView) -> float:
        """Largest inverse depth of any surface or splat in view from its base, 1/m: at most ``view.nearest_w``, 0 for an empty
        view.

        It is found by a search through boxes without drawing (`render.layers.nearest`). It is never too small, and a little
        too large only where the nearest triangle is clipped by a corner of the view, is cut out or faces away.
        """
        nearest_w = max(0.0, 1.0 / nearest_depth_m(self.index, view) - view.base_w)
        if not self.splats:
            return nearest_w
        from render.layers.splats import nearest_splat_w

        return max(nearest_w, nearest_splat_w(self.splats, view))

    def peel(
        self,
        view: PinholeView,
        *,
        layers: int,
        umbra: float,
        unlit: bool = False,
        sampling: SurfaceSampling = PLAIN,
        moves: Mapping[int, Movement] | None = None,
        reachable: OpenSides | None = None,
        sheets: int = 0,
        is_sketch: bool = False,
        ids: bool = False,
        cache_slot: str = PICTURE,
    ) -> Layers:
        """Peel the loaded scene. Returns the same object without drawing where the cache slot holds an equal peeling.

        Partly transparent surfaces hide nothing and are peeled one by one; the last layer skips them where an opaque surface is
        behind. Those that have no layer left are merged into the last two (`render.layers.rest`). Of the layers beyond
        ``layers``, a pixel has only those that have fewer than ``layers`` opaque surfaces in front.

        Args:
            view: the picture that the layers are drawn for, guard band included.
            layers: at most this many, up to `MAX_LAYERS`; fewer where the scene is opaque and `layers_needed` says so.
            umbra: reach of an opaque surface's umbra in inverse depth, 1/m: `umbra_reach`, or `HIDES_ALL`; shorter by itself
                where surfaces move apart.
            unlit: take base colour for radiance.
            sampling: how finely the finished picture samples surfaces.
            moves: movements of the batches (`render.layers.movement`), where the layers are to hold motion.
            reachable: sides that rays may come in through, to leave out surfaces that no ray of the umbra's pupil can meet
                (`render.layers.reach`); None to draw what is behind all layers. Has no effect where
                surfaces move.
            sheets: at most this many surfaces in a pixel, up to `MAX_LAYERS`, where some may be partly transparent: those do not
                count against ``layers``. No effect where it is less than ``layers``.
            is_sketch: draw simpler levels of meshes that are far away, where they are ready (`render.layers.levels`).
            ids: hold ids of the surfaces too.
            cache_slot: name of the slot that caches the layers, which are valid until the slot's next peeling.
        """
        key = PeelKey(view, layers, umbra, unlit, sampling, reachable, sheets, is_sketch, ids)
        return self.peel_by(key, moves=moves, cache_slot=cache_slot)

    def peel_by(
        self, key: PeelKey, *, moves: Mapping[int, Movement] | None = None, cache_slot: str = PICTURE
    ) -> Layers:
        """Peel the loaded scene by the parameters of a key; as `peel`."""
        if not moves and self.keeps(key, cache_slot=cache_slot):
            return self._kept[cache_slot][1]
        self._kept.pop(cache_slot, None)
        peeled = self._draw_layers(key, moves or {}, cache_slot)
        if not moves:
            self._kept[cache_slot] = key, peeled
        return peeled

    def keeps(self, key: PeelKey, *, cache_slot: str = PICTURE) -> bool:
        """Whether `peel_by` would return kept layers of surfaces that stand still."""
        kept = self._kept.get(cache_slot)
        return kept is not None and kept[0].matches(key)

    def has_layers(self, view: PinholeView, *, unlit: bool, cache_slot: str) -> bool:
        """Whether a cache slot holds layers of this view, for any number of layers and any pupil."""
        kept = self._kept.get(cache_slot)
        return kept is not None and kept[0].unlit == unlit and kept[0].view.matches(view)

    def _draw_layers(self, key: PeelKey, moves: Mapping[int, Movement], cache_slot: str) -> Layers:
        view, layers, umbra, unlit, sampling = key.view, key.layers, key.umbra, key.unlit, key.sampling
        self.textures.fit(view, sampling.detail)
        self._bind_lighting(view)
        nearest_w = None
        if key.is_sketch:
            if self.sketches.update():
                self._renderer.upload()
            clusters = self._renderer.sketched_clusters(view)
            nearest_w = max(0.0, 1.0 / nearest_drawn_depth_m(self.sketches, clusters, view) - view.base_w)
        draws = self._renderer.visible_draws(view, is_sketch=key.is_sketch)
        self._ctx.memory_barrier()  # after a peeling that was cancelled before its own
        layers = min(layers, MAX_LAYERS)
        faded = _any_translucent(draws)
        if not faded and not any(id(draw.batch) in moves for draw in draws):
            layers = min(layers, layers_needed(1 / umbra, self.nearest_w(view) if nearest_w is None else nearest_w))
        sheets = max(layers, min(key.sheets, MAX_LAYERS)) if faded else layers
        with MovingDraws(self._ctx, draws, moves, DrawingSpace.of_view(view).from_world) as moving:
            targets = self._allocate_targets(view, sheets, cache_slot, motion=moving.any, lit=not unlit, ids=key.ids)
            self._lighting.draw_background(view, targets)
            slots = targets.slots
            layer = LayerPass(view, draws, slots[0], umbra, None, sheets == 1, unlit, sampling, is_sketch=key.is_sketch)
            if targets.motion is not None and moving.any:
                layer = replace(layer, moving=moving, motion=targets.motion)
            count = 0
            while self._draw_and_query(layer):
                count += 1
                if count == sheets:
                    self._merge_rest(layer, targets, count - 1)
                    break
                if key.reachable is not None and not moving.any:
                    slopes = targets.packed_slopes[(count - 1) // LAYERS_PER_PACK]
                    reach = self._reach.bound(layer.slot, slopes, umbra, is_first=count == 1, open_sides=key.reachable)
                    layer = replace(layer, reach=reach)
                solid_first = count + 1 == sheets
                layer = replace(layer, slot=slots[count], previous=layer.slot, number=count, solid_first=solid_first)
                if count >= layers:
                    layer = replace(layer, most_opaque=layers, first=slots[0])
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
            self._ctx.memory_barrier()
        return Layers(view, targets, count, faded, moving.any, umbra=umbra, nearest_w=nearest_w, splats=self.splats)

    def peel_groups(
        self, view: PinholeView, *, unlit: bool = False, sampling: SurfaceSampling = PLAIN
    ) -> Iterator[LayerGroup]:
        """Peel all surfaces that a pinhole sees, four layers at a time, until none is left.

        Where `MAX_PINHOLE_LAYERS` are not enough, the rest is merged into the last two, as in `peel`.

        Args:
            view: view from the pinhole.
            unlit: take base colour for radiance.
            sampling: how finely the finished picture samples surfaces.
        """
        self.textures.fit(view, sampling.detail)
        self._bind_lighting(view)
        draws = self._renderer.visible_draws(view)
        layers = MAX_PINHOLE_LAYERS if _any_translucent(draws) else 1
        self._kept.pop(PICTURE, None)
        targets = self._allocate_targets(view, min(layers, 2 * LAYERS_PER_PACK), PICTURE, lit=not unlit)
        self._lighting.draw_background(view, targets)
        previous = None
        for first in range(0, layers, LAYERS_PER_PACK):
            count = 0
            for number in range(first, min(first + LAYERS_PER_PACK, layers)):
                slot = targets.slots[number % len(targets.slots)]
                solid = number + 1 == layers
                layer = LayerPass(view, draws, slot, HIDES_ALL, previous, solid, unlit, sampling)
                if not self._draw_and_query(layer):
                    break
                if solid:
                    self._merge_rest(layer, targets, number % len(targets.slots))
                count, previous = count + 1, slot
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
            self._ctx.memory_barrier()
            last = count < LAYERS_PER_PACK or first + LAYERS_PER_PACK >= layers
            yield LayerGroup(targets, first % len(targets.slots), count, first == 0, last)
            if last:
                return

    def draw_surfaces(self, view: PinholeView) -> SurfaceTargets:
        """Draw the nearest surfaces: inverse depth and ids at each pixel's centre. Valid until the next call."""
        self._bind_lighting(view)
        targets = self._surfaces
        if targets is None or (targets.width, targets.height) != (view.width, view.height):
            check_layer_size(self._ctx, view.width, view.height)
            if targets is not None:
                targets.release()
                self._surfaces = None
            targets = self._surfaces = SurfaceTargets.allocate(self._ctx, view.width, view.height)
        targets.clear_ids()
        self._renderer.draw_layer(LayerPass(view, self._renderer.visible_draws(view), targets.slot, unlit=True))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        return targets

    def hand_over(self, cache_slot: str) -> Layers:
        """Give the layers of a cache slot away, which stay valid until the caller releases their targets."""
        _, layers = self._kept.pop(cache_slot)
        del self._targets[cache_slot]
        return replace(layers, targets=layers.targets.without_slots())

    def clear_cache(self) -> None:
        """Discard cached layers, so that the next peeling draws: for time measurements."""
        self._kept = {}

    def release(self) -> None:
        """Release all memory on the device."""
        self._kept = {}
        for targets in (*self._targets.values(), self._surfaces):
            if targets is not None:
                targets.release()
        self._reach.release()
        self._rest.release()
        self._lighting.release()
        self.sketches.release()
        self._renderer.delete()

    def _bind_lighting(self, view: PinholeView) -> None:
        if self._scene is None:
            raise GraphicsError("no scene is loaded: call load() first")
        self._lighting.bind(view)

    def _merge_rest(self, last: LayerPass, targets: LayerTargets, index: int) -> None:
        """Merge the partly transparent surfaces that no layer holds into the last two; ``index`` is the last one's."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        self._ctx.memory_barrier()
        self._rest.merge(self._draw_and_query, last, targets, index)

    def _draw_and_query(self, layer: LayerPass) -> bool:
        """Draw a layer and light it; true where any of its pixels was filled (occlusion query)."""
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
        if passed and not layer.unlit:
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
            self._ctx.memory_barrier()
            self._lighting.bind_maps(is_sketch=layer.is_sketch)
            surfaces = (draw.batch.material for draw in layer.draws)
            has_clearcoat = any(surface.may_have_coat for surface in surfaces)
            options, by_quads = self._lighting.options(is_sketch=layer.is_sketch), layer.sampling.by_quads
            self._lighter.light(layer.slot, layer.view, options, has_clearcoat=has_clearcoat, by_quads=by_quads)
        return passed != 0

    def _allocate_targets(
        self,
        view: PinholeView,
        layers: int,
        cache_slot: str,
        *,
        motion: bool = False,
        lit: bool,
        ids: bool = False,
    ) -> LayerTargets:
        """Targets of the view's size for this many layers, or for more where more were needed before."""
        targets = self._targets.get(cache_slot)
        if targets is None or not targets.fits(view.width, view.height, layers, motion=motion, lit=lit, ids=ids):
            check_layer_size(self._ctx, view.width, view.height)
            if targets is not None:
                targets.release()
                del self._targets[cache_slot]
            targets = self._targets[cache_slot] = LayerTargets.allocate(
                self._ctx, view.width, view.height, layers, motion=motion, lit=lit, ids=ids
            )
        return targets


def _all_corners(draws: list[Draw]) -> DoubleArray:
    """Corners ``(n, 3)`` of the boxes of draws, world."""
    return np.concatenate([np.zeros((0, 3)), *(draw.corners for draw in draws)])


def _any_translucent(draws: list[Draw]) -> bool:
    return any(draw.may_be_translucent for draw in draws)
