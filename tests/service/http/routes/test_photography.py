"""Exposure and film over HTTP: settings are read and seen, bad ones are refused, all can be undone."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from render.cli.main import main
from service.models.exposure import EXPOSURE_EXAMPLE, ExposureSettings, ExposureSettingsEdit
from service.models.film_settings import FILM_EXAMPLE, FilmSettings, FilmSettingsEdit
from tests.service.conftest import ROOM, send
from usd_schemas.settings.tables import rest_settings

SMALL = {"time": 1, "width": 64, "height": 36, "rays": 4, "supersample": 1, "layers": 2}


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def read(client, shot, what, time=1):
    answer = client.get(f"{shot}/camera/{what}", params={"time": time})
    assert answer.status_code == 200, answer.text
    assert answer.headers["etag"] == answer.json()["etag"]
    return answer.json()


def edit(client, shot, what, change, **ask):
    return client.patch(f"{shot}/camera/{what}", json=change, **ask)


def refused(answer, status, words):
    assert answer.status_code == status, answer.text
    assert set(answer.json()) == {"code", "detail", "path", "errors"}
    assert words in answer.json()["detail"] + str(answer.json()["path"])


def pixels(client, shot, **parameters) -> np.ndarray:
    answer = client.get(f"{shot}/frame", params=SMALL | parameters)
    assert answer.status_code == 200, answer.text
    return np.asarray(Image.open(BytesIO(answer.content)), np.int16)


def test_examples_are_true_to_their_models():
    for model, example in ((ExposureSettings, EXPOSURE_EXAMPLE), (FilmSettings, FILM_EXAMPLE)):
        assert model.model_validate(example).model_dump(by_alias=True, mode="json") == example


def test_a_shot_that_says_nothing_exposes_as_usd_does(client, shot):
    settings = read(client, shot, "exposure")
    assert (settings["exposureTimeS"], settings["iso"], settings["exposureFStop"], settings["compensationStops"]) == (
        1,
        100,
        1,
        0,
    )
    assert (settings["exposureStop"], settings["stopMarking"], settings["meteringMode"], settings["keys"]) == (
        "exposure",
        "f",
        "manual",
        {},
    )
    film = read(client, shot, "film")
    assert (film["process"], film["stock"], film["display"], film["keys"]) == ("none", "", "", {})
    assert film["gateMm"] == pytest.approx([36, 20.25], rel=1e-6)


def others(resource, known):
    """A value other than the default of each number that REST sets and the test does not name."""
    missing = [item for item in rest_settings(resource) if not item.read_only and item.camel_name not in known]
    return {item.camel_name: next(end for end in item.hard if end not in (None, item.default)) for item in missing}


def test_everything_that_can_be_read_can_be_set(client, shot):
    exposure = {
        "exposureTimeS": 0.5,
        "iso": 400,
        "exposureFStop": 2,
        "exposureStop": "iris",
        "stopMarking": "t",
        "compensationStops": -1,
        "responsivity": 2,
        "transmittance": 0.5,
        "neutralDensity": 0.3,
        "naturalVignetting": True,
        "breathing": True,
        "channelIndex": [1.48, 1.52, 1.57],
        "circleDistance": "imageDistance",
        "flareGhosts": 2,
        "flareStar": 0.5,
        "shutterOpen": -0.25,
        "shutterClose": 0.25,
        "shutterType": "rolling",
        "shutterDirection": "up",
        "shutterTravelS": 0.01,
        "shutterEfficiency": [0, 1, 0],
        "meteringMode": "spot",
        "meteringSpot": [0.25, 0.75],
        "meteringFocusPoint": "",
        "meteringCompensationStops": 1,
        "meteringSmoothingS": 0.5,
    }
    exposure |= others("exposure", {*exposure, "shutterAngleDeg"})
    assert set(exposure) == {info.alias for info in ExposureSettingsEdit.model_fields.values()} - {
        "time",
        "shutterAngleDeg",
    }
    answer = edit(client, shot, "exposure", exposure)
    assert answer.status_code == 200, answer.text
    assert {name: answer.json()[name] for name in exposure} == exposure
    film = {
        "process": "monochrome",
        "printStock": "print_2302",
        "speed": 200,
        "push": 1,
        "whiteBalanceK": 3200,
        "tint": 3,
        "curveSource": "knots",
        "curveRed": [[-2, 0.1], [0, 1.5]],
        "curveGreen": [[-2, 0.1], [0, 1.5]],
        "curveBlue": [[-2, 0.1], [0, 1.5]],
        "curveMiddleGray": -1,
        "curveMinDensity": [0.1, 0.2, 0.3],
        "curveMaxDensity": [2, 2.1, 2.2],
        "curveGamma": [0.5, 0.6, 0.7],
        "curveToe": [0.4, 0.5, 0.6],
        "curveShoulder": [0.4, 0.5, 0.6],
        "grainAmount": 0.5,
        "grainRms": [5, 6, 7],
        "grainSizeUm": 8,
        "grainSeed": 3,
        "halationAmount": 0.02,
        "halationRadiusMm": 0.2,
        "halationColor": [1, 0.5, 0.25],
        "sensorFullWellE": 30000,
        "sensorReadNoiseE": 3,
        "sensorClipStops": 6,
        "sensorSensitivity": [1, 0.9, 0.8],
        "display": "sRGB - Display",
        "view": "Raw",
        "look": "",
        "cdlSlope": [1.1, 1, 0.9],
        "cdlOffset": [0.01, 0, -0.01],
        "cdlPower": [1, 1.1, 1.2],
        "cdlSaturation": 0.5,
    }
    film |= others("film", {*film, "stock"})
    assert set(film) == {info.alias for info in FilmSettingsEdit.model_fields.values()} - {"time", "stock"}
    answer = edit(client, shot, "film", film)
    assert answer.status_code == 200, answer.text
    assert {name: answer.json()[name] for name in film} == film


def test_a_shutter_is_set_by_its_angle(client, shot):
    settings = edit(client, shot, "exposure", {"shutterAngleDeg": 172.8, "shutterOpen": -0.1}).json()
    assert (settings["shutterOpen"], settings["shutterClose"]) == pytest.approx((-0.1, 0.38))
    assert settings["shutterAngleDeg"] == pytest.approx(172.8)
    refused(edit(client, shot, "exposure", {"shutterAngleDeg": 90, "shutterClose": 1}), 422, "shutterAngleDeg")


def test_a_stock_brings_its_process_and_is_taken_out_again(client, shot):
    settings = edit(client, shot, "film", {"stock": "5219", "push": 1}).json()
    assert (settings["stock"], settings["process"], settings["printStock"]) == (
        "vision3_500t_5219",
        "negative",
        "vision_2383",
    )
    assert (settings["push"], settings["grainAmount"]) == (1, 1)
    assert edit(client, shot, "film", {"whiteBalanceK": 3200}).json()["stock"] == "vision3_500t_5219"
    assert edit(client, shot, "film", {"stock": None}).json()["process"] == "none"
    client.post(f"{shot}/edits/undo")
    assert read(client, shot, "film")["stock"] == "vision3_500t_5219"


def test_a_body_brings_its_gate(client, shot):
    answer = client.patch(f"{shot}/camera", json={"body": "super16"})
    assert answer.status_code == 200, answer.text
    [film] = [body for body in client.get("/v1/bodies").json()["bodies"] if body["name"] == "super16"]
    settings = read(client, shot, "film")
    assert settings["body"] == film["title"]
    assert settings["gateMm"] == pytest.approx(film["gateMm"], rel=1e-4)
    assert answer.json()["focalLengthMm"] == pytest.approx(50)
    refused(client.patch(f"{shot}/camera", json={"body": "super61"}), 422, "super16")


def test_what_is_set_is_seen_as_the_command_line_has_it(client, shot, room_file, tmp_path):
    plain = pixels(client, shot)
    edit(client, shot, "exposure", {"compensationStops": 1})
    assert (pixels(client, shot) >= plain).all()
    edit(client, shot, "film", {"stock": "double_x_5222"})
    graded = pixels(client, shot)
    assert np.ptp(graded[..., :3], axis=2).max() <= 12, "black and white, but for the tone of the print"
    edits = tmp_path / "edits.usda"
    edits.write_text(client.get(f"{shot}/edits").text)
    out = tmp_path / "out.png"
    arguments = ["record", str(room_file), str(out), "--edits", str(edits), "--imageWidth", "64", "--rays", "4"]
    assert main([*arguments, "--supersample", "1", "--layers", "2"]) == 0
    assert (np.asarray(Image.open(out)) == graded).all()


def test_a_frame_can_have_another_film_and_another_display(client, shot, room_file, tmp_path):
    parameters = {"film": "velvia_50", "display": "Rec.1886 Rec.709 - Display", "motion": 2, "motionBy": "velocities"}
    out = tmp_path / "out.png"
    arguments = ["record", str(room_file), str(out), "--imageWidth", "64", "--rays", "4", "--supersample", "1"]
    options = ["--film", "velvia_50", "--display", "Rec.1886 Rec.709 - Display", "--motion", "2", "--layers", "2"]
    options += ["--motion-by", "velocities"]
    assert main([*arguments, *options]) == 0
    assert (np.asarray(Image.open(out)) == pixels(client, shot, **parameters)).all()
    raw = pixels(client, shot, display="sRGB - Display", view="Raw")
    assert np.abs(raw - pixels(client, shot)).max() > 20


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"film": "velvia_5"}, "velvia_50"),
        ({"display": "sRGB - Displya"}, "sRGB - Display"),
        ({"view": "Rawr"}, "Raw"),
        ({"look": "warm"}, "warm"),
        ({"motion": 0}, "motion"),
        ({"motion": 100_000}, "motion"),
        ({"motion": 4, "motionBy": "velocities", "engine": "accumulation"}, "motion by moments"),
    ],
    ids=str,
)
def test_a_frame_that_cannot_be_finished_so_says_why(client, shot, parameters, words):
    refused(client.get(f"{shot}/frame", params=SMALL | parameters), 422, words)


def test_grades_are_those_of_the_configuration(client, shot):
    settings = client.get(f"{shot}/camera/grades", params={"time": 1}).json()
    displays = {display["name"]: display for display in settings["displays"]}
    assert settings["defaultDisplay"] in displays
    for display in displays.values():
        assert display["defaultView"] in display["views"]
    name, view = next((n, d["views"][-1]) for n, d in displays.items() if n != settings["defaultDisplay"])
    assert edit(client, shot, "film", {"display": name, "view": view}).status_code == 200


@pytest.mark.parametrize(
    ("what", "change", "words"),
    [
        ("exposure", {"iso": 0}, "iso"),
        ("exposure", {"exposureTimeS": -1}, "exposureTimeS"),
        ("exposure", {"shutterOpen": 0, "shutterClose": -0.5}, "cannot close before it opens"),
        ("exposure", {"shutterEfficiency": [0, 0]}, "let light through"),
        ("exposure", {"shutterType": "guillotine"}, "shutterType"),
        ("exposure", {"transmittance": 1.5}, "transmittance"),
        ("exposure", {"aperture": 2}, "aperture"),
        ("film", {"stock": "vision3_500t_5291"}, "vision3_500t_5219"),
        ("film", {"stock": "vision_2383"}, "print stock"),
        ("film", {"process": "negative"}, "needs a stock"),
        ("film", {"stock": "5219", "printStock": "print_2302"}, "print stock of 3"),
        ("film", {"stock": "5219", "process": "reversal"}, "run backwards"),
        ("film", {"process": "negative", "curveSource": "knots", "curveGreen": [[0, 1], [-1, 2]]}, "film:curve"),
        ("film", {"display": "sRGB - Displya"}, "sRGB - Display"),
        ("film", {"view": "Rawr"}, "Raw"),
        ("film", {"look": "warm"}, "look"),
        ("film", {"push": 9}, "push"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused_and_changes_nothing(client, shot, what, change, words):
    before = client.get(f"{shot}/edits").text
    refused(edit(client, shot, what, change), 422, words)
    assert client.get(f"{shot}/edits").text == before


def test_settings_have_the_cameras_tag(client, shot):
    seen = read(client, shot, "film")["etag"]
    assert seen == read(client, shot, "exposure")["etag"]
    edit(client, shot, "exposure", {"iso": 200})
    headers = {"If-Match": seen}
    key = {"time": 1, "value": 1}
    for answer in (
        edit(client, shot, "exposure", {"iso": 400}, headers=headers),
        edit(client, shot, "film", {"push": 1}, headers=headers),
        client.put(f"{shot}/camera/film/keys/push", json=key, headers=headers),
        client.delete(f"{shot}/camera/exposure/keys/iso", params={"time": 1}, headers=headers),
    ):
        refused(answer, 412, "camera")


def test_settings_are_keyed(client, shot):
    for time, value in ((1, 0), (11, 2)):
        edit(client, shot, "exposure", {"compensationStops": value, "time": time})
        client.put(f"{shot}/camera/film/keys/push", json={"time": time, "value": value / 2})
    assert [read(client, shot, "exposure", time)["compensationStops"] for time in (1, 6, 11)] == [0, 1, 2]
    assert read(client, shot, "film", 6)["push"] == pytest.approx(0.5)
    settings = read(client, shot, "exposure")["keys"]
    assert [(key["time"], key["value"]) for key in settings["compensationStops"]] == [(1, 0), (11, 2)]
    removed = client.delete(f"{shot}/camera/film/keys/push", params={"time": 1})
    assert [key["time"] for key in removed.json()["keys"]["push"]] == [11]
    refused(client.delete(f"{shot}/camera/film/keys/push", params={"time": 1}), 404, "11")
    refused(client.put(f"{shot}/camera/exposure/keys/iso", json={"time": 1, "value": 0}), 422, "iso")


def test_numbers_that_are_not_finite_are_refused_and_it_lives_on(client):
    authored = """float exposure:time = nan
        float fStop.timeSamples = { 1: nan, 2: 2 }
        float exposure:iso.timeSamples = { 1: 100, 24: inf }
        double focus:lag.timeSamples = { 1: nan, 2: 0.1 }
        double film:push = nan
    """
    applied = 'def Camera "cam" (\n        prepend apiSchemas = ["FocusAPI", "FilmAPI"]\n    )'
    stage = ROOM.replace("float fStop = 1.4", authored).replace('def Camera "cam"', applied)
    sent = send(client, "room.usda", stage.encode())
    assert sent.status_code == 201, sent.text
    shot = f"/v1/shots/{sent.json()['id']}"
    parameters = {what: client.get(f"{shot}/{what}", params={"time": 1}) for what in (
        "camera", "cameras", "camera/exposure", "camera/film", "camera/focus", "camera/grades", "readout", "focus-points", "frame"
    )}  # fmt: skip
    assert {what: answer.status_code for what, answer in parameters.items() if answer.status_code >= 500} == {}
    assert "lag_s" in parameters["camera/focus"].json()["detail"]
    assert client.get(f"{shot}/camera/focus", params={"time": 2}).json()["keys"]["lagS"][0]["value"] is None
    assert "push" in parameters["camera/film"].json()["detail"]
    mended = edit(client, shot, "film", {"push": 0})
    assert mended.status_code == 200, mended.text
    client.delete(shot)


def test_field_offsets_that_the_next_frame_would_refuse_are_refused(client, shot):
    before = client.get(f"{shot}/edits").text
    refused(
        client.patch(f"{shot}/camera/focus", json={"fieldOffsets": [[0.5, 0.5, 60]]}), 422, "leave it behind the lens"
    )
    assert client.get(f"{shot}/edits").text == before
