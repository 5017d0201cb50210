"""Points move between samples by their velocities and accelerations (UsdGeomPointBased), whatever the faces do."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.stage import AnchorReader, StageReader
from tests.render.kits.stages import QUAD_POINTS, add_mesh, codes, new_stage, only_batch, world_points
from usd_schemas import FocusPoint


def add_flying(stage: Usd.Stage, acceleration: float = 0.0) -> UsdGeom.Mesh:
    """A square that flies along z at 24 units in a second, and is a triangle from time 10 on."""
    stage.SetTimeCodesPerSecond(24)
    mesh = add_mesh(stage, "/m")
    points, counts, corners = mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    points.Set([Gf.Vec3f(*each) for each in QUAD_POINTS], 0)
    points.Set([Gf.Vec3f(*each) for each in QUAD_POINTS[:3]], 10)
    counts.Set([4], 0)
    counts.Set([3], 10)
    corners.Set([0, 1, 2, 3], 0)
    corners.Set([0, 1, 2], 10)
    for time, count in ((0, 4), (10, 3)):
        mesh.CreateVelocitiesAttr().Set(Vt.Vec3fArray([Gf.Vec3f(0, 0, 24)] * count), time)
        if acceleration:
            mesh.CreateAccelerationsAttr().Set(Vt.Vec3fArray([Gf.Vec3f(0, 0, acceleration)] * count), time)
    return mesh


@pytest.mark.parametrize(("acceleration", "height"), [(0.0, 6.0), (48.0, 6 + 48 * 0.25**2 / 2)])
def test_points_fly_on_from_their_sample(acceleration: float, height: float) -> None:
    stage = new_stage()
    add_flying(stage, acceleration)
    reader = StageReader(stage)
    shapes = {time: world_points(only_batch(reader.read(time))) for time in (0.0, 6.0, 10.0, 16.0)}
    assert [len(points) for points in shapes.values()] == [4, 4, 3, 3]
    np.testing.assert_allclose([points[:, 2].max() for points in shapes.values()], [0, height, 0, height], atol=1e-5)
    assert codes(reader) == set()
    point = FocusPoint("p", ("/m",), face=0, fan_triangle=0, barycentric=(0.5, 0.25, 0.25))
    assert AnchorReader(stage).position(point, 6.0)[2] == pytest.approx(height)


def test_particles_fly_too() -> None:
    stage = new_stage()
    stage.SetTimeCodesPerSecond(24)
    points = UsdGeom.Points.Define(stage, "/p")
    points.CreatePointsAttr().Set([Gf.Vec3f(0)], 0)
    points.CreateVelocitiesAttr().Set([Gf.Vec3f(24, 0, 0)], 0)
    points.CreateWidthsAttr([2.0])
    reader = StageReader(stage)
    for time in (0.0, 5.0):
        ball = world_points(only_batch(reader.read(time)))
        np.testing.assert_allclose((ball.min(axis=0) + ball.max(axis=0)) / 2, [time, 0, 0], atol=1e-3)


def test_velocities_of_other_times_are_named_and_points_interpolated() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    mesh.GetPointsAttr().Set([Gf.Vec3f(*each) for each in QUAD_POINTS], 0)
    mesh.GetPointsAttr().Set([Gf.Vec3f(*each) + Gf.Vec3f(0, 0, 10) for each in QUAD_POINTS], 10)
    mesh.CreateVelocitiesAttr().Set([Gf.Vec3f(0, 0, 240)] * 4, 3)
    reader = StageReader(stage)
    np.testing.assert_allclose(world_points(only_batch(reader.read(5.0)))[:, 2], 5)
    assert codes(reader) == {"bad_velocities"}


def test_velocities_that_do_not_fit_leave_points_in_place() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    mesh.GetPointsAttr().Set([Gf.Vec3f(*each) for each in QUAD_POINTS], 0)
    mesh.CreateVelocitiesAttr().Set([Gf.Vec3f(0, 0, 240)] * 3, 0)
    reader = StageReader(stage)
    np.testing.assert_allclose(world_points(only_batch(reader.read(5.0)))[:, 2], 0)
    assert codes(reader) == {"bad_velocities"}
