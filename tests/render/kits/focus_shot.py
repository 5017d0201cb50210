"""A small shot for the tests of focus: two cards that move before a camera, in any unit and with either axis up."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pxr import Gf, Sdf, Usd, UsdGeom

from render.shot import Shot

CAMERA = "/World/cam"
NEAR = "/World/near"
FAR = "/World/far"
FRAMES = range(1, 25)
Rig = Callable[[UsdGeom.Camera, UsdGeom.Xformable], None]
"""Changes the camera, and the world that it is below."""


@dataclass(frozen=True)
class Units:
    """Units of a stage. The same world is read whatever they are."""

    metres: float = 1.0
    up: str = "Y"
    per_second: float = 24.0


def write_shot(path: Path, units: Units = Units(), *, camera: bool = True) -> Path:
    """Write the shot.

    A 50 mm lens at f/2 on a 36 × 20.25 mm gate stands at (0, 1, 10) m, +Y up, and looks along -Z, focused at 3 m. The
    near card, 1 m wide, is 4 m away and slides to the right out of the picture, 0.25 m a frame; the far card comes from
    10 m to 8 m between frames 1 and 24.
    """
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, units.metres)
    UsdGeom.SetStageUpAxis(stage, units.up)
    stage.SetTimeCodesPerSecond(units.per_second)
    stage.SetFramesPerSecond(24)
    step = units.per_second / 24
    stage.SetStartTimeCode(FRAMES[0] * step)
    stage.SetEndTimeCode(FRAMES[-1] * step)
    turn = Gf.Matrix4d(1) if units.up == "Y" else Gf.Matrix4d(Gf.Rotation(Gf.Vec3d(1, 0, 0), 90), Gf.Vec3d(0))
    scale = Gf.Matrix4d(Gf.Vec4d(*[1 / units.metres] * 3, 1))
    world = UsdGeom.Xform.Define(stage, "/World")
    world.AddTransformOp().Set(turn)
    for name in (NEAR, FAR):
        card = UsdGeom.Mesh.Define(stage, name)
        card.CreatePointsAttr(
            [
                p / units.metres
                for p in (Gf.Vec3f(-0.5, 0, 0), Gf.Vec3f(0.5, 0, 0), Gf.Vec3f(0.5, 2, 0), Gf.Vec3f(-0.5, 2, 0))
            ]
        )
        card.CreateFaceVertexCountsAttr([4])
        card.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
        card.CreateSubdivisionSchemeAttr("none")
    near, far = (UsdGeom.Xformable(stage.GetPrimAtPath(p)).AddTranslateOp() for p in (NEAR, FAR))
    for frame in (FRAMES[0], FRAMES[-1]):
        t = frame - FRAMES[0]
        near.Set(scale.Transform(Gf.Vec3d(0.25 * t, 0, 6)), frame * step)
        far.Set(scale.Transform(Gf.Vec3d(-1, 0, 2 * t / 23)), frame * step)
    if camera:
        cam = UsdGeom.Camera.Define(stage, CAMERA)
        cam.AddTranslateOp().Set(scale.Transform(Gf.Vec3d(0, 1, 10)))
        tenth_mm = units.metres * 100
        cam.CreateFocalLengthAttr(50 / tenth_mm)
        cam.CreateHorizontalApertureAttr(36 / tenth_mm)
        cam.CreateVerticalApertureAttr(20.25 / tenth_mm)
        cam.CreateFStopAttr(2.0)
        cam.CreateFocusDistanceAttr(3 / units.metres)
        cam.CreateClippingRangeAttr(Gf.Vec2f(0.1 / units.metres, 1000 / units.metres))
    stage.SetDefaultPrim(world.GetPrim())
    stage.Save()
    return path


def open_rigged(path: Path, rig: Rig | None, units: Units = Units()) -> Shot:
    """Write the shot, change its camera and what it is below, and open it."""
    write_shot(path, units)
    if rig is not None:
        stage = Usd.Stage.Open(str(path))
        rig(UsdGeom.Camera(stage.GetPrimAtPath(CAMERA)), UsdGeom.Xformable(stage.GetPrimAtPath("/World")))
        stage.Save()
    return Shot.open(path)


def open_bare(path: Path) -> Usd.Stage:
    """The file as any USD tool opens it, fresh from disk."""
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    return Usd.Stage.Open(layer)
