"""A table with a row of objects on it before a camera that looks along it: what tilted lenses are for."""

from __future__ import annotations

from pathlib import Path

from pxr import Gf, Usd, UsdGeom

from usd_schemas import FocusPoint

CAMERA, TABLE = "/World/cam", "/World/table"
ON_TABLE = {"near": (0.0, 0.0, 0.55), "left": (-0.45, 0.0, -0.4), "far": (0.3, 0.0, -1.5)}
"""Places on the table, metres."""


def write_table(path: Path) -> Path:
    """A camera of 40 mm at f/1 on a 36 x 24 mm gate, 0.7 m above the table's top and 1.6 m before its middle, looks down by 18
    degrees. The table is 1.6 m wide and 4 m long, of 0.1 m squares; balls of 4 cm stand along it. Metres, +Y up."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Y")
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(24)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    table = UsdGeom.Mesh.Define(stage, TABLE)
    across, along = 17, 41
    table.CreatePointsAttr([Gf.Vec3f(-0.8 + 0.1 * i, 0, 1.0 - 0.1 * k) for k in range(along) for i in range(across)])
    quads = [
        (k * across + i, k * across + i + 1, (k + 1) * across + i + 1, (k + 1) * across + i)
        for k in range(along - 1)
        for i in range(across - 1)
    ]
    table.CreateFaceVertexCountsAttr([4] * len(quads))
    table.CreateFaceVertexIndicesAttr([corner for quad in quads for corner in quad])
    table.CreateSubdivisionSchemeAttr("none")
    colours = [
        Gf.Vec3f(*((0.8, 0.75, 0.65) if (n % 16 + n // 16) % 2 else (0.35, 0.2, 0.12))) for n in range(len(quads))
    ]
    UsdGeom.PrimvarsAPI(table).CreatePrimvar("displayColor", table.GetDisplayColorAttr().GetTypeName(), "uniform").Set(
        colours
    )
    for n in range(9):
        ball = UsdGeom.Sphere.Define(stage, f"/World/ball{n}")
        ball.CreateRadiusAttr(0.04)
        ball.AddTranslateOp().Set(Gf.Vec3d(-0.28 + 0.07 * n, 0.04, 0.55 - 0.28 * n))
        ball.CreateDisplayColorAttr([Gf.Vec3f(0.9 - 0.09 * n, 0.2, 0.1 + 0.09 * n)])
    camera = UsdGeom.Camera.Define(stage, CAMERA)
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0.7, 1.6))
    camera.AddRotateXOp().Set(-18.0)
    camera.CreateFocalLengthAttr(0.4)
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.24)
    camera.CreateFStopAttr(1.0)
    camera.CreateFocusDistanceAttr(1.8)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.05, 100))
    stage.Save()
    return path


def on_table(name: str, place: tuple[float, float, float], **settings: object) -> FocusPoint:
    """A focus point at a place of the table's own space: the offset from its origin."""
    return FocusPoint(name, target=(TABLE,), offset=place, **settings)  # type: ignore[arg-type]
