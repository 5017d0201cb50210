"""UsdPreviewSurface networks to materials."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from pxr import Usd, UsdShade

from render.model.scene import MAX_TEXTURES, Material, TextureLookup
from render.stage.color_spaces import rgb_to_working, to_rec709
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import Displacement
from render.stage.geometry.shape import PrimvarNames
from render.stage.materials.shading import NetworkReader, Source, finite_numbers
from render.stage.materials.texture_nodes import TextureNodes
from render.stage.values import format_value

WHITE = (1.0, 1.0, 1.0)
_COLORS = {"base_color": ("diffuseColor", (0.18,) * 3), "emissive": ("emissiveColor", (0.0,) * 3)}
_SCALARS = {
    "metallic": ("metallic", 0.0),
    "roughness": ("roughness", 0.5),
    "opacity": ("opacity", 1.0),
    "clearcoat": ("clearcoat", 0.0),
    "clearcoat_roughness": ("clearcoatRoughness", 0.01),
    "ior": ("ior", 1.5),
    "opacity_threshold": ("opacityThreshold", 0.0),
    "occlusion": ("occlusion", 1.0),
}
_UNIFORM_SCALARS = ("opacity_threshold",)
"""Inputs that take constants alone."""


@dataclass(frozen=True, eq=False)
class BoundMaterial:
    """Material, and the primvars that it reads from meshes.

    Attributes:
        material: for the renderer.
        primvars: primvars that it reads.
        varies: whether it may change over time.
        displacement: of surfaces that wear it, or None.
    """

    material: Material
    primvars: PrimvarNames = field(default_factory=PrimvarNames)
    varies: bool = False
    displacement: Displacement | None = None


DEFAULT_LOOK = BoundMaterial(
    Material(name="", base_color=WHITE, uses_display_color=True), PrimvarNames(None, "displayColor", "displayOpacity")
)


def preview_surface_look(
    material: UsdShade.Material, shader: UsdShade.Shader, time: Usd.TimeCode, nodes: TextureNodes, log: FindingLog
) -> BoundMaterial:
    """Read a material whose surface is a UsdPreviewSurface."""
    return _SurfaceReader(material, shader, time, nodes, log).look()


def preview_surface_displacement(
    material: UsdShade.Material, shader: UsdShade.Shader, time: Usd.TimeCode, nodes: TextureNodes, log: FindingLog
) -> Displacement | None:
    """Read the displacement alone of a material whose surface is a UsdPreviewSurface."""
    return _SurfaceReader(material, shader, time, nodes, log).displacement()


class _SurfaceReader:
    def __init__(
        self,
        material: UsdShade.Material,
        shader: UsdShade.Shader,
        time: Usd.TimeCode,
        nodes: TextureNodes,
        log: FindingLog,
    ) -> None:
        self._material, self._path = material, str(material.GetPath())
        self._shader, self._nodes, self._log = shader, nodes, log
        self._network = NetworkReader(time)
        self._constants: dict[str, float | tuple[float, float, float]] = {}
        self._lookups: dict[str, TextureLookup] = {}
        self._uv_names: dict[str, str] = {}
        self._primvars = PrimvarNames(uv=None)

    def look(self) -> BoundMaterial:
        for name, (usd_name, default) in _COLORS.items():
            self._color(name, usd_name, default)
        for name, (usd_name, scalar) in _SCALARS.items():
            self._scalar(name, usd_name, scalar)
        if self._network.constant(self._shader, "useSpecularWorkflow", 0) == 1:
            self._color("specular", "specularColor", (0.0,) * 3)
        self._normal()
        self._drop_excess()
        material = Material(
            name=self._path,
            uses_display_color=self._primvars.color is not None or self._primvars.opacity is not None,
            fades_highlights=self._opacity_mode() == "presence",
            lookups=self._lookups,
            **self._constants,  # type: ignore[arg-type]
        )
        displacement = self.displacement()
        return BoundMaterial(material, replace(self._primvars, uv=self._uv_name()), self._network.varies, displacement)

    def displacement(self) -> Displacement | None:
        source = self._network.source(self._shader, "displacement")
        (amount,) = self._numbers("displacement", source, (0.0,))
        if source is None or (source.shader is None and amount == 0 and not self._network.varies):
            return None
        terminal = self._material.ComputeDisplacementSource()[0]
        if not terminal or terminal.GetPath() != self._shader.GetPath():
            self._ignored(
                "displacement", "displacement is not connected to outputs:displacement: surfaces stay in place"
            )
            return None
        if source.shader is None:
            return Displacement(amount, varies=self._network.varies)
        kind = self._nodes.kind(source.shader)
        if kind == "UsdPrimvarReader_float":
            (fallback,) = self._network.numbers(source.shader, "fallback", (0.0,))
            varname = str(self._network.constant(source.shader, "varname", ""))
            return Displacement(fallback, varname, varies=self._network.varies)
        if kind != "UsdUVTexture":
            self._ignored(
                "displacement", f"displacement is fed by {kind or 'an unknown shader'}, which is not honoured"
            )
            return None
        texture = self._nodes.read(self._network, source, "data", self._path)
        amount = texture.fallback[max(texture.channel, 0)]
        return Displacement(amount, texture.uv_name, texture.lookup, self._network.varies)

    def _color(self, name: str, usd_name: str, default: tuple[float, ...]) -> None:
        source = self._network.source(self._shader, usd_name)
        value = self._numbers(usd_name, source, default)
        self._constants[name] = rgb_to_working(value, source.attribute if source else None, self._log)
        if source is not None and source.shader is not None:
            self._read_connection(name, usd_name, source, default, "color")

    def _scalar(self, name: str, usd_name: str, default: float) -> None:
        source = self._network.source(self._shader, usd_name)
        self._constants[name] = self._numbers(usd_name, source, (default,))[0]
        if source is None or source.shader is None:
            return
        if name in _UNIFORM_SCALARS:
            self._ignored(
                usd_name,
                f"{usd_name} takes a constant alone, so that its connection is not honoured: {default} is used",
            )
        else:
            self._read_connection(name, usd_name, source, (default,), "data")

    def _numbers(self, usd_name: str, source: Source | None, default: tuple[float, ...]) -> tuple[float, ...]:
        """The components of a constant input, or the default; a value that cannot be used is a finding."""
        value = source.value if source else None
        found = finite_numbers(value, len(default))
        if found is None and value is not None:
            needs = "a finite number" if len(default) == 1 else f"{len(default)} finite numbers"
            self._ignored(usd_name, f"{usd_name} must be {needs}, got {format_value(value)}: its fallback is used")
        return found or default

    def _normal(self) -> None:
        source = self._network.source(self._shader, "normal")
        if source is not None and source.shader is not None:
            self._read_connection("normal", "normal", source, (0.0, 0.0, 1.0), "normal")

    def _read_connection(
        self, name: str, usd_name: str, source: Source, default: tuple[float, ...], purpose: str
    ) -> None:
        kind = self._nodes.kind(source.shader)
        if kind == "UsdUVTexture":
            self._read_texture(name, usd_name, source, default, purpose)
        elif kind.startswith("UsdPrimvarReader") and name in ("base_color", "opacity"):
            self._from_primvar(name, source)
        else:
            self._ignored(usd_name, f"{usd_name} is fed by {kind or 'an unknown shader'}, which is not honoured")

    def _read_texture(self, name: str, usd_name: str, source: Source, default: tuple[float, ...], purpose: str) -> None:
        texture = self._nodes.read(self._network, source, purpose, self._path)
        if texture.lookup is not None:
            self._lookups[name] = texture.lookup
            self._uv_names[name] = texture.uv_name
        elif purpose == "color":
            shader = source.shader
            self._constants[name] = self._nodes.working_color(self._network, shader, texture.fallback)
        elif purpose == "data":
            self._constants[name] = texture.fallback[max(texture.channel, 0)]

    def _from_primvar(self, name: str, source: Source) -> None:
        """displayColor or another primvar as diffuseColor or opacity: it multiplies white, or 1. A UsdPrimvarReader's fallback is
        0 where none is authored."""
        varname = str(self._network.constant(source.shader, "varname", ""))
        if name == "base_color":
            self._constants[name] = WHITE
            rgb = self._network.rgba(source.shader, "fallback", (0.0, 0.0, 0.0, 1.0))[:3]
            authored = self._network.source(source.shader, "fallback")
            if authored is not None and authored.attribute is not None:
                rgb = tuple(to_rec709(np.array(rgb, np.float32), authored.attribute, self._log).tolist())
            self._primvars = replace(self._primvars, color=varname, color_fallback=(rgb[0], rgb[1], rgb[2]))
        else:
            self._constants[name] = 1.0
            (opacity,) = self._network.numbers(source.shader, "fallback", (0.0,))
            self._primvars = replace(self._primvars, opacity=varname, opacity_fallback=opacity)

    def _opacity_mode(self) -> str:
        mode = str(self._network.constant(self._shader, "opacityMode", "transparent"))
        if mode not in ("transparent", "presence"):
            self._ignored(
                "opacityMode", f"opacityMode must be transparent or presence, got {mode!r}: it is transparent"
            )
        return mode

    def _drop_excess(self) -> None:
        """Leave out the textures that exceed what a material looks up."""
        images = list(dict.fromkeys((id(look.image), look.wrap_s, look.wrap_t) for look in self._lookups.values()))
        for name, look in list(self._lookups.items()):
            if (id(look.image), look.wrap_s, look.wrap_t) not in images[:MAX_TEXTURES]:
                del self._lookups[name]
                what = f"its {len(images)} textures are more than {MAX_TEXTURES}: that of {name} is not drawn"
                self._ignored(f"textures_{name}", what)

    def _uv_name(self) -> str | None:
        """The one set of texture coordinates that a geometry carries: the base colour's if it has one."""
        names = list(dict.fromkeys(self._uv_names.values()))
        if not names:
            return None
        chosen = self._uv_names.get("base_color", names[0])
        if len(names) > 1:
            self._ignored("uv", f"several texture coordinates are used ({', '.join(names)}); only {chosen} is honoured")
        return chosen

    def _ignored(self, what: str, message: str) -> None:
        self._log.add(f"material_{what}", self._path, f"in material {self._path}, {message}")
