"""Shots in which cards and posts move while the shutter is open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom

from render.film import Grade
from render.frame import FrameRenderer, FrameSettings
from render.pictures.picture import make_picture
from render.shot import Shot
from usd_schemas import FilmData, LensCamera
from usd_schemas import Shutter as ShutterData

STILL = FrameSettings(240, 120, engine="pinhole", shading="unlit", rays=1, supersample=1)


def write_moving(path: Path, *, shutter: ShutterData | None = None, closes: float = 0.5) -> Path:
    """Write a shot of a white card that moves to the right by 1 m a frame.

    The card is 0.2 m wide and 1.2 m high, 2 m before a pinhole camera that sees 2.4 by 1.2 m there, so it moves by 100
    pixels a frame. The shutter opens at each frame's time and closes ``closes`` frames later.
    """
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Y")
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(3)
    card = UsdGeom.Mesh.Define(stage, "/card")
    corners = ((-0.1, -0.6), (0.1, -0.6), (0.1, 0.6), (-0.1, 0.6))
    card.CreatePointsAttr([Gf.Vec3f(x, y, -2) for x, y in corners])
    card.CreateFaceVertexCountsAttr([4])
    card.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    card.CreateDisplayColorAttr([Gf.Vec3f(1, 1, 1)])
    moves = card.AddTranslateOp()
    for frame in (1, 3):
        moves.Set(Gf.Vec3d(frame - 1.5, 0, 0), frame)
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateFocalLengthAttr(0.2)
    camera.CreateHorizontalApertureAttr(0.24)
    camera.CreateVerticalApertureAttr(0.12)
    camera.CreateShutterOpenAttr(0.0)
    camera.CreateShutterCloseAttr(closes)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 10))
    if shutter is not None:
        LensCamera(camera.GetPrim()).film.author(FilmData(shutter=shutter))
    stage.Save()
    return path


def coverage(renderer: FrameRenderer, shot: Shot, motion: int) -> np.ndarray:
    """Render the coverage at frame 1, ``(height, width)``, from a number of shutter samples."""
    return make_picture(renderer, shot, "/cam", 1.0, replace(STILL, motion=motion), Grade()).frame.color[..., 3]


def add_card(
    stage: Usd.Stage, path: str, *, size: tuple[float, float], depth: float, colour: tuple[float, float, float]
) -> UsdGeom.Mesh:
    """Add a two-sided rectangle that faces the camera, ``size`` and ``depth`` in metres."""
    card = UsdGeom.Mesh.Define(stage, path)
    x, y = size[0] / 2, size[1] / 2
    card.CreatePointsAttr([Gf.Vec3f(*at, -depth) for at in ((-x, -y), (x, -y), (x, y), (-x, y))])
    card.CreateFaceVertexCountsAttr([4])
    card.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    card.CreateDisplayColorAttr([Gf.Vec3f(*colour)])
    card.CreateDoubleSidedAttr(True)
    return card


def write_posts_shot(path: Path, *, f_stop: float = 2.0) -> Usd.Stage:
    """Make a room: a striped wall 8 m away, three posts in front of it, a camera that focuses 3 m away."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Y")
    for i in range(24):
        shade = 0.2 + 0.6 * (i % 2)
        stripe = add_card(stage, f"/wall/s{i}", size=(0.5, 6), depth=8, colour=(shade, 0.5, 1 - shade))
        stripe.AddTranslateOp().Set(Gf.Vec3d(0.5 * (i - 11.5), 0, 0))
    for i, depth in enumerate((2.5, 4.0, 6.0)):
        post = add_card(stage, f"/posts/p{i}", size=(0.15, 5), depth=depth, colour=(0.9, 0.3 * i, 0.1))
        post.AddTranslateOp().Set(Gf.Vec3d(0.8 * (i - 1), 0, 0))
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.CreateFocalLengthAttr(0.3)
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.2025)
    camera.CreateFStopAttr(f_stop / 10)
    camera.CreateFocusDistanceAttr(3.0)
    camera.CreateShutterOpenAttr(0.0)
    camera.CreateShutterCloseAttr(0.5)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    return stage


def key_move(op: UsdGeom.XformOp, first: Gf.Vec3d, last: Gf.Vec3d) -> None:
    """Key a movement over the half frame in which the shutter is open at frame 1."""
    op.Set(first, 1.0)
    op.Set(last, 1.5)
