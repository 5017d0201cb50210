"""Exposure, film and body of a camera: settings are read back, films and bodies bring theirs, undo takes them back."""

from __future__ import annotations

import math

import pytest
from pxr import Usd

from render.errors import CameraError, SettingsError
from render.shot import Shot
from usd_schemas import Key, film_names, library_body, library_film

CAMERA = """#usda 1.0
(
    metersPerUnit = 1
    timeCodesPerSecond = 24
)
def Camera "cam"
{
    float focalLength = 0.5
    float horizontalAperture = 0.36
    float verticalAperture = 0.24
}
"""


@pytest.fixture
def shot(tmp_path) -> Shot:
    file = tmp_path / "shot.usda"
    file.write_text(CAMERA)
    return Shot.open(file)


def film_of(shot: Shot):
    return shot.film.finish(shot.camera_at(None, 1, 16, 9), 1).film


def test_settings_are_read_back_and_undone(shot):
    before, film = dict(shot.exposure.settings(None, 1)), dict(shot.film.settings(None, 1))
    assert (before["iso"], before["exposure_time_s"], before["transmittance"], film["process"]) == (100, 1, 1, "none")
    changes = {"iso": 800.0, "exposure_time_s": 1 / 48, "neutral_density": 0.6}
    shot.film.set(None, push=1.0)
    shot.exposure.set(None, **changes)
    settings = shot.exposure.settings(None, 1)
    assert {name: settings[name] for name in changes} == pytest.approx(changes, rel=1e-6)
    assert shot.film.settings(None, 1)["push"] == 1.0
    assert "iso" in (shot.edits.history.undo_label or "")
    shot.edits.undo()
    assert dict(shot.exposure.settings(None, 1)) == before
    shot.edits.undo()
    assert dict(shot.film.settings(None, 1)) == film


def test_a_stop_more_of_each_doubles_the_exposure(shot):
    scale = shot.camera_at(None, 1, 16, 9).exposure_scale
    for change in (
        {"iso": 200.0},
        {"exposure_time_s": 2.0},
        {"compensation_stops": 1.0},
        {"exposure_f_stop": 0.5**0.5},
    ):
        shot.exposure.set(None, **change)
        assert shot.camera_at(None, 1, 16, 9).exposure_scale == pytest.approx(2 * scale, rel=1e-6)
        shot.edits.undo()


def test_numbers_are_keyed_and_words_hold_for_all_time(shot):
    for time, stops in ((1, 0.0), (11, 2.0)):
        shot.exposure.set(None, time=time, compensation_stops=stops, shutter_type="rolling")
    assert shot.exposure.settings(None, 6)["compensation_stops"] == pytest.approx(1)
    assert [key.time for key in shot.camera.keys(None, "compensation_stops")] == [1, 11]
    assert {shot.exposure.settings(None, time)["shutter_type"] for time in (1, 6, 11)} == {"rolling"}
    shot.camera.set_key(None, "push", Key(1, 0.5, "linear"))
    assert shot.camera.keys(None, "push")[0].value == 0.5


@pytest.mark.parametrize(
    ("part", "change", "words"),
    [
        ("exposure", {"iso": 0.0}, "iso must be a positive number"),
        ("exposure", {"exposure_time_s": -1.0}, "exposure time s must be"),
        ("exposure", {"exposure_f_stop": math.nan}, "exposure f stop must be"),
        ("exposure", {"transmittance": 2.0}, "at most 1"),
        ("film", {"process": "digitl"}, "digital"),
        ("exposure", {"zoom": 2}, "zoom"),
        ("film", {"zoom": 2}, "zoom"),
    ],
    ids=str,
)
def test_what_cannot_be_set_changes_nothing(shot, part, change, words):
    before = shot.edits.export()
    with pytest.raises(SettingsError, match=words):
        getattr(shot, part).set(None, **change)
    assert shot.edits.export() == before


