"""The set from above over HTTP: its numbers are those of the readouts, and a point is moved in it."""

from __future__ import annotations

import numpy as np
import pytest

POINT = {"target": ["/World/far"], "face": 0, "barycentric": [0.5, 0, 0.5], "name": "hero"}


@pytest.fixture
def shot(client, room) -> str:
    address = f"/v1/shots/{room}"
    client.post(f"{address}/focus-points", params={"time": 1}, json=POINT).raise_for_status()
    return address


def read(client, address: str, **query):
    answer = client.get(address, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


def hero(client, shot, time=1):
    return read(client, f"{shot}/focus-points/hero", time=time)


def test_the_cut_is_that_of_the_readouts(client, shot):
    client.patch(f"{shot}/camera/focus", json={"mode": "manual", "swingDeg": 1.5}).raise_for_status()
    view, lens = read(client, f"{shot}/top-view", time=1), read(client, f"{shot}/readout", time=1)
    axis = view["axis"]
    assert [1 / axis[name] for name in ("nearW", "focusW", "farW")] == pytest.approx(
        [lens[name] for name in ("nearM", "focusDistanceM", "farM")]
    )
    for x, cut in ((0, view["cut"][0]), (1, view["cut"][-1])):
        at = read(client, f"{shot}/readout/place", time=1, x=x, y=0.5, depthM=4)
        assert 1 / cut["focusW"] == pytest.approx(at["focusDistanceM"])
        assert 1 / cut["nearW"] == pytest.approx(at["nearM"])
    assert [view["cut"][0]["slope"], view["cut"][-1]["slope"]] == view["edges"]


def test_a_point_is_in_the_plan_at_its_depth(client, shot):
    view, point = read(client, f"{shot}/top-view", time=1), hero(client, shot)
    way = np.array(point["positionM"]) - view["positionM"]
    assert way @ view["ahead"] == pytest.approx(point["depthM"])
    paths = read(client, f"{shot}/paths")
    (path,) = paths["points"]
    assert path["name"] == "hero"
    assert path["positionsM"][0] == pytest.approx(point["positionM"])
    assert len(paths["times"]) == len(paths["cameraM"]) == len(path["positionsM"])
    assert paths["cameraM"][0] == pytest.approx(view["positionM"])


def test_a_point_is_moved_in_the_world(client, shot):
    before = hero(client, shot)
    x, y, z = before["positionM"]
    move = {"type": "movePoint", "name": "hero", "positionM": [x + 0.5, y, z + 1], "time": 1}
    answer = client.post(f"{shot}/edits", json={"changes": [move], "answer": {"time": 1}})
    assert answer.status_code == 200, answer.text
    (point,) = answer.json()["state"]["focusPoints"]["focusPoints"]
    assert point["positionM"] == pytest.approx([x + 0.5, y, z + 1], abs=1e-5)
    assert point["depthM"] == pytest.approx(before["depthM"] - 1, abs=1e-5)
    client.post(f"{shot}/edits/undo", headers={"If-Match": answer.headers["etag"]}).raise_for_status()
    assert hero(client, shot)["positionM"] == pytest.approx([x, y, z])


@pytest.mark.parametrize(
    "to",
    [{}, {"positionM": [0, 0, 0], "place": [0.5, 0.5]}, {"positionM": [0, 0]}, {"positionM": [0, 0, 1e30]}],
    ids=["nowhere", "two places", "flat", "too far"],
)
def test_other_moves_are_refused(client, shot, to):
    move = {"type": "movePoint", "name": "hero", "time": 1} | to
    assert client.post(f"{shot}/edits", json={"changes": [move]}).status_code == 422
