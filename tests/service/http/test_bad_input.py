"""Bad input of every kind: a 4xx that names the thing, nothing left on disk, and a service that goes on."""

from __future__ import annotations

import io
import stat
import zipfile

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pxr import Usd

from service.workers.errors import BLAMED
from tests.service.conftest import ROOM, send

HEADER = "#usda 1.0\n"


@pytest.fixture(autouse=True)
def goes_on(service):
    """Whatever a test sends: no worker dies of it, nothing is left behind, and the next frame comes."""
    kept = service.client.get("/v1/shots").json()
    blamed = blames(service)
    yield
    assert service.client.get("/v1/shots").json() == kept
    folders = {folder.name for folder in (service.settings.data / "shots").iterdir()}
    assert folders == {shot["id"] for shot in kept["shots"]}
    assert service.client.get("/readyz").status_code == 200
    assert blames(service) == blamed


def blames(service) -> int:
    """Number of workers that have ended because of what they worked on."""
    return sum(count for (_, end), count in service.internal.pool.ends.items() if end in BLAMED)


def problem(answer, *statuses: int):
    """The body of a refusal, checked for its shape."""
    assert answer.status_code in (statuses or (422,)), (answer.status_code, answer.text)
    body = answer.json()
    assert set(body) == {"code", "detail", "path", "errors"}
    assert body["code"]
    assert body["detail"]
    assert "Traceback" not in body["detail"]
    return body


def archive(*entries: tuple[str | zipfile.ZipInfo, bytes | str]) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as opened:
        for name, content in entries:
            opened.writestr(name, content)
    return file.getvalue()


def usdc(tmp_path, text: str) -> bytes:
    source = tmp_path / "source.usda"
    source.write_text(text)
    Usd.Stage.Open(str(source)).Export(str(tmp_path / "out.usdc"))
    return (tmp_path / "out.usdc").read_bytes()


@pytest.mark.parametrize("name", ["shot.usda", "shot.usdc", "shot.usd", "shot.usdz", "shot.zip"])
@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n" + bytes(200), "Führerschein".encode() * 9])
def test_what_is_not_usd(client, name, content):
    assert name in problem(send(client, name, content))["detail"]


def test_a_file_of_another_kind(client):
    assert problem(send(client, "shot.fbx", b"Kaydara"), 415)["code"] == "unsupported_type"


@pytest.mark.parametrize("keep", [8, 64, 0.3, 0.9, -1])
def test_a_truncated_usdc(client, tmp_path, keep):
    whole = usdc(tmp_path, ROOM)
    cut = whole[: int(len(whole) * keep)] if isinstance(keep, float) else whole[:keep]
    assert "shot.usdc" in problem(send(client, "shot.usdc", cut))["detail"]


@pytest.mark.parametrize("arc", ["references", "payload", "subLayers"])
def test_a_shot_that_is_empty_for_a_missing_file(client, arc):
    where = f'def "Set" (prepend {arc} = @./sets/gone.usda@) {{ }}'
    text = f"{HEADER}(subLayers = [@./sets/gone.usda@])\n" if arc == "subLayers" else f"{HEADER}{where}\n"
    refusal = problem(send(client, "shot.usda", text.encode()))
    assert "gone.usda" in refusal["detail"]
    assert "/shots/" not in refusal["detail"] + str(refusal["path"])


def test_a_missing_reference_is_a_note(client):
    text = ROOM + 'def "Set" (prepend references = @./sets/gone.usda@) { }\n'
    shot = send(client, "shot.usda", text.encode()).json()["id"]
    notes = client.get(f"/v1/shots/{shot}/inspect").json()["notes"]
    client.delete(f"/v1/shots/{shot}")
    (note,) = [note for note in notes if note["code"] == "missing_reference"]
    assert note["path"] == "sets/gone.usda"
    assert "/Set" in note["message"]
    assert "/shots/" not in note["message"]


@pytest.mark.parametrize("target", ["/etc/hostname", "../../../other/files/secret.usda", "file:///etc/hostname"])
@pytest.mark.parametrize("arc", ["references", "subLayers", "texture"])
def test_a_reference_to_outside_is_named(client, target, arc):
    text = {
        "references": f'{HEADER}def "Set" (prepend references = @{target}@) {{ }}\n',
        "subLayers": f"{HEADER}(subLayers = [@{target}@])\n",
        "texture": f'{HEADER}def Shader "Tex" {{ asset inputs:file = @{target}@ }}\n',
    }[arc]
    refusal = problem(send(client, "shot.usda", text.encode()))
    assert target.removeprefix("file://").split("/")[-1] in refusal["detail"]


