"""The focus: one point on each robot's face, and the rack between them as keys on the points' weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from pxr import Usd, UsdGeom

from render.demo.author import FIRST_FRAME, LAST_FRAME, units
from render.demo.camera import CAMERA
from render.demo.performance import MARA, PIP
from usd_schemas.keys import Tangents
from usd_schemas.settings import FocusData, FocusPoint
from usd_schemas.view import LensCamera

RACK_START, RACK_END = 44, 66
HANDLE_FRAMES = 7.0  # of the level handles that ease the rack in and out


def write_focus(stage: Usd.Stage) -> None:
    """Authors the two focus points and the rack."""
    camera = LensCamera(stage.GetPrimAtPath(CAMERA))
    camera.focus.author(FocusData(mode="points"))
    # Pip's brow between the eyes, and Mara's left eye: their own spaces, metres.
    pip = camera.add_focus_point("pip", _anchor(stage, "pip", f"{PIP}/Body/Head/FacePlate", (0.0, 0.20, 0.21)))
    mara = camera.add_focus_point("mara", _anchor(stage, "mara", f"{MARA}/Body/Head/VisorGlow", (0.05, 0.175, 0.155)))
    for point, before, after in ((pip, 1.0, 0.0), (mara, 0.0, 1.0)):
        for time, value in ((FIRST_FRAME, before), (RACK_START, before), (RACK_END, after), (LAST_FRAME, after)):
            point.set_key("weight", time, value, "bezier", Tangents(0.0, HANDLE_FRAMES, 0.0, HANDLE_FRAMES))


def _anchor(stage: Usd.Stage, name: str, path: str, near_m: ArrayLike) -> FocusPoint:
    """A sharp focus point in the middle of the face of a mesh whose middle lies nearest to a place.

    Args:
        stage: stage of the mesh.
        name: of the focus point.
        path: of the mesh.
        near_m: ``(3,)`` metres in the mesh's space.
    """
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(path))
    points = np.asarray(mesh.GetPointsAttr().Get())
    counts = np.asarray(mesh.GetFaceVertexCountsAttr().Get())
    corners = points[np.asarray(mesh.GetFaceVertexIndicesAttr().Get())]
    middles = np.add.reduceat(corners, np.cumsum(counts) - counts) / counts[:, None]
    face = int(np.argmin(np.linalg.norm(middles - units(near_m), axis=1)))
    return FocusPoint(name, (path,), face=face, fan_triangle=0, barycentric=(1 / 3, 1 / 3, 1 / 3))
