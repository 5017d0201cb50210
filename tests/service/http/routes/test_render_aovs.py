"""AOVs in the EXR files of renders over REST: those that `pullfocus record` writes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from render.cli.main import main
from service.storage.database.connection import transaction
from service.storage.database.tables import RenderRow
from tests.service.kits.renders import SMALL, ended, render_of

NEAR_M = 3.0
AOVS = ["depth", "coc", "albedo", "cryptoObject", "primvars:displayColor"]


def parts_of(path: Path) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """Channels and pixels of each part of an EXR file."""
    found: dict[str, tuple[tuple[str, ...], np.ndarray]] = {}
    for index in range(oiio.ImageBuf(str(path)).nsubimages):
        image = oiio.ImageBuf(str(path), index, 0)
        found[image.spec()["oiio:subimagename"]] = (
            tuple(image.spec().channelnames),
            image.get_pixels(image.spec().format),
        )
    return found


@pytest.mark.gl
def test_the_exr_of_a_render_is_that_of_record(client, room, room_file, tmp_path):
    render = render_of(client, room, frames="3", engine="lens", formats=["png", "exr"], aovs=AOVS)
    assert render["aovs"] == AOVS
    assert ended(client, render)["state"] == "done"
    recorded, rendered = tmp_path / "recorded.exr", tmp_path / "rendered.exr"
    arguments = ["record", str(room_file), str(recorded), "--frames", "3", "--imageWidth", "32", "--rays", "4"]
    assert main([*arguments, "--aov", ",".join(["color", *AOVS])]) == 0
    rendered.write_bytes(client.get(f"/v1/renders/{render['id']}/frames/3", params={"format": "exr"}).content)
    expected, parts = parts_of(recorded), parts_of(rendered)
    assert sorted(parts) == sorted(["rgba", *AOVS])
    assert list(parts) == list(expected)
    for name, (channels, pixels) in parts.items():
        assert channels == expected[name][0]
        np.testing.assert_array_equal(pixels, expected[name][1])
    assert np.nanmin(parts["depth"][1]) == pytest.approx(NEAR_M, rel=1e-4)


@pytest.mark.gl
def test_a_render_of_an_earlier_version_has_no_aovs(service, client, room, tmp_path):
    queue = service.internal.renders
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(queue, "claim", lambda *_: None)
        render = render_of(client, room, frames="1")
        with transaction(queue._engine) as session:
            row = session.get(RenderRow, render["id"])
            row.request = {name: value for name, value in row.request.items() if name != "aovs"}
        assert client.get(f"/v1/renders/{render['id']}").json()["aovs"] == []
    assert ended(client, render)["state"] == "done"
    path = tmp_path / "frame.exr"
    path.write_bytes(client.get(f"/v1/renders/{render['id']}/frames/1").content)
    assert list(parts_of(path)) == ["rgba"]


@pytest.mark.parametrize(
    ("request_part", "says"),
    [
        ({"aovs": ["depth"], "formats": ["png"]}, "add exr to the formats"),
        ({"aovs": ["depth", "depth"]}, "each AOV may come once"),
        ({"aovs": ["color"]}, "an AOV is one of depth"),
        ({"aovs": ["primvars:"]}, "an AOV is one of depth"),
        ({"aovs": ["primvars:a b"]}, "an AOV is one of depth"),
        ({"aovs": ["cryptoObject"], "engine": "scatter"}, "the scatter engine has no cryptoObject"),
        ({"aovs": [f"primvars:p{n}" for n in range(33)]}, "at most 32 items"),
    ],
    ids=str,
)
def test_aovs_that_cannot_be_are_refused(client, room, request_part, says):
    answer = client.post("/v1/render-plans", json=SMALL | {"shot": room, "frames": "1"} | request_part)
    assert answer.status_code == 422
    assert says in str(answer.json())


def test_a_plan_counts_the_cost_of_aovs(client, room):
    plain, measured, albedo = (
        client.post(
            "/v1/render-plans", json={"shot": room, "frames": "1-100", "width": 480, "engine": "lens", "aovs": aovs}
        ).json()["secondsOfProcessor"]
        for aovs in ([], ["depth", "coc"], ["albedo"])
    )
    assert plain < measured < 1.5 * plain < albedo