def test_another_shots_files_are_outside(client, room, service):
    other = service.settings.data / "shots" / room / "files" / "room.usda"
    text = f'{HEADER}def "Set" (prepend references = @../../{room}/files/room.usda@) {{ }}\n'
    problem(send(client, "shot.usda", text.encode()))
    problem(send(client, "shot.usda", text.replace(f"../../{room}/files/room.usda", str(other)).encode()))


def test_a_zip_bomb(client):
    refusal = problem(send(client, "bomb.zip", archive(("shot.usda", bytes(70_000_000)))), 413)
    assert (refusal["code"], refusal["path"]) == ("archive_too_large", "shot.usda")


@pytest.mark.parametrize("name", ["../shot.usda", "a/../../shot.usda", "/elsewhere/shot.usda", "..\\shot.usda"])
def test_a_zip_that_leaves_its_folder(client, name, service):
    refusal = problem(send(client, "shot.zip", archive(("ok.usda", ROOM), (name, ROOM))))
    assert refusal["code"] == "unsafe_archive"
    assert not (service.settings.data / "shots" / "shot.usda").exists()


def test_a_zip_with_a_link(client):
    link = zipfile.ZipInfo("shot.usda")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    assert problem(send(client, "shot.zip", archive((link, "/etc/passwd"))))["code"] == "unsafe_archive"


@pytest.mark.parametrize("has_length", [True, False])
def test_more_than_is_taken(client, has_length):
    def chunks():
        yield b'--x\r\nContent-Disposition: form-data; name="file"; filename="shot.usda"\r\n\r\n'
        for _ in range(40):
            yield bytes(100_000)
        yield b"\r\n--x--\r\n"

    kind = {"Content-Type": "multipart/form-data; boundary=x"}
    content = b"".join(chunks()) if has_length else chunks()
    assert problem(client.post("/v1/shots", headers=kind, content=content), 413)["code"] == "too_large"


def test_no_file_at_all(client):
    assert problem(client.post("/v1/shots"))["path"] == "body.file"
    assert problem(client.post("/v1/shots", data={"file": "text"}))["path"] == "body.file"
    kind = {"Content-Type": "multipart/form-data; boundary=x"}
    problem(client.post("/v1/shots", headers=kind, content=b"no boundary here"), 400, 422)


# A shot that can be sent, of which a frame cannot be had.


def refused_frame(client, text: str, **parameters):
    sent = send(client, "shot.usda", text.encode())
    if sent.status_code != 201:
        return problem(sent)
    shot = sent.json()["id"]
    try:
        answer = client.get(
            f"/v1/shots/{shot}/frame", params={"time": 1, "width": 32, "height": 18, "rays": 1} | parameters
        )
        return problem(answer)
    finally:
        assert client.delete(f"/v1/shots/{shot}").status_code == 204


def test_an_empty_stage(client):
    assert refused_frame(client, HEADER)["detail"]


def test_a_negative_focal_length(client):
    refusal = refused_frame(client, ROOM.replace("focalLength = 0.5", "focalLength = -0.5"))
    assert "/World/cam" in refusal["detail"] + str(refusal["path"])


NO_NUMBER = """    {
        double3 xformOp:translate = (nan, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
"""


def test_a_camera_whose_transform_is_no_number(client):
    text = ROOM.replace('    def Camera "cam"\n    {\n', f'    def Camera "cam"\n{NO_NUMBER}')
    refusal = refused_frame(client, text)
    assert "/World/cam" in refusal["detail"] + str(refusal["path"])


def test_a_mesh_whose_transform_is_no_number_is_left_out_and_named(client):
    text = ROOM.replace('    def Mesh "near"\n    {\n', f'    def Mesh "near"\n{NO_NUMBER}')
    shot = send(client, "shot.usda", text.encode()).json()["id"]
    try:
        small = {"time": 1, "width": 32, "height": 18, "rays": 1}
        assert client.get(f"/v1/shots/{shot}/frame", params=small).status_code == 200
        notes = client.get(f"/v1/shots/{shot}/inspect").json()["notes"]
        assert any("/World/near" in note["message"] for note in notes)
    finally:
        assert client.delete(f"/v1/shots/{shot}").status_code == 204


