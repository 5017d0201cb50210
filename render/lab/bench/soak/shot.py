"""A small shot for soaking: balls on a floor, one of which rolls, and a camera that can be focused by two of them."""

from __future__ import annotations

from pathlib import Path

from pxr import Gf, Usd, UsdGeom, UsdLux

from usd_schemas import FocusPoint, LensCamera

CAMERA = "/World/camera"
BALLS = 5
FRAMES = (1.0, 24.0)


def write_soak_shot(folder: Path) -> Path:
    """Write the shot.

    Args:
        folder: where; it must exist.

    Returns:
        The stage's file.
    """
    stage = Usd.Stage.CreateNew(str(folder / "soak.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    stage.SetStartTimeCode(FRAMES[0])
    stage.SetEndTimeCode(FRAMES[1])
    _write_floor(stage)
    for i in range(BALLS):
        ball = UsdGeom.Sphere.Define(stage, f"/World/ball{i}")
        ball.CreateRadiusAttr(0.3)
        ball.CreateDisplayColorAttr([Gf.Vec3f(0.9 - 0.15 * i, 0.2 + 0.12 * i, 0.3)])
        place = UsdGeom.Xformable(ball).AddTranslateOp()
        place.Set(Gf.Vec3d(0.7 * (i - 2), 0.3, -2.0 - 1.1 * i))
    rolls = UsdGeom.XformCommonAPI(stage.GetPrimAtPath("/World/ball1"))
    for time, x in zip(FRAMES, (-1.5, 1.0), strict=True):
        rolls.SetTranslate(Gf.Vec3d(x, 0.3, -3.0), time)
    sun = UsdLux.DistantLight.Define(stage, "/World/sun")
    sun.CreateIntensityAttr(3.0)
    sun.CreateAngleAttr(0.5)
    UsdLux.ShadowAPI.Apply(sun.GetPrim())
    UsdGeom.Xformable(sun).AddRotateXYZOp().Set(Gf.Vec3f(-50, 25, 0))
    _write_camera(stage)
    stage.Save()
    return folder / "soak.usda"


def _write_floor(stage: Usd.Stage) -> None:
    floor = UsdGeom.Mesh.Define(stage, "/World/floor")
    floor.CreatePointsAttr([Gf.Vec3f(x, 0, z) for x, z in ((-6, 2), (6, 2), (6, -14), (-6, -14))])
    floor.CreateFaceVertexCountsAttr([4])
    floor.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    floor.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    floor.CreateDoubleSidedAttr(True)
    floor.CreateDisplayColorAttr([Gf.Vec3f(0.5, 0.5, 0.55)])


def _write_camera(stage: Usd.Stage) -> None:
    camera = UsdGeom.Camera.Define(stage, CAMERA)
    camera.CreateFocalLengthAttr(0.5)
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.2025)
    camera.CreateFStopAttr(0.14)
    camera.CreateFocusDistanceAttr(4.0)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    UsdGeom.Xformable(camera).AddTranslateOp().Set(Gf.Vec3d(0, 0.9, 1.5))
    lens = LensCamera(camera.GetPrim())
    for name, ball in (("near", 0), ("far", 4)):
        lens.add_focus_point(name, FocusPoint(name=name, target=(f"/World/ball{ball}",)))
