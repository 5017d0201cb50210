"""The lens read off over HTTP: as a whole, at a focus point, and at a place that somebody points at."""

from __future__ import annotations

import math

import pytest

NEAR_M, FAR_M = 3.0, 8.0
FOCAL_MM, F_STOP = 50.0, 1.4


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def at(client, shot, **ask):
    answer = client.get(f"{shot}/readout/place", params={"time": 1} | ask)
    assert answer.status_code == 200, answer.text
    return answer.json()


def circle_mm(depth_m, focus_m=NEAR_M):
    return FOCAL_MM**2 / F_STOP / 1000 * abs(1 / depth_m - 1 / focus_m)


def test_what_is_pointed_at_is_read_off(client, shot):
    near, far = at(client, shot, x=0.4, y=0.5), at(client, shot, x=0.75, y=0.5)
    assert near["depthM"] == pytest.approx(NEAR_M, rel=1e-4)
    assert near["sharp"]
    assert near["cocMm"] == pytest.approx(0, abs=1e-3)
    assert far["depthM"] == pytest.approx(FAR_M, rel=1e-4)
    assert far["cocMm"] == pytest.approx(circle_mm(FAR_M), rel=1e-3)
    assert not far["sharp"]
    assert far["nearM"] < NEAR_M < far["farM"] < FAR_M
    assert (far["camera"], far["point"]) == ("/World/cam", None)


def test_behind_everything_is_infinity(client, shot):
    sky = at(client, shot, x=0.02, y=0.02)
    assert sky["depthM"] is None
    assert sky["cocMm"] == pytest.approx(circle_mm(math.inf), rel=1e-4)


def test_a_depth_can_be_given(client, shot):
    assert at(client, shot, x=0.02, y=0.02, depthM=5)["cocMm"] == pytest.approx(circle_mm(5), rel=1e-4)


def test_a_point_is_read_off(client, shot):
    point = {"target": ["/World/far"], "face": 0, "barycentric": [0.5, 0, 0.5], "name": "hero", "enabled": False}
    placed = client.post(f"{shot}/focus-points", params={"time": 1}, json=point).json()
    client.patch(f"{shot}/camera", json={"focusDistanceM": 3})
    read = at(client, shot, point="hero")
    assert read["point"] == "hero"
    assert read["cocMm"] == pytest.approx(circle_mm(FAR_M), rel=1e-4)
    assert read["screen"] == pytest.approx(placed["screen"])
    same = at(client, shot, x=read["screen"][0], y=read["screen"][1])
    assert same["depthM"] == pytest.approx(read["depthM"], rel=1e-4)


def test_a_tilted_lens_reads_nearer_below(client, shot):
    change = {"mode": "tiltPlane", "drivenByPoints": False, "tiltDeg": -5, "swingDeg": 2}
    client.patch(f"{shot}/camera/focus", json=change)
    below, above = at(client, shot, x=0.5, y=0.9, depthM=3), at(client, shot, x=0.5, y=0.1, depthM=3)
    assert below["focusDistanceM"] < NEAR_M < above["focusDistanceM"]
    lens = client.get(f"{shot}/readout", params={"time": 1}).json()
    assert (lens["tiltDeg"], lens["swingDeg"]) == (pytest.approx(-5), pytest.approx(2))


@pytest.mark.parametrize(
    "ask",
    [
        {},
        {"x": 0.5},
        {"x": 0.5, "y": 1.5},
        {"x": "nan", "y": 0.5},
        {"x": 0.5, "y": 0.5, "depthM": 0},
        {"x": 0.5, "y": 0.5, "depthM": -1},
        {"x": 0.5, "y": 0.5, "point": "hero"},
        {"point": "hero", "depthM": 3},
        {"point": "1st"},
        {"x": 0.5, "y": 0.5, "aspect": 0},
        {"x": 0.5, "y": 0.5, "camera": "/World/near"},
    ],
    ids=str,
)
def test_places_that_cannot_be(client, shot, ask):
    answer = client.get(f"{shot}/readout/place", params={"time": 1} | ask)
    assert answer.status_code == 422, answer.text
    assert set(answer.json()) == {"code", "detail", "path", "errors"}


def test_points_that_are_not_there(client, shot):
    answer = client.get(f"{shot}/readout/place", params={"time": 1, "point": "nobody"})
    assert answer.status_code == 404
    assert "nobody" in answer.json()["detail"]


def test_the_camera_tells_the_stop_that_its_points_set(client, shot):
    for place in ("near", "far"):
        point = {"target": [f"/World/{place}"], "face": 0, "barycentric": [0.5, 0, 0.5], "name": place}
        assert client.post(f"{shot}/focus-points", params={"time": 1}, json=point).status_code == 201
    client.patch(f"{shot}/camera/focus", json={"mode": "points", "solveStop": True})
    readout = client.get(f"{shot}/readout", params={"time": 1}).json()
    camera = client.get(f"{shot}/camera", params={"time": 1}).json()
    assert readout["fStop"] > 5
    assert camera["fStop"] == readout["fStop"]
    assert camera["focusDistanceM"] == readout["focusDistanceM"]
