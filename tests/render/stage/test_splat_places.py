"""Gaussian splats where their prims stand: transforms, mirrors and instances, against points that are moved one by one."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, Vt

from render.layers.splats import project_splats
from render.model.arrays import DoubleArray, FloatArray
from render.model.splats import SplatBatch
from render.optics.view import PinholeView
from render.stage import StageReader
from tests.render.kits.splats import CAMERA, SIZE
from tests.render.kits.stages import instancer, new_stage, read

VIEW = PinholeView.from_camera(CAMERA, *SIZE)
KIND = "ParticleField3DGaussianSplat"
AXES = np.array([0.02, 0.01, 0.005])
PLACE = np.array([0.1, 0.05, -0.2])
FIRST = 0.4886025119029199  # spherical harmonics of degree 1

TRANSFORMS = {
    "turned": [("RotateXYZ", Gf.Vec3f(20, -35, 70))],
    "stretched": [("RotateXYZ", Gf.Vec3f(0, 0, 30)), ("Scale", Gf.Vec3f(3, 0.5, 1.5))],
    "sheared": [("Scale", Gf.Vec3f(1, 3, 1)), ("RotateXYZ", Gf.Vec3f(30, 20, 40))],
    "mirrored": [("Scale", Gf.Vec3f(-1, 1, 1)), ("RotateXYZ", Gf.Vec3f(10, 50, 20))],
    "flat": [("RotateXYZ", Gf.Vec3f(0, 40, 0)), ("Scale", Gf.Vec3f(2, 1, 0))],
}


def add_splat(stage: Usd.Stage, path: str) -> Usd.Prim:
    """One splat whose red lies along +x of its own space, green along +y and blue along +z."""
    prim = stage.DefinePrim(path, KIND)
    lobes = np.zeros((4, 3), np.float32)
    lobes[3, 0] = lobes[1, 1] = -0.4 / FIRST
    lobes[2, 2] = 0.4 / FIRST
    values = {
        "positions": Vt.Vec3fArray([Gf.Vec3f(*PLACE.tolist())]),
        "scales": Vt.Vec3fArray([Gf.Vec3f(*AXES.tolist())]),
        "opacities": Vt.FloatArray([0.5]),
        "radiance:sphericalHarmonicsDegree": 1,
        "radiance:sphericalHarmonicsCoefficients": Vt.Vec3fArray.FromNumpy(lobes),
    }
    for name, value in values.items():
        prim.GetAttribute(name).Set(value)
    prim.GetAttribute("radiance:sphericalHarmonicsCoefficients").SetColorSpace("lin_rec709_scene")
    return prim


def transform(stage: Usd.Stage, path: str, kind: str) -> DoubleArray:
    """Transform a prim above a cloud, three units in front of the camera. Returns its matrix, for columns."""
    xform = UsdGeom.Xform.Define(stage, path)
    xform.AddTranslateOp().Set(Gf.Vec3d(0.2, -0.1, -3))
    for name, value in TRANSFORMS[kind]:
        getattr(xform, f"Add{name}Op")().Set(value)
    return np.array(xform.GetLocalTransformation(), np.float64).T


def covariance(record: FloatArray) -> DoubleArray:
    factor = np.array([[record[4], 0], [record[5], record[6]]], np.float64)
    return factor @ factor.T


def records(batches: tuple[SplatBatch, ...]) -> FloatArray:
    return project_splats(batches, VIEW, 0.0).records


def expected_covariance(matrix: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Centre and covariance in pixels of a splat's points, each moved by a matrix and projected by itself; small steps for a
    derivative."""
    centre = matrix[:3, :3] @ PLACE + matrix[:3, 3]
    step = 1e-4
    ends = centre + step * (matrix[:3, :3] * AXES).T
    (middle, *moved), _ = VIEW.project(np.concatenate([centre[None], ends]))
    slopes = (np.array(moved) - middle) / step
    return middle, slopes.T @ slopes


@pytest.mark.parametrize("kind", TRANSFORMS)
def test_transforms_above_a_cloud_move_and_stretch_it(kind: str) -> None:
    stage = new_stage()
    matrix = transform(stage, "/set", kind)
    add_splat(stage, "/set/cloud")
    (record,) = records(read(stage).splats)
    centre, expected = expected_covariance(matrix)
    np.testing.assert_allclose(record[:2], centre, rtol=1e-5)
    np.testing.assert_allclose(covariance(record), expected, rtol=2e-3, atol=2e-5)
    assert np.isfinite(record).all()


