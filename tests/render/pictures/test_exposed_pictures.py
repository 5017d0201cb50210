"""Exposure in pictures: a stop is twice the light, USD's scale is ours, and the corners are as dark as cos⁴ says."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdLux

from render.errors import CameraError
from render.film import Grade
from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import DoubleArray
from render.optics.photometry.exposure import ExposureSettings, equivalent
from render.optics.view import PinholeView
from render.pictures.picture import Picture, make_picture
from render.shot import Shot
from render.shot.lens.lens_choice import choose_lens
from usd_schemas.applying import apply

CAMERA = "/cam"
SMALL = FrameSettings(24, 16, rays=16, supersample=1)
LIGHT = 0.25
SET = {"exposure:time": 1 / 50, "exposure:iso": 400.0, "exposure:fStop": 2.8, "exposure": 0.5}


def open_wall(folder: Path, **values: Any) -> Shot:
    """A camera of 28 mm at f/2.8 on full frame, focused at 0.14 m, with even light all around it.

    Args:
        folder: where the file goes.
        values: of the camera's attributes, by USD's names.
    """
    path = folder / f"wall{len(list(folder.iterdir()))}.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    prim = UsdGeom.Camera.Define(stage, CAMERA).GetPrim()
    for schema in ("LensAPI", "FilmAPI"):
        apply(prim, schema)
    gate = {"focalLength": 0.28, "horizontalAperture": 0.36, "verticalAperture": 0.24, "fStop": 2.8}
    for name, value in (gate | {"focusDistance": 0.14} | values).items():
        prim.GetAttribute(name).Set(value)
    UsdLux.DomeLight.Define(stage, "/dome").CreateIntensityAttr(LIGHT)
    stage.Save()
    return Shot.open(path)


def taken(renderer: FrameRenderer, folder: Path, settings: FrameSettings = SMALL, **values: Any) -> Picture:
    return make_picture(renderer, open_wall(folder, **values), CAMERA, 1.0, settings, Grade())


def exposed(renderer: FrameRenderer, folder: Path, settings: FrameSettings = SMALL, **values: Any) -> DoubleArray:
    """``(height, width, 3)`` scene-linear, exposed, as an EXR holds it."""
    picture = taken(renderer, folder, settings, **values)
    return picture.frame.color[..., :3] * np.float64(picture.camera.exposure_scale)


@pytest.mark.gl
@pytest.mark.parametrize(
    "brighter",
    [{"exposure:time": 1 / 25}, {"exposure:iso": 800.0}, {"exposure:fStop": 2.8 / math.sqrt(2)}, {"exposure": 1.5}],
)
def test_a_stop_more_is_twice_the_light_in_the_picture(
    renderer: FrameRenderer, tmp_path: Path, brighter: dict[str, float]
) -> None:
    one, two = exposed(renderer, tmp_path, **SET), exposed(renderer, tmp_path, **SET | brighter)
    assert one.min() > 0
    np.testing.assert_allclose(two, 2 * one, rtol=1e-6)


@pytest.mark.gl
def test_equivalent_exposures_make_the_same_picture(renderer: FrameRenderer, tmp_path: Path) -> None:
    settings = ExposureSettings(1 / 50, 400, 2.8, 0.5)
    one = exposed(renderer, tmp_path, **SET)
    closed = equivalent(settings, "time", f_stop=8.0)
    faster = equivalent(settings, "iso", time_s=1 / 500)
    for other in (closed, faster):
        attributes = {"exposure:time": other.time_s, "exposure:iso": other.iso, "exposure:fStop": other.f_stop}
        np.testing.assert_allclose(exposed(renderer, tmp_path, **SET | attributes), one, rtol=1e-6)


@pytest.mark.gl
def test_by_default_the_picture_is_exposed_by_usds_own_scale(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Whatever the iris does."""
    for f_stop in (0.0, 1.4, 22.0):
        shot = open_wall(tmp_path, **SET, fStop=f_stop)
        scale = UsdGeom.Camera(shot.stage.GetPrimAtPath(CAMERA)).ComputeLinearExposureScale(Usd.TimeCode(1))
        picture = make_picture(renderer, shot, CAMERA, 1.0, SMALL, Grade())
        assert picture.camera.exposure_scale == pytest.approx(scale, rel=1e-6)
        np.testing.assert_allclose(picture.frame.color[..., :3] * scale, LIGHT * scale, rtol=1e-4)


