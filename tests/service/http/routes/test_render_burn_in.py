"""Facts burnt into the graded pictures of renders over REST: those that `pullfocus record` burns in."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from render.cli.main import main
from tests.service.kits.renders import ended, render_of


@pytest.mark.gl
def test_the_pictures_of_a_render_have_its_facts(client, room, room_file, tmp_path):
    facts = ["focus", "frame", "timecode"]
    render = render_of(client, room, frames="3", engine="lens", formats=["png", "exr"], burnIn=facts)
    assert ended(client, render)["state"] == "done"
    recorded = tmp_path / "recorded.png"
    arguments = ["record", str(room_file), str(recorded), "--frames", "3", "--imageWidth", "32", "--rays", "4"]
    assert main([*arguments, "--burn-in", ",".join(facts)]) == 0
    answer = client.get(f"/v1/renders/{render['id']}/frames/3", params={"format": "png"})
    burnt, expected = np.asarray(Image.open(io.BytesIO(answer.content))), np.asarray(Image.open(recorded))
    np.testing.assert_array_equal(burnt, expected)
    assert main([*arguments]) == 0
    assert (burnt != np.asarray(Image.open(recorded))).any()


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"formats": ["exr"], "burnIn": ["frame"]}, "add png or jpeg to the formats"),
        ({"formats": ["png"], "burnIn": ["frame", "frame"]}, "each fact may come once"),
        ({"formats": ["png"], "burnIn": ["frmae"]}, "burnIn"),
    ],
)
def test_facts_that_no_picture_can_have_are_refused(asked, message, client, room):
    answer = client.post("/v1/renders", json={"shot": room} | asked)
    assert answer.status_code == 422
    assert message in answer.text
