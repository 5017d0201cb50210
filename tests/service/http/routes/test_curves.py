"""Focus curves over HTTP: taken away in every format, and brought back from other tools."""

from __future__ import annotations

import json

import pytest

CSV = "frame,focus_distance_m,f_stop\n" + "".join(f"{n},{2 + n / 10},{4}\n" for n in range(1, 25))


@pytest.fixture
def shot(room: str) -> str:
    return f"/v1/shots/{room}"


def send(client, shot, content: str, headers=None, **params):
    return client.put(
        f"{shot}/focus-curve", files={"file": ("curve", content.encode())}, params=params, headers=headers
    )


def distance(client, shot, time: float) -> float:
    return client.get(f"{shot}/readout", params={"time": time}).json()["focusDistanceM"]


def test_editorial_and_the_set_get_their_files(client, shot):
    timeline = client.get(f"{shot}/focus-curve", params={"format": "otio", "frames": "1:24"})
    assert timeline.json()["OTIO_SCHEMA"] == "Timeline.1"
    assert timeline.headers["content-disposition"].endswith('-focus.otio"')
    samples = client.get(f"{shot}/focus-curve", params={"format": "opentrackio", "frames": "1:24"}).json()
    assert [sample["lens"]["focusDistance"] for sample in samples] == pytest.approx([3] * 24)
    assert samples[0]["protocol"]["name"] == "OpenTrackIO"


def test_a_curve_of_another_tool_drives_the_camera(client, shot):
    answer = send(client, shot, CSV)
    assert answer.status_code == 200, answer.text
    imported = answer.json()
    assert (imported["firstTime"], imported["lastTime"], imported["frames"]) == (1, 24, 24)
    assert (imported["drives"], imported["findings"]) == (["focusDistance", "fStop"], [])
    assert imported["camera"]["focusDistanceM"] == pytest.approx(2.1)
    assert imported["camera"]["fStop"] == pytest.approx(4)
    assert answer.headers["etag"] == imported["camera"]["etag"]
    assert [distance(client, shot, time) for time in (1, 12, 24)] == pytest.approx([2.1, 3.2, 4.4])


@pytest.mark.parametrize("format", ["json", "csv", "otio", "opentrackio"])
@pytest.mark.parametrize("baked", [False, True])
def test_what_was_taken_away_can_be_brought_back(client, shot, format, baked):
    send(client, shot, CSV)
    taken = client.get(f"{shot}/focus-curve", params={"format": format}).text
    client.patch(f"{shot}/camera", json={"focusDistanceM": 9, "fStop": 8})
    assert distance(client, shot, 12) == pytest.approx(9)
    assert send(client, shot, taken, baked=baked).status_code == 200
    assert [distance(client, shot, time) for time in (1, 12, 24)] == pytest.approx([2.1, 3.2, 4.4], rel=1e-6)


def test_an_import_is_one_step_of_undo(client, shot):
    send(client, shot, CSV)
    client.post(f"{shot}/edits/undo")
    assert distance(client, shot, 24) == pytest.approx(3)
    client.post(f"{shot}/edits/redo")
    assert distance(client, shot, 24) == pytest.approx(4.4)


def test_an_import_on_old_terms_is_refused(client, shot):
    tag = client.get(f"{shot}/camera", params={"time": 1}).headers["etag"]
    client.patch(f"{shot}/camera", json={"fStop": 8})
    refused = send(client, shot, CSV, headers={"If-Match": tag})
    assert (refused.status_code, refused.json()["code"]) == (412, "changed_meanwhile")
    assert distance(client, shot, 24) == pytest.approx(3)


def test_gaps_are_refused_or_filled_and_reported(client, shot):
    holes = "frame,focus_distance_m\n1,2\n2,2\n3,?\n4,2\n9,4\n"
    refused = send(client, shot, holes)
    assert (refused.status_code, refused.json()["code"]) == (422, "curve_gaps")
    assert "row 4" in refused.json()["detail"]
    assert "frames 5 to 8" in refused.json()["detail"]
    filled = send(client, shot, holes, gaps="interpolate").json()
    assert [(finding["code"], finding["place"]) for finding in filled["findings"]] == [
        ("bad_row", "row 4"),
        ("gap", "frames 5 to 8"),
    ]
    assert filled["frames"] == 9


def test_a_curve_can_be_put_anywhere_in_time(client, shot):
    assert send(client, shot, CSV, firstFrame=101).json()["firstTime"] == 101


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ("", "bad_curve"),
        ("\x00\x01", "bad_curve"),
        ("frame,focus_distance\n1,2\n", "bad_units"),
        ("frame,focus_distance_m\n" + "".join(f"{n},2\n" for n in range(20_001)), "bad_frames"),
        (json.dumps([{"protocol": {"name": "OpenTrackIO"}}]), "bad_curve"),
    ],
)
def test_a_file_that_cannot_be_used_changes_nothing(client, shot, content, code):
    before = client.get(f"{shot}/edits").text
    answer = send(client, shot, content)
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert client.get(f"{shot}/edits").text == before


def test_a_curve_may_be_larger_than_other_requests_up_to_a_limit(client, shot):
    large = "frame,focus_distance_m\n" + "".join(f"{n},2.{'0' * 60}\n" for n in range(1, 20_001))
    assert len(large) > 1 << 20
    assert send(client, shot, large).json()["frames"] == 20_000
    assert send(client, shot, "x" * (33 << 20)).status_code == 413