@pytest.mark.gl
def test_when_exposed_by_the_iris_an_f_stop_is_a_stop_of_the_picture(renderer: FrameRenderer, tmp_path: Path) -> None:
    by_iris = SET | {"film:exposure:stop": "iris"}
    wide = exposed(renderer, tmp_path, **by_iris, fStop=2.8)
    np.testing.assert_allclose(wide, exposed(renderer, tmp_path, **SET), rtol=1e-6)
    closed = exposed(renderer, tmp_path, **by_iris, fStop=2.8 * math.sqrt(2))
    np.testing.assert_allclose(2 * closed, wide, rtol=1e-6)
    pinhole = exposed(renderer, tmp_path, **by_iris, fStop=0.0)  # there is no iris to expose by
    np.testing.assert_allclose(pinhole, exposed(renderer, tmp_path, **SET, fStop=0.0), rtol=1e-6)


@pytest.mark.gl
def test_glass_loses_light_at_f_numbers_and_not_at_t_stops(renderer: FrameRenderer, tmp_path: Path) -> None:
    clear = exposed(renderer, tmp_path, **SET)
    glass = {"lens:transmittance": 0.8}
    np.testing.assert_allclose(exposed(renderer, tmp_path, **SET, **glass), 0.8 * clear, rtol=1e-6)
    cine = glass | {"lens:stopMarking": "t"}
    np.testing.assert_allclose(exposed(renderer, tmp_path, **SET, **cine), clear, rtol=1e-6)
    filtered = cine | {"lens:neutralDensity": 2 * math.log10(2)}
    np.testing.assert_allclose(4 * exposed(renderer, tmp_path, **SET, **filtered), clear, rtol=1e-6)


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["pinhole", "accumulation"])
def test_every_engine_has_the_lens_s_light(renderer: FrameRenderer, tmp_path: Path, engine: str) -> None:
    values = {"lens:transmittance": 0.8, "lens:neutralDensity": 0.3, "lens:naturalVignetting": True}
    other = replace(SMALL, engine=engine)
    expected = exposed(renderer, tmp_path, **values)
    np.testing.assert_allclose(exposed(renderer, tmp_path, other, **values), expected, rtol=1e-4)


@pytest.mark.gl
def test_a_lens_that_breathes_loses_light_close_by(renderer: FrameRenderer, tmp_path: Path) -> None:
    """A 28 mm lens at 140 mm has m = 28 / (140 - 28) = 1/4, so the film is 5/4 as far away as at infinity."""
    still, breathing = exposed(renderer, tmp_path), exposed(renderer, tmp_path, **{"lens:breathing": True})
    np.testing.assert_allclose(breathing * (5 / 4) ** 2, still, rtol=1e-5)
    rear = {"lens:breathing": True, "lens:pupilMagnification": 0.5}
    np.testing.assert_allclose(exposed(renderer, tmp_path, **rear) * (3 / 2) ** 2, still, rtol=1e-5)


@pytest.mark.gl
@pytest.mark.parametrize("model", ["thin", "seidel", "pinhole"])
def test_the_corners_are_as_dark_as_cos4_to_a_thousandth(renderer: FrameRenderer, tmp_path: Path, model: str) -> None:
    values = {"lens:model": model, "lens:naturalVignetting": True}
    picture = taken(renderer, tmp_path, replace(SMALL, rays=64), **values)
    view = PinholeView.from_camera(picture.camera, SMALL.width, SMALL.height)
    directions = np.array([[view.ray(x + 0.5, y + 0.5)[1] for x in range(view.width)] for y in range(view.height)])
    cosine = -directions[..., 2] / np.linalg.norm(directions, axis=-1)
    np.testing.assert_allclose(picture.frame.color[..., 1] / LIGHT, cosine**4, rtol=1e-3)
    assert picture.frame.color[0, 0, 1] < 0.5 * LIGHT


