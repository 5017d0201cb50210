"""Focus maps over HTTP: the AOVs of the command line, and the answers to odd requests."""

from __future__ import annotations

import numpy as np
import OpenImageIO
import pytest

from render.cli.main import main
from tests.service.kits.focus_maps import decode_focus_map

SMALL = {"time": 12, "width": 96, "height": 54}


def focus_map(client, shot, **parameters):
    """Ask for a small focus map."""
    return client.get(f"/v1/shots/{shot}/focus-map", params=SMALL | parameters)


def test_it_has_the_numbers_of_the_aovs(client, room, room_file, tmp_path):
    out = tmp_path / "out.exr"
    arguments = ["record", str(room_file), str(out), "--frames", "12", "--imageWidth", "96", "--rays", "1"]
    assert main([*arguments, "--aov", "color,coc,depth"]) == 0
    parts = [OpenImageIO.ImageBuf(str(out), i, 0) for i in range(OpenImageIO.ImageBuf(str(out)).nsubimages)]
    aovs = {part.spec().get_string_attribute("name"): part.get_pixels(OpenImageIO.FLOAT)[..., 0] for part in parts}
    answer = client.get(f"/v1/shots/{room}/focus-map", params={"time": 12, "width": 96})
    assert answer.status_code == 200, answer.text
    head, coc_px, depth_m = decode_focus_map(answer.content)
    assert (head["width"], head["height"]) == (96, aovs["coc"].shape[0])
    np.testing.assert_array_equal(coc_px, aovs["coc"])
    np.testing.assert_array_equal(depth_m, aovs["depth"])
    assert np.ptp(coc_px) > 0.5


def test_its_millimetres_are_those_of_a_place(client, room):
    answer = focus_map(client, room)
    assert answer.status_code == 200, answer.text
    head, coc_px, depth_m = decode_focus_map(answer.content)
    row, column = 20, 70
    place = {"time": 12, "x": (column + 0.5) / 96, "y": (row + 0.5) / 54, "aspect": 96 / 54}
    readout = client.get(f"/v1/shots/{room}/readout/place", params=place).json()
    assert readout["depthM"] == pytest.approx(depth_m[row, column], rel=1e-4)
    assert readout["cocMm"] == pytest.approx(2 * abs(coc_px[row, column]) * head["filmMmPerPx"], rel=1e-3)


def test_its_tag_changes_with_the_focus(client, room):
    before = focus_map(client, room)
    assert before.status_code == 200, before.text
    tag = before.headers["etag"]
    unchanged = client.get(f"/v1/shots/{room}/focus-map", params=SMALL, headers={"If-None-Match": tag})
    assert unchanged.status_code == 304
    assert not unchanged.content
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 1, "focusDistanceM": 8})
    after = client.get(f"/v1/shots/{room}/focus-map", params=SMALL, headers={"If-None-Match": tag})
    assert after.status_code == 200
    assert after.headers["etag"] != tag
    assert after.content != before.content


@pytest.mark.parametrize(
    ("parameters", "status"),
    [
        ({"width": 0}, 422),
        ({"width": "wide"}, 422),
        ({"width": 8192, "height": 8192}, 422),
        ({"time": "nan"}, 422),
        ({"camera": "/no/such"}, 422),
    ],
)
def test_odd_requests_get_a_problem(client, room, parameters, status):
    answer = focus_map(client, room, **parameters)
    assert answer.status_code == status
    assert answer.json()["detail"]
