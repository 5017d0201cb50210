"""Lighting of a loaded scene on the device: lights, dome, shadow maps, and the background behind all surfaces."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from render.gl.compat import GL
from render.gl.shaders import ProgramCache
from render.layers.dome_gloss import GLOSS_LEVELS, DomeGloss
from render.layers.dome_irradiance import IRRADIANCE_UNIT, irradiance_image
from render.layers.drawing_space import DrawingSpace
from render.layers.index import Draw
from render.layers.light_filters import filter_options, pack_filters, place_filters
from render.layers.light_links import LinkSets
from render.layers.light_parts import light_parts
from render.layers.light_profiles import ProfileMaps
from render.layers.lights import lighting_options, pack_lights, row_order, select_lights, unit_axes
from render.layers.materials import HalfTexture
from render.layers.renderer import DOME_UNIT, LayerRenderer
from render.layers.shadow_maps import ShadowMaps
from render.layers.shadows import ShadowPlan, Sphere, plan_shadows
from render.layers.targets import LayerTargets
from render.model.scene import Dome, Image, Light, Scene
from render.optics.view import PinholeView


class Lighting:
    """Lights of the loaded scene, in the context of a renderer that draws their shadows."""

    def __init__(self, renderer: LayerRenderer, programs: ProgramCache, ctx: moderngl.Context) -> None:
        self._renderer = renderer
        self._programs = programs
        self._lights: tuple[Light, ...] = ()
        self._parts: tuple[tuple[Light, ...], ...] = ()
        self._links = LinkSets(())
        self._dome: Dome | None = None
        self._profiles = ProfileMaps(ctx)
        self._dome_map = _dome_texture(None)
        self._irradiance_map = _texture_around(irradiance_image(None))
        self._gloss = DomeGloss(ctx, programs)
        self._plan = ShadowPlan({}, np.zeros((0, 4, 4)))
        self._maps = ShadowMaps(renderer.draw_shadow, ctx, programs)

    def load(self, scene: Scene) -> None:
        """Load a scene's lights and dome; its shadows are out of date until `cast_shadows`."""
        self._lights = select_lights(scene.lights)
        self._parts = light_parts(self._lights)
        self._profiles.load(self._lights)
        self._links = LinkSets(scene.batches)
        self._renderer.link_sets = self._links
        if scene.dome is not self._dome:
            self._load_dome(scene.dome)

    def cast_shadows(self, whole: Sphere, region: Sphere | None, draws: Sequence[Draw]) -> bool:
        """Draw the shadow maps that have changed.

        Args:
            whole: sphere around the scene.
            region: where a distant light's shadows are resolved; None, or a region larger than the scene, for all of it.
            draws: draws of the scene.

        Returns:
            Whether any map has changed.
        """
        self._plan = plan_shadows(self._lights, whole, region)
        paths = {self._lights[i].path: slot for i, slot in self._plan.slots.items()}
        casting: list[Sequence[Draw]] = [draws] * len(self._plan.clip_from_world)
        for path, slot in paths.items() if any(draw.batch.links.unshadowed for draw in draws) else ():
            own = [draw for draw in draws if path not in draw.batch.links.unshadowed]
            casting[slot.first : slot.first + slot.count] = [own] * slot.count
        return self._maps.cast(self._plan.clip_from_world, casting)

    def options(self, *, is_sketch: bool) -> dict[str, int | float | str]:
        """Defines of the shaders that light surfaces, by what the scene's lights need; shadows of sketches are hard."""
        soft = () if is_sketch else self._plan.slots.values()
        dome: dict[str, int | float | str] = {"GLOSS_LEVELS": GLOSS_LEVELS} if self._has_dome_image else {}
        return lighting_options(self._lights, soft) | filter_options(self._lights) | self._links.options | dome

    def bind(self, view: PinholeView) -> None:
        """Bind the lighting of surfaces, in the space that they are drawn in."""
        dome_map = self._dome_map
        world_from_camera = np.asarray(np.linalg.inv(DrawingSpace.of_view(view).from_world), np.float64)
        slots, profiles = self._plan.slots, self._profiles.profiles
        first_filters = place_filters(self._lights)
        block = pack_lights(self._parts, self._dome, dome_map.height, world_from_camera, slots, profiles, first_filters)
        filters = pack_filters(self._parts, world_from_camera)
        rows = [self._lights[i].path for i in row_order(self._parts, self._plan.slots)]
        links = self._links.pack(rows, self._dome.path if self._dome is not None else "")
        self._renderer.set_lighting(block, self._plan.clip_from_world @ world_from_camera, links, filters)

    def bind_maps(self, *, is_sketch: bool) -> None:
        """Bind the dome's images, the shadow maps and the profiles to their texture units, which other passes may use too."""
        slots = () if is_sketch else self._plan.slots.values()
        soft = {slot.first + i for slot in slots if slot.outline[2] for i in range(slot.count)}
        self._maps.bind(soft)
        GL.glActiveTexture(GL.GL_TEXTURE0 + DOME_UNIT)
        self._dome_map._bind()
        GL.glActiveTexture(GL.GL_TEXTURE0 + IRRADIANCE_UNIT)
        self._irradiance_map._bind()
        self._gloss.bind()
        self._profiles.bind()

    def draw_background(self, view: PinholeView, targets: LayerTargets) -> None:
        """Draw the background behind all surfaces: the dome, or black."""
        dome = self._dome
        if dome is None or not dome.visible or not any(dome.radiance):
            GL.glClearTexImage(targets.background.glo, 0, GL.GL_RGBA, GL.GL_FLOAT, np.zeros(4, np.float32))
            return
        program = self._programs.compute("layers/background.comp")
        rotation = np.eye(4)
        rotation[:3, :3] = np.linalg.inv(unit_axes(dome.pose)) @ np.linalg.inv(view.camera_from_world)[:3, :3]
        program["dome_from_camera"] = tuple(rotation.T.ravel())
        program["radiance"] = dome.radiance
        program["focal_px"] = (view.fx, view.fy)
        program["centre_px"] = (view.cx, view.cy)
        program["unshear"] = tuple(np.linalg.inv(np.reshape(view.shear, (2, 2))).T.ravel())
        program["dome_map"] = DOME_UNIT
        GL.glActiveTexture(GL.GL_TEXTURE0 + DOME_UNIT)
        self._dome_map._bind()
        targets.background.bind_to_image(0, read=False, write=True)
        program.run(-(-view.width // 8), -(-view.height // 8))

    def release(self) -> None:
        """Release the memory on the device."""
        self._maps.release()
        self._profiles.release()
        self._gloss.release()
        self._dome_map.delete()
        self._irradiance_map.delete()

    @property
    def _has_dome_image(self) -> bool:
        return self._dome is not None and self._dome.image is not None

    def _load_dome(self, dome: Dome | None) -> None:
        image = dome.image if dome is not None else None
        if image is (self._dome.image if self._dome is not None else None):
            self._dome = dome
            return
        texture, irradiance = _dome_texture(dome), _texture_around(irradiance_image(image))
        self._dome_map.delete()
        self._irradiance_map.delete()
        self._dome, self._dome_map, self._irradiance_map = dome, texture, irradiance
        self._gloss.release()
        if self._has_dome_image:
            GL.glActiveTexture(GL.GL_TEXTURE0 + DOME_UNIT)
            texture._bind()
            self._gloss.fill()


def _dome_texture(dome: Dome | None) -> HalfTexture:
    image = dome.image if dome is not None else None
    return _texture_around(image or Image(np.ones((1, 1, 4), np.float16), "uniform dome"))


def _texture_around(image: Image) -> HalfTexture:
    """Texture of a latitude-longitude image."""
    texture = HalfTexture(image, "repeat", "clamp")
    texture._add_to_context()
    return texture
