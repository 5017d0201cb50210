"""Renders over REST: sent, watched, paused, canceled, fetched, and finished after a restart."""

from __future__ import annotations

import hashlib
import io
import json
import re

import httpx
import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image

from render.errors import OutputError
from service.http.errors import ServiceError
from service.http.routes.renders import _digest
from service.http.settings import Settings
from service.models.renders import RenderRequest
from service.storage.database.connection import transaction
from service.storage.database.tables import TaskRow
from tests.service.conftest import Running, running, send, until
from tests.service.kits.renders import SMALL, ended, render_of, watched

pytestmark = pytest.mark.gl


def wait_for_turns(service: Running) -> None:
    """Wait until the service has looked for frames twice from now on."""
    queue, looks = service.internal.renders, []
    claim = queue.claim

    def counted(*arguments):
        looks.append(arguments)
        return claim(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(queue, "claim", counted)
        until(lambda: len(looks) > 2)  # the first one may have begun before


def test_frames_are_drawn_and_fetched(client, room, tmp_path):
    render = render_of(client, room, frames="1-3", name="dailies/x")
    assert (render["count"], render["frames"], render["shot"]) == (3, "1-3", room)
    done = ended(client, render)
    assert (done["state"], done["done"], done["secondsLeft"]) == ("done", 3, None)
    assert re.search(r'pullfocus_render_frames{state="done"} [1-9]', client.get("/metrics").text)
    tasks = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
    assert [(task["frame"], task["state"], len(task["attempts"])) for task in tasks] == [
        (frame, "done", 1) for frame in (1, 2, 3)
    ]
    answer = client.get(f"/v1/renders/{render['id']}/frames/2")
    assert answer.headers["content-type"] == "image/x-exr"
    assert 'filename="x.0002.exr"' in answer.headers["content-disposition"]
    assert answer.headers["etag"] == f'"{tasks[1]["files"][0]["sha256"]}"'
    direct = client.get(f"/v1/shots/{room}/frame", params=SMALL | {"time": 2, "format": "exr"})
    pixels = []
    for name, content in (("render.exr", answer.content), ("frame.exr", direct.content)):
        (tmp_path / name).write_bytes(content)
        pixels.append(oiio.ImageBuf(str(tmp_path / name)).get_pixels())
    np.testing.assert_array_equal(*pixels)


def test_all_formats_of_a_frame_are_of_one_drawing(service, client, room):
    render = render_of(client, room, frames="1-2", formats=["exr", "png", "jpeg"])
    assert render["formats"] == ["exr", "png", "jpeg"]
    assert ended(client, render)["state"] == "done"
    address = f"/v1/renders/{render['id']}"
    tasks = client.get(f"{address}/tasks").json()["tasks"]
    stored = service.settings.data / "renders" / render["id"]
    for task in tasks:
        assert [len(task["attempts"]), [file["format"] for file in task["files"]]] == [1, ["exr", "png", "jpeg"]]
        for file in task["files"]:
            query = {"format": file["format"]}
            answer = client.get(f"{address}/frames/{task['frame']}", params=query)
            direct = client.get(f"/v1/shots/{room}/frame", params=SMALL | query | {"time": task["frame"]})
            assert answer.headers["content-type"] == direct.headers["content-type"]
            assert hashlib.sha256(answer.content).hexdigest() == file["sha256"]
            if file["format"] != "exr":  # an EXR's header has the frame as a whole number
                assert answer.content == direct.content
            assert len(answer.content) == file["sizeBytes"]
            assert (stored / f"{task['frame']}.1.{file['format']}").read_bytes() == answer.content
    first = client.get(f"{address}/frames/1")
    assert (first.headers["content-type"], len(list(stored.iterdir()))) == ("image/x-exr", 8)  # two are small


def test_small_pictures_show_frames_of_any_format(client, room):
    render = render_of(client, room, frames="1-2", width=480, height=270)
    address = f"/v1/renders/{render['id']}"
    early = client.get(f"{address}/frames/2/thumbnail")
    assert early.status_code in (200, 409)
    ended(client, render)
    small, last = client.get(f"{address}/frames/2/thumbnail"), client.get(f"{address}/thumbnail")
    assert small.headers["content-type"] == "image/jpeg"
    assert (small.content, small.headers["etag"]) == (last.content, last.headers["etag"])
    graded = client.get(f"/v1/shots/{room}/frame", params=SMALL | {"time": 2, "width": 480, "height": 270})
    pixels = [np.asarray(Image.open(io.BytesIO(answer.content)), float) for answer in (small, graded)]
    assert pixels[0].shape == (135, 240, 3)
    np.testing.assert_allclose(pixels[0].mean((0, 1)), pixels[1].mean((0, 1)), atol=2)
    assert client.get(f"{address}/frames/3/thumbnail").status_code == 404


def test_frames_of_an_earlier_version_have_no_small_picture(service, client, room):
    render = render_of(client, room, frames="1")
    ended(client, render)
    queue = service.internal.renders
    with transaction(queue._engine) as session:
        task = session.get_one(TaskRow, (render["id"], 1))
        task.files = {name: entry for name, entry in task.files.items() if name != "thumbnail"}
    answer = client.get(f"/v1/renders/{render['id']}/thumbnail")
    assert (answer.status_code, answer.json()["code"]) == (404, "no_thumbnail")


def test_a_request_has_the_digest_of_earlier_versions():
    request = RenderRequest(shot="demo", frames="1-2")
    later = ("after", "aovs", "burn_in", "lens", "products")
    told = {name: value for name, value in request.model_dump(mode="json").items() if name not in later}
    assert _digest(request) == hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()
    assert _digest(request) != _digest(RenderRequest(shot="demo", frames="1-2", after=["r-1"]))


def test_a_render_without_a_frame_has_no_picture(client, room):
    render = render_of(client, room, frames="1", camera="/World/none")
    assert ended(client, render)["state"] == "failed"
    answer = client.get(f"/v1/renders/{render['id']}/thumbnail")
    assert (answer.status_code, answer.json()["code"]) == (404, "frame_not_found")


def test_a_render_waits_until_another_is_done_or_accepted(client, room):
    first = render_of(client, room, frames="1-2", camera="/World/none")
    second = render_of(client, room, frames="1", after=[first["id"]])
    assert second["waitsFor"] == [first["id"]]
    assert ended(client, first)["state"] == "failed"
    listed = {each["id"]: each["waitsFor"] for each in client.get("/v1/renders").json()["renders"]}
    assert (listed[second["id"]], listed[first["id"]]) == ([first["id"]], [])
    assert client.get(f"/v1/renders/{second['id']}").json()["state"] == "queued"
    accepted = client.post(f"/v1/renders/{first['id']}/accept").json()
    assert (accepted["state"], accepted["failed"], accepted["accepted"]) == ("done", 2, True)
    assert ended(client, second)["state"] == "done"
    again = client.post(f"/v1/renders/{first['id']}/accept")
    assert (again.status_code, again.json()["code"]) == (409, "render_conflict")


@pytest.mark.parametrize("after", [["r-000000000000"], ["\0"], ["r-1"] * 17, "r-1"])
def test_a_render_that_waits_for_none_that_is_there_is_refused(client, room, after):
    answer = client.post("/v1/renders", json=SMALL | {"shot": room, "frames": "1", "after": after})
    assert answer.status_code in (404, 422)


def test_a_format_that_was_not_rendered_is_told(client, room):
    render = render_of(client, room, frames="1", formats=["png"])
    ended(client, render)
    answer = client.get(f"/v1/renders/{render['id']}/frames/1", params={"format": "exr"})
    assert (answer.status_code, answer.json()["code"]) == (404, "format_not_rendered")
    assert "it has png" in answer.json()["detail"]


def test_a_lost_file_of_any_format_is_drawn_again(service, client, room):
    render = render_of(client, room, frames="1-2", formats=["exr", "png"])
    ended(client, render)
    address, folder = f"/v1/renders/{render['id']}", service.settings.data / "renders" / render["id"]
    before = service.internal.renders.get(render["id"]).stored_bytes
    (folder / "2.1.png").unlink()
    assert client.get(f"{address}/frames/2").status_code == 200
    answer = client.get(f"{address}/frames/2", params={"format": "png"})
    assert (answer.status_code, answer.json()["code"]) == (404, "frame_file_gone")
    assert client.post(f"{address}/retry").json()["ready"] == 1
    assert ended(client, render)["done"] == 2
    assert client.get(f"{address}/frames/2", params={"format": "png"}).status_code == 200
    # The files of the first attempt are gone: nothing is stored that is not counted.
    files = [path for path in folder.iterdir() if path.suffix != ".thumbnail"]
    assert sorted(path.name for path in files) == ["1.1.exr", "1.1.png", "2.2.exr", "2.2.png"]
    stored = sum(path.stat().st_size for path in files)
    now = service.internal.renders.get(render["id"]).stored_bytes
    assert now == before + len(client.get(f"{address}/frames/2/log").content)
    assert stored == sum(
        file["sizeBytes"] for task in client.get(f"{address}/tasks").json()["tasks"] for file in task["files"]
    )


def test_a_render_keeps_the_edits_that_it_was_sent_with(client, room):
    plain = client.get(f"/v1/shots/{room}/frame", params=SMALL | {"time": 24}).content
    before = render_of(client, room, formats=["png"])
    client.post(f"/v1/renders/{before['id']}/pause")
    watched(client, before, lambda now: now["state"] == "paused")
    assert client.patch(f"/v1/shots/{room}/camera/exposure", json={"compensationStops": 3}).status_code == 200
    client.post(f"/v1/renders/{before['id']}/resume")
    later = render_of(client, room, frames="24", formats=["png"])
    assert later["revision"] != before["revision"]
    assert [ended(client, render)["state"] for render in (before, later)] == ["done", "done"]
    bright = client.get(f"/v1/renders/{later['id']}/frames/24").content
    assert client.get(f"/v1/renders/{before['id']}/frames/24").content == plain != bright


@pytest.mark.parametrize(
    ("request_", "status", "code"),
    [
        ({"frames": "1-"}, 422, "bad_setting"),
        ({"frames": "1,1"}, 422, "bad_setting"),
        ({"shot": "no-such-shot"}, 404, "shot_not_found"),
        ({"width": 8192, "height": 8192}, 422, "too_many_pixels"),
        ({"rays": 10**9}, 422, "too_costly"),
        ({"formats": ["tiff"]}, 422, "invalid_request"),
        ({"formats": []}, 422, "invalid_request"),
        ({"formats": ["png", "png"]}, 422, "invalid_request"),
        ({"format": "png"}, 422, "invalid_request"),
        ({"time": 1}, 422, "invalid_request"),
    ],
)
def test_what_cannot_be_rendered_is_refused(client, room, request_, status, code):
    answer = client.post("/v1/renders", json=SMALL | {"shot": room} | request_)
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_a_key_makes_sending_again_safe(client, room):
    wanted = SMALL | {"shot": room, "frames": "1"}
    first, again = (client.post("/v1/renders", json=wanted, headers={"Idempotency-Key": "k"}) for _ in range(2))
    assert first.json()["id"] == again.json()["id"]
    other = client.post("/v1/renders", json=wanted | {"frames": "2"}, headers={"Idempotency-Key": "k"})
    assert (other.status_code, other.json()["code"]) == (409, "idempotency_key_reused")


def test_a_frame_that_fails_says_why_and_is_tried_again(client, room):
    render = render_of(client, room, frames="1", camera="/World/none")
    failed = ended(client, render)
    assert (failed["state"], failed["failed"]) == ("failed", 1)
    (task,) = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
    assert [(attempt["outcome"], "/World/none" in attempt["error"]) for attempt in task["attempts"]] == [
        ("failed", True)
    ]
    answer = client.get(f"/v1/renders/{render['id']}/frames/1")
    assert (answer.status_code, answer.json()["code"]) == (409, "frame_not_done")
    assert client.post(f"/v1/renders/{render['id']}/retry").json()["ready"] == 1
    assert ended(client, render)["failed"] == 1


def test_a_render_is_paused_resumed_canceled_and_removed(service, client, room):
    render = render_of(client, room)
    address = f"/v1/renders/{render['id']}"
    assert client.post(f"{address}/pause").json()["state"] in ("paused", "pause-requested")
    paused = watched(client, render, lambda now: now["state"] == "paused")
    assert client.delete(address).status_code == 409
    wait_for_turns(service)
    assert client.get(address).json() == paused
    client.post(f"{address}/resume")
    watched(client, render, lambda now: now["done"] > paused["done"])
    client.post(f"{address}/cancel")
    canceled = ended(client, render)
    assert canceled["done"] + canceled["canceled"] == 24
    assert canceled["state"] == ("canceled" if canceled["canceled"] else "done")
    files = service.settings.data / "renders" / render["id"]
    assert len(list(files.glob("*.exr"))) == canceled["done"]
    assert client.delete(address).status_code == 204
    assert not files.exists()
    assert client.get(address).json()["code"] == "render_not_found"


def test_a_restart_goes_on_where_it_was(tmp_path, room_file):
    settings = Settings(data=tmp_path, demo=False)
    with running(settings) as before:
        shot = send(before.client, "room.usda", room_file.read_bytes()).json()["id"]
        render = render_of(before.client, shot, frames="1-8")
        watched(before.client, render, lambda now: now["done"] > 1)
    with running(settings) as after:
        done = ended(after.client, render)
        assert (done["state"], done["done"]) == ("done", 8)
        tasks = after.client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
        outcomes = {attempt["outcome"] for task in tasks for attempt in task["attempts"]}
        assert outcomes <= {"done", "given-back"}


def test_a_deleted_shot_ends_its_renders_with_a_word(client, room):
    render = render_of(client, room, frames="1-24")
    client.delete(f"/v1/shots/{room}")
    failed = ended(client, render)
    assert failed["state"] == "failed"
    tasks = client.get(f"/v1/renders/{render['id']}/tasks").json()["tasks"]
    assert room in tasks[-1]["attempts"][-1]["error"]


def test_a_lost_file_is_told_and_drawn_again(service, client, room):
    render = render_of(client, room, frames="1-2")
    ended(client, render)
    first, second = sorted((service.settings.data / "renders" / render["id"]).glob("*.exr"))
    first.unlink()
    second.write_bytes(b"junk")
    answers = [client.get(f"/v1/renders/{render['id']}/frames/{frame}") for frame in (1, 2)]
    assert [answer.json()["code"] for answer in answers] == ["frame_file_gone"] * 2
    assert client.post(f"/v1/renders/{render['id']}/retry").json()["ready"] == 2
    assert ended(client, render)["done"] == 2
    assert client.get(f"/v1/renders/{render['id']}/frames/2").status_code == 200


def test_errors_name_no_folder_of_the_service(service, client, room, monkeypatch):
    data = service.settings.data

    def refuse(*_):
        raise OutputError(f"cannot write {data}/renders/1.png: the disk is full")

    monkeypatch.setattr(service.internal.render_files, "write", refuse)
    render = render_of(client, room, frames="1")
    address = f"/v1/renders/{render['id']}/tasks"
    until(lambda: client.get(address).json()["tasks"][0]["attempts"][0:1] and told(client, address))
    assert "the disk is full" in told(client, address)
    assert str(data) not in told(client, address)
    client.post(f"/v1/renders/{render['id']}/cancel")


def told(client: httpx.Client, address: str) -> str | None:
    """The error of the first attempt."""
    return client.get(address).json()["tasks"][0]["attempts"][0]["error"]


def test_a_queue_that_cannot_be_written_ends_nothing_else(service, client, room, monkeypatch):
    def fail(claim, error, *, may_pass):
        raise OutputError("the queue of renders cannot be used now: database or disk is full")

    with monkeypatch.context() as patch:
        patch.setattr(service.internal.renders, "fail", fail)
        stuck = render_of(client, room, frames="1", camera="/World/none")
        watched(client, stuck, lambda now: now["running"] == 1)
        assert ended(client, render_of(client, room, frames="1"))["state"] == "done"
    client.post(f"/v1/renders/{stuck['id']}/cancel")


def test_a_shot_in_quarantine_fails_its_renders(service, client, room, monkeypatch):
    def refuse(record):
        raise ServiceError(423, "quarantined", "The shot is in quarantine.")

    monkeypatch.setattr(service.internal.quarantine, "check", refuse)
    assert ended(client, render_of(client, room, frames="1-24"))["failed"] == 24


def test_a_render_waits_for_its_owners_processor_time(service, client, room, monkeypatch):
    checked = []

    def refuse(sender=None):
        checked.append(sender)
        if sender is not None:
            raise ServiceError(429, "quota_cpu", "You have used up your time.")

    monkeypatch.setattr(service.internal.quotas, "check_work", refuse)
    render = render_of(client, room, frames="1-24")
    until(lambda: any(checked))
    wait_for_turns(service)
    waiting = client.get(f"/v1/renders/{render['id']}").json()
    assert (waiting["ready"], waiting["running"]) == (24, 0)
    assert len([sender for sender in checked if sender]) == 1
    client.post(f"/v1/renders/{render['id']}/cancel")


def test_renders_are_seen_in_their_project_alone(tmp_path, room_file):
    with running(Settings(data=tmp_path, demo=False, access="keys")) as service:
        keys = service.app.state.identity.keys
        headers = [
            {"Authorization": f"Bearer {keys.create(project, scopes, project)[1]}"}
            for project, scopes in (
                ("one", {"read", "edit", "render"}),
                ("two", {"read", "edit", "render"}),
                ("one", {"read"}),
            )
        ]
        file = {"file": ("room.usda", room_file.read_bytes())}
        shot = service.client.post("/v1/shots", files=file, headers=headers[0]).json()["id"]
        wanted = SMALL | {"shot": shot, "frames": "1"}
        render = service.client.post("/v1/renders", json=wanted, headers=headers[0]).json()
        address = f"/v1/renders/{render['id']}"
        assert [service.client.get(address, headers=each).status_code for each in headers] == [200, 404, 200]
        for path in ("log", "log/stream"):
            answer = service.client.get(f"{address}/frames/1/{path}", headers=headers[1])
            assert (answer.status_code, answer.json()["code"]) == (404, "render_not_found")
        listed = [service.client.get("/v1/renders", headers=each).json()["renders"] for each in headers]
        assert [len(renders) for renders in listed] == [1, 0, 1]
        assert service.client.post("/v1/renders", json=wanted, headers=headers[1]).status_code == 404
        assert service.client.post("/v1/renders", json=wanted, headers=headers[2]).status_code == 403
        assert service.client.post(f"{address}/cancel", headers=headers[2]).status_code == 403
