"""How a camera exposes and on what: what is set is read back, films and bodies bring what is theirs, undo undoes it."""

from __future__ import annotations

import math

import pytest
from pxr import Usd

from render.errors import CameraError, SettingsError
from render.shot import Shot
from render.shot.film.finish import finish_of
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
    return finish_of(shot.stage, shot.camera_at(None, 1, 16, 9), 1).film


def test_what_is_set_is_said_and_undone(shot):
    before = dict(shot.photography(None, 1))
    assert (before["iso"], before["exposure_time_s"], before["transmittance"], before["process"]) == (100, 1, 1, "none")
    wanted = {"iso": 800.0, "exposure_time_s": 1 / 48, "neutral_density": 0.6, "push": 1.0}
    shot.set_photography(None, **wanted)
    said = shot.photography(None, 1)
    assert {name: said[name] for name in wanted} == pytest.approx(wanted, rel=1e-6)
    assert "iso" in (shot.history.undo_label or "")
    shot.undo()
    assert dict(shot.photography(None, 1)) == before


def test_a_stop_more_of_each_doubles_the_exposure(shot):
    scale = shot.camera_at(None, 1, 16, 9).exposure_scale
    for change in (
        {"iso": 200.0},
        {"exposure_time_s": 2.0},
        {"compensation_stops": 1.0},
        {"exposure_f_stop": 0.5**0.5},
    ):
        shot.set_photography(None, **change)
        assert shot.camera_at(None, 1, 16, 9).exposure_scale == pytest.approx(2 * scale, rel=1e-6)
        shot.undo()


def test_numbers_are_keyed_and_words_hold_for_all_time(shot):
    for time, stops in ((1, 0.0), (11, 2.0)):
        shot.set_photography(None, time=time, compensation_stops=stops, shutter_type="rolling")
    assert shot.photography(None, 6)["compensation_stops"] == pytest.approx(1)
    assert [key.time for key in shot.camera_keys(None, "compensation_stops")] == [1, 11]
    assert {shot.photography(None, time)["shutter_type"] for time in (1, 6, 11)} == {"rolling"}
    shot.set_camera_key(None, "push", Key(1, 0.5, "linear"))
    assert shot.camera_keys(None, "push")[0].value == 0.5


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"iso": 0.0}, "iso must be a positive number"),
        ({"exposure_time_s": -1.0}, "exposure time s must be"),
        ({"exposure_f_stop": math.nan}, "exposure f stop must be"),
        ({"transmittance": 2.0}, "at most 1"),
        ({"process": "digitl"}, "digital"),
        ({"zoom": 2}, "zoom"),
    ],
    ids=str,
)
def test_what_cannot_be_set_changes_nothing(shot, change, words):
    before = shot.export_edits()
    with pytest.raises(SettingsError, match=words):
        shot.set_photography(None, **change)
    assert shot.export_edits() == before


def test_film_is_put_in_with_its_print_and_grain_and_taken_out(shot):
    shot.mount_film(None, library_film("5219"))
    film = film_of(shot)
    assert (film.process, film.stock.name, film.print_stock.name) == ("negative", "vision3_500t_5219", "vision_2383")
    assert film.grain.amount == 1
    shot.set_photography(None, print_stock="eterna_cp_3513di", grain_amount=0.0, push=1.0)
    shot.mount_film(None, library_film("vision3_250d_5207"))
    film = film_of(shot)
    assert (film.stock.name, film.print_stock.name) == ("vision3_250d_5207", "eterna_cp_3513di")
    assert (film.grain.amount, film.push) == (0, 1)
    shot.mount_film(None, library_film("velvia_50"))
    assert (film_of(shot).process, film_of(shot).print_stock) == ("reversal", None)
    shot.mount_film(None, None)
    assert film_of(shot) is None


@pytest.mark.parametrize("name", film_names())
def test_film_in_a_camera_is_what_the_same_film_for_one_run_is(shot, name):
    stock = library_film(name)
    if stock.kind == "print":
        return
    camera = shot.camera_at(None, 1, 16, 9)
    asked = finish_of(shot.stage, camera, 1, stock=name).film
    shot.mount_film(None, stock)
    put_in = film_of(shot)
    assert (put_in.process, put_in.grain, put_in.push) == (asked.process, asked.grain, asked.push)
    assert put_in.stock.name == asked.stock.name
    assert getattr(put_in.print_stock, "name", None) == getattr(asked.print_stock, "name", None)


def test_a_drawn_curve_makes_way_for_the_stocks(shot):
    drawn = {"process": "negative", "curve_source": "parametric"}
    shot.set_photography(None, **drawn)
    assert film_of(shot).stock.name == "the film that the shot draws"
    shot.mount_film(None, library_film("portra_400"))
    assert film_of(shot).stock.name == "portra_400"


def test_a_print_stock_does_not_go_in_a_camera(shot):
    with pytest.raises(SettingsError, match="vision_2383 is a print stock"):
        shot.mount_film(None, library_film("vision_2383"))


def test_a_body_brings_its_gate_and_keeps_the_lens(shot):
    shot.mount_body(None, library_body("super16"))
    camera = shot.camera_at(None, 1, 12, 7)
    assert camera.focal_length_mm == pytest.approx(50)
    assert camera.horizontal_aperture_mm == pytest.approx(library_body("super16").gate_mm[0], rel=0.1)
    assert shot.photography(None, 1)["body"] == library_body("super16").title


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"process": "negative"}, "needs a stock"),
        ({"process": "reversal", "stock": "vision3_500t_5219"}, "run backwards"),
        ({"grade_display": "sRGB - Displya"}, "unknown display"),
        ({"shutter_close": -1.0}, "cannot close before it opens"),
        ({"shutter_efficiency": (0.0, 0.0)}, "let light through"),
    ],
    ids=str,
)
def test_edits_that_the_next_picture_would_refuse_can_be_refused(shot, change, words):
    before = shot.export_edits()
    with pytest.raises((CameraError, SettingsError), match=words), shot.one_edit(), shot.kept_usable(None, 1):
        shot.set_photography(None, **change)
    assert shot.export_edits() == before


def test_a_shot_that_makes_no_picture_can_still_be_edited(shot):
    prim = shot.stage.GetPrimAtPath("/cam")
    with Usd.EditContext(shot.stage, shot.stage.GetRootLayer()):
        prim.ApplyAPI("FilmAPI")
        prim.GetAttribute("film:process").Set("negative")
    with shot.kept_usable(None, 1):
        shot.set_photography(None, iso=400.0)
    with shot.kept_usable(None, 1):
        shot.mount_film(None, library_film("5219"))
    assert film_of(shot).stock.name == "vision3_500t_5219"
