"""From a click to a focus curve, over HTTP."""

from __future__ import annotations

import csv
import io
import json

import pytest
from pxr import Sdf, Usd

from service.models.curve import FocusCurve

FAR_M, NEAR_M = 8.0, 3.0


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def pick(client, shot, x: float, y: float = 90):
    body = {"time": 1, "width": 320, "height": 180, "x": x, "y": y}
    return client.post(f"{shot}/pick", json=body).json()


def place(client, shot, x: float, **values):
    answer = client.post(f"{shot}/focus-points", params={"time": 1}, json=pick(client, shot, x)["anchor"] | values)
    assert answer.status_code == 201, answer.text
    return answer.json()


def readout(client, shot, time: float = 1):
    return client.get(f"{shot}/readout", params={"time": time}).json()


def test_a_pick_says_what_is_where(client, shot):
    picked = pick(client, shot, 240)
    assert picked["hit"]
    assert picked["anchor"]["target"] == ["/World/far"]
    assert picked["depthM"] == pytest.approx(FAR_M, abs=1e-3)
    assert picked["positionM"][2] == pytest.approx(-FAR_M, abs=1e-3)
    assert pick(client, shot, 2, 2) == {"hit": False, "anchor": None, "depthM": None, "positionM": None}


def test_a_click_becomes_a_point_that_sets_the_focus(client, shot):
    assert readout(client, shot)["focusDistanceM"] == pytest.approx(3)
    point = place(client, shot, 240)
    assert point["name"] == "point1"
    assert point["depthM"] == pytest.approx(FAR_M, abs=1e-3)
    assert point["screen"] == pytest.approx([240 / 320, 0.5], abs=1e-3)
    assert point["visibleInFrame"]
    lens = readout(client, shot)
    assert lens["focusDistanceM"] == pytest.approx(FAR_M, abs=1e-3)
    assert lens["nearM"] < FAR_M < lens["farM"]
    assert (lens["source"], lens["focusMode"]) == ("points", "points")
    cameras = client.get(f"{shot}/cameras", params={"time": 1}).json()["cameras"]
    assert cameras[0]["focusDistanceM"] == pytest.approx(FAR_M, abs=1e-3)


def test_points_are_read_changed_and_removed(client, shot):
    place(client, shot, 240, name="far", weight=2)
    place(client, shot, 80, name="near")
    listed = client.get(f"{shot}/focus-points", params={"time": 1}).json()["focusPoints"]
    assert {point["name"]: point["weight"] for point in listed} == {"far": 2, "near": 1}
    one = client.get(f"{shot}/focus-points/far", params={"time": 1})
    assert one.json() in listed
    changed = client.patch(f"{shot}/focus-points/far", params={"time": 1}, json={"enabled": False, "blurMm": 0.1})
    assert (changed.json()["enabled"], changed.json()["blurMm"], changed.json()["weight"]) == (False, 0.1, 2)
    assert readout(client, shot)["focusDistanceM"] == pytest.approx(NEAR_M, abs=1e-3)
    assert client.delete(f"{shot}/focus-points/far").status_code == 204
    assert client.get(f"{shot}/focus-points/far", params={"time": 1}).status_code == 404
    assert client.delete(f"{shot}/focus-points/far").status_code == 404


def test_a_name_is_taken_once(client, shot):
    place(client, shot, 240, name="hero")
    again = client.post(
        f"{shot}/focus-points", params={"time": 1}, json=pick(client, shot, 80)["anchor"] | {"name": "hero"}
    )
    assert (again.status_code, again.json()["code"]) == (422, "name_taken")
    assert place(client, shot, 80)["name"] == "point1"


def test_keys_rack_the_focus_from_near_to_far(client, shot):
    for name, x, at_start in (("near", 80, 1), ("far", 240, 0)):
        place(client, shot, x, name=name)
        for time, value in ((1, at_start), (24, 1 - at_start)):
            key = {"time": time, "value": value, "interpolation": "linear"}
            answer = client.put(f"{shot}/focus-points/{name}/keys/weight", json=key)
            assert answer.status_code == 200, answer.text
    assert [key["time"] for key in answer.json()["keys"]["weight"]] == [1, 24]
    distances = [readout(client, shot, time)["focusDistanceM"] for time in (1, 8, 16, 24)]
    assert distances[0] == pytest.approx(NEAR_M, abs=1e-3)
    assert distances[-1] == pytest.approx(FAR_M, abs=1e-3)
    assert distances == sorted(distances)
    removed = client.delete(f"{shot}/focus-points/far/keys/weight", params={"time": 1})
    assert [key["time"] for key in removed.json()["keys"]["weight"]] == [24]
    missing = client.delete(f"{shot}/focus-points/far/keys/weight", params={"time": 1})
    assert missing.status_code == 404


