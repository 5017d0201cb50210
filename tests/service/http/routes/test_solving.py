"""Focus solving over HTTP: modes, keys of the camera with all tangents, racks, and their undo."""

from __future__ import annotations

import pytest

from service.models.solving import RACK_EXAMPLE, SETTINGS_EXAMPLE, FocusSettings, FocusSettingsEdit, RackCreate

NEAR_M, FAR_M = 3.0, 8.0


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def settings_of(client, shot, time=1):
    return client.get(f"{shot}/camera/focus", params={"time": time}).json()


def edit(client, shot, change, **ask):
    return client.patch(f"{shot}/camera/focus", json=change, **ask)


def distance(client, shot, time):
    return client.get(f"{shot}/readout", params={"time": time}).json()["focusDistanceM"]


def place(client, shot, name, target, **values):
    point = {"target": [target], "face": 0, "barycentric": [0.5, 0, 0.5], "name": name} | values
    answer = client.post(f"{shot}/focus-points", params={"time": 1}, json=point)
    assert answer.status_code == 201, answer.text
    return answer


def refused(answer, status, words):
    assert answer.status_code == status, answer.text
    assert set(answer.json()) == {"code", "detail", "path", "errors"}
    assert words in answer.json()["detail"] + str(answer.json()["path"])


def test_examples_are_true_to_their_models():
    assert FocusSettings.model_validate(SETTINGS_EXAMPLE).model_dump(by_alias=True, mode="json") == SETTINGS_EXAMPLE
    assert RackCreate.model_validate(RACK_EXAMPLE).model_dump(by_alias=True, mode="json") == RACK_EXAMPLE


def test_settings_are_what_the_schema_says_until_they_are_set(client, shot):
    settings = settings_of(client, shot)
    assert (settings["mode"], settings["offScreen"], settings["occluded"]) == ("manual", "ignore", "keep")
    assert (settings["surfaceExponent"], settings["expressive"], settings["maxAngleDeg"]) == (3, 1, 15)
    assert (settings["drivenByPoints"], settings["keys"], settings["camera"]) == (True, {}, "/World/cam")


def test_everything_that_can_be_read_can_be_set(client, shot):
    change = {
        "mode": "surface",
        "solveStop": True,
        "circleOfConfusionMm": 0.02,
        "smoothingS": 0.5,
        "lagS": 0.2,
        "deadZoneMm": 0.01,
        "maxSpeedDegS": 90,
        "nearPriority": 1,
        "offScreen": "keep",
        "occluded": "fade",
        "surfaceExponent": 4,
        "expressive": 0.5,
        "fieldOffsets": [[0, 0, 0.1], [1, 1, -0.1]],
        "tiltDeg": -6,
        "swingDeg": 3,
        "riseMm": 4,
        "shiftMm": -4,
        "drivenByPoints": False,
        "maxAngleDeg": 20,
    }
    aliases = {info.alias for info in FocusSettingsEdit.model_fields.values()}
    assert set(change) == aliases - {"time"}
    before = settings_of(client, shot)
    answer = edit(client, shot, change)
    assert answer.status_code == 200, answer.text
    assert {name: answer.json()[name] for name in change} == change
    assert settings_of(client, shot) == answer.json()
    assert all(before[name] != value for name, value in change.items())
    client.post(f"{shot}/edits/undo")
    assert settings_of(client, shot) == before


def test_what_is_left_out_stays(client, shot):
    edit(client, shot, {"lagS": 0.2})
    assert edit(client, shot, {"mode": "points", "lagS": None}).json()["lagS"] == 0.2


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mode": "by feel"}, "mode"),
        ({"lagS": -1}, "lagS"),
        ({"expressive": 2}, "expressive"),
        ({"tiltDeg": 90}, "tiltDeg"),
        ({"maxAngleDeg": -1}, "maxAngleDeg"),
        ({"fieldOffsets": [[2, 0, 0]]}, "fieldOffsets"),
        ({"fieldOffsets": [[0, 0, 0]] * 65}, "fieldOffsets"),
        ({"surfaceExponent": 0}, "surfaceExponent"),
        ({"zoom": 1}, "zoom"),
        ({"lagS": 1, "time": 1e300}, "time"),
    ],
    ids=str,
)
def test_settings_that_cannot_be(client, shot, change, words):
    before = client.get(f"{shot}/edits").text
    refused(edit(client, shot, change), 422, words)
    assert client.get(f"{shot}/edits").text == before


def test_settings_have_the_cameras_tag(client, shot):
    seen = client.get(f"{shot}/camera/focus", params={"time": 1})
    assert seen.headers["etag"] == client.get(f"{shot}/camera", params={"time": 1}).headers["etag"]
    client.patch(f"{shot}/camera", json={"fStop": 4})
    headers = {"If-Match": seen.headers["etag"]}
    key = {"time": 1, "value": 3}
    for answer in (
        edit(client, shot, {"lagS": 1}, headers=headers),
        client.put(f"{shot}/camera/keys/tiltDeg", json=key, headers=headers),
        client.delete(f"{shot}/camera/keys/tiltDeg", params={"time": 1}, headers=headers),
    ):
        refused(answer, 412, "camera")


def test_settings_are_keyed(client, shot):
    for time, value in ((1, 0), (11, 1)):
        edit(client, shot, {"expressive": value, "time": time})
    assert [settings_of(client, shot, time)["expressive"] for time in (1, 6, 11)] == [0, 0.5, 1]
    settings = settings_of(client, shot)["keys"]
    assert [(key["time"], key["value"]) for key in settings["expressive"]] == [(1, 0), (11, 1)]
    assert edit(client, shot, {"expressive": 0.25}).json()["keys"] == {}