@pytest.mark.parametrize(
    "parameters",
    [
        {"camera": "/World/near"},
        {"camera": "/Nowhere"},
        {"camera": "cam"},
        {"camera": "/World/cam.focalLength"},
        {"width": 0},
        {"height": 0},
        {"width": -5},
        {"width": 1_000_000_000},
        {"width": 8192, "height": 8192},
        {"time": "nan"},
        {"time": "inf"},
        {"time": "noon"},
        {"engine": "magic"},
        {"rays": 0},
        {"rays": 10**9},
        {"noise": 0.0001},
        {"noise": 2},
        {"adaptive": "often"},
        {"layers": 0},
        {"layers": 10**6},
        {"supersample": 0.5},
        {"supersample": 99},
        {"wavelengths": 0},
        {"wavelengths": 65},
        {"shading": "dark"},
        {"seed": -1},
        {"seed": 10**12},
        {"format": "bmp"},
        {"aov": "depth"},
    ],
    ids=str,
)
def test_a_frame_that_cannot_be(client, room, parameters):
    answer = client.get(
        f"/v1/shots/{room}/frame", params={"time": 1, "width": 32, "height": 18, "rays": 1} | parameters
    )
    problem(answer)


@pytest.mark.parametrize("frames", ["", "1:1000000000", "x", "5:1x1", "1:2x0", "1:", "3,2,1", "1,1", "nan"])
def test_frames_that_cannot_be(client, room, frames):
    problem(client.get(f"/v1/shots/{room}/focus-curve", params={"frames": frames}))


@pytest.mark.parametrize(("start", "end"), [(1, 10**9), (24, 1), ("-inf", "inf")])
def test_frame_ranges_that_cannot_be(client, start, end):
    """A stage may say so; it has one frame then, or its curve is refused, and no list of all frames is ever made."""
    text = ROOM.replace("endTimeCode = 24", f"endTimeCode = {end}").replace(
        "startTimeCode = 1", f"startTimeCode = {start}"
    )
    sent = send(client, "shot.usda", text.encode())
    if sent.status_code != 201:
        problem(sent)
        return
    curve = client.get(f"/v1/shots/{sent.json()['id']}/focus-curve")
    assert curve.status_code in (200, 422)
    assert curve.status_code == 422 or len(curve.json()["samples"]) == 1
    client.delete(sent.headers["location"])


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"time": 1, "width": 32, "height": 18, "x": 99, "y": 1},
        {"time": 1, "width": 0, "height": 18, "x": 0, "y": 0},
        {"time": 1, "width": 32, "height": 18, "x": -1, "y": 0},
        {"time": 1, "width": 32, "height": 18, "x": 1, "y": 1, "camera": "/World/near"},
        {"time": 1, "width": 32, "height": 18, "x": 1, "y": 1, "zoom": 3},
        [],
        "x",
    ],
    ids=str,
)
def test_a_pick_that_cannot_be(client, room, body):
    problem(client.post(f"/v1/shots/{room}/pick", json=body))


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", b'{"time": NaN}', b'{"time": 1e999}', b"[" * 100_000])
def test_bodies_that_are_no_json(client, room, content):
    headers = {"Content-Type": "application/json"}
    problem(client.patch(f"/v1/shots/{room}/camera", content=content, headers=headers), 400, 422)


@pytest.mark.parametrize("path", ["/v1/nothing", "/v1/shots/none", "/v1/shots/..%2f..", "/v1/shots/%00/frame?time=1"])
def test_what_is_not_there(client, path):
    problem(client.get(path), 404)


@pytest.mark.parametrize(("method", "path"), [("PUT", "/v1/shots"), ("GET", "/v1/shots/x/pick"), ("DELETE", "/livez")])
def test_what_cannot_be_done(client, method, path):
    answer = client.request(method, path)
    assert problem(answer, 405)["code"] == "method_not_allowed"
    assert answer.headers["allow"]


WORDS = st.text(max_size=12) | st.integers().map(str) | st.floats().map(str)


@given(
    query=st.dictionaries(st.sampled_from(["camera", "time", "width", "rays", "seed", "format", "client", "x"]), WORDS)
)
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
def test_no_query_is_too_odd(client, room, query):
    for path in ("readout", "focus-points", "focus-curve", "cameras"):
        answer = client.get(f"/v1/shots/{room}/{path}", params=query)
        assert answer.status_code == 200 or problem(answer, 404, 422)
    if "width" in query:
        answer = client.get(f"/v1/shots/{room}/frame", params=query | {"height": "2", "rays": query.get("rays", "1")})
        assert answer.status_code == 200 or problem(answer, 404, 422)