def test_enabling_is_keyed_by_0_and_1(client, shot):
    place(client, shot, 240, name="far")
    for time, value in ((1, 0), (12, 1)):
        client.put(f"{shot}/focus-points/far/keys/enabled", json={"time": time, "value": value})
    assert readout(client, shot, 11)["focusDistanceM"] == pytest.approx(3)
    assert readout(client, shot, 12)["focusDistanceM"] == pytest.approx(FAR_M, abs=1e-3)
    refused = client.put(f"{shot}/focus-points/far/keys/enabled", json={"time": 1, "value": 0.5})
    assert refused.status_code == 422


def test_the_curve_comes_in_every_format(client, shot, room_file):
    place(client, shot, 240)
    ask = {"frames": "1:24"}
    text = client.get(f"{shot}/focus-curve", params=ask).text
    curve = json.loads(text)
    assert FocusCurve.model_validate_json(text).model_dump(by_alias=True, mode="json") == curve
    assert [sample["frame"] for sample in curve["samples"]] == list(range(1, 25))
    assert curve["samples"][0]["focusDistanceM"] == pytest.approx(FAR_M, abs=1e-3)
    rows = list(csv.DictReader(io.StringIO(client.get(f"{shot}/focus-curve", params=ask | {"format": "csv"}).text)))
    assert [float(row["focus_distance_m"]) for row in rows] == [s["focusDistanceM"] for s in curve["samples"]]
    for baked in (True, False):
        text = client.get(f"{shot}/focus-curve", params=ask | {"format": "usda", "baked": baked}).text
        layer = Sdf.Layer.CreateAnonymous(".usda")
        assert layer.ImportFromString(text)
        stage = Usd.Stage.Open(str(room_file))
        stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
        focus = stage.GetPrimAtPath("/World/cam").GetAttribute("focusDistance")
        assert focus.HasSpline() != baked
        assert focus.Get(12) == pytest.approx(FAR_M, abs=1e-2)
    assert client.get(f"{shot}/focus-curve").json()["samples"] == curve["samples"]


def test_the_lens_is_set_for_all_time_or_keyed(client, shot):
    changed = client.patch(f"{shot}/camera", params={"camera": "/World/cam"}, json={"fStop": 4, "focalLengthMm": 35})
    assert (changed.json()["fStop"], changed.json()["focalLengthMm"]) == (4, pytest.approx(35))
    for time, distance_m in ((1, 3), (24, 6)):
        client.patch(f"{shot}/camera", json={"focusDistanceM": distance_m, "time": time})
    assert [readout(client, shot, t)["focusDistanceM"] for t in (1, 24)] == [pytest.approx(3), pytest.approx(6)]
    assert 3 < readout(client, shot, 12)["focusDistanceM"] < 6
    far = client.patch(f"{shot}/camera", json={"focusDistanceM": 0})
    assert far.json()["focusDistanceM"] is None or far.json()["focusDistanceM"] >= 1e5
    assert readout(client, shot)["farM"] is None


def test_a_hand_on_the_ring_wins_until_the_points_get_it_back(client, shot):
    place(client, shot, 240)
    assert client.patch(f"{shot}/camera", json={"focusDistanceM": 5}).json()["focusMode"] == "manual"
    assert readout(client, shot)["focusDistanceM"] == pytest.approx(5)
    client.patch(f"{shot}/camera", json={"focusMode": "points"})
    assert readout(client, shot)["focusDistanceM"] == pytest.approx(FAR_M, abs=1e-3)


def test_a_refused_edit_changes_nothing(client, shot):
    place(client, shot, 240)
    before = client.get(f"{shot}/edits").text
    for method, path, body in [
        ("PATCH", "camera", {"fStop": -1}),
        ("PATCH", "camera?camera=/World/far", {"fStop": 2}),
        ("PATCH", "focus-points/point1?time=1", {"target": ["not a path"]}),
        ("PATCH", "focus-points/nobody?time=1", {"weight": 2}),
        ("POST", "focus-points?time=1", {"target": ["/World/far"], "name": "1st"}),
        ("PUT", "focus-points/point1/keys/weight", {"time": 1, "value": -3}),
        ("PUT", "focus-points/point1/keys/kind", {"time": 1, "value": 1}),
        ("PUT", "focus-points/point1/keys/weight", {"time": 1e300, "value": 1}),
        ("PATCH", "focus-points/point1?time=1", {"face": 2**31}),
        ("PATCH", "focus-points/point1?time=1", {"barycentric": [1e308, 1e308, 1e308]}),
        ("PATCH", "focus-points/point1?time=1", {"offset": [1e300, 0, 0]}),
        ("PATCH", "camera", {"focalLengthMm": 1e-300}),
    ]:
        answer = client.request(method, f"{shot}/{path}", json=body)
        assert 400 <= answer.status_code < 500, (path, body, answer.text)
        assert set(answer.json()) == {"code", "detail", "path", "errors"}
    assert client.get(f"{shot}/edits").text == before
    assert readout(client, shot)["focusDistanceM"] == pytest.approx(FAR_M, abs=1e-3)
