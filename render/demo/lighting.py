"""The lights: warm practicals in a cool night, and rims that cut the two robots out of it.

Each light is a practical that the picture shows or could show. Intensities are radiances, tuned so that faces come out at
0.2 to 0.8 with the camera's exposure at its defaults.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

from render.demo.author import UNITS_PER_METRE, vector
from render.demo.looks import AMBER, TUNGSTEN, Colour
from render.demo.performance import MARA, PIP
from render.demo.places import LAMP_POSTS, TRAM_PLACE
from render.demo.street import KERB_M

LIGHTS = "/World/Lights"
MOONLIGHT: Colour = (0.42, 0.60, 1.0)
TRAM_YELLOW: Colour = (1.0, 0.92, 0.60)
PIP_M, MARA_M = (-0.47, 0.95, -2.55), (1.0, 1.1, -8.4)  # what their rims are aimed at


@dataclass(frozen=True)
class Lamp:
    """A sphere, disk or rect light.

    Attributes:
        kind: schema name.
        place_m: where, in its parent's space.
        colour: of its light.
        intensity: radiance of its surface.
        size_m: radius, or width and height of a rect.
        aim_m: the point that it shines at, for the flat kinds and for cones.
        cone_deg: half angle of its cone; 180 for none.
        shadow: whether it casts shadows; kept to the few that matter to the picture.
    """

    kind: str
    place_m: tuple[float, float, float]
    colour: Colour
    intensity: float
    size_m: tuple[float, ...]
    aim_m: tuple[float, float, float] | None = None
    cone_deg: float = 180.0
    shadow: bool = False


def _lamps() -> dict[str, Lamp]:
    posts = {
        f"{LIGHTS}/LampPost{k}": Lamp("SphereLight", (x, KERB_M + 2.97, z), TUNGSTEN, 340.0, (0.13,))
        for k, (x, z) in enumerate(LAMP_POSTS[:3])
    }
    tram_lamps = (TRAM_PLACE[0], 1.0, TRAM_PLACE[2] + 0.4)
    return posts | {
        # Pip: the lantern in its hand, a cool rim from the moonlit side, a warm one from the café.
        f"{PIP}/Body/ArmRight/Lantern/Flame": Lamp("SphereLight", (0.0, -0.18, 0.0), AMBER, 80.0, (0.05,)),
        f"{LIGHTS}/PipRimCool": Lamp("RectLight", (-1.75, 1.5, -3.75), MOONLIGHT, 150.0, (0.7, 1.3), PIP_M, shadow=True),
        f"{LIGHTS}/PipRimWarm": Lamp("RectLight", (0.75, 1.35, -4.3), AMBER, 90.0, (0.5, 1.1), PIP_M, shadow=True),
        f"{LIGHTS}/Leaves": Lamp("SphereLight", (0.75, 1.15, -0.35), TUNGSTEN, 260.0, (0.05,)),
        f"{LIGHTS}/Ivy": Lamp("SphereLight", (-1.05, 1.3, -0.35), TUNGSTEN, 200.0, (0.05,)),
        f"{LIGHTS}/PipKey": Lamp("RectLight", (-1.5, 2.1, -0.2), TUNGSTEN, 4.5, (1.2, 0.9), PIP_M, shadow=True),
        # Mara: the lamp behind her, and a small lantern under the umbrella.
        f"{LIGHTS}/MaraRim": Lamp("DiskLight", (3.0, 1.7, -9.5), TUNGSTEN, 330.0, (0.28,), MARA_M, 50.0, True),
        f"{LIGHTS}/MaraRimCool": Lamp("RectLight", (-1.3, 1.7, -9.6), MOONLIGHT, 130.0, (0.9, 1.2), MARA_M),
        f"{MARA}/Body/Umbrella/Lantern": Lamp("SphereLight", (0.0, 0.50, 0.30), TUNGSTEN, 260.0, (0.035,)),
        # The places that glow.
        f"{LIGHTS}/Stall": Lamp("SphereLight", (-2.1, 1.95, -5.7), AMBER, 95.0, (0.14,)),
        f"{LIGHTS}/Cafe": Lamp("RectLight", (3.95, 2.0, -8.2), TUNGSTEN, 9.0, (3.6, 1.7), (0.0, 0.6, -8.0)),
        f"{LIGHTS}/TramLamps": Lamp("DiskLight", tram_lamps, TRAM_YELLOW, 480.0, (0.16,), (0.3, 0.2, -9.0), 40.0),
    }  # fmt: skip


def write_lights(stage: Usd.Stage) -> None:
    """Authors the dome, the moon and every lamp."""
    UsdGeom.Scope.Define(stage, LIGHTS)
    dome = UsdLux.DomeLight.Define(stage, f"{LIGHTS}/Night")
    dome.CreateTextureFileAttr(Sdf.AssetPath("./textures/night_dome.exr"))
    dome.CreateTextureFormatAttr(UsdLux.Tokens.latlong)
    dome.CreateIntensityAttr(1.0)
    moon = UsdLux.DistantLight.Define(stage, f"{LIGHTS}/Moon")
    moon.CreateAngleAttr(0.53)
    moon.CreateIntensityAttr(0.8)
    moon.CreateColorAttr(Gf.Vec3f(*MOONLIGHT))
    _aim(moon.GetPrim(), (-3.0, 12.0, -1.0), (0.0, 0.0, -6.0))
    for path, lamp in _lamps().items():
        _write_lamp(stage, path, lamp)


def _write_lamp(stage: Usd.Stage, path: str, lamp: Lamp) -> None:
    prim = stage.DefinePrim(path, lamp.kind)
    light = UsdLux.LightAPI(prim)
    light.CreateColorAttr(Gf.Vec3f(*lamp.colour))
    light.CreateIntensityAttr(lamp.intensity)
    if lamp.kind == "RectLight":
        rect = UsdLux.RectLight(prim)
        rect.CreateWidthAttr(lamp.size_m[0] * UNITS_PER_METRE)
        rect.CreateHeightAttr(lamp.size_m[1] * UNITS_PER_METRE)
    else:
        prim.GetAttribute("inputs:radius").Set(lamp.size_m[0] * UNITS_PER_METRE)
    if lamp.cone_deg < 180:
        shaping = UsdLux.ShapingAPI.Apply(prim)
        shaping.CreateShapingConeAngleAttr(lamp.cone_deg)
        shaping.CreateShapingConeSoftnessAttr(0.5)
    UsdLux.ShadowAPI.Apply(prim).CreateShadowEnableAttr(lamp.shadow)
    _aim(prim, lamp.place_m, lamp.aim_m)


def _aim(prim: Usd.Prim, place_m: ArrayLike, aim_m: ArrayLike | None) -> None:
    """Stands a light somewhere, turned so that its -Z points at ``aim_m``."""
    common = UsdGeom.XformCommonAPI(prim)
    common.SetTranslate(vector(place_m))
    if aim_m is not None:
        x, y, z = np.asarray(aim_m, np.float64) - np.asarray(place_m, np.float64)
        pitch, yaw = np.degrees(np.arctan2(y, np.hypot(x, z))), np.degrees(np.arctan2(-x, -z))
        common.SetRotate(Gf.Vec3f(round(float(pitch), 3), round(float(yaw), 3), 0))
