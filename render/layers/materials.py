"""Scene materials and images as pyrender materials and textures, for our own shaders."""

from __future__ import annotations

import numpy as np

from render.gl.compat import GL, half_float_image, pyrender
from render.gl.resources import Construction
from render.model.arrays import FloatArray
from render.model.scene import LEAST_GLASS_OPACITY, Image, Material, TextureLookup, Wrap
from render.model.udim import tile_bits

INPUTS = (
    "base_color",
    "emissive",
    "metallic",
    "roughness",
    "specular",
    "opacity",
    "normal",
    "occlusion",
    "clearcoat",
    "clearcoat_roughness",
    "ior",
)
"""Material inputs that may come from a texture; the index is that of the shader's table."""

_WRAPS: dict[Wrap, int] = {
    "repeat": GL.GL_REPEAT,
    "clamp": GL.GL_CLAMP_TO_EDGE,
    "mirror": GL.GL_MIRRORED_REPEAT,
    "black": GL.GL_CLAMP_TO_BORDER,
}
_GL_TEXTURE_MAX_ANISOTROPY = 0x84FE
_TEXEL_BYTES = 8
_LOOKUP_ROWS = 6  # vectors of a look-up in the uniform block
GRAPH_ROWS = 10
"""Rows of the block of `layers/graph.glsl` before the numbers of the network."""


