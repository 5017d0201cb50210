"""Shots over HTTP: sent, listed, looked into, removed."""

from __future__ import annotations

import io
import zipfile

import pytest
from pxr import Sdf, Usd, UsdUtils

from service.http.settings import Settings
from tests.service.conftest import ROOM, running, send


def zipped(**entries: bytes | str) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(name.replace("__", "/").replace("_dot_", "."), content)
    return file.getvalue()


def test_a_shot_is_listed_described_and_removed(client, room):
    listed = client.get("/v1/shots").json()["shots"]
    shot = client.get(f"/v1/shots/{room}").json()
    assert {k: shot[k] for k in listed[-1]} == listed[-1]
    assert shot["cameras"] == ["/World/cam"] == [shot["defaultCamera"]["path"]]
    assert shot["frameRange"] == {"start": 1, "end": 24, "framesPerSecond": 24}
    assert client.get(f"/v1/shots/{room}").headers["ETag"] == f'"{shot["revision"]}"'
    assert client.delete(f"/v1/shots/{room}").status_code == 204
    assert client.get(f"/v1/shots/{room}").status_code == 404
    assert client.delete(f"/v1/shots/{room}").status_code == 404
    assert room not in {shot["id"] for shot in client.get("/v1/shots").json()["shots"]}


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd", ".usdz"])
def test_every_kind_of_usd_is_taken(client, room_file, tmp_path, suffix):
    file = tmp_path / f"shot{suffix}"
    if suffix == ".usdz":
        assert UsdUtils.CreateNewUsdzPackage(str(room_file), str(file))
    else:
        Usd.Stage.Open(str(room_file)).Export(str(file))
    sent = send(client, file.name, file.read_bytes())
    assert sent.status_code == 201, sent.text
    shot = sent.json()
    assert sent.headers["location"] == f"/v1/shots/{shot['id']}"
    assert shot["cameras"] == ["/World/cam"]
    client.delete(sent.headers["location"])


def test_a_zip_brings_what_it_refers_to(client):
    root = "#usda 1.0\n(subLayers = [@./sets/room.usda@])\n"
    sent = send(client, "set.zip", zipped(top__shot_dot_usda=root, top__sets__room_dot_usda=ROOM))
    assert sent.status_code == 201, sent.text
    shot = sent.json()
    assert (shot["root"], shot["fileCount"], shot["cameras"]) == ("top/shot.usda", 2, ["/World/cam"])
    client.delete(sent.headers["location"])


def test_the_root_of_a_zip_can_be_named(client):
    content = zipped(a_dot_usda="#usda 1.0\n", b_dot_usda=ROOM)
    refused = send(client, "set.zip", content)
    assert (refused.status_code, refused.json()["code"]) == (422, "ambiguous_root")
    assert [candidate["path"] for candidate in refused.json()["errors"]] == ["a.usda", "b.usda"]
    sent = send(client, "set.zip", content, root="b.usda")
    assert (sent.status_code, sent.json()["root"]) == (201, "b.usda")
    client.delete(sent.headers["location"])


@pytest.mark.parametrize(
    "root",
    ["../b.usda", "/etc/passwd", "/b.usda", "c.usda", "b.txt", "set", "b.usda\0", "b\r\n.usda", "${HOME}"],
)
def test_a_root_that_is_none_of_the_zips_stages_is_refused(client, root):
    content = zipped(a_dot_usda="#usda 1.0\n", b_dot_usda=ROOM, b_dot_txt="notes", set__c_dot_usda=ROOM)
    before = len(client.get("/v1/shots").json()["shots"])
    refused = send(client, "set.zip", content, root=root)
    assert (refused.status_code, refused.json()["code"]) == (422, "bad_root")
    assert refused.json()["detail"].startswith("set.zip holds no USD file ")
    assert len(client.get("/v1/shots").json()["shots"]) == before


