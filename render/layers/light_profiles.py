"""Profiles of lights on the device: one layer of a texture array for each."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from render.model.arrays import FloatArray
from render.model.scene import PROFILE_SHAPE, Light

PROFILE_UNIT = 11
"""Texture unit as ``layers/lighting.glsl`` binds it."""


class ProfileMaps:
    """Profiles of the lights of one context.

    Attributes:
        profiles: profiles in the order of their layers.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self.profiles: tuple[FloatArray, ...] = ()
        self._texture: moderngl.TextureArray | None = None

    def load(self, lights: Sequence[Light]) -> None:
        """Upload the profiles of lights, where they are others than before."""
        found = {id(light.profile): light.profile for light in lights if light.profile is not None}
        if list(found) == [id(profile) for profile in self.profiles]:
            return
        self.release()
        if not found:
            return
        profiles = tuple(found.values())
        data = np.ascontiguousarray(np.stack(profiles).transpose(0, 2, 1), np.float32)
        texture = self._ctx.texture_array((*PROFILE_SHAPE, len(data)), 1, data.tobytes(), dtype="f4")
        texture.filter, texture.repeat_x, texture.repeat_y = (moderngl.LINEAR, moderngl.LINEAR), True, False
        self.profiles, self._texture = profiles, texture

    def bind(self) -> None:
        """Bind the texture to its unit, where there is one."""
        if self._texture is not None:
            self._texture.use(PROFILE_UNIT)

    def release(self) -> None:
        """Release the memory on the device."""
        if self._texture is not None:
            self._texture.release()
        self._texture, self.profiles = None, ()
