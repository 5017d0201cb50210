"""The light meter of a shot: grey is grey, whatever the light; and the same frame is exposed alike in every range of frames."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdLux

from render.errors import CameraError, SettingsError
from render.film import Grade
from render.frame import FrameRenderer, FrameSettings
from render.optics.photometry.exposure import MIDDLE_GREY
from render.pictures.picture import make_picture
from render.shot import Shot
from render.shot.light_meter import LightMeter
from usd_schemas import FocusPoint, LensCamera
from usd_schemas.applying import apply

pytestmark = pytest.mark.gl

CAMERA = "/cam"
PICTURE = FrameSettings(24, 16, rays=4, supersample=1, layers=1)
UNLIT = replace(PICTURE, shading="unlit")
WALL, LAMP, LAST = 0.2, 8.0, 48


def open_shot(folder: Path, light: dict[int, float] | None = None, **values: Any) -> Shot:
    """A wall that fills the picture of a 50 mm lens at 4 m, and on it a lamp of a quarter metre, half a metre to the left. Their
    colours are their light where nothing is lit.

    Args:
        folder: where the file goes.
        light: of a dome all around, by frame, in place of wall and lamp.
        values: of the camera's attributes, by USD's names; with `:` between the names' parts as ``_``.
    """
    stage = Usd.Stage.CreateNew(str(folder / f"lit{len(list(folder.iterdir()))}.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(LAST)
    camera = LensCamera(UsdGeom.Camera.Define(stage, CAMERA).GetPrim())
    for schema in ("LensAPI", "FilmAPI"):
        apply(camera.prim, schema)
    for name, aside in (("lamp", 0.0), ("away", 50.0)):
        camera.add_focus_point(name, FocusPoint(name, target=("/lamp",), offset=(aside, 0.0, 0.0)))
    gate = {"focalLength": 0.5, "horizontalAperture": 0.36, "verticalAperture": 0.24, "focusDistance": 4.0}
    for name, value in (gate | values).items():
        camera.prim.GetAttribute(name.replace("_", ":")).Set(value)
    if light is not None:
        intensity = UsdLux.DomeLight.Define(stage, "/dome").CreateIntensityAttr()
        for frame, value in light.items():
            intensity.Set(value, frame)
    for name, grey, side, place in (("wall", WALL, 20.0, (0, 0, -4)), ("lamp", LAMP, 0.25, (-0.5, 0, -3.99))):
        square = UsdGeom.Mesh.Define(stage, f"/{name}")
        square.CreatePointsAttr([(x * side / 2, y * side / 2, 0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
        square.CreateFaceVertexCountsAttr([4])
        square.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
        square.CreateDisplayColorAttr([(grey,) * 3])
        square.AddTranslateOp().Set(place)
        if light is not None:
            square.MakeInvisible()
    stage.Save()
    return Shot.open(stage.GetRootLayer().realPath)


def exposed(renderer: FrameRenderer, shot: Shot, time: float = 1.0, settings: FrameSettings = UNLIT) -> float:
    """Render and return the middle of the graded picture."""
    picture = make_picture(renderer, shot, CAMERA, time, settings, Grade())
    return float(picture.frame.color[8, 12, 1] * picture.camera.exposure_scale)


@pytest.mark.parametrize(
    ("asked", "metered"),
    [
        ({"mode": "spot"}, WALL),
        ({"mode": "spot", "spot": (0.5 - 0.5 * 50 / (36 * 3.99), 0.5)}, LAMP),
        ({"mode": "spot", "focus_point": "lamp"}, LAMP),
        ({"mode": "average"}, WALL + (LAMP - WALL) * (0.25 * 50 / 3.99) ** 2 / (36 * 24)),
    ],
)
def test_the_meter_reads_the_light_of_what_it_looks_at(
    renderer: FrameRenderer, tmp_path: Path, asked: dict[str, Any], metered: float
) -> None:
    said = LightMeter(renderer, open_shot(tmp_path), CAMERA, "unlit", **asked).read(1.0)
    assert said.reading.luminance_nits == pytest.approx(metered, rel=0.02 if asked["mode"] == "average" else 1e-3)
    assert said.reading.stops == pytest.approx(math.log2(metered / MIDDLE_GREY), abs=0.03)
    assert said.compensation_stops == pytest.approx(-said.reading.stops, abs=1e-6)
    assert said.lux_on_film == pytest.approx(math.pi / 4 * said.reading.luminance_nits)
    assert (said.place is None) == (asked["mode"] == "average")


def test_the_centre_weighs_more_than_the_corner(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = open_shot(tmp_path)
    said = {m: LightMeter(renderer, shot, CAMERA, "unlit", mode=m).read(1.0) for m in ("center", "average")}
    assert WALL < said["average"].reading.luminance_nits < said["center"].reading.luminance_nits < LAMP


def test_a_camera_without_light_is_exposed_as_it_is_set(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = open_shot(tmp_path, lens_transmittance=0.0, film_metering_mode="average")
    assert exposed(renderer, shot) == 0
    metered = LightMeter(renderer, shot, CAMERA, "unlit").read(1.0)
    assert metered.reading.luminance_nits > WALL
    assert math.isnan(metered.compensation_stops)
    assert metered.exposed == metered.exposure


SETTINGS: tuple[dict[str, Any], ...] = (
    {},
    {"exposure": 3.0, "exposure_iso": 400.0, "exposure_fStop": 5.6},
    {"lens_neutralDensity": 0.9, "lens_transmittance": 0.8, "fStop": 4.0, "film_exposure_stop": "iris"},
    {"lens_transmittance": 0.5, "lens_stopMarking": "t", "lens_breathing": True, "focusDistance": 0.2, "fStop": 2.0},
)


@pytest.mark.parametrize("settings", SETTINGS)
def test_a_metered_grey_is_grey_in_the_picture_at_any_setting(
    renderer: FrameRenderer, tmp_path: Path, settings: dict[str, Any]
) -> None:
    """The meter is on the camera: it sees what filters, glass and bellows take."""
    shot = open_shot(tmp_path, **settings, film_metering_mode="spot")
    assert exposed(renderer, shot) == pytest.approx(MIDDLE_GREY, rel=2e-3)
    brighter = open_shot(tmp_path, **settings, film_metering_mode="spot", film_metering_compensation=1.0)
    assert exposed(renderer, brighter) == pytest.approx(2 * MIDDLE_GREY, rel=2e-3)


def test_by_hand_nothing_is_metered(renderer: FrameRenderer, tmp_path: Path) -> None:
    assert exposed(renderer, open_shot(tmp_path)) == pytest.approx(WALL, rel=1e-3)


def flickering() -> dict[int, float]:
    """Two stops more from frame 25 on, and a stop up and down from frame to frame."""
    return {n: (1.6 if n >= 25 else 0.4) * 2.0 ** (0.5 if n % 2 else -0.5) for n in range(1, LAST + 1)}


def test_the_exposure_follows_the_light_slowly_and_does_not_flicker(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = open_shot(tmp_path, flickering(), film_metering_mode="average")
    meter = LightMeter(renderer, shot, CAMERA)
    keys = np.array([meter.read(float(n)).compensation_stops for n in range(5, LAST - 4)])
    assert keys[:4] == pytest.approx([math.log2(MIDDLE_GREY / 0.4)] * 4, abs=0.25)
    assert keys[-4:] == pytest.approx([math.log2(MIDDLE_GREY / 1.6)] * 4, abs=0.25)
    assert np.abs(np.diff(keys, 2)).max() < 0.02  # one that follows each flicker goes up and down by 2
    assert np.abs(np.diff(keys)).max() < 1.1 * 2 / (0.25 * math.sqrt(2 * math.pi)) / 24  # the steepest of a bell's step


def test_a_frame_is_exposed_alike_whichever_frames_are_metered(renderer: FrameRenderer, tmp_path: Path) -> None:
    forward = open_shot(tmp_path, flickering(), film_metering_mode="center")
    alone = open_shot(tmp_path, flickering(), film_metering_mode="center")
    scales = [
        make_picture(renderer, forward, CAMERA, t, PICTURE, Grade()).camera.exposure_scale for t in (1.0, 20.0, 30.0)
    ]
    assert make_picture(renderer, alone, CAMERA, 30.0, PICTURE, Grade()).camera.exposure_scale == scales[2]
    assert len(set(scales)) == 3
    larger = replace(PICTURE, width=48, height=32, rays=9)
    assert make_picture(renderer, alone, CAMERA, 30.0, larger, Grade()).camera.exposure_scale == scales[2]


def test_a_stop_that_is_pulled_within_the_shot_is_met_at_once(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = open_shot(tmp_path, {1: 0.4}, film_metering_mode="average")
    iso = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("exposure:iso")
    iso.Set(100.0, 10)
    iso.Set(800.0, 11)
    said = [exposed(renderer, shot, t, PICTURE) for t in (9.0, 10.0, 10.5, 11.0)]
    assert said == pytest.approx([MIDDLE_GREY] * 4, rel=1e-5)


def test_off_screen_or_black_spots_leave_the_exposure_as_set(renderer: FrameRenderer, tmp_path: Path) -> None:
    away = open_shot(tmp_path, film_metering_mode="spot", film_metering_focusPoint="away", exposure=1.0)
    assert exposed(renderer, away) == pytest.approx(2 * WALL, rel=1e-3)
    said = LightMeter(renderer, away, CAMERA, "unlit").read(1.0)
    assert (said.place, said.reading.luminance_nits) == (None, 0.0)
    assert math.isnan(said.compensation_stops)
    black = open_shot(tmp_path, {1: 0.0}, film_metering_mode="average")
    assert exposed(renderer, black, 1.0, PICTURE) == 0


def test_what_was_read_is_kept_until_the_scene_changes(renderer: FrameRenderer, tmp_path: Path) -> None:
    shot = open_shot(tmp_path, {1: 0.4}, film_metering_mode="average")
    exposed(renderer, shot, 24.0, PICTURE)
    known = dict(shot.exposure.meter_cache)
    shot.camera.set(CAMERA, f_stop=2.0, focus_distance_m=7.0)
    exposed(renderer, shot, 24.0, PICTURE)
    assert shot.exposure.meter_cache == known
    shot.stage.GetPrimAtPath("/dome").GetAttribute("inputs:intensity").Set(0.8, 1)
    assert exposed(renderer, shot, 24.0, PICTURE) == pytest.approx(MIDDLE_GREY, rel=1e-5)


@pytest.mark.parametrize("held", [False, True])
def test_what_it_says_becomes_keys_that_are_edits(renderer: FrameRenderer, tmp_path: Path, held: bool) -> None:
    shot = open_shot(tmp_path, flickering(), film_metering_mode="average")
    meter = LightMeter(renderer, shot, CAMERA)
    said = [meter.read(float(n)) for n in range(1, LAST + 1, 6)]
    shot.exposure.key(CAMERA, said, held=held)
    assert meter.metering(1.0).mode == "manual"
    attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("exposure")
    keyed = [attribute.Get(one.time) for one in said]
    wanted = [one.compensation_stops for one in said]
    assert attribute.HasSpline() != held
    assert keyed == pytest.approx([sum(wanted) / len(wanted)] * len(wanted) if held else wanted, abs=0.006)
    shot.edits.undo()
    assert meter.metering(1.0).mode == "average"


def test_an_impossible_meter_is_refused_with_its_camera(renderer: FrameRenderer, tmp_path: Path) -> None:
    lost = open_shot(tmp_path, film_metering_mode="spot", film_metering_focusPoint="lampe")
    with pytest.raises(CameraError, match="camera /cam: no focus point to meter is named 'lampe': did you mean 'lamp'"):
        exposed(renderer, lost)
    (told,) = [finding.message for finding in lost.findings() if finding.code == "metering_point"]
    assert told == "/cam meters the focus point 'lampe', which it does not have: did you mean 'lamp'?"
    with pytest.raises(SettingsError, match="no focus point to meter is named 'nobody'"):
        LightMeter(renderer, lost, CAMERA, mode="spot", focus_point="nobody").read(1.0)
    with pytest.raises(SettingsError, match="metering must be one of manual, spot, center, average, got matrix"):
        LightMeter(renderer, lost, CAMERA, mode="matrix")
    with pytest.raises(SettingsError, match="smoothing of metering must be above 0 s, got 0"):
        LightMeter(renderer, lost, CAMERA, smoothing_s=0.0)


def test_sunny_sixteen_exposes_a_card_in_the_sun(renderer: FrameRenderer, tmp_path: Path) -> None:
    """100 000 lux on a matt grey of 18 % are 5 730 nits; and at f/16 for the reciprocal of the ISO it is right, as on the box."""
    sunny = {"exposure_time": 1 / 400, "exposure_iso": 400.0, "exposure_fStop": 16.0}
    shot = open_shot(tmp_path, **sunny)
    sun = UsdLux.DistantLight.Define(shot.stage, "/sun")
    sun.CreateIntensityAttr(200_000)  # on what faces it; the card is turned away by 60°, so that it does not mirror it
    sun.CreateNormalizeAttr(True)
    sun.AddRotateXOp().Set(-60.0)
    card = UsdGeom.Gprim(shot.stage.GetPrimAtPath("/wall"))
    card.GetDisplayColorAttr().Set([(0.18,) * 3])
    said = LightMeter(renderer, shot, CAMERA, mode="spot").read(1.0)
    assert said.reading.luminance_nits == pytest.approx(0.18 * 100_000 / math.pi, rel=0.1)
    assert said.reading.incident_lux == pytest.approx(100_000, rel=0.1)
    assert said.reading.ev100 == pytest.approx(15.5, abs=0.2)
    assert abs(said.reading.stops) < 0.5
    assert said.lux_on_film == pytest.approx(math.pi * said.reading.luminance_nits / (4 * 16**2), rel=1e-6)
