"""Scene materials and images as pyrender materials and textures, for our own shaders."""

from __future__ import annotations

import numpy as np

from render.gl.compat import GL, half_float_image, pyrender
from render.gl.resources import Construction
from render.model.arrays import FloatArray
from render.model.scene import Image, Material, TextureLookup, Wrap

INPUTS = ("base_color", "emissive", "metallic", "roughness", "specular", "opacity", "normal", "occlusion")
"""Material inputs that may come from a texture; the index is that of the shader's table."""

_WRAPS: dict[Wrap, int] = {
    "repeat": GL.GL_REPEAT,
    "clamp": GL.GL_CLAMP_TO_EDGE,
    "mirror": GL.GL_MIRRORED_REPEAT,
    "black": GL.GL_CLAMP_TO_BORDER,
}
_GL_TEXTURE_MAX_ANISOTROPY = 0x84FE


class HalfTexture(pyrender.Texture):  # type: ignore[misc]
    """Half-float image with mipmaps, row 0 first. pyrender's own textures have eight bits."""

    def __init__(self, image: Image, wrap_s: Wrap = "repeat", wrap_t: Wrap = "repeat", anisotropy: float = 1.0) -> None:
        height, width = image.pixels.shape[:2]
        super().__init__(name=image.name, source=None, source_channels="RGBA", width=width, height=height)
        self.image = image
        self.wraps = (wrap_s, wrap_t)
        self.anisotropy = anisotropy

    def _add_to_context(self) -> None:
        with Construction() as making:
            self._texid = GL.glGenTextures(1)
            making.callback(self.delete)
            GL.glBindTexture(GL.GL_TEXTURE_2D, self._texid)
            half_float_image(self.image.pixels)
            GL.glGenerateMipmap(GL.GL_TEXTURE_2D)
            GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR)
            GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR_MIPMAP_LINEAR)
            GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_WRAP_S, _WRAPS[self.wraps[0]])
            GL.glTexParameteri(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_WRAP_T, _WRAPS[self.wraps[1]])
            GL.glTexParameterf(GL.GL_TEXTURE_2D, _GL_TEXTURE_MAX_ANISOTROPY, self.anisotropy)
            GL.glTexParameterfv(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_BORDER_COLOR, np.zeros(4, np.float32))
            GL.glBindTexture(GL.GL_TEXTURE_2D, 0)


class PreviewSurface(pyrender.Material):  # type: ignore[misc]
    """UsdPreviewSurface for ``layers/material.glsl``: its uniform block, its textures and its shader defines."""

    def __init__(self, material: Material, textures: dict[str, HalfTexture]) -> None:
        """``textures`` holds one texture for each entry of ``material.lookups``."""
        super().__init__(name=material.name)
        self.source = material
        self.maps = textures
        self.defines: dict[str, int] = {"CLEARCOAT": 1} if material.clearcoat > 0 else {}
        for name in textures:
            self.defines[f"HAS_{name.upper()}"] = 1
            self.defines[f"LOOKUP_{name.upper()}"] = INPUTS.index(name)
        self.block: bytes = _pack(material)

    @property
    def textures(self) -> set[HalfTexture]:
        """Textures that pyrender uploads before it draws."""
        return set(self.maps.values())

    def _compute_transparency(self) -> bool:
        return False  # peeling needs no sorting

    def _compute_tex_flags(self) -> int:
        return 0


def _pack(m: Material) -> bytes:
    """The std140 bytes of ``MaterialBlock``."""
    head = np.zeros((5, 4), np.float32)
    head[0] = [*m.base_color, m.opacity]
    head[1] = [*m.emissive, m.metallic]
    if m.specular is not None:
        head[2] = [*m.specular, 1.0]
    head[3] = [m.roughness, m.ior, m.opacity_threshold, float(m.uses_display_color)]
    head[4, :2] = [m.clearcoat, m.clearcoat_roughness]
    lookups = np.zeros((len(INPUTS), 4, 4), np.float32)
    for name, lookup in m.lookups.items():
        lookups[INPUTS.index(name)] = _pack_lookup(lookup)
    return np.concatenate([head.ravel(), lookups.ravel()]).tobytes()


def _pack_lookup(lookup: TextureLookup) -> FloatArray:
    rows = np.zeros((4, 4), np.float32)
    rows[:2, :3] = lookup.uv_transform
    rows[0, 3] = max(lookup.channel, 0)
    rows[2] = lookup.scale
    rows[3] = lookup.bias
    return rows
