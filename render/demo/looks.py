"""The materials ("looks") of the demo shot: a table of UsdPreviewSurface networks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

from render.demo.author import LOOKS

Colour = tuple[float, float, float]
Tokens = Sdf.ValueTypeNames


@dataclass(frozen=True)
class Picture:
    """Image file of a material input.

    Attributes:
        file: path relative to the looks layer.
        tile_m: size of one tile in texture coordinates (metres on most shapes), across and up.
        offset_m: position of the tile's lower left corner, likewise.
        scale: multiplier of the texel's colour.
        wrap: wrap mode.
    """

    file: str
    tile_m: tuple[float, float] = (1.0, 1.0)
    offset_m: tuple[float, float] = (0.0, 0.0)
    scale: float = 1.0
    wrap: Literal["repeat", "clamp", "black"] = "repeat"


@dataclass(frozen=True)
class Look:
    """A material: a UsdPreviewSurface. Colours are scene-linear Rec.709, USD's default.

    Attributes:
        colour: base colour (diffuseColor).
        roughness: from 0, a mirror, to 1, chalk.
        metallic: 0 or 1.
        emissive: radiance that leaves the surface.
        clearcoat: amount of a second, sharp highlight (enamel, wet paint).
        pictures: images by input: diffuseColor, emissiveColor, roughness, normal.
    """

    colour: Colour = (0.18, 0.18, 0.18)
    roughness: float = 0.5
    metallic: float = 0.0
    emissive: Colour = (0.0, 0.0, 0.0)
    clearcoat: float = 0.0
    pictures: dict[str, Picture] = field(default_factory=dict)


def glow(colour: Colour, radiance: float) -> Look:
    """Make a material that emits light and reflects none."""
    return Look((0.0, 0.0, 0.0), 0.6, emissive=(colour[0] * radiance, colour[1] * radiance, colour[2] * radiance))


AMBER: Colour = (1.0, 0.50, 0.16)
TUNGSTEN: Colour = (1.0, 0.64, 0.30)
ROSE: Colour = (1.0, 0.22, 0.16)
TEAL: Colour = (0.16, 0.85, 0.95)

_STONE = {
    "diffuseColor": Picture("./textures/setts_colour.jpg", (2.0, 2.0)),
    "roughness": Picture("./textures/setts_roughness.png", (2.0, 2.0)),
    "normal": Picture("./textures/setts_normal.png", (2.0, 2.0)),
    # Lies over the roadway from x = -2.7, z = -3 to x = 2.7, z = -23; see `render.demo.glints`.
    "emissiveColor": Picture("./textures/glints.jpg", (5.4, 20.0), (-2.7, 3.0), 2.0, "black"),
}
_WOOD = {"diffuseColor": Picture("./textures/wood_colour.jpg", (0.8, 0.8))}
_KNIT = {
    "diffuseColor": Picture("./textures/knit_colour.jpg", (0.08, 0.08)),
    "normal": Picture("./textures/knit_normal.png", (0.08, 0.08)),
}


def _window(file: str, radiance: float) -> Look:
    picture = Picture(f"./textures/{file}", scale=radiance, wrap="clamp")
    return Look((0.01, 0.01, 0.012), 0.15, pictures={"emissiveColor": picture})


TABLE: dict[str, Look] = {
    "Setts": Look(pictures=_STONE),
    "Kerb": Look((0.16, 0.16, 0.17), 0.35),
    "PlasterOchre": Look(
        roughness=0.85, pictures={"diffuseColor": Picture("./textures/plaster_ochre.jpg", (3.0, 3.0))}
    ),
    "PlasterBlue": Look(roughness=0.85, pictures={"diffuseColor": Picture("./textures/plaster_blue.jpg", (3.0, 3.0))}),
    "Trim": Look((0.42, 0.40, 0.36), 0.7),
    "Sky": Look(
        (0.0, 0.0, 0.0), 1.0, pictures={"emissiveColor": Picture("./textures/sky.jpg", scale=0.35, wrap="clamp")}
    ),
    "Roof": Look((0.05, 0.035, 0.03), 0.6),
    "Iron": Look((0.025, 0.027, 0.03), 0.38, metallic=0.0, clearcoat=0.5),
    "Brass": Look((0.83, 0.56, 0.25), 0.36, metallic=1.0),
    "Steel": Look((0.42, 0.43, 0.46), 0.4, metallic=1.0),
    "Wood": Look(roughness=0.5, pictures=_WOOD),
    "AwningRed": Look(roughness=0.8, pictures={"diffuseColor": Picture("./textures/stripes_red.png", (0.5, 0.5))}),
    "AwningTeal": Look(roughness=0.8, pictures={"diffuseColor": Picture("./textures/stripes_teal.png", (0.5, 0.5))}),
    "ShopGreen": Look((0.02, 0.075, 0.06), 0.35, clearcoat=0.6),
    "WindowWarm": _window("window_warm.jpg", 2.2),
    "WindowDim": _window("window_warm.jpg", 0.55),
    "WindowDark": Look((0.012, 0.016, 0.024), 0.12),
    "ShopWindow": _window("shop.jpg", 3.6),
    "Leaf": Look(roughness=0.35, pictures={"diffuseColor": Picture("./textures/leaf_colour.png", wrap="clamp")}),
    "Fruit": Look((0.85, 0.30, 0.03), 0.4, clearcoat=0.4),
    "Apple": Look((0.55, 0.03, 0.02), 0.25, clearcoat=0.8),
    "Clay": Look((0.35, 0.12, 0.06), 0.7),
    "Cloth": Look((0.62, 0.58, 0.5), 0.85),
    "EnamelCream": Look((0.78, 0.66, 0.46), 0.32, clearcoat=0.9),
    "EnamelTeal": Look((0.02, 0.24, 0.27), 0.28, clearcoat=0.9),
    "FacePlate": Look((0.006, 0.007, 0.009), 0.12, clearcoat=1.0),
    "Rubber": Look((0.02, 0.02, 0.022), 0.65),
    "Scarf": Look(roughness=0.9, pictures=_KNIT),
    "Raincoat": Look((0.80, 0.42, 0.03), 0.33, clearcoat=0.5),
    "Porcelain": Look((0.80, 0.78, 0.74), 0.22, clearcoat=0.8),
    "Umbrella": Look((0.75, 0.07, 0.03), 0.45, emissive=(0.05, 0.004, 0.001)),
    "EyeGlow": glow((0.16, 0.72, 1.0), 2.2),
    "VisorGlow": glow((1.0, 0.62, 0.22), 3.0),
    "HeartGlow": glow(ROSE, 5.0),
    "PaperGlow": Look(
        (0.3, 0.2, 0.1), 0.8, pictures={"emissiveColor": Picture("./textures/paper.jpg", (0.5, 0.42), scale=3.0)}
    ),
    "FlameGlow": glow((1.0, 0.42, 0.10), 2.4),
    "BulbWarm": glow(TUNGSTEN, 22.0),
    "BulbAmber": glow(AMBER, 22.0),
    "BulbRose": glow(ROSE, 22.0),
    "BulbTeal": glow(TEAL, 22.0),
    "LampGlow": glow(TUNGSTEN, 12.0),
    "NeonRose": glow((1.0, 0.12, 0.22), 14.0),
    "NeonTeal": glow((0.1, 0.8, 0.9), 10.0),
    "TramGlow": _window("tram.jpg", 2.2),
    "HeadLamp": glow((1.0, 0.90, 0.72), 24.0),
}


def write_looks(stage: Usd.Stage, names: set[str] | None = None) -> None:
    """Define the materials of the table, or those named, under the scope `LOOKS`."""
    UsdGeom.Scope.Define(stage, LOOKS)
    for name, look in TABLE.items():
        if names is None or name in names:
            _write_look(stage, f"{LOOKS}/{name}", look)


def _write_look(stage: Usd.Stage, path: str, look: Look) -> None:
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    values = {
        "diffuseColor": (Tokens.Color3f, Gf.Vec3f(*look.colour)),
        "emissiveColor": (Tokens.Color3f, Gf.Vec3f(*look.emissive)),
        "roughness": (Tokens.Float, look.roughness),
        "metallic": (Tokens.Float, look.metallic),
        "clearcoat": (Tokens.Float, look.clearcoat),
    }
    for name, (kind, value) in values.items():
        if name not in look.pictures:
            shader.CreateInput(name, kind).Set(value)
    if look.pictures:
        reader = UsdShade.Shader.Define(stage, f"{path}/Primvar")
        reader.CreateIdAttr("UsdPrimvarReader_float2")
        reader.CreateInput("varname", Tokens.String).Set("st")
        coordinates = reader.CreateOutput("result", Tokens.Float2)
        for name, picture in look.pictures.items():
            _write_picture(stage, path, shader, name, picture, coordinates)
    surface = shader.CreateOutput("surface", Tokens.Token)
    material.CreateSurfaceOutput().ConnectToSource(surface)


def _write_picture(
    stage: Usd.Stage, path: str, shader: UsdShade.Shader, name: str, picture: Picture, coordinates: UsdShade.Output
) -> None:
    """Connect one input of the surface to an image."""
    transform = UsdShade.Shader.Define(stage, f"{path}/{name}Placement")
    transform.CreateIdAttr("UsdTransform2d")
    transform.CreateInput("in", Tokens.Float2).ConnectToSource(coordinates)
    width, height = picture.tile_m
    transform.CreateInput("scale", Tokens.Float2).Set(Gf.Vec2f(1 / width, 1 / height))
    left, bottom = picture.offset_m
    transform.CreateInput("translation", Tokens.Float2).Set(Gf.Vec2f(-left / width, -bottom / height))
    texture = UsdShade.Shader.Define(stage, f"{path}/{name}Texture")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Tokens.Asset).Set(Sdf.AssetPath(picture.file))
    texture.CreateInput("st", Tokens.Float2).ConnectToSource(transform.CreateOutput("result", Tokens.Float2))
    texture.CreateInput("wrapS", Tokens.Token).Set(picture.wrap)
    texture.CreateInput("wrapT", Tokens.Token).Set(picture.wrap)
    is_colour = name in ("diffuseColor", "emissiveColor")
    texture.CreateInput("sourceColorSpace", Tokens.Token).Set("sRGB" if is_colour else "raw")
    if name == "normal":
        texture.CreateInput("scale", Tokens.Float4).Set(Gf.Vec4f(2, 2, 2, 1))
        texture.CreateInput("bias", Tokens.Float4).Set(Gf.Vec4f(-1, -1, -1, 0))
        kind = Tokens.Normal3f
    else:
        texture.CreateInput("scale", Tokens.Float4).Set(Gf.Vec4f(*[picture.scale] * 3, 1))
        kind = Tokens.Color3f if is_colour else Tokens.Float
    source = texture.CreateOutput(
        "r" if kind == Tokens.Float else "rgb", Tokens.Float if kind == Tokens.Float else Tokens.Float3
    )
    shader.CreateInput(name, kind).ConnectToSource(source)