def test_inspect_says_what_is_there_and_what_is_not_honoured(client, room_file):
    text = room_file.read_text().replace(
        'def DistantLight "sun"', 'def GeometryLight "glow"\n{\n}\ndef DistantLight "sun"'
    )
    shot = send(client, "room.usda", text.encode()).json()["id"]
    inspection = client.get(f"/v1/shots/{shot}/inspect").json()
    assert (
        inspection["triangleCount"],
        inspection["primCount"],
        inspection["upAxis"],
        inspection["metersPerUnit"],
    ) == (4, 2, "Y", 1)
    assert inspection["readouts"][0]["focalLengthMm"] == pytest.approx(50)
    assert "/World/glow" in {note["path"] for note in inspection["notes"]}
    client.delete(f"/v1/shots/{shot}")


def test_a_file_that_crashes_the_reader_is_refused_and_it_lives_on(service, client, room):
    """USD's text parser recurses without a limit, so deep nesting ends the process that parses (usd-core 26.11)."""
    depth = 60_000
    text = "#usda 1.0\n" + 'def "a" {\n' * depth + "}\n" * depth
    refused = send(client, "deep.usda", text.encode())
    assert (refused.status_code, refused.json()["code"]) == (422, "stage_unreadable")
    assert "deep.usda" in refused.json()["detail"]
    assert len(list((service.settings.data / "shots").iterdir())) == len(client.get("/v1/shots").json()["shots"])
    assert client.get(f"/v1/shots/{room}/readout", params={"time": 1}).status_code == 200


def test_nothing_says_where_this_machine_keeps_a_shot(service, client):
    sky = 'def DomeLight "sky"\n{\n    asset inputs:texture:file = @./gone.hdr@\n}\n'
    sent = send(client, "room.usda", ROOM.replace("def DistantLight", sky + "def DistantLight").encode())
    answers = [sent.text]
    if sent.status_code == 201:
        at = sent.headers["location"]
        answers += [client.get(f"{at}/{path}").text for path in ("inspect", "edits", "frame?time=1&width=8")]
        client.delete(at)
    assert "gone.hdr" in "".join(answers)
    assert str(service.settings.data) not in "".join(answers)


def test_edits_outlive_the_service(room_file, tmp_path):
    settings = Settings(data=tmp_path, demo=False)
    with running(settings) as first:
        shot = send(first.client, "room.usda", room_file.read_bytes()).json()["id"]
        before = first.client.get(f"/v1/shots/{shot}").json()["revision"]
        edited = first.client.patch(f"/v1/shots/{shot}/camera", json={"fStop": 5.6})
        assert edited.status_code == 200, edited.text
        revision = first.client.get(f"/v1/shots/{shot}").json()["revision"]
        assert revision != before
    with running(settings) as second:
        assert second.client.get(f"/v1/shots/{shot}").json()["revision"] == revision
        lens = second.client.get(f"/v1/shots/{shot}/readout", params={"time": 1}).json()
        assert lens["fStop"] == pytest.approx(5.6)


def test_edits_are_a_layer_to_put_over_the_shot(client, room, room_file):
    assert Sdf.Layer.CreateAnonymous().ImportFromString(client.get(f"/v1/shots/{room}/edits").text)
    client.patch(f"/v1/shots/{room}/camera", json={"focusDistanceM": 8, "fStop": 2})
    edits = client.get(f"/v1/shots/{room}/edits")
    assert "attachment" in edits.headers["content-disposition"]
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(edits.text)
    stage = Usd.Stage.Open(str(room_file))
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    camera = stage.GetPrimAtPath("/World/cam")
    assert camera.GetAttribute("focusDistance").Get() == pytest.approx(8)
    assert camera.GetAttribute("fStop").Get() == pytest.approx(2)


def test_the_demo_shot_is_there_at_start(tmp_path):
    with running(Settings(data=tmp_path)) as service:
        shots = service.client.get("/v1/shots").json()["shots"]
        assert [shot["id"] for shot in shots] == ["demo"]
        shot = service.client.get("/v1/shots/demo").json()
        assert shot["frameRange"]["end"] - shot["frameRange"]["start"] + 1 == 96
        points = service.client.get("/v1/shots/demo/focus-points", params={"time": 1}).json()["focusPoints"]
        assert len(points) >= 2
        assert any(point["keys"] for point in points)
