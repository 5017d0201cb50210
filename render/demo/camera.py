"""The camera: a slow push in on a 50 mm at f/1.4, from behind the leaves."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdRender, Vt

from render.demo.author import FIRST_FRAME, LAST_FRAME, animate
from render.demo.performance import ease, seconds

CAMERA = "/World/main_cam"
RENDER_SETTINGS = "/Render/Settings"
FOCAL_LENGTH_MM, F_STOP = 50.0, 1.4
GATE_MM = (36.0, 20.25)
START_M, END_M = np.array([-0.16, 1.12, 0.42]), np.array([0.06, 1.15, 0.02])


def camera_place(frame: float) -> list[float]:
    """The dolly's position in metres, with a breath of handheld drift."""
    t = 0.35 * (frame - FIRST_FRAME) / (LAST_FRAME - FIRST_FRAME) + 0.65 * ease(frame, -12, LAST_FRAME + 12)
    drift = 0.0025 * np.array([np.sin(1.7 * seconds(frame)), np.sin(2.3 * seconds(frame) + 1), 0])
    return [float(x) for x in START_M + t * (END_M - START_M) + drift]


def camera_turn(frame: float) -> list[float]:
    """Pitch and yaw in degrees: from Pip a little over to Mara."""
    over = ease(frame, 30, 86)
    return [-1.9 + 0.12 * np.sin(1.3 * seconds(frame)), -0.2 - 1.6 * over + 0.1 * np.sin(0.9 * seconds(frame)), 0.0]


def write_camera(stage: Usd.Stage) -> None:
    """Authors the camera and the render settings that name it."""
    camera = UsdGeom.Camera.Define(stage, CAMERA)
    camera.CreateProjectionAttr(UsdGeom.Tokens.perspective)
    camera.CreateFocalLengthAttr(FOCAL_LENGTH_MM)
    camera.CreateHorizontalApertureAttr(GATE_MM[0])
    camera.CreateVerticalApertureAttr(GATE_MM[1])
    camera.CreateFStopAttr(F_STOP)
    camera.CreateFocusDistanceAttr(290.0)
    camera.CreateClippingRangeAttr(Gf.Vec2f(10.0, 20000.0))
    camera.CreateShutterOpenAttr(-0.25)
    camera.CreateShutterCloseAttr(0.25)
    animate(camera.GetPrim(), translate=camera_place, rotate=camera_turn)
    settings = UsdRender.Settings.Define(stage, RENDER_SETTINGS)
    settings.CreateCameraRel().SetTargets([Sdf.Path(CAMERA)])
    settings.CreateResolutionAttr(Gf.Vec2i(1920, 1080))
    settings.CreateIncludedPurposesAttr(Vt.TokenArray(["default", "render"]))
    _write_products(stage, settings)


def _write_products(stage: Usd.Stage, settings: UsdRender.Settings) -> None:
    """Authors what `pullfocus record --products` writes: the picture with depths and mattes, and all sharp for reference."""
    scope = settings.GetPath().GetParentPath()
    for name, source, kind in (
        ("color", "color", "color4f"),
        ("depth", "cameraDepth", "float"),
        ("objects", "cryptoObject", "float4"),
    ):
        var = UsdRender.Var.Define(stage, scope.AppendChild(name))
        var.CreateSourceNameAttr(source)
        var.CreateDataTypeAttr(kind)
    beauty = UsdRender.Product.Define(stage, scope.AppendChild("Beauty"))
    beauty.CreateProductNameAttr("beauty.####.exr")
    beauty.CreateOrderedVarsRel().SetTargets([scope.AppendChild(name) for name in ("color", "depth", "objects")])
    sharp = UsdRender.Product.Define(stage, scope.AppendChild("Sharp"))
    sharp.CreateProductNameAttr("sharp/reference.####.png")
    sharp.CreateDisableDepthOfFieldAttr(True)
    for product in (beauty, sharp):
        product.CreateResolutionAttr(Gf.Vec2i(960, 540))
    settings.CreateProductsRel().SetTargets([beauty.GetPath(), sharp.GetPath()])
