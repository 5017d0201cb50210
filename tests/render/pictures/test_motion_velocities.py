"""Motion from one peeling: what velocities carry through the layers is where peeling every moment anew has it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, UsdGeom

from render.engines import check_settings
from render.errors import SettingsError
from render.film import Grade
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.layers.movement import find_movements
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.optics.view import PinholeView
from render.pictures.picture import expose_frame, make_picture
from render.shot import Shot
from render.trace.moment_view import MomentView
from tests.render.kits.moving_shots import STILL, add_card, coverage, key_move, write_moving, write_posts_shot
from usd_schemas import Shutter as ShutterData

WIDTH, HEIGHT = 128, 72
LENS = FrameSettings(WIDTH, HEIGHT, shading="unlit", rays=32, motion=8, supersample=3)
"""So fine that neither way has a sharp layer, which velocities lack."""


def both(
    renderer: FrameRenderer, path: Path, settings: FrameSettings = LENS
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Radiance at frame 1 from every moment peeled, from velocities, and of a still."""
    shot = Shot.open(path)
    ways = [settings, replace(settings, motion_by="velocities"), replace(settings, motion=1)]
    exact, fast, still = (make_picture(renderer, shot, "/cam", 1.0, way, Grade()).frame.color[..., :3] for way in ways)
    return exact, fast, still


def psnr(one: FloatArray, other: FloatArray) -> float:
    return float(-10 * np.log10(max(float(np.mean((one - other) ** 2)), 1e-12)))


@pytest.mark.parametrize("direction", ["down", "up"])
def test_a_rolling_shutter_leans_what_moves_by_velocities_too(
    renderer: FrameRenderer, tmp_path: Path, direction: str
) -> None:
    rolling = ShutterData(type="rolling", direction=direction, travel_s=0.5 / 24)  # type: ignore[arg-type]
    shot = Shot.open(write_moving(tmp_path / "rolling.usda", shutter=rolling, closes=0.02))
    fast = replace(STILL, motion=26, motion_by="velocities")
    seen = make_picture(renderer, shot, "/cam", 1.0, fast, Grade()).frame.color[..., 3]
    assert seen.sum() == pytest.approx(20 * STILL.height, rel=0.01)
    middles = (seen * np.arange(STILL.width)).sum(axis=1) / seen.sum(axis=1)
    lean = np.polyfit(np.arange(STILL.height), middles, 1)[0] * STILL.height
    assert lean == pytest.approx(50 if direction == "down" else -50, rel=0.02)


