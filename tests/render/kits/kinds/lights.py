"""Each kind of light, in a booth of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux

from tests.render.kits.kinds.parts import Author
from tests.render.kits.stages import add_mesh, write_picture


def _booth(stage: Usd.Stage, path: str) -> str:
    """Floor, back and two sides with a ball; returns the path of the whole."""
    UsdGeom.Xform.Define(stage, path)
    low, high = (-1.4, 0.0, -1.4), (1.4, 2.4, 1.4)
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    walls = add_mesh(stage, f"{path}/walls", corners, [4] * 4, [0, 1, 5, 4, 0, 4, 6, 2, 0, 2, 3, 1, 4, 5, 7, 6])
    walls.CreateDoubleSidedAttr(True)
    walls.CreateDisplayColorAttr([(0.5, 0.5, 0.5)])
    ball = UsdGeom.Sphere.Define(stage, f"{path}/ball")
    ball.CreateRadiusAttr(0.4)
    ball.AddTranslateOp().Set((0.1, 0.4, 0.1))
    ball.CreateDisplayColorAttr([(0.6, 0.6, 0.6)])
    return path


def _lit_by(
    kind: type, place: tuple[float, ...], turn: tuple[float, ...], apis: tuple[type, ...] = (), **values: object
) -> Author:
    """Booth with a light. ``values`` are its properties, with ``_`` for ``:``."""

    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        _booth(stage, path)
        light = kind.Define(stage, f"{path}/light")
        light.AddTranslateOp().Set(place)
        light.AddRotateXYZOp().Set(turn)
        for api in apis:
            api.Apply(light.GetPrim())
        for name, value in values.items():
            light.GetPrim().GetAttribute(name.replace("_", ":")).Set(value)

    return author


def _pictured(stage: Usd.Stage, path: str, folder: Path) -> None:
    stripes = np.zeros((64, 64, 3), np.uint8)
    stripes[:, :22], stripes[:, 22:43], stripes[:, 43:] = (255, 30, 30), (30, 255, 30), (40, 40, 255)
    write_picture(folder / "stripes.png", stripes)
    _lit_by(UsdLux.RectLight, (0, 1.8, 0.9), (-60, 0, 0), inputs_intensity=14.0, inputs_width=1.6, inputs_height=0.5)(
        stage, path, folder
    )
    UsdLux.RectLight(stage.GetPrimAtPath(f"{path}/light")).CreateTextureFileAttr("./stripes.png")


def _mesh_light(stage: Usd.Stage, path: str, folder: Path) -> None:
    _booth(stage, path)
    points = [(-0.3, 1.5, 0.2), (0.3, 1.5, 0.2), (0, 1.5, -0.4), (0, 2.0, 0)]
    mesh = add_mesh(stage, f"{path}/light", points, [3] * 4, [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3])
    UsdLux.MeshLightAPI.Apply(mesh.GetPrim())
    UsdLux.LightAPI(mesh.GetPrim()).CreateIntensityAttr(6.0)


def _profiled(stage: Usd.Stage, path: str, folder: Path) -> None:
    candela = " ".join(str(value) for value in (100, 700, 60, 900, 20, 0, 0))
    (folder / "lamp.ies").write_text(
        f"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 7 1 1 2 0 0 0\n1 1 100\n0 15 30 45 60 75 90\n0\n{candela}\n"
    )
    _lit_by(
        UsdLux.SphereLight, (0, 2.0, 0.3), (-90, 0, 0), (UsdLux.ShapingAPI,), inputs_intensity=0.5, inputs_radius=0.05
    )(stage, path, folder)
    UsdLux.ShapingAPI(stage.GetPrimAtPath(f"{path}/light")).CreateShapingIesFileAttr("./lamp.ies")


LIGHTS: dict[str, Author] = {
    "distant light": _lit_by(
        UsdLux.DistantLight, (0, 0, 0), (-50, 35, 0), inputs_intensity=2.0, inputs_normalize=True, inputs_angle=1.0
    ),
    "distant light of 20°": _lit_by(
        UsdLux.DistantLight, (0, 0, 0), (-50, 35, 0), inputs_intensity=2.0, inputs_normalize=True, inputs_angle=20.0
    ),
    "small sphere light": _lit_by(
        UsdLux.SphereLight, (-0.6, 1.7, 0.7), (0, 0, 0), inputs_intensity=300.0, inputs_radius=0.05
    ),
    "large sphere light": _lit_by(
        UsdLux.SphereLight, (-0.6, 1.7, 0.7), (0, 0, 0), inputs_intensity=8.0, inputs_radius=0.3
    ),
    "disk light": _lit_by(UsdLux.DiskLight, (0, 2.2, 0.4), (-80, 0, 0), inputs_intensity=8.0, inputs_radius=0.4),
    "rect light": _lit_by(
        UsdLux.RectLight, (0, 2.2, 0.4), (-80, 0, 0), inputs_intensity=8.0, inputs_width=1.6, inputs_height=0.3
    ),
    "rect light with a texture": _pictured,
    "cylinder light": _lit_by(
        UsdLux.CylinderLight, (0, 1.6, 0.5), (0, 0, 20), inputs_intensity=14.0, inputs_length=1.6, inputs_radius=0.04
    ),
    "mesh light": _mesh_light,
    "cone": _lit_by(
        UsdLux.SphereLight,
        (0, 2.2, 1.0),
        (-65, 0, 0),
        (UsdLux.ShapingAPI,),
        inputs_intensity=300.0,
        inputs_radius=0.06,
        inputs_shaping_cone_angle=22.0,
        inputs_shaping_cone_softness=0.3,
    ),
    "IES profile": _profiled,
    "colour temperature": _lit_by(
        UsdLux.SphereLight,
        (-0.6, 1.7, 0.7),
        (0, 0, 0),
        inputs_intensity=8.0,
        inputs_radius=0.3,
        inputs_enableColorTemperature=True,
        inputs_colorTemperature=2700.0,
    ),
    "coloured shadow": _lit_by(
        UsdLux.DistantLight,
        (0, 0, 0),
        (-50, 35, 0),
        (UsdLux.ShadowAPI,),
        inputs_intensity=2.0,
        inputs_normalize=True,
        inputs_shadow_color=Gf.Vec3f(0.5, 0.05, 0.05),
    ),
    "shadow:distance": _lit_by(
        UsdLux.DistantLight,
        (0, 0, 0),
        (-50, 35, 0),
        (UsdLux.ShadowAPI,),
        inputs_intensity=2.0,
        inputs_normalize=True,
        inputs_shadow_distance=0.6,
    ),
}
