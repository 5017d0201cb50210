"""Focus reports of renders over REST: the numbers of the readouts, with the edits that the render keeps."""

from __future__ import annotations

import csv
import io

import pytest

from service.storage.database.connection import transaction
from service.storage.database.tables import RenderRow
from tests.service.conftest import ROOM, send
from tests.service.kits.renders import render_of

NEAR_M, FAR_M = 3.0, 8.0
FOCAL_MM, F_STOP, GATE_MM, WIDTH_PX = 50.0, 1.4, 36.0, 32
SAME_NAMES = ("kind", "enabled", "weight", "state", "depthM", "focusDistanceM", "visibleInFrame", "sharp")
OF_READOUT = ("fStop", "focalLengthMm", "nearM", "farM", "hyperfocalM", "cocLimitMm", "tiltDeg", "swingDeg")


@pytest.fixture(autouse=True)
def undrawn(service, monkeypatch):
    """No frame is drawn: a report needs none."""
    monkeypatch.setattr(service.internal.renders, "claim", lambda *_: None)


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def place(client, shot, name, **values):
    point = {"target": [f"/World/{name}"], "face": 0, "barycentric": [0.5, 0, 0.5], "name": name} | values
    answer = client.post(f"{shot}/focus-points", params={"time": 1}, json=point)
    assert answer.status_code == 201, answer.text


