"""Cameras that frame the subject of a focus point by its size."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from render.errors import CameraError, NotFoundError, PullfocusError, SettingsError
from render.shot import Shot
from render.shot.camera.placing import CameraPlace
from render.shot.camera.subject_framing import PictureField, Subject, framing_pupil
from render.stage import read_camera
from tests.render.kits.focus_shot import CAMERA, Units, write_shot
from usd_schemas import FocusPoint

SHARE = 2 / 3
HALF_HEIGHT = 20.25 / 50 / 2
"""Slope of the upper edge of the picture of the shot's camera."""
METRES, CM_Z_UP = Units(), Units(metres=0.01, up="Z")


def open_shot(tmp_path: Path, units: Units = METRES, change=None) -> Shot:
    """Open the shot with a ball of 0.5 m at (0.4, 1.2, -2) m, with a focus point on it, changed by ``change(stage)``."""
    path = write_shot(tmp_path / "shot.usda", units)
    stage = Usd.Stage.Open(str(path))
    ball = UsdGeom.Sphere.Define(stage, "/World/ball")
    ball.CreateRadiusAttr(0.5 / units.metres)
    ball.AddTranslateOp().Set(Gf.Vec3d(0.4, 1.2, -2) / units.metres)
    if change is not None:
        change(stage)
    stage.Save()
    shot = Shot.open(path)
    shot.focus.add_point(CAMERA, "ball", FocusPoint(name="ball", target=("/World/ball",)))
    return shot


def eye_of(shot: Shot, time: float) -> tuple[np.ndarray, np.ndarray]:
    """``(3,)`` place and ``(3, 3)`` rows: right, up and ahead."""
    frame = read_camera(shot.stage, CAMERA, time).world_from_camera
    return frame[:3, 3], frame[:3, :3].T * [[1], [1], [-1]]


@pytest.mark.parametrize("units", [METRES, CM_Z_UP], ids=["m", "cm, z up"])
@pytest.mark.parametrize("ahead", [(0, 0, -1), (1, -0.5, -1)], ids=["level", "turned"])
def test_a_ball_fills_two_thirds_of_the_height(tmp_path, units, ahead):
    shot = open_shot(tmp_path, units)
    shot.camera.move(CAMERA, CameraPlace((3, 2, 8), ahead, (0, 1, 0)), 5)
    _, before = eye_of(shot, 5)
    shot.plan.frame_subject(CAMERA, "ball", 5)
    place, axes = eye_of(shot, 5)
    assert axes == pytest.approx(before, abs=1e-9)
    distance = 0.5 * math.sqrt(1 + 1 / (SHARE * HALF_HEIGHT) ** 2)
    assert axes @ ([0.4, 1.2, -2] - place) == pytest.approx([0, 0, distance], abs=1e-6)
    shot.plan.frame_subject(CAMERA, "ball", 5, aspect=0.5)  # the gate grows in height, and the width is filled first
    distance = 0.5 * math.sqrt(1 + 1 / (SHARE * 36 / 50 / 2) ** 2)
    assert axes @ ([0.4, 1.2, -2] - eye_of(shot, 5)[0]) == pytest.approx([0, 0, distance], abs=1e-6)


def outline(subject: Subject, pupil: np.ndarray, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest slopes, ``(2,)`` each, of dense places on an ellipsoid."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 721), np.linspace(0, np.pi, 361))
    ball = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)]).reshape(3, -1)
    seen = axes @ (subject.middle_m[:, None] + subject.halves_m @ ball - pupil[:, None])
    slopes = seen[:2] / seen[2]
    return slopes.min(axis=1), slopes.max(axis=1)


@pytest.mark.parametrize("share", [0.2, SHARE, 0.95])
@pytest.mark.parametrize("field", [PictureField(-0.4, 0.4, -0.2, 0.2), PictureField(-0.1, 0.5, -0.3, 0.1)])
def test_the_outline_is_in_the_middle_and_fills_the_share(field, share):
    random = np.random.default_rng(1)
    for _ in range(5):
        subject = Subject(random.normal(size=3), random.normal(size=(3, 3)) * [0.1, 1, 2])
        axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
        axes[2] *= np.sign(np.linalg.det(np.array([axes[0], axes[1], -axes[2]])))
        least, most = outline(subject, framing_pupil(subject, axes, field, share), axes)
        assert (least + most) / 2 == pytest.approx(field.middle, abs=2e-4)
        assert ((most - least) / field.size).max() == pytest.approx(share, rel=1e-3)