@pytest.mark.gl
def test_corners_are_even_by_default_and_darken_with_vignetting(renderer: FrameRenderer, tmp_path: Path) -> None:
    even = taken(renderer, tmp_path).frame.color[..., 1]
    np.testing.assert_allclose(even, LIGHT, rtol=1e-4)
    once = taken(renderer, tmp_path, **{"lens:naturalVignetting": True}).frame.color[..., 1]
    half = {"lens:naturalVignetting": True, "lens:aberration:vignetting": 0.5}
    np.testing.assert_allclose(taken(renderer, tmp_path, **half).frame.color[..., 1] ** 2, LIGHT * once, rtol=1e-4)


@pytest.mark.gl
def test_glass_has_its_own_fall_off_once(renderer: FrameRenderer, tmp_path: Path) -> None:
    lens = {
        "lens:model": "prescription",
        "lens:prescription:radius": [0.0, 28.0, -28.0],
        "lens:prescription:thickness": [1e-3, 0.1, 0.0],
        "lens:prescription:index": [1.0, 1.5, 1.0],
        "lens:prescription:clearDiameter": [1.6, 2.8, 2.8],
        "lens:prescription:stopSurface": 0,
        "fStop": 22.0,
        "focusDistance": 4.0,
    }
    own = taken(renderer, tmp_path, **lens).frame.color
    assert np.array_equal(own, taken(renderer, tmp_path, **lens, **{"lens:naturalVignetting": True}).frame.color)
    assert own[0, 0, 1] < 0.6 * own[8, 12, 1]


@pytest.mark.gl
def test_a_higher_iso_has_fewer_photons_for_the_same_picture(renderer: FrameRenderer, tmp_path: Path) -> None:
    """Three stops: the noise of an even wall is √8 times as strong."""
    digital = {"film:process": "digital", "film:sensor:fullWell": 4000.0, "exposure:fStop": 1.0}
    noise = []
    for iso in (100.0, 800.0):
        values = digital | {"exposure:iso": iso, "exposure:time": 100 / iso}
        picture = taken(renderer, tmp_path, SMALL, **values)
        noise.append(float(picture.graded.std()))
    assert noise[1] / noise[0] == pytest.approx(math.sqrt(8), rel=0.15)


@pytest.mark.gl
def test_a_data_sheet_without_light_fall_off_falls_off_by_cos4(renderer: FrameRenderer, tmp_path: Path) -> None:
    sheet = {"lens:model": "dataSheet", "lens:table:height": [0.0, 20.0], "lens:naturalVignetting": True}
    thin = taken(renderer, tmp_path, **{"lens:naturalVignetting": True}).frame.color[..., 1]
    np.testing.assert_allclose(taken(renderer, tmp_path, **sheet).frame.color[..., 1], thin, rtol=1e-3)
    attributes = sheet | {"lens:table:vignetting": [1.0, 0.9]}
    assert taken(renderer, tmp_path, **attributes).frame.color[0, 0, 1] > 1.5 * thin[0, 0]