def test_the_lens_is_keyed_with_tangents_that_shape_the_way(client, shot):
    at = f"{shot}/camera/keys/focusDistanceM"
    level = {"inSlope": 0, "inWidth": 3, "outSlope": 0, "outWidth": 3}
    for time, value in ((1, 3), (11, 6)):
        key = {"time": time, "value": value, "interpolation": "bezier", "tangents": level}
        answer = client.put(at, json=key)
        assert answer.status_code == 200, answer.text
    assert answer.json()["keys"]["focusDistanceM"][0]["tangents"] == pytest.approx(level)
    assert distance(client, shot, 6) == pytest.approx(4.5)
    assert 3 < distance(client, shot, 2) < 3.15, "it starts softly"
    steep = {"time": 1, "value": 3, "interpolation": "bezier", "tangents": level | {"outSlope": 0.5}}
    client.put(at, json=steep)
    assert distance(client, shot, 2) > 3.3
    client.put(at, json={"time": 1, "value": 3, "interpolation": "held"})
    assert distance(client, shot, 10) == pytest.approx(3)
    removed = client.delete(at, params={"time": 1})
    assert [key["time"] for key in removed.json()["keys"]["focusDistanceM"]] == [11]
    refused(client.delete(at, params={"time": 1}), 404, "11")


def test_switches_are_keyed_by_0_and_1(client, shot):
    at = f"{shot}/camera/keys/solveStop"
    client.put(at, json={"time": 1, "value": 0})
    settings = client.put(at, json={"time": 5, "value": 1}).json()
    assert settings["solveStop"] is True
    assert settings_of(client, shot, 4)["solveStop"] is False
    refused(client.put(at, json={"time": 1, "value": 0.5}), 422, "0 or 1")


@pytest.mark.parametrize(
    ("attribute", "key", "words"),
    [
        ("mode", {"time": 1, "value": 1}, "attribute"),
        ("fStop", {"time": 1, "value": -1}, "f-number"),
        ("focusDistanceM", {"time": 1, "value": 0}, "focus distance"),
        ("tiltDeg", {"time": 1, "value": 100}, "tilt"),
        ("fStop", {"time": 1, "value": 4, "tangents": {"inSlope": 1}}, "tangents"),
        ("fStop", {"time": "noon", "value": 4}, "time"),
    ],
    ids=str,
)
def test_keys_that_cannot_be(client, shot, attribute, key, words):
    before = client.get(f"{shot}/edits").text
    refused(client.put(f"{shot}/camera/keys/{attribute}", json=key), 422, words)
    assert client.get(f"{shot}/edits").text == before


def test_points_take_tangents_too(client, shot):
    place(client, shot, "near", "/World/near")
    level = {"inSlope": 0.0, "inWidth": 2.0, "outSlope": 0.0, "outWidth": 2.0}
    at = f"{shot}/focus-points/near/keys/weight"
    for time, value in ((1, 1), (9, 0)):
        settings = client.put(at, json={"time": time, "value": value, "interpolation": "bezier", "tangents": level})
    assert settings.json()["keys"]["weight"][0]["tangents"] == level


def test_a_rack_takes_the_focus_from_one_point_to_the_other(client, shot):
    place(client, shot, "near", "/World/near")
    place(client, shot, "far", "/World/far", weight=0)
    made = client.post(f"{shot}/racks", json={"from": "near", "to": "far", "start": 5, "end": 15, "ease": "linear"})
    assert made.status_code == 201, made.text
    settings = made.json()
    assert (settings["from"], settings["to"], settings["end"], settings["stretched"]) == ("near", "far", 15, False)
    assert (settings["startDistanceM"], settings["endDistanceM"]) == (pytest.approx(NEAR_M), pytest.approx(FAR_M))
    assert made.headers["etag"] == client.get(f"{shot}/focus-points", params={"time": 1}).headers["etag"]
    assert [distance(client, shot, time) for time in (1, 5, 15, 24)] == pytest.approx([3, 3, 8, 8], rel=1e-3)
    assert 1 / distance(client, shot, 10) == pytest.approx((1 / 3 + 1 / 8) / 2, rel=1e-3)
    client.post(f"{shot}/edits/undo")
    assert distance(client, shot, 15) == pytest.approx(NEAR_M, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "status", "words"),
    [
        ({"to": "near"}, 422, "twice"),
        ({"to": "nobody"}, 404, "nobody"),
        ({"end": 5}, 422, "end after"),
        ({"ease": "jerk"}, 422, "ease"),
        ({"from": "1st"}, 422, "from"),
        ({"start": 1e300}, 422, "start"),
    ],
    ids=str,
)
def test_racks_that_cannot_be(client, shot, change, status, words):
    place(client, shot, "near", "/World/near")
    place(client, shot, "far", "/World/far")
    before = client.get(f"{shot}/edits").text
    body = {"from": "near", "to": "far", "start": 5, "end": 15} | change
    refused(client.post(f"{shot}/racks", json=body), status, words)
    assert client.get(f"{shot}/edits").text == before


def test_racks_that_contradict_each_other_are_refused(client, shot):
    place(client, shot, "near", "/World/near")
    place(client, shot, "far", "/World/far", weight=0)
    client.post(f"{shot}/racks", json={"from": "near", "to": "far", "start": 5, "end": 15})
    seen = client.get(f"{shot}/focus-points", params={"time": 1})
    again = client.post(f"{shot}/racks", json={"from": "near", "to": "far", "start": 1, "end": 8})
    refused(again, 422, "contradicts")
    place(client, shot, "other", "/World/far", weight=0)
    third = {"from": "far", "to": "other", "start": 20, "end": 22}
    refused(client.post(f"{shot}/racks", json=third, headers={"If-Match": seen.headers["etag"]}), 412, "list")