def test_film_is_put_in_with_its_print_and_grain_and_taken_out(shot):
    shot.film.mount_stock(None, library_film("5219"))
    film = film_of(shot)
    assert (film.process, film.stock.name, film.print_stock.name) == ("negative", "vision3_500t_5219", "vision_2383")
    assert film.grain.amount == 1
    shot.film.set(None, print_stock="eterna_cp_3513di", grain_amount=0.0, push=1.0)
    shot.film.mount_stock(None, library_film("vision3_250d_5207"))
    film = film_of(shot)
    assert (film.stock.name, film.print_stock.name) == ("vision3_250d_5207", "eterna_cp_3513di")
    assert (film.grain.amount, film.push) == (0, 1)
    shot.film.mount_stock(None, library_film("velvia_50"))
    assert (film_of(shot).process, film_of(shot).print_stock) == ("reversal", None)
    shot.film.mount_stock(None, None)
    assert film_of(shot) is None


@pytest.mark.parametrize("name", film_names())
def test_film_in_a_camera_is_what_the_same_film_for_one_run_is(shot, name):
    stock = library_film(name)
    if stock.kind == "print":
        return
    camera = shot.camera_at(None, 1, 16, 9)
    chosen = shot.film.finish(camera, 1, stock=name).film
    shot.film.mount_stock(None, stock)
    put_in = film_of(shot)
    assert (put_in.process, put_in.grain, put_in.push) == (chosen.process, chosen.grain, chosen.push)
    assert put_in.stock.name == chosen.stock.name
    assert getattr(put_in.print_stock, "name", None) == getattr(chosen.print_stock, "name", None)


def test_a_drawn_curve_makes_way_for_the_stocks(shot):
    drawn = {"process": "negative", "curve_source": "parametric"}
    shot.film.set(None, **drawn)
    assert film_of(shot).stock.name == "the film that the shot draws"
    shot.film.mount_stock(None, library_film("portra_400"))
    assert film_of(shot).stock.name == "portra_400"


def test_a_print_stock_does_not_go_in_a_camera(shot):
    with pytest.raises(SettingsError, match="vision_2383 is a print stock"):
        shot.film.mount_stock(None, library_film("vision_2383"))


def test_a_body_brings_its_gate_and_keeps_the_lens(shot):
    shot.camera.mount_body(None, library_body("super16"))
    camera = shot.camera_at(None, 1, 12, 7)
    assert camera.focal_length_mm == pytest.approx(50)
    assert camera.horizontal_aperture_mm == pytest.approx(library_body("super16").gate_mm[0], rel=0.1)
    assert shot.film.settings(None, 1)["body"] == library_body("super16").title


@pytest.mark.parametrize(
    ("part", "change", "words"),
    [
        ("film", {"process": "negative"}, "needs a stock"),
        ("film", {"process": "reversal", "stock": "vision3_500t_5219"}, "run backwards"),
        ("film", {"display": "sRGB - Displya"}, "unknown display"),
        ("exposure", {"shutter_close": -1.0}, "cannot close before it opens"),
        ("exposure", {"shutter_efficiency": (0.0, 0.0)}, "let light through"),
    ],
    ids=str,
)
def test_edits_that_the_next_picture_would_refuse_can_be_refused(shot, part, change, words):
    before = shot.edits.export()
    with pytest.raises((CameraError, SettingsError), match=words), shot.edits.transaction(), shot.keep_usable(None, 1):
        getattr(shot, part).set(None, **change)
    assert shot.edits.export() == before


def test_a_shot_that_makes_no_picture_can_still_be_edited(shot):
    prim = shot.stage.GetPrimAtPath("/cam")
    with Usd.EditContext(shot.stage, shot.stage.GetRootLayer()):
        prim.ApplyAPI("FilmAPI")
        prim.GetAttribute("film:process").Set("negative")
    with shot.keep_usable(None, 1):
        shot.exposure.set(None, iso=400.0)
    with shot.keep_usable(None, 1):
        shot.film.mount_stock(None, library_film("5219"))
    assert film_of(shot).stock.name == "vision3_500t_5219"