def test_the_readout_names_all_that_is_between_the_scene_and_the_film(tmp_path: Path) -> None:
    values = {"lens:transmittance": 0.81, "lens:neutralDensity": 0.6, "lens:breathing": True, "shutter:close": 0.5}
    read = open_wall(tmp_path, **SET, **values).exposure.read(CAMERA, 1.0)
    assert read.path is not None
    assert (read.stop, read.is_t_stop) == ("exposure", False)
    assert read.settings.iso == 400
    assert read.ev100 == pytest.approx(math.log2(100 * 2.8**2 * 50 / 400))
    assert read.path.magnification == pytest.approx(0.25, rel=1e-6)
    assert read.path.effective_f_stop == pytest.approx(2.8 * 1.25, rel=1e-6)
    assert read.glass == pytest.approx(0.81)
    assert read.path.t_stop == pytest.approx(2.8 / 0.9, rel=1e-6)  # of the lens; filters are beside it
    assert read.nd_stops == pytest.approx(1.993, abs=1e-3)
    assert math.degrees(read.shutter_angle_rad) == pytest.approx(180)
    assert read.shutter_time_s == pytest.approx(1 / 48)
    lux = math.pi * 100 * 0.81 * 10**-0.6 / (4 * 2.8**2 * 1.25**2)
    assert read.lux_on_film(100.0) == pytest.approx(lux, rel=1e-6)
    assert read.settings.value(lux / 50) == pytest.approx(100 * read.scale, rel=1e-6)
    assert read.reading(read.grey_nits).stops == pytest.approx(0, abs=1e-9)
    assert read.reading(4 * read.grey_nits).stops == pytest.approx(2)
    assert {round(e.scale / read.settings.scale, 9) for e in read.equivalents()} == {1.0}
    assert [round(e.f_stop, 1) for e in read.equivalents((-1, 0, 1))] == [2.0, 2.8, 4.0]


def test_a_lens_set_wider_than_it_opens_exposes_by_its_widest(tmp_path: Path) -> None:
    shot = open_wall(tmp_path, **SET, **{"film:exposure:stop": "iris", "focusDistance": 4.0})
    shot.camera.mount_lens(CAMERA, choose_lens("planar_50"))
    shot.camera.set(CAMERA, f_stop=0.5)
    read = shot.exposure.read(CAMERA, 1.0)
    assert read.path is not None
    assert read.settings.f_stop == read.path.f_stop
    assert 1.3 < read.path.f_stop < 1.5
    shot.camera.set(CAMERA, f_stop=4.0)
    assert shot.exposure.read(CAMERA, 1.0).settings.f_stop == pytest.approx(4, rel=1e-3)


def test_a_lens_set_wider_than_it_opens_is_as_deep_as_its_widest(tmp_path: Path) -> None:
    shot = open_wall(tmp_path, **SET, focusDistance=4.0)
    shot.camera.mount_lens(CAMERA, choose_lens("planar_50"))
    fields = []
    for f_stop in (0.5, 1.4, 2.8):
        shot.camera.set(CAMERA, f_stop=f_stop)
        read = shot.focus.read(CAMERA, 1.0)
        fields.append([read.near_m, read.far_m, read.hyperfocal_m])
    assert fields[0] == pytest.approx(fields[1])
    assert fields[1][2] == pytest.approx(2 * fields[2][2], rel=1e-3)


def test_what_the_picture_is_multiplied_by_is_what_the_readout_says(tmp_path: Path) -> None:
    """Light that came through the lens has lost what glass and filters take."""
    for values in (
        {},
        {"lens:transmittance": 0.7, "lens:neutralDensity": 0.3},
        {"lens:transmittance": 0.7, "lens:stopMarking": "t"},
        {"lens:breathing": True, "film:exposure:stop": "iris"},
    ):
        shot = open_wall(tmp_path, **SET, **values)
        read, camera = shot.exposure.read(CAMERA, 1.0), shot.camera_at(CAMERA, 1.0, 24, 16)
        assert camera.exposure_scale == pytest.approx(read.exposure_scale, rel=1e-6)
        assert camera.exposure_scale * camera.lens.transmittance == pytest.approx(read.scale, rel=1e-6)


def test_an_exposure_that_has_no_meaning_is_the_camera_s_fault(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match=r"exposure:iso of camera /cam must be a positive number, got 0"):
        open_wall(tmp_path, **{"exposure:iso": 0.0}).exposure.read(CAMERA, 1.0)
    dark = open_wall(tmp_path, **{"lens:transmittance": 0.0}).exposure.read(CAMERA, 1.0)
    assert dark.grey_nits == math.inf
    assert dark.exposure_scale == 1