def test_a_trail_is_as_long_and_as_bright_by_velocities(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = Shot.open(write_moving(tmp_path / "moving.usda"))
    fast = replace(STILL, motion=50, motion_by="velocities")
    moving = make_picture(renderer, shot, "/cam", 1.0, fast, Grade()).frame.color[..., 3]
    assert moving.sum() == pytest.approx(coverage(renderer, shot, 1).sum(), rel=0.01)
    row = moving[STILL.height // 2]
    lit = np.flatnonzero(row > 0.005)
    assert lit[-1] - lit[0] + 1 == pytest.approx(70, abs=2)
    assert row[lit[0] + 22 : lit[0] + 48] == pytest.approx(0.4, abs=0.04)


@pytest.mark.parametrize("engine", ["lens", "pinhole"])
@pytest.mark.parametrize("way", ["truck", "dolly", "pan", "zoom", "rack"])
def test_what_the_camera_does_needs_no_velocities(
    renderer: FrameRenderer, tmp_path: Path, way: str, engine: str
) -> None:
    stage = write_posts_shot(tmp_path / "camera.usda")
    camera = UsdGeom.Camera.Get(stage, "/cam")
    if way == "truck":
        key_move(camera.AddTranslateOp(), Gf.Vec3d(-0.1, 0, 0), Gf.Vec3d(0.1, 0, 0))
    elif way == "dolly":
        key_move(camera.AddTranslateOp(), Gf.Vec3d(0, 0, 0.2), Gf.Vec3d(0, 0, -0.2))
    elif way == "pan":
        turn = camera.AddRotateYOp()
        turn.Set(-3.0, 1.0)
        turn.Set(3.0, 1.5)
    else:
        values = (0.27, 0.33) if way == "zoom" else (2.2, 6.0)
        attribute = camera.GetFocalLengthAttr() if way == "zoom" else camera.GetFocusDistanceAttr()
        for time, value in zip((1.0, 1.5), values, strict=True):
            attribute.Set(value, time)
    stage.Save()
    exact, fast, still = both(renderer, tmp_path / "camera.usda", replace(LENS, engine=engine))
    assert psnr(exact, fast) > 36
    if (way, engine) != ("rack", "pinhole"):  # which nothing tells apart
        assert psnr(exact, fast) > psnr(exact, still) + 8


MOVES = {
    "across": (Gf.Vec3d(-0.4, 0, 0), Gf.Vec3d(0.4, 0, 0)),
    "towards": (Gf.Vec3d(0.2, 0, -1.0), Gf.Vec3d(0.2, 0, 1.0)),
    "up and away": (Gf.Vec3d(0, -0.3, 0.5), Gf.Vec3d(0.1, 0.3, -0.5)),
}


@pytest.mark.parametrize("engine", ["lens", "pinhole"])
@pytest.mark.parametrize("way", MOVES)
def test_what_moves_uncovers_what_is_behind_it(renderer: FrameRenderer, tmp_path: Path, way: str, engine: str) -> None:
    """In front of a post and behind another one, while the camera trucks the other way."""
    stage = write_posts_shot(tmp_path / "object.usda")
    mover = add_card(stage, "/mover", size=(0.7, 0.8), depth=3.2, colour=(1, 1, 0.2))
    key_move(mover.AddTranslateOp(), *MOVES[way])
    key_move(UsdGeom.Camera.Get(stage, "/cam").AddTranslateOp(), Gf.Vec3d(0.05, 0, 0), Gf.Vec3d(-0.05, 0, 0))
    stage.Save()
    exact, fast, still = both(renderer, tmp_path / "object.usda", replace(LENS, engine=engine))
    assert psnr(exact, fast) > 35
    assert psnr(exact, fast) > psnr(exact, still) + 10


def test_what_bends_and_what_turns_is_carried_by_each_of_its_points(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = write_posts_shot(tmp_path / "bending.usda")
    sheet = add_card(stage, "/sheet", size=(1.2, 1.0), depth=3.0, colour=(0.1, 1, 0.4))
    points = np.array(sheet.GetPointsAttr().Get())
    for time, lean in ((1.0, -0.15), (1.5, 0.15)):
        bent = points + np.array([[lean, 0, 0], [lean, 0, 0], [-lean, 0, 0], [-lean, 0, 0]], np.float32)
        sheet.GetPointsAttr().Set([Gf.Vec3f(*map(float, point)) for point in bent], time)
    wheel = add_card(stage, "/wheel", size=(1.4, 0.3), depth=0.0, colour=(0.2, 0.3, 1))
    wheel.AddTranslateOp().Set(Gf.Vec3d(0.5, 0.4, -3.6))
    turn = wheel.AddRotateZOp()
    turn.Set(0.0, 1.0)
    turn.Set(14.0, 1.5)
    stage.Save()
    exact, fast, still = both(renderer, tmp_path / "bending.usda")
    assert psnr(exact, fast) > 35
    assert psnr(exact, fast) > psnr(exact, still) + 6


def test_an_instancer_moves_instance_by_instance(
    renderer: FrameRenderer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where each is drawn by itself."""
    stage = write_posts_shot(tmp_path / "instances.usda")
    instancer = UsdGeom.PointInstancer.Define(stage, "/many")
    card = add_card(stage, "/many/card", size=(0.3, 0.3), depth=0.0, colour=(1, 0.2, 0.8))
    instancer.CreatePrototypesRel().SetTargets([card.GetPath()])
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    places = np.array([[-1.0, 0.2, -3.0], [0.0, -0.3, -3.5], [1.0, 0.1, -4.0]])
    moves = np.array([[0.3, 0, 0], [0, 0.3, 0], [-0.3, 0.0, 0.2]])
    for time, at, order in ((1.0, places, [2, 0, 1]), (1.5, places + moves, [2, 0, 1])):
        instancer.CreateIdsAttr().Set([10 + i for i in order], time)
        instancer.CreatePositionsAttr().Set([Gf.Vec3f(*map(float, at[i])) for i in order], time)
    stage.Save()
    exact, fast, still = both(renderer, tmp_path / "instances.usda")
    assert psnr(exact, fast) > 35
    assert psnr(exact, fast) > psnr(exact, still) + 6
    monkeypatch.setattr("render.layers.draw_splitter._TRIANGLES", 2)
    monkeypatch.setattr("render.layers.draw_splitter._LEAST_TRIANGLES", 2)
    monkeypatch.setattr("render.layers.draw_splitter._MOST_TRIANGLES", 2)
    with FrameRenderer() as other, other.graphics.cancellation.cancel_when(lambda: False):
        _, one_by_one, _ = both(other, tmp_path / "instances.usda")
    np.testing.assert_array_equal(one_by_one, fast)


def write_particles(path: Path, ids: dict[float, list[int]], *, has_ids: bool) -> Shot:
    """Cards in a row, one for each id and its position by the id; their ids are authored, or are not."""
    stage = write_posts_shot(path)
    instancer = UsdGeom.PointInstancer.Define(stage, "/many")
    card = add_card(stage, "/many/card", size=(0.3, 0.3), depth=0.0, colour=(1, 1, 1))
    instancer.CreatePrototypesRel().SetTargets([card.GetPath()])
    for time, at in ids.items():
        if has_ids:
            instancer.CreateIdsAttr().Set(at, time)
        instancer.CreateProtoIndicesAttr().Set([0] * len(at), time)
        instancer.CreatePositionsAttr().Set([Gf.Vec3f(i, time, -3) for i in at], time)
    stage.Save()
    return Shot.open(path)


def test_instances_are_known_again_by_their_ids(tmp_path: Path) -> None:
    """However many there are and however they are ordered; those that come or go stand still."""
    shot = write_particles(tmp_path / "ids.usda", {1.0: [7, 8], 2.0: [9, 8, 7], 3.0: [8, 7, 9]}, has_ids=True)
    before, middle, after = (shot.scene_at(time) for time in (1.0, 2.0, 3.0))
    movements = find_movements(middle, before, after)
    (batch,) = (batch for batch in middle.batches if len(batch.poses) == 3)
    movement = movements[id(batch)]
    moved = movement.closing_poses[:, :3, 3] - movement.opening_poses[:, :3, 3]
    np.testing.assert_allclose(moved, [[0, 0, 0], [0, 2, 0], [0, 2, 0]], atol=1e-6)
    assert find_movements(middle, middle, middle) == {}


def test_instances_without_ids_stand_still_where_some_come_or_go(tmp_path: Path) -> None:
    """The first of four goes: the others are not taken for their neighbours."""
    shot = write_particles(tmp_path / "none.usda", {1.0: [5, 6, 7, 8], 2.0: [6, 7, 8], 3.0: [6, 7, 8]}, has_ids=False)
    before, middle, after = (shot.scene_at(time) for time in (1.0, 2.0, 3.0))
    (batch,) = (batch for batch in middle.batches if len(batch.poses) == 3)
    assert id(batch) not in find_movements(middle, before, after)


def test_what_is_passed_through_is_counted_once(renderer: FrameRenderer, tmp_path: Path) -> None:
    """A half clear pane that turns and comes nearer covers half of what is behind it, wherever it goes."""
    stage = write_posts_shot(tmp_path / "pane.usda")
    stage.RemovePrim("/wall")
    stage.RemovePrim("/posts")
    pane = add_card(stage, "/pane", size=(1.0, 1.0), depth=0.0, colour=(1, 1, 1))
    pane.CreateDisplayOpacityAttr([0.5])
    key_move(pane.AddTranslateOp(), Gf.Vec3d(-0.1, 0, -4), Gf.Vec3d(0.1, 0, -2.6))
    turn = pane.AddRotateYOp()
    turn.Set(-30.0, 1.0)
    turn.Set(30.0, 1.5)
    stage.Save()
    shot = Shot.open(tmp_path / "pane.usda")
    exact, fast = (
        make_picture(renderer, shot, "/cam", 1.0, replace(LENS, motion_by=way), Grade()).frame.color[..., 3]
        for way in ("moments", "velocities")
    )
    assert fast.max() < 0.52
    assert fast.sum() == pytest.approx(exact.sum(), rel=0.05)
    assert psnr(exact, fast) > 33


CROSSING = {
    "against each other": ((3.0, -0.3, 0.3), (3.3, 0.4, -0.4)),
    "slow before fast": ((3.0, -0.1, 0.1), (3.3, -0.8, 0.8)),
    "fast before slow": ((3.0, -0.8, 0.8), (3.3, 0.1, -0.1)),
}


@pytest.mark.parametrize("engine", ["lens", "pinhole"])
@pytest.mark.parametrize("way", CROSSING)
def test_things_that_cross_are_distinguished(renderer: FrameRenderer, tmp_path: Path, way: str, engine: str) -> None:
    stage = write_posts_shot(tmp_path / "crossing.usda")
    for name, colour, (depth, begins, ends) in zip("ab", ((1, 1, 0.2), (1, 0.1, 0.8)), CROSSING[way], strict=True):
        card = add_card(stage, f"/{name}", size=(0.6, 0.8), depth=depth, colour=colour)
        key_move(card.AddTranslateOp(), Gf.Vec3d(begins, 0, 0), Gf.Vec3d(ends, 0.1, 0))
    stage.Save()
    exact, fast, _ = both(renderer, tmp_path / "crossing.usda", replace(LENS, engine=engine))
    assert psnr(exact, fast) > 35


HARD = {
    "close before a wall": ((1.6, 2.0), Gf.Vec3d(-0.8, 0, -7.9), Gf.Vec3d(0.8, 0, -7.9)),
    "into the picture": ((1.2, 1.2), Gf.Vec3d(-3.5, 0, -3.2), Gf.Vec3d(-0.9, 0, -3.2)),
    "past the eye": ((0.2, 0.2), Gf.Vec3d(0.15, 0, -1.4), Gf.Vec3d(0.15, 0, 0.4)),
}


@pytest.mark.parametrize("engine", ["lens", "pinhole"])
@pytest.mark.parametrize("way", HARD)
def test_what_moves_is_seen_wherever_it_goes(renderer: FrameRenderer, tmp_path: Path, way: str, engine: str) -> None:
    stage = write_posts_shot(tmp_path / "hard.usda")
    size, begins, ends = HARD[way]
    key_move(add_card(stage, "/card", size=size, depth=0.0, colour=(1, 1, 0.2)).AddTranslateOp(), begins, ends)
    stage.Save()
    exact, fast, still = both(renderer, tmp_path / "hard.usda", replace(LENS, engine=engine))
    assert psnr(exact, fast) > 34
    assert psnr(exact, fast) > psnr(exact, still) + 6


def test_what_stops_half_way_stops(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = write_posts_shot(tmp_path / "stops.usda")
    slide = add_card(stage, "/card", size=(0.6, 0.8), depth=3.2, colour=(1, 1, 0.2)).AddTranslateOp()
    for time, x in ((1.0, -0.8), (1.25, 0.3), (1.5, 0.3)):
        slide.Set(Gf.Vec3d(x, 0, 0), time)
    stage.Save()
    exact, fast, still = both(renderer, tmp_path / "stops.usda")
    assert psnr(exact, fast) > 35
    assert psnr(exact, fast) > psnr(exact, still) + 8


def test_the_layers_of_a_still_shot_keep_no_motion(renderer: FrameRenderer, tmp_path: Path) -> None:
    stage = write_posts_shot(tmp_path / "still.usda")
    stage.Save()
    shot = Shot.open(tmp_path / "still.usda")
    assert find_movements(*(shot.scene_at(time) for time in (1.25, 1.0, 1.5))) == {}
    exact, fast, still = both(renderer, tmp_path / "still.usda", replace(LENS, rays=64))
    assert psnr(exact, fast) > 45
    assert psnr(still, fast) > 40


def test_a_camera_that_turns_sees_its_rays_from_where_it_was() -> None:
    """A ray of the camera at the moment, as one of the camera in the middle, passes the same points of the world."""
    moved = np.eye(4)
    angle = 0.2
    moved[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    moved[:3, 3] = 0.3, -0.1, 0.2
    middle, moment = (PinholeView.from_camera(Camera(pose), 64, 36) for pose in (np.eye(4), moved))
    moment_view = MomentView(middle, moment, 0.5)
    origin, along = moment.ray(40.0, 10.0)
    slope = np.array([(40.0 - moment.cx) / moment.fx, (10.0 - moment.cy) / moment.fy, 1.0])
    down = np.array([1.0, -1.0, -1.0])  # from camera space to x right, y down, z ahead
    np.testing.assert_allclose(moment_view.turn @ slope, along * down, atol=1e-12)
    np.testing.assert_allclose(moment_view.move_m, origin * down, atol=1e-12)


def test_the_reference_has_no_velocities() -> None:
    with pytest.raises(SettingsError, match="motion by moments"):
        check_settings(FrameSettings(engine="accumulation", motion=4, motion_by="velocities"))
    with pytest.raises(SettingsError, match="motion_by must be one of moments, velocities"):
        FrameSettings(motion=4, motion_by="guess")


def test_the_demo_shot_moves_alike_both_ways(renderer: FrameRenderer, demo_file: Path) -> None:
    """Robots that walk, an umbrella that sways, a camera that travels and racks its focus; lit, `bench motion` measures it."""
    shot = Shot.open(demo_file)
    settings = FrameSettings(240, 135, shading="unlit", rays=32, motion=8, supersample=2)
    lens = shot.camera_at(None, 48, settings.width, settings.height)
    exact, fast = (
        expose_frame(renderer, shot, None, lens, 48, replace(settings, motion_by=way)).color
        for way in ("moments", "velocities")
    )
    assert psnr_db(exact, fast) > 35