class HalfTexture(pyrender.Texture):  # type: ignore[misc]
    """Half-float image with mipmaps, row 0 first. pyrender's own textures have eight bits.

    A set of UDIM tiles is an array of textures, each with its own mipmaps and clamped to its edges, so that no tile bleeds into
    another.

    Attributes:
        image: the image.
        wraps: wrapping across and up the image.
        anisotropy: largest number of samples of a look-up.
        first_level: mip level of the image that the texture on the device begins with; the last is a mean of some texels.
    """

    def __init__(self, image: Image, wrap_s: Wrap = "repeat", wrap_t: Wrap = "repeat", anisotropy: float = 1.0) -> None:
        height, width = image.pixels.shape[-3:-1]
        super().__init__(name=image.name, source=None, source_channels="RGBA", width=width, height=height)
        self.tex_type = GL.GL_TEXTURE_2D_ARRAY if image.tiles else GL.GL_TEXTURE_2D
        self.image = image
        self.wraps: tuple[Wrap, Wrap] = ("clamp", "clamp") if image.tiles else (wrap_s, wrap_t)
        self.anisotropy = anisotropy
        self.first_level = 0

    @property
    def is_held(self) -> bool:
        """Whether it is on the device."""
        return bool(self._in_context())

    @property
    def last_level(self) -> int:
        """Mip level of a single texel."""
        return int(np.log2(max(self.width, self.height)))

    def level_of_side(self, side_px: int) -> int:
        """First level whose sides are at most so long."""
        return max(0, int(np.ceil(np.log2(max(self.width, self.height) / side_px))))

    def bytes_from(self, level: int) -> int:
        """Memory of the levels from one on, bytes."""
        levels, texel_bytes = range(level, self.last_level + 1), _TEXEL_BYTES * self._count
        return sum(texel_bytes * max(1, self.width >> i) * max(1, self.height >> i) for i in levels)

    @property
    def _count(self) -> int:
        """Images that it holds."""
        return max(1, len(self.image.tiles))

    def hold_from(self, level: int) -> None:
        """Hold the image from a level on, now where it is on the device."""
        if level == self.first_level:
            return
        self.first_level = level
        if self._in_context():
            self.delete()
            self._add_to_context()

    def _add_to_context(self) -> None:
        kind = self.tex_type
        with Construction() as making:
            self._texid = GL.glGenTextures(1)
            making.callback(self.delete)
            GL.glBindTexture(kind, self._texid)
            if self.first_level == 0:
                half_float_image(self.image.pixels)
                GL.glGenerateMipmap(kind)
            elif self.first_level == self.last_level:
                some = self.image.pixels[..., :: max(1, self.height // 512), :: max(1, self.width // 512), :]
                half_float_image(some.mean(axis=(-3, -2), dtype=np.float32, keepdims=True).astype(np.float16))
            else:
                self._fill_reduced()
            GL.glTexParameteri(kind, GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR)
            GL.glTexParameteri(kind, GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR_MIPMAP_LINEAR)
            GL.glTexParameteri(kind, GL.GL_TEXTURE_WRAP_S, _WRAPS[self.wraps[0]])
            GL.glTexParameteri(kind, GL.GL_TEXTURE_WRAP_T, _WRAPS[self.wraps[1]])
            GL.glTexParameterf(kind, _GL_TEXTURE_MAX_ANISOTROPY, self.anisotropy)
            GL.glTexParameterfv(kind, GL.GL_TEXTURE_BORDER_COLOR, np.zeros(4, np.float32))
            GL.glBindTexture(kind, 0)

    def _fill_reduced(self) -> None:
        """Fill the bound texture with the image's levels from the first one held on. The device has all of them meanwhile."""
        first, last, kind = self.first_level, self.last_level, self.tex_type
        size = (max(1, self.width >> first), max(1, self.height >> first))
        if self.image.tiles:
            GL.glTexStorage3D(kind, last - first + 1, GL.GL_RGBA16F, *size, self._count)
        else:
            GL.glTexStorage2D(kind, last - first + 1, GL.GL_RGBA16F, *size)
        whole = GL.glGenTextures(1)
        try:
            GL.glBindTexture(kind, whole)
            half_float_image(self.image.pixels)
            GL.glGenerateMipmap(kind)
            for level in range(first, last + 1):
                size = (max(1, self.width >> level), max(1, self.height >> level))
                GL.glCopyImageSubData(
                    whole, kind, level, 0, 0, 0, self._texid, kind, level - first, 0, 0, 0, *size, self._count
                )
        finally:
            GL.glBindTexture(kind, self._texid)
            GL.glDeleteTextures([whole])


class PreviewSurface(pyrender.Material):  # type: ignore[misc]
    """Material for ``layers/material.glsl``.

    Attributes:
        maps: texture of each input that has one, or of each sampler of its network.
        units: the texture units of these, in their order; inputs that share a texture share its unit.
        defines: shader defines.
        functions: of its network, or none.
        block: bytes of the uniform block.
    """

    def __init__(self, material: Material, textures: dict[str, HalfTexture]) -> None:
        """``textures`` holds one texture for each entry of ``material.lookups``."""
        super().__init__(name=material.name)
        self.source = material
        self.maps = textures
        bound = list(dict.fromkeys(textures.values()))
        self.units = tuple(_unit(bound.index(texture)) for texture in textures.values())
        self.defines: dict[str, int | str] = {}
        self.block: bytes
        self.functions = ""
        if material.graph is not None:
            self.defines |= {"GRAPH": 1, "GRAPH_NUMBERS": len(material.graph.numbers) // 4 - GRAPH_ROWS}
            if material.graph.reads_place:
                self.defines["GRAPH_OBJECT_SPACE"] = 1
            if material.unlit:
                self.defines["GRAPH_UNLIT"] = 1
            if material.graph.has_sheen:
                self.defines["GRAPH_SHEEN"] = 1
            if material.graph.has_film:
                self.defines["GRAPH_FILM"] = 1
            if material.graph.mixed > 1:
                self.defines["GRAPH_MIXED"] = material.graph.mixed
            self.functions = material.graph.functions
            self.block = np.array(material.graph.numbers, np.float32).tobytes()
            return
        for name in textures:
            self.defines[f"HAS_{name.upper()}"] = 1
            self.defines[f"LOOKUP_{name.upper()}"] = INPUTS.index(name)
            self.defines[f"MAP_{name.upper()}"] = "sampler2DArray" if textures[name].image.tiles else "sampler2D"
            if textures[name].image.tiles:
                self.defines["TILED"] = 1
            at = material.lookups[name].uv_at
            self.defines[f"PLACE_{name.upper()}"] = "uv" if at < 0 else f"value_pair({at})"
        self.defines |= {f"FROM_{name.upper()}": first for name, first in material.values.items()}
        self.block = _pack(material)

    @property
    def textures(self) -> set[HalfTexture]:
        """Textures that pyrender uploads before it draws."""
        return set(self.maps.values())

    def _compute_transparency(self) -> bool:
        return False  # peeling needs no sorting

    def _compute_tex_flags(self) -> int:
        return 0


def _unit(number: int) -> int:
    """Texture unit of a material's texture: below those that the shaders bind by themselves, or behind them."""
    return number if number < 8 else number + 8


def _pack(m: Material) -> bytes:
    """The std140 bytes of ``MaterialBlock``."""
    head = np.zeros((5, 4), np.float32)
    opacity = m.opacity if m.fades_highlights or m.opacity_threshold > 0 else max(m.opacity, LEAST_GLASS_OPACITY)
    head[0] = [*m.base_color, opacity]
    head[1] = [*m.emissive, m.metallic]
    if m.specular is not None:
        head[2] = [*m.specular, 1.0]
    head[3] = [m.roughness, m.ior, m.opacity_threshold, float(m.uses_display_color)]
    head[4] = [m.clearcoat, m.clearcoat_roughness, m.occlusion, 0.0 if m.fades_highlights else 1.0]
    lookups = np.zeros((len(INPUTS), _LOOKUP_ROWS, 4), np.float32)
    for name, lookup in m.lookups.items():
        lookups[INPUTS.index(name)] = _pack_lookup(lookup)
    return np.concatenate([head.ravel(), lookups.ravel()]).tobytes()


def _pack_lookup(lookup: TextureLookup) -> FloatArray:
    rows = np.zeros((_LOOKUP_ROWS, 4), np.float32)
    rows[:2, :3] = lookup.uv_transform
    rows[0, 3] = max(lookup.channel, 0)
    rows[2] = lookup.scale
    rows[3] = lookup.bias
    rows[4] = lookup.fallback
    rows.view(np.uint32)[5] = tile_bits(lookup.image.tiles)
    return rows
