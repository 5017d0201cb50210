"""Boxes of Gaussian splats without an authored extent: of draw modes, parts, framing and orthographic cameras."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.stage import StageReader, anchor_position, read_camera
from render.stage.camera.framing import framing_camera
from render.stage.geometry.splat_boxes import EXTENT_SIGMAS, box_below, splat_extent
from tests.render.kits.stages import add_mesh, new_stage
from usd_schemas import FocusPoint

TIME = Usd.TimeCode(0)
PURPOSES = ("default",)


def add_cloud(stage: Usd.Stage, path: str = "/model/cloud", *, count: int = 20) -> Usd.Prim:
    """Splats at random, turned and stretched."""
    random = np.random.default_rng(4)
    prim = stage.DefinePrim(path, "ParticleField3DGaussianSplat")
    prim.GetAttribute("positions").Set(Vt.Vec3fArray.FromNumpy(random.normal(size=(count, 3)).astype(np.float32)))
    prim.GetAttribute("scales").Set(Vt.Vec3fArray.FromNumpy(random.uniform(0.1, 1, (count, 3)).astype(np.float32)))
    turns = random.normal(size=(count, 4)).astype(np.float32)
    prim.GetAttribute("orientations").Set(Vt.QuatfArray.FromNumpy(turns))
    return prim


def corners(box: Gf.Range3d) -> np.ndarray:
    return np.array([box.GetMin(), box.GetMax()])


def test_an_extent_bounds_each_ellipsoid() -> None:
    """The box of points on the ellipsoids of three standard deviations."""
    stage = new_stage()
    prim = add_cloud(stage)
    (batch,) = StageReader(stage).read(0).splats
    random = np.random.default_rng(1)
    on_ball = random.normal(size=(5_000, 3))
    on_ball *= EXTENT_SIGMAS / np.linalg.norm(on_ball, axis=1, keepdims=True)
    cloud = batch.cloud
    points = np.einsum("nij,mj->nmi", cloud.axes, on_ball) + cloud.positions[:, None]
    expected = np.array([points.min(axis=(0, 1)), points.max(axis=(0, 1))])
    extent = splat_extent(prim, TIME)
    assert extent is not None
    np.testing.assert_allclose(extent, expected, atol=0.02 * np.ptp(expected))


def test_splats_that_cannot_be_read_have_no_extent() -> None:
    stage = new_stage()
    assert splat_extent(stage.DefinePrim("/none", "ParticleField3DGaussianSplat"), TIME) is None
    prim = add_cloud(stage, "/far", count=2)
    prim.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(float("nan"), 0, 0), Gf.Vec3f(3e38, 0, 0)]))
    assert splat_extent(prim, TIME) is None
    assert box_below(stage.GetPseudoRoot(), TIME, PURPOSES).IsEmpty()


def test_a_box_joins_splats_and_surfaces() -> None:
    stage = new_stage()
    model = UsdGeom.Xform.Define(stage, "/model")
    model.AddTranslateOp().Set(Gf.Vec3d(100, 0, 0))
    prim = add_cloud(stage)
    UsdGeom.Xformable(prim).AddTranslateOp().Set(Gf.Vec3d(0, 10, 0))
    add_mesh(stage, "/model/mesh", [(0, 0, 0), (0, -20, 0), (1, 0, 0)], [3], [0, 1, 2])
    own = splat_extent(prim, TIME)
    assert own is not None
    box = corners(box_below(model.GetPrim(), TIME, PURPOSES))
    np.testing.assert_allclose(box[:, 1], [-20, own[1, 1] + 10], rtol=1e-6)
    whole = corners(box_below(stage.GetPseudoRoot(), TIME, PURPOSES))
    np.testing.assert_allclose(whole, box + np.array([100, 0, 0]), rtol=1e-6)


@pytest.mark.parametrize("why", ["hidden", "purpose", "extent", "hint"])
def test_splats_count_as_other_shapes_do(why: str) -> None:
    stage = new_stage()
    UsdGeom.Xform.Define(stage, "/model")
    prim = add_cloud(stage)
    expected = None
    if why == "hidden":
        UsdGeom.Imageable(stage.GetPrimAtPath("/model")).MakeInvisible()
    elif why == "purpose":
        UsdGeom.Imageable(prim).CreatePurposeAttr("guide")
    elif why == "extent":
        expected = [[-1, -2, -3], [1, 2, 3]]
        UsdGeom.Boundable(prim).CreateExtentAttr([Gf.Vec3f(*corner) for corner in expected])
    else:
        expected = [[-5, -5, -5], [5, 5, 5]]
        Usd.ModelAPI(stage.GetPrimAtPath("/model")).SetKind("component")
        hints = UsdGeom.ModelAPI.Apply(stage.GetPrimAtPath("/model"))
        hints.SetExtentsHint([Gf.Vec3f(*corner) for corner in expected])
    box = box_below(stage.GetPseudoRoot(), TIME, PURPOSES)
    assert box.IsEmpty() if expected is None else np.allclose(corners(box), expected)


def test_draw_modes_show_the_box_of_splats() -> None:
    stage = new_stage()
    UsdGeom.Xform.Define(stage, "/model")
    Usd.ModelAPI(stage.GetPrimAtPath("/model")).SetKind("component")
    prim = add_cloud(stage)
    model = UsdGeom.ModelAPI.Apply(stage.GetPrimAtPath("/model"))
    model.CreateModelApplyDrawModeAttr(True)
    extent = splat_extent(prim, TIME)
    assert extent is not None
    for mode in ("bounds", "cards"):
        model.CreateModelDrawModeAttr().Set(mode)
        reader = StageReader(stage)
        scene = reader.read(0)
        assert not reader.findings
        assert not scene.splats
        places = np.concatenate(
            [b.geometry.positions @ b.poses[0][:3, :3].T + b.poses[0][:3, 3] for b in scene.batches]
        )
        np.testing.assert_allclose([places.min(axis=0), places.max(axis=0)], extent, atol=0.03)  # bars have a width


def test_framing_sees_all_of_the_splats() -> None:
    stage = new_stage()
    near = add_cloud(stage, "/near")
    camera = framing_camera(stage, 0)
    UsdGeom.Xformable(add_cloud(stage, "/right")).AddTranslateOp().Set(Gf.Vec3d(40, 0, 0))
    assert near
    assert framing_camera(stage, 0).world_from_camera[0, 3] > camera.world_from_camera[0, 3]


def test_orthographic_cameras_keep_splats_beyond_other_things() -> None:
    stage = new_stage()
    add_mesh(stage, "/near", [(0, 0, -3), (1, 0, -3), (0, 1, -4)], [3], [0, 1, 2])
    UsdGeom.Xformable(add_cloud(stage, "/far")).AddTranslateOp().Set(Gf.Vec3d(0, 0, -50))
    lens = UsdGeom.Camera.Define(stage, "/cam")
    lens.CreateProjectionAttr("orthographic")
    lens.CreateClippingRangeAttr(Gf.Vec2f(1, 100))
    camera = read_camera(stage, "/cam", 0)
    assert camera.far_m - camera.set_back_m >= 50


def test_a_focus_point_follows_the_bounds_of_splats() -> None:
    stage = new_stage()
    extent = splat_extent(add_cloud(stage), TIME)
    assert extent is not None
    point = FocusPoint("p", target=("/gone",), part="/model/cloud", bounds_point=(1, 0.5, 0))
    expected = [extent[1, 0], extent[:, 1].mean(), extent[0, 2]]
    np.testing.assert_allclose(anchor_position(stage, point, 0), expected, rtol=1e-6)


@pytest.mark.parametrize("kind", ["Cube", "ParticleField3DGaussianSplat"])
def test_a_billion_nested_instances_are_not_walked(kind: str) -> None:
    stage = new_stage()
    stage.CreateClassPrim("/P0")
    stage.DefinePrim("/P0/x", kind)
    for level in range(1, 10):
        stage.CreateClassPrim(f"/P{level}")
        for number in range(10):
            prim = stage.DefinePrim(f"/P{level}/i{number}", "Xform")
            prim.GetReferences().AddInternalReference(f"/P{level - 1}")
            prim.SetInstanceable(True)
    stage.DefinePrim("/model", "Xform").GetReferences().AddInternalReference("/P9")
    assert box_below(stage.GetPseudoRoot(), TIME, PURPOSES).IsEmpty() == (kind != "Cube")
