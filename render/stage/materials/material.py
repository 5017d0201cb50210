"""UsdPreviewSurface networks to materials."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from pxr import Usd, UsdShade

from render.model.scene import MAX_TEXTURES, VALUES_WIDTH, Image, Material, TextureLookup
from render.stage.color_spaces import rgb_to_working, to_rec709
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import Displacement
from render.stage.geometry.shape import PrimvarNames, ValuePrimvar
from render.stage.materials.shading import NetworkReader, Source, finite_numbers
from render.stage.materials.texture_nodes import TextureNodes
from render.stage.values import format_value

TOO_MANY_PRIMVARS = (
    f"a material reads at most {VALUES_WIDTH} numbers of primvars beside a colour, an opacity and texture coordinates"
)
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
_READERS = {
    "UsdPrimvarReader_float": 1,
    "UsdPrimvarReader_int": 1,
    "UsdPrimvarReader_float3": 3,
    "UsdPrimvarReader_vector": 3,
    "UsdPrimvarReader_point": 3,
    "UsdPrimvarReader_normal": 3,
}
"""Readers of primvars of as many numbers."""
_UP = (0.0, 0.0, 1.0)
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
        self._coordinates: dict[str, tuple[str, tuple[float, float]]] = {}
        self._primvars = PrimvarNames(uv=None)
        self._values: dict[str, int] = {}

    def look(self) -> BoundMaterial:
        for name, (usd_name, default) in _COLORS.items():
            self._color(name, usd_name, default)
        for name, (usd_name, scalar) in _SCALARS.items():
            self._scalar(name, usd_name, scalar)
        if self._network.constant(self._shader, "useSpecularWorkflow", 0) == 1:
            self._color("specular", "specularColor", (0.0,) * 3)
        self._normal()
        self._drop_excess()
        self._place_coordinates()
        material = Material(
            name=self._path,
            uses_display_color=self._primvars.color is not None or self._primvars.opacity is not None,
            fades_highlights=self._opacity_mode() == "presence",
            values=self._values,
            lookups=self._lookups,
            **self._constants,  # type: ignore[arg-type]
        )
        displacement = self.displacement()
        return BoundMaterial(material, self._primvars, self._network.varies, displacement)

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
            return
        x, y, z = self._numbers("normal", source, _UP)
        if (x, y, z) != _UP:
            self._lookups["normal"] = TextureLookup(Image(np.array([[[x, y, z, 1]]], np.float16), "normal"))
            self._coordinates["normal"] = "st", (0.0, 0.0)

    def _read_connection(
        self, name: str, usd_name: str, source: Source, default: tuple[float, ...], purpose: str
    ) -> None:
        kind = self._nodes.kind(source.shader)
        if kind == "UsdUVTexture":
            self._read_texture(name, usd_name, source, default, purpose)
        elif kind.startswith("UsdPrimvarReader") and name in ("base_color", "opacity"):
            self._from_primvar(name, source)
        elif _READERS.get(kind) == len(default) and name != "normal":
            self._from_value(name, usd_name, source)
        else:
            self._ignored(usd_name, f"{usd_name} is fed by {kind or 'an unknown shader'}, which is not honoured")

    def _read_texture(self, name: str, usd_name: str, source: Source, default: tuple[float, ...], purpose: str) -> None:
        texture = self._nodes.read(self._network, source, purpose, self._path)
        if texture.lookup is not None:
            self._lookups[name] = texture.lookup
            self._coordinates[name] = texture.uv_name, texture.uv_fallback
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
            rgb = self._linear_fallback(source.shader, rgb)
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

    def _from_value(self, name: str, usd_name: str, source: Source) -> None:
        """A primvar as any other input, in place of its constant."""
        assert source.shader is not None
        is_color = name in ("emissive", "specular")
        fallback = self._network.numbers(source.shader, "fallback", (0.0, 0.0, 0.0) if is_color else (0.0,))
        if is_color:
            fallback = self._linear_fallback(source.shader, fallback)
        primvar = ValuePrimvar(str(self._network.constant(source.shader, "varname", "")), fallback, is_color)
        at = self._add_value(primvar)
        if at is None:
            self._ignored(usd_name, f"{usd_name} is not read from {primvar.name}: {TOO_MANY_PRIMVARS}")
        else:
            self._values[name] = at

    def _linear_fallback(self, shader: UsdShade.Shader, rgb: tuple[float, ...]) -> tuple[float, ...]:
        """The colour of a reader's ``fallback`` as linear Rec. 709."""
        authored = self._network.source(shader, "fallback")
        if authored is None or authored.attribute is None:
            return rgb
        return tuple(to_rec709(np.array(rgb, np.float32), authored.attribute, self._log).tolist())

    def _add_value(self, primvar: ValuePrimvar) -> int | None:
        """Place of a further primvar among the vertices' numbers; None where there is no more."""
        at = 0
        for known in self._primvars.values:
            if known == primvar:
                return at
            at += len(known.fallback)
        if at + len(primvar.fallback) > VALUES_WIDTH:
            return None
        self._primvars = replace(self._primvars, values=(*self._primvars.values, primvar))
        return at

    def _place_coordinates(self) -> None:
        """Choose the texture coordinates of vertices, those of the base colour if it has any; others are further numbers."""
        moved = {name: look for name, look in self._lookups.items() if look.uv_transform[:, :2].any()}
        used = {name: self._coordinates[name] for name in moved}
        if not used:
            return
        first = used.get("base_color", next(iter(used.values())))
        self._primvars = replace(self._primvars, uv=first[0], uv_fallback=first[1])
        for name, coordinates in used.items():
            if coordinates == first:
                continue
            at = self._add_value(ValuePrimvar(*coordinates))
            if at is None:
                self._ignored(
                    "uv", f"the texture of {name} has coordinates {first[0]}, not {coordinates[0]}: {TOO_MANY_PRIMVARS}"
                )
            else:
                self._lookups[name] = replace(self._lookups[name], uv_at=at)

    def _ignored(self, what: str, message: str) -> None:
        self._log.add(f"material_{what}", self._path, f"in material {self._path}, {message}")