def report_of(client, render, **query):
    answer = client.get(f"/v1/renders/{render['id']}/focus-report", params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


def circle_mm(depth_m, focus_m):
    """Diameter of the circle of confusion by the thin lens, negative in front of the focus."""
    return FOCAL_MM**2 / F_STOP / 1000 * (1 / focus_m - 1 / depth_m)


def test_numbers_are_those_of_the_readouts_at_the_renders_edits(client, shot, room):
    place(client, shot, "near")
    place(client, shot, "far", weight=0.25)
    lens = {"mode": "surface", "lagS": 0.5, "smoothingS": 0.2}
    assert client.patch(f"{shot}/camera/focus", json=lens).status_code == 200
    for time, value in ((1, 0), (9, 1)):
        client.put(f"{shot}/focus-points/near/keys/weight", json={"time": time, "value": value})
    render = render_of(client, room, frames="3-9:3", height=32)
    params = [{"time": time, "aspect": 1} for time in (3, 6, 9)]
    lenses = [client.get(f"{shot}/readout", params={"time": one["time"]}).json() for one in params]
    points = [client.get(f"{shot}/focus-points", params=one).json()["focusPoints"] for one in params]
    client.patch(f"{shot}/camera", json={"focusDistanceM": 9, "fStop": 8, "focusMode": "manual"})
    client.delete(f"{shot}/focus-points/far")

    report = report_of(client, render)
    assert [sample["frame"] for sample in report["samples"]] == [3, 6, 9]
    assert len({lens["focusDistanceM"] for lens in lenses}) == 3
    for sample, lens, placed in zip(report["samples"], lenses, points, strict=True):
        assert {name: sample[name] for name in OF_READOUT} == {name: lens[name] for name in OF_READOUT}
        assert sample["focusDistanceM"] == lens["focusDistanceM"]
        assert [point["name"] for point in sample["points"]] == ["near", "far"]
        for reported, point in zip(sample["points"], placed, strict=True):
            assert {name: reported[name] for name in SAME_NAMES} == {name: point[name] for name in SAME_NAMES}
            assert abs(reported["signedCocMm"]) == point["cocMm"]
    assert (report["revision"], report["camera"], report["width"]) == (render["revision"], "/World/cam", WIDTH_PX)


def test_circles_have_a_sign_and_a_size_in_pixels(client, shot, room):
    place(client, shot, "near")
    place(client, shot, "far")
    client.patch(f"{shot}/camera", json={"focusDistanceM": 5, "focusMode": "manual"})
    (sample,) = report_of(client, render_of(client, room, frames="1"))["samples"]
    for point, depth_m in zip(sample["points"], (NEAR_M, FAR_M), strict=True):
        assert point["signedCocMm"] == pytest.approx(circle_mm(depth_m, 5), rel=1e-4)
        assert point["signedCocPx"] == pytest.approx(circle_mm(depth_m, 5) / GATE_MM * WIDTH_PX, rel=1e-4)
        assert (point["sharp"], point["judged"], point["state"]) == (False, True, "by_hand")
    assert sample["points"][0]["signedCocMm"] < 0 < sample["points"][1]["signedCocMm"]
    assert sample["tStop"] == pytest.approx(F_STOP)


def test_glass_that_absorbs_light_makes_the_t_stop_larger(client):
    glass = "float fStop = 1.4\n        double lens:transmittance = 0.64"
    dim = ROOM.replace('"cam"', '"cam" (prepend apiSchemas = ["LensAPI"])').replace("float fStop = 1.4", glass)
    shot = send(client, "dim.usda", dim.encode()).json()["id"]
    (sample,) = report_of(client, render_of(client, shot, frames="1"))["samples"]
    assert (sample["fStop"], sample["tStop"]) == (pytest.approx(1.4), pytest.approx(1.4 / 0.8))
    client.delete(f"/v1/shots/{shot}")


def test_the_summary_names_who_is_soft_and_when(client, shot, room):
    place(client, shot, "near")
    place(client, shot, "far")
    client.patch(f"{shot}/camera", json={"focusDistanceM": NEAR_M, "focusMode": "manual"})
    for time, value in ((1, 1), (3, 0)):
        client.put(f"{shot}/focus-points/far/keys/enabled", json={"time": time, "value": value})
    render = render_of(client, room, frames="1-5")
    summary = report_of(client, render)["summary"]
    near, far = summary["points"]
    assert (near["name"], near["judgedCount"], near["softFrames"]) == ("near", 5, [])
    assert (far["name"], far["judgedCount"], far["softFrames"]) == ("far", 2, [1, 2])
    assert (summary["softFrames"], summary["softest"]) == ([1, 2], far["softest"])
    softest = summary["softest"]
    assert (softest["point"], softest["frame"], softest["sharp"]) == ("far", 1, False)
    assert softest["signedCocMm"] == pytest.approx(circle_mm(FAR_M, NEAR_M), rel=1e-4)
    later = report_of(client, render, frames="4-5")
    assert (later["frames"], later["count"], later["summary"]["softFrames"]) == ("4-5", 2, [])


def test_the_csv_has_the_numbers_of_the_json_under_their_units(client, shot, room):
    place(client, shot, "near")
    place(client, shot, "far")
    render = render_of(client, room, frames="1-2")
    answer = client.get(f"/v1/renders/{render['id']}/focus-report", params={"format": "csv"})
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    assert answer.headers["content-disposition"] == f'inline; filename="{render["id"]}-focus.csv"'
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    samples = report_of(client, render)["samples"]
    assert [(row["frame"], row["point_name"]) for row in rows] == [
        ("1", "near"),
        ("1", "far"),
        ("2", "near"),
        ("2", "far"),
    ]
    flat = [(sample, point) for sample in samples for point in sample["points"]]
    for row, (sample, point) in zip(rows, flat, strict=True):
        assert float(row["f_stop"]) == sample["fStop"]
        assert float(row["focus_distance_m"]) == sample["focusDistanceM"]
        assert float(row["point_signed_coc_mm"]) == point["signedCocMm"]
        assert float(row["point_signed_coc_px"]) == point["signedCocPx"]
        assert row["point_sharp"] == str(point["sharp"]).lower()


def test_a_shot_without_cameras_has_a_report_without_points(client):
    text = '#usda 1.0\n(\n metersPerUnit = 1\n)\ndef Cube "box" {}\n'
    shot = send(client, "box.usda", text.encode()).json()["id"]
    render = render_of(client, shot, frames="1-2")
    report = report_of(client, render)
    assert (report["camera"], [sample["points"] for sample in report["samples"]]) == (None, [[], []])
    assert report["summary"] == {"softest": None, "softFrames": [], "points": []}
    rows = client.get(f"/v1/renders/{render['id']}/focus-report", params={"format": "csv"}).text.splitlines()
    assert len(rows) == 3
    client.delete(f"/v1/shots/{shot}")


@pytest.mark.parametrize(
    ("frames", "status", "code"),
    [("7", 404, "frame_not_found"), ("1-", 422, "bad_setting"), ("3,3", 422, "bad_setting")],
)
def test_frames_of_a_report_are_the_renders_own(client, room, frames, status, code):
    render = render_of(client, room, frames="1-5")
    answer = client.get(f"/v1/renders/{render['id']}/focus-report", params={"frames": frames})
    assert (answer.status_code, answer.json()["code"], answer.json()["path"]) == (status, code, "frames")


@pytest.mark.parametrize("product", ["focus-report", "focus-curve"])
def test_a_render_whose_camera_is_none_has_no_report(client, room, product):
    render = render_of(client, room, frames="1", camera="/World")
    answer = client.get(f"/v1/renders/{render['id']}/{product}")
    assert (answer.status_code, answer.json()["code"], answer.json()["path"]) == (409, "bad_camera", "render")


def test_a_report_needs_the_shot_that_was_sent(service, client, room_file):
    shot = send(client, "away.usda", room_file.read_bytes()).json()["id"]
    render = render_of(client, shot, frames="1")
    address = f"/v1/renders/{render['id']}/focus-report"
    with transaction(service.internal.renders._engine) as session:
        session.get(RenderRow, render["id"]).shot_created_at = "2026-01-01T00:00:00+00:00"
    other = client.get(address)
    assert (other.status_code, other.json()["code"]) == (404, "shot_replaced")
    client.delete(f"/v1/shots/{shot}")
    gone = client.get(address)
    assert (gone.status_code, gone.json()["code"]) == (404, "shot_not_found")
    assert "which is gone" in gone.json()["detail"]
    unknown = client.get("/v1/renders/r-nothing/focus-report")
    assert (unknown.status_code, unknown.json()["code"]) == (404, "render_not_found")


def test_a_page_has_the_marks_of_the_pull(client, shot, room):
    place(client, shot, "near")
    for time, value in ((1, 0), (9, 1)):
        client.put(f"{shot}/focus-points/near/keys/weight", json={"time": time, "value": value})
    render = render_of(client, room, frames="3-9:3", height=32)
    answer = client.get(f"/v1/renders/{render['id']}/focus-report", params={"format": "html"})
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert answer.headers["content-disposition"] == f'attachment; filename="{render["id"]}-focus.html"'
    assert "weight of near: 1" in answer.text
    assert "weight of near: 0" not in answer.text, "it lies before the first frame"


def test_a_page_without_points_and_keys_says_so(client, room):
    render = render_of(client, room, frames="3", height=32)
    answer = client.get(f"/v1/renders/{render['id']}/focus-report", params={"format": "html"})
    assert answer.status_code == 200
    assert "The camera has no focus points." in answer.text
    assert "Nothing that changes the focus has keys." in answer.text
