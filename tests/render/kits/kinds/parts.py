"""Parts that kinds are authored with."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, Vt

from tests.render.kits.stages import add_mesh, set_primvar

T = Sdf.ValueTypeNames

Author = Callable[[Usd.Stage, str, Path], None]


def as_points(values: object) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.asarray(values, np.float32))


def ball(stage: Usd.Stage, path: str) -> Usd.Prim:
    """Ball of latitude and longitude, with texture coordinates."""
    columns, rows = 48, 24
    around, up = np.meshgrid(np.linspace(0, 2 * np.pi, columns + 1), np.linspace(0, np.pi, rows + 1))
    points = np.stack([np.sin(up) * np.sin(around), -np.cos(up), np.sin(up) * np.cos(around)], axis=2) * 0.8 + (
        0,
        0.8,
        0,
    )
    corner = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    corners = np.stack([corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]], axis=2).reshape(-1)
    mesh = add_mesh(stage, path, points.reshape(-1, 3), [4] * (columns * rows), corners)
    st = np.stack([around / (2 * np.pi), up / np.pi], axis=2).reshape(-1, 2).astype(np.float32)
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "vertex", Vt.Vec2fArray.FromNumpy(st))
    mesh.CreateNormalsAttr(as_points((points - (0, 0.8, 0)).reshape(-1, 3)))
    mesh.SetNormalsInterpolation("vertex")
    return mesh.GetPrim()