def test_a_key_frames_the_subject_where_it_is_then(tmp_path):
    shot = open_shot(tmp_path)
    shot.focus.add_point(CAMERA, "card", FocusPoint(name="card", target=("/World/near",)))
    shot.camera.move(CAMERA, CameraPlace((0, 1, 10), (0, 0, -1), (0, 1, 0)), 1, is_keyed=True)
    shot.plan.frame_subject(CAMERA, "card", 13, is_keyed=True)
    assert shot.camera.place_keys(CAMERA) == [1, 13]
    assert eye_of(shot, 1)[0] == pytest.approx([0, 1, 10])
    # The flat card is 1 m wide and 2 m high, and 3 m to the right by then.
    assert eye_of(shot, 13)[0] == pytest.approx([3, 1, 6 + 1 / (SHARE * HALF_HEIGHT)])
    assert shot.edits.history.undo_label == "frame card"


def test_a_point_in_a_part_frames_all_of_the_part(tmp_path):
    def two(stage: Usd.Stage) -> None:
        other = UsdGeom.Sphere.Define(stage, "/World/ball/other")
        other.AddTranslateOp().Set(Gf.Vec3d(0, 4, 0))
        other.CreateRadiusAttr(0.5)

    shot = open_shot(tmp_path, change=two)
    shot.focus.follow_part(CAMERA, "ball", "/World/ball", 1)
    shot.plan.frame_subject(CAMERA, "ball", 1)
    place, _ = eye_of(shot, 1)
    assert place[:2] == pytest.approx([0.4, 3.2])  # the middle of both
    far = place[2] + 2
    assert far == pytest.approx(math.sqrt(0.25 + (2.5 / (SHARE * HALF_HEIGHT)) ** 2), rel=1e-7)


def empty(stage: Usd.Stage) -> None:
    UsdGeom.Sphere(stage.GetPrimAtPath("/World/ball")).GetRadiusAttr().Set(0.0)


def no_number(stage: Usd.Stage) -> None:
    prim = stage.GetPrimAtPath("/World/ball")
    UsdGeom.Boundable(prim).CreateExtentAttr([Gf.Vec3f(math.nan), Gf.Vec3f(1)])


def only_a_place(stage: Usd.Stage) -> None:
    stage.GetPrimAtPath("/World/ball").SetTypeName("Xform")


@pytest.mark.parametrize("change", [empty, no_number, only_a_place])
def test_a_subject_without_a_size_is_framed_by_its_place(tmp_path, change):
    shot = open_shot(tmp_path, change=change)
    shot.plan.frame_subject(CAMERA, "ball", 1)
    assert eye_of(shot, 1)[0] == pytest.approx([0.4, 1.2, -2 + 0.3 / HALF_HEIGHT])


def huge(stage: Usd.Stage) -> None:
    prim = stage.GetPrimAtPath("/World/ball")
    UsdGeom.Boundable(prim).CreateExtentAttr([Gf.Vec3f(-1e38), Gf.Vec3f(1e38)])


def flat(stage: Usd.Stage) -> None:
    UsdGeom.Xformable(stage.GetPrimAtPath("/World/ball")).AddScaleOp().Set(Gf.Vec3f(math.inf, 1, 1))


@pytest.mark.parametrize("change", [huge, flat])
def test_subjects_beyond_reach_are_refused(tmp_path, change):
    shot = open_shot(tmp_path, change=change)
    before = shot.edits.state()
    with pytest.raises(PullfocusError, match=r"finite"):
        shot.plan.frame_subject(CAMERA, "ball", 1)
    assert shot.edits.state() == before


def test_an_orthographic_camera_keeps_its_depth(tmp_path):
    def orthographic(stage: Usd.Stage) -> None:
        UsdGeom.Camera(stage.GetPrimAtPath(CAMERA)).CreateProjectionAttr(UsdGeom.Tokens.orthographic)

    shot = open_shot(tmp_path, change=orthographic)
    shot.plan.frame_subject(CAMERA, "ball", 1)
    assert shot.plan.read(CAMERA, 1).position_m == pytest.approx([0.4, 1.2, 10], abs=1e-4)


@pytest.mark.parametrize("share", [0, 1, -0.5, math.nan, math.inf])
def test_shares_that_cannot_be_are_refused(tmp_path, share):
    with pytest.raises(SettingsError, match="share"):
        open_shot(tmp_path).plan.frame_subject(CAMERA, "ball", 1, share=share)


def test_points_that_are_nowhere_are_refused(tmp_path):
    shot = open_shot(tmp_path)
    shot.focus.add_point(CAMERA, "gone", FocusPoint(name="gone", target=("/World/ball",)))
    shot.stage.GetPrimAtPath("/World/ball").SetActive(False)
    with pytest.raises(NotFoundError) as found:
        shot.plan.frame_subject(CAMERA, "gone", 1)
    assert found.value.code == "no_place"
    with pytest.raises(NotFoundError, match="no focus point"):
        shot.plan.frame_subject(CAMERA, "none", 1)
    with pytest.raises(CameraError):
        shot.plan.frame_subject("/World/near", "ball", 1)
