"""Depth peeling from the centre of the entrance pupil, with the umbra extended to neighbouring pixel centres.

Lee, Eisemann & Seidel 2010, section 3.1: a pixel's surface at depth ``d``, extended by ``s = d / f_px`` to its neighbours'
centres, hides from a pupil of radius ``E`` all that is nearer than ``d + x`` on its ray, with ``x = d·s / (E - s)``. In
inverse depth that is a constant: ``1/(d + x) = w·(1 - s/E) = w - 1/(f_px·E)``, the step of ``w`` in which the pupil's
outermost ray moves by one pixel. So ``w_near · f_px · E + 1`` layers are enough for any scene, and one is for a pinhole.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.layers.index import SceneIndex
from render.layers.lights import chosen_lights, dome_irradiance, pack_lights, unit_axes
from render.layers.limits import MAX_LAYERS
from render.layers.materials import HalfTexture
from render.layers.renderer import DOME_UNIT, SHADOW_UNIT, LayerPass, LayerRenderer
from render.layers.shadows import SHADOW_MAP_SIDE_PX, ShadowPlan, Sphere, plan_shadows, sphere_around
from render.layers.targets import LayerTargets, SurfaceTargets, check_layer_size
from render.optics.view import PinholeView
from render.scene import DoubleArray, Image, Light, Scene

HIDES_ALL = 1e30
"""Umbra of a pinhole, 1/m: an opaque surface hides everything behind it."""


def umbra_reach(pupil_px: float) -> float:
    """How far in inverse depth (1/m) the extended umbra of a surface reaches, for a pupil whose radius times the focal length in
    layer pixels is ``pupil_px``: ``1/(f_px·E)``, wherever the surface is."""
    return 1.0 / pupil_px if pupil_px > 0 else HIDES_ALL


@dataclass(frozen=True)
class Layers:
    """A peeled scene. Valid until the next peeling.

    Attributes:
        view: what the layers' pixels see.
        targets: the textures. Channels of inverse depth from ``count`` on are 0 in a texture whose first layer is below
            ``count``; textures and slices from there on hold what an earlier peeling left.
        count: layers that hold something.
    """

    view: PinholeView
    targets: LayerTargets
    count: int


class Peeler:
    """Peels scenes: owns the render index, the renderer, the shadow maps and the layers' textures of one context."""

    def __init__(self, graphics: GraphicsContext, programs: ProgramCache) -> None:
        self._ctx = graphics.ctx
        self._programs = programs
        # on a CPU, anisotropic look-ups triple the time of a textured layer, and the layers are supersampled anyway
        self.index = SceneIndex(anisotropy=1.0 if graphics.is_software else 8.0)
        self._renderer = LayerRenderer(self.index)
        self._targets: LayerTargets | None = None
        self._surfaces: SurfaceTargets | None = None
        self._scene: Scene | None = None
        self._lights: tuple[Light, ...] = ()
        self._plan = ShadowPlan({}, np.zeros((0, 4, 4)))
        self._interest: Sphere | None = None
        self._shadow_layers = 0
        self._shadow_maps: tuple[int, int] | None = None
        self._dome: HalfTexture | None = None
        self._harmonics = dome_irradiance(None)

    def load(self, scene: Scene, interest: Sphere | None = None) -> None:
        """Upload a scene: what is new in it, its lights and its shadows. Does nothing for the scene that is loaded.

        Args:
            scene: what to upload.
            interest: where a distant light's shadows are wanted; everywhere, where the scene is no larger.
        """
        if scene is not self._scene:
            before, self._scene = self._scene, None  # nothing is loaded until all of it is
            self.index.update(scene)
            self._renderer.upload()
            self._lights = chosen_lights(scene.lights)
            if before is None or scene.dome is not before.dome:
                self._load_dome(scene)
            self._plan = ShadowPlan({}, np.zeros((0, 4, 4)))
        elif interest == self._interest:
            return
        plan = plan_shadows(self._lights, sphere_around(self._all_corners()), interest)
        if not np.array_equal(plan.clip_from_world, self._plan.clip_from_world):
            self._plan = plan
            self._draw_shadows()
        self._scene, self._interest = scene, interest

    def peel(
        self,
        view: PinholeView,
        *,
        layers: int,
        umbra: float,
        unlit: bool = False,
        detail: float = 1.0,
        picture_px: float = 1.0,
    ) -> Layers:
        """Peel the loaded scene.

        Args:
            view: the picture that the layers are drawn for, guard band included.
            layers: at most this many, up to `MAX_LAYERS`.
            umbra: reach of an opaque surface's umbra in inverse depth, 1/m: `umbra_reach`, or `HIDES_ALL`.
            unlit: take base colour for radiance.
            detail: how many times finer than the view's pixels the finished picture samples surfaces.
            picture_px: side of the finished picture's pixels, in the view's.
        """
        layers = min(layers, MAX_LAYERS)
        targets = self._sized_targets(view, layers)
        self._set_lighting(view)
        self._draw_background(view, targets)
        count = 0
        for layer in range(layers):
            previous = targets.stored(layer - 1) if layer else None
            layer_pass = LayerPass(view, targets.slots[layer], umbra, previous, unlit, detail, picture_px)
            if self._draw_counted(layer_pass) == 0:
                break
            count = layer + 1
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        return Layers(view, targets, count)

    def surfaces(self, view: PinholeView) -> SurfaceTargets:
        """Where and what the nearest surfaces are, at each pixel's centre. Valid until the next call."""
        targets = self._surfaces
        if targets is None or (targets.width, targets.height) != (view.width, view.height):
            check_layer_size(self._ctx, view.width, view.height)
            if targets is not None:
                targets.release()
                self._surfaces = None
            targets = self._surfaces = SurfaceTargets.make(self._ctx, view.width, view.height)
        self._set_lighting(view)
        targets.clear_ids()
        self._renderer.draw_layer(LayerPass(view, targets.slot, unlit=True))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)
        return targets

    def release(self) -> None:
        """Give all memory on the device back."""
        for targets in (self._targets, self._surfaces):
            if targets is not None:
                targets.release()
        if self._shadow_maps is not None:
            GL.glDeleteTextures([self._shadow_maps[0]])
            GL.glDeleteFramebuffers(1, [self._shadow_maps[1]])
        if self._dome is not None:
            self._dome.delete()
        self._renderer.delete()

    def _all_corners(self) -> DoubleArray:
        corners = [draw.corners for draw in self.index.draws]
        return np.concatenate(corners) if corners else np.zeros((0, 3))

    def _draw_counted(self, layer: LayerPass) -> int:
        """Draw a layer and say whether any pixel of it was filled (an occlusion query)."""
        query = GL.glGenQueries(1)
        name = int(np.ravel(query)[0])
        GL.glBeginQuery(GL.GL_ANY_SAMPLES_PASSED, name)
        try:
            self._renderer.draw_layer(layer)
        finally:
            GL.glEndQuery(GL.GL_ANY_SAMPLES_PASSED)
        passed = int(np.ravel(GL.glGetQueryObjectuiv(name, GL.GL_QUERY_RESULT))[0])
        GL.glDeleteQueries(1, [name])
        return passed

    def _loaded(self) -> tuple[Scene, HalfTexture]:
        if self._scene is None or self._dome is None:
            raise GraphicsError("no scene is loaded: call load() before peel()")
        return self._scene, self._dome

    def _sized_targets(self, view: PinholeView, layers: int) -> LayerTargets:
        """Targets of the view's size for so many layers, or for more where more were asked before."""
        targets = self._targets
        if targets is None or not targets.hold(view.width, view.height, layers):
            check_layer_size(self._ctx, view.width, view.height)
            if targets is not None:
                targets.release()
                self._targets = None
            targets = self._targets = LayerTargets.make(self._ctx, view.width, view.height, layers)
        return targets

    def _load_dome(self, scene: Scene) -> None:
        if self._dome is not None:
            self._dome.delete()
        self._harmonics = dome_irradiance(scene.dome)
        image = scene.dome.image if scene.dome is not None else None
        self._dome = HalfTexture(image or Image(np.ones((1, 1, 4), np.float16), "uniform dome"), "repeat", "clamp")
        self._dome._add_to_context()

    def _set_lighting(self, view: PinholeView) -> None:
        scene, loaded_dome = self._loaded()
        world_from_camera = np.asarray(np.linalg.inv(view.camera_from_world), np.float64)
        mips = int(np.log2(max(loaded_dome.width, loaded_dome.height)))
        block = pack_lights(self._lights, scene.dome, self._harmonics, mips, world_from_camera, self._plan.slots)
        self._renderer.set_lighting(block, self._plan.clip_from_world @ world_from_camera)
        GL.glActiveTexture(GL.GL_TEXTURE0 + DOME_UNIT)
        loaded_dome._bind()
        GL.glActiveTexture(GL.GL_TEXTURE0 + SHADOW_UNIT)
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, self._shadow_textures()[0])

    def _draw_shadows(self) -> None:
        texture, framebuffer = self._shadow_textures()
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, framebuffer)
        for layer, clip_from_world in enumerate(self._plan.clip_from_world):
            GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, texture, 0, layer)
            GL.glDepthMask(True)
            GL.glClearBufferfv(GL.GL_DEPTH, 0, np.zeros(4, np.float32))
            self._renderer.draw_shadow(SHADOW_MAP_SIDE_PX, clip_from_world)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)

    def _shadow_textures(self) -> tuple[int, int]:
        """Texture and framebuffer of the shadow maps, as large as the plan needs; one map at the least."""
        layers = max(1, len(self._plan.clip_from_world))
        if self._shadow_maps is not None and self._shadow_layers >= layers:
            return self._shadow_maps
        if self._shadow_maps is not None:
            GL.glDeleteTextures([self._shadow_maps[0]])
            GL.glDeleteFramebuffers(1, [self._shadow_maps[1]])
        self._shadow_layers = layers
        self._shadow_maps = (_depth_array(SHADOW_MAP_SIDE_PX, layers), GL.glGenFramebuffers(1))
        return self._shadow_maps

    def _draw_background(self, view: PinholeView, targets: LayerTargets) -> None:
        """What is seen past all surfaces: the dome, or nothing."""
        scene, loaded_dome = self._loaded()
        dome = scene.dome
        program = self._programs.compute("background.comp")
        rotation = np.eye(4)
        if dome is not None:
            rotation[:3, :3] = np.linalg.inv(unit_axes(dome.pose)) @ np.linalg.inv(view.camera_from_world)[:3, :3]
        program["dome_from_camera"] = tuple(rotation.T.ravel())
        program["radiance"] = dome.radiance if dome is not None and dome.visible else (0.0, 0.0, 0.0)
        program["focal_px"] = (view.fx, view.fy)
        program["centre_px"] = (view.cx, view.cy)
        program["dome_map"] = DOME_UNIT
        GL.glActiveTexture(GL.GL_TEXTURE0 + DOME_UNIT)
        loaded_dome._bind()
        targets.background.bind_to_image(0, read=False, write=True)
        program.run(-(-view.width // 8), -(-view.height // 8))
        self._ctx.memory_barrier()


def _depth_array(side_px: int, layers: int) -> int:
    """A depth texture array for shadow comparison, lit where the reference is nearer or as near (reversed depth)."""
    name: int = GL.glGenTextures(1)
    GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, name)
    GL.glTexImage3D(
        GL.GL_TEXTURE_2D_ARRAY,
        0,
        GL.GL_DEPTH_COMPONENT32F,
        side_px,
        side_px,
        layers,
        0,
        GL.GL_DEPTH_COMPONENT,
        GL.GL_FLOAT,
        None,
    )
    for parameter, value in (
        (GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR),
        (GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR),
        (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_EDGE),
        (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_EDGE),
        (GL.GL_TEXTURE_COMPARE_MODE, GL.GL_COMPARE_REF_TO_TEXTURE),
        (GL.GL_TEXTURE_COMPARE_FUNC, GL.GL_GEQUAL),
    ):
        GL.glTexParameteri(GL.GL_TEXTURE_2D_ARRAY, parameter, value)
    GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, 0)
    return name
