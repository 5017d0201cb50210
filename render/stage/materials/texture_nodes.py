"""UsdUVTexture, UsdTransform2d and UsdPrimvarReader_float2 nodes to texture lookups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast, get_args

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Usd, UsdShade

from render.errors import InputError
from render.model.scene import Image, TextureLookup, Wrap
from render.model.udim import FIRST_TILE, LAST_TILE
from render.stage.color_spaces import SpaceName, rgb_to_working
from render.stage.findings import FindingLog
from render.stage.materials.image_files import TextureError
from render.stage.materials.shading import NetworkReader, Source, finite_numbers
from render.stage.materials.textures import TextureCache

_CHANNELS = {"r": 0, "g": 1, "b": 2, "a": 3, "rgb": -1}


@dataclass(frozen=True, eq=False)
class Texture:
    """Value that a UsdUVTexture gives an input.

    Attributes:
        lookup: how to read the image, or None where there is no image.
        fallback: ``rgba`` to use instead.
        channel: which channel a scalar takes, or -1.
        uv_name: the primvar of its texture coordinates.
        uv_fallback: texture coordinates where a surface has no such primvar.
    """

    lookup: TextureLookup | None
    fallback: tuple[float, ...]
    channel: int
    uv_name: str
    uv_fallback: tuple[float, float] = (0.0, 0.0)


class TextureNodes:
    """Reads texture nodes.

    Args:
        cache: reads the image files.
        log: receives requests that are not honoured.
    """

    def __init__(self, cache: TextureCache, log: FindingLog) -> None:
        self._cache, self._log = cache, log

    def kind(self, shader: UsdShade.Shader | None) -> str:
        """A shader's identifier, such as ``UsdUVTexture``, or an empty string."""
        return str(shader.GetIdAttr().Get() or "") if shader is not None else ""

    def read(self, network: NetworkReader, source: Source, purpose: str, material_path: str) -> Texture:
        """Read a UsdUVTexture.

        Args:
            network: reads inputs at the time.
            source: the texture shader and which of its outputs is taken.
            purpose: ``color``, ``data`` for a single channel, or ``normal``.
            material_path: for findings.
        """
        shader = source.shader
        channel = _CHANNELS.get(source.output, -1)
        fallback = network.rgba(shader, "fallback", (0.0, 0.0, 0.0, 1.0))
        uv_name, uv_fallback, uv_transform = self._coordinates(network, shader, material_path)
        scale = network.rgba(shader, "scale", (1.0,) * 4)
        bias = network.rgba(shader, "bias", (0.0,) * 4)
        # Tinting and the change of primaries do not commute, so a colour's scale and bias go into its image.
        in_image = purpose == "color" and (len(set(scale[:3])) > 1 or any(bias[:3]))
        image = self._image(network, shader, purpose, (scale, bias) if in_image else ((1.0,) * 4, (0.0,) * 4))
        if image is None:
            return Texture(None, fallback, channel, uv_name, uv_fallback)
        without = (*self.working_color(network, shader, fallback), fallback[3]) if purpose == "color" else fallback
        lookup = TextureLookup(
            image=image,
            uv_transform=uv_transform,
            scale=np.array((1.0,) * 4 if in_image else scale, np.float32),
            bias=np.array((0.0,) * 4 if in_image else bias, np.float32),
            wrap_s=self._wrap(network, shader, "wrapS", image),
            wrap_t=self._wrap(network, shader, "wrapT", image),
            channel=max(channel, 0) if purpose == "data" else -1,
            fallback=np.array(without, np.float32),
        )
        return Texture(lookup, fallback, channel, uv_name, uv_fallback)

    def working_color(
        self, network: NetworkReader, shader: UsdShade.Shader, rgba: tuple[float, ...]
    ) -> tuple[float, float, float]:
        """Colour of a node's ``fallback`` in the working space."""
        source = network.source(shader, "fallback")
        return rgb_to_working(rgba[:3], source.attribute if source else None, self._log)

    def _image(
        self, network: NetworkReader, shader: UsdShade.Shader, purpose: str, scale_bias: tuple[tuple[float, ...], ...]
    ) -> Image | None:
        asset = network.asset(shader, "file")
        path = shader.GetPath()
        if asset is None or not asset.path:
            self._log.add("texture_missing", path, f"texture {path} names no file; its fallback value is used")
            return None
        space: SpaceName = str(network.constant(shader, "sourceColorSpace", "auto"))
        if space == "auto":
            space = network.color_space(shader, "file") or "auto"
        use = "color" if purpose == "color" else "data"
        try:
            if UsdShade.UdimUtils.IsUdimIdentifier(asset.path):
                return self._tiles(asset, shader, space, use, scale_bias)
            return self._cache.image(str(asset.resolvedPath), space, use, *scale_bias)
        except (TextureError, InputError) as problem:
            self._log.add("texture_unreadable", path, f"texture {asset.path} {problem}; the fallback of {path} is used")
            return None

    def _tiles(
        self,
        asset: Sdf.AssetPath,
        shader: UsdShade.Shader,
        space: SpaceName,
        use: str,
        scale_bias: tuple[tuple[float, ...], ...],
    ) -> Image:
        """Set of UDIM tiles; those that cannot be read are findings.

        Raises:
            TextureError: there is no tile that can be read.
        """
        files = self._tile_files(asset, shader)
        if not files:
            raise TextureError(f"has no tiles from {FIRST_TILE} to {LAST_TILE}")
        image, problems = self._cache.tiled(asset.path, files, space, use, *scale_bias)
        for number, problem in problems.items():
            path = shader.GetPath()
            message = f"tile {number} of texture {asset.path} {problem}; the fallback of {path} is used"
            self._log.add("texture_unreadable", f"{path} tile {number}", message)
        return image

    def _tile_files(self, asset: Sdf.AssetPath, shader: UsdShade.Shader) -> dict[int, str]:
        """Resolved paths of a set's tiles by their numbers, beside the layer that names the set."""
        for attribute in shader.GetInput("file").GetValueProducingAttributes():
            for spec in attribute.GetPropertyStack(Usd.TimeCode.EarliestTime()):
                tiles = UsdShade.UdimUtils.ResolveUdimTilePaths(asset.path, spec.layer)
                if tiles:
                    return {int(number): str(path) for path, number in tiles}
        return {}

    def _wrap(self, network: NetworkReader, shader: UsdShade.Shader, name: str, image: Image) -> Wrap:
        """The wrap mode; ``useMetadata``, the default, means black for files without such metadata."""
        token = str(network.constant(shader, name, "useMetadata"))
        if token in get_args(Wrap):
            return cast(Wrap, token)
        if token != "useMetadata":
            path = shader.GetPath()
            expected = ", ".join((*get_args(Wrap), "useMetadata"))
            self._log.add(
                f"texture_{name}", path, f"{name} of {path} must be one of {expected}, got {token!r}: black is used"
            )
        return "black" if image.tiles or token != "useMetadata" else self._cache.wraps(image.name)[name == "wrapT"]

    def _coordinates(
        self, network: NetworkReader, shader: UsdShade.Shader, material_path: str
    ) -> tuple[str, tuple[float, float], NDArray[np.float32]]:
        """The primvar that the lookup starts from, its fallback, and the ``(2, 3)`` transform of it by UsdTransform2d nodes.

        A constant is a transform that keeps nothing of the primvar.
        """
        transform = np.eye(3)
        source = network.source(shader, "st")
        passed: set[Sdf.Path] = set()
        name, fallback = "st", (0.0, 0.0)
        while source is not None:
            if source.shader is None:
                constant = finite_numbers(source.value, 2)
                transform = transform @ np.array([[0, 0, v] for v in (*(constant or fallback), 1)])
                break
            kind = self.kind(source.shader)
            if source.shader.GetPath() in passed:
                message = f"in material {material_path}, texture coordinates come from themselves; st is used"
                self._log.add("material_st", material_path, message)
                break
            passed.add(source.shader.GetPath())
            if kind == "UsdTransform2d":
                transform = transform @ _transform_2d(network, source.shader)
                source = network.source(source.shader, "in")
                continue
            if kind == "UsdPrimvarReader_float2":
                name = str(network.constant(source.shader, "varname", "") or "st")
                across, up = network.numbers(source.shader, "fallback", fallback)
                fallback = (across, up)
            else:
                message = f"in material {material_path}, texture coordinates from {kind} are not honoured; st is used"
                self._log.add("material_st", material_path, message)
            break
        return name, fallback, transform[:2].astype(np.float32)


def _transform_2d(network: NetworkReader, shader: UsdShade.Shader) -> NDArray[np.float64]:
    """``(3, 3)``: scale, then rotate counter-clockwise, then translate (UsdPreviewSurface specification, Transform2d)."""
    scale = network.numbers(shader, "scale", (1.0, 1.0))
    angle = np.radians(network.numbers(shader, "rotation", (0.0,))[0])
    translation = network.numbers(shader, "translation", (0.0, 0.0))
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array(
        [
            [cos * scale[0], -sin * scale[1], translation[0]],
            [sin * scale[0], cos * scale[1], translation[1]],
            [0, 0, 1],
        ]
    )