@pytest.mark.parametrize("kind", ["turned", "mirrored", "stretched"])
def test_colours_are_seen_from_the_clouds_own_space(kind: str) -> None:
    """A lobe stays on the side of the cloud that it is on, whatever turns, mirrors or stretches that."""
    stage = new_stage()
    matrix = transform(stage, "/set", kind)
    add_splat(stage, "/set/cloud")
    batches = read(stage).splats
    (record,), to_working = records(batches), batches[0].cloud.to_working
    towards = PLACE - np.linalg.solve(matrix, [0, 0, 0, 1])[:3]
    towards /= np.linalg.norm(towards)
    expected = 0.5 + 0.4 * towards  # all of them shine forward, along the direction of view
    assert to_working is not None
    np.testing.assert_allclose(record[8:11], to_working @ np.maximum(expected, 0), atol=1e-4)
    assert np.ptp(expected) > 0.1


def test_instances_have_the_transforms_of_theirs() -> None:
    """A native instance of a turned set, and a point instancer's with a scale and a turn of their own."""
    stage = new_stage()
    stage.CreateClassPrim("/_set")
    inner = transform(stage, "/_set/inner", "stretched")
    add_splat(stage, "/_set/inner/cloud")
    expected = []
    for number, x in enumerate((-0.5, 0.5)):
        prim = UsdGeom.Xform.Define(stage, f"/i{number}")
        prim.GetPrim().GetReferences().AddInternalReference("/_set")
        prim.GetPrim().SetInstanceable(True)
        prim.AddTranslateOp().Set(Gf.Vec3d(x, 0, -1 - number))
        expected.append(expected_covariance(np.array(prim.GetLocalTransformation()).T @ inner))
    found = records(read(stage).splats)[::-1]
    for record, (centre, spread) in zip(found, expected, strict=True):
        np.testing.assert_allclose(record[:2], centre, rtol=1e-5)
        np.testing.assert_allclose(covariance(record), spread, rtol=2e-3, atol=2e-5)
    paths = read(stage).prim_paths
    assert [paths[batch.prim_id] for batch in read(stage).splats] == ["/i0/inner/cloud", "/i1/inner/cloud"]


def test_point_instances_have_scales_and_turns_of_their_own() -> None:
    stage = new_stage()
    add_splat(stage, "/many/proto/cloud")
    many = instancer(stage, "/many", ["/many/proto"], [0, 0, 0])
    places = [(-0.4, 0, -2), (0.3, 0.1, -3), (0, 0, -4)]
    many.CreatePositionsAttr([Gf.Vec3f(*place) for place in places])
    many.CreateScalesAttr([Gf.Vec3f(1, 2, 1), Gf.Vec3f(-2, 1, 1), Gf.Vec3f(1)])
    turn = Gf.Rotation(Gf.Vec3d(1, 2, 3), 50)
    many.CreateOrientationsAttr([Gf.Quath(turn.GetQuat())] * 3)
    many.CreateInvisibleIdsAttr([2])
    found = records(read(stage).splats)[::-1]
    assert len(found) == 2
    about = np.array(Gf.Matrix3d(turn), np.float64).T
    for record, place, scale in zip(found, places, ((1, 2, 1), (-2, 1, 1)), strict=False):
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = about * scale, place
        centre, spread = expected_covariance(matrix)
        np.testing.assert_allclose(record[:2], centre, atol=0.05)  # half-precision turns
        np.testing.assert_allclose(covariance(record), spread, rtol=1e-2, atol=1e-4)


def test_what_is_above_a_cloud_hides_it_and_gives_its_purpose() -> None:
    stage = new_stage()
    for name in ("shown", "hidden", "guide"):
        UsdGeom.Xform.Define(stage, f"/{name}")
        add_splat(stage, f"/{name}/cloud")
    visibility = UsdGeom.Imageable(stage.GetPrimAtPath("/hidden")).CreateVisibilityAttr()
    visibility.Set("invisible", 0)
    visibility.Set("inherited", 5)
    UsdGeom.Imageable(stage.GetPrimAtPath("/guide")).CreatePurposeAttr("guide")
    reader = StageReader(stage)
    assert [len(reader.read(time).splats) for time in (0, 5, 0)] == [1, 2, 1]


@pytest.mark.parametrize("scale", [(0, 0, 0), (1e-30, 1e-30, 1e-30), (1e30, 1e30, 1e30), (1e30, 1, 1)])
def test_extreme_transforms_make_no_bad_numbers(scale: tuple[float, float, float]) -> None:
    stage = new_stage()
    xform = UsdGeom.Xform.Define(stage, "/set")
    xform.AddTranslateOp().Set(Gf.Vec3d(0, 0, -3))
    xform.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*scale))
    prim = add_splat(stage, "/set/cloud")
    prim.GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(0)]))
    assert np.isfinite(records(read(stage).splats)).all()
