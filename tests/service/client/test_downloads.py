"""Frames that are fetched: whole, compared and named by the client, whatever the service sends."""

from __future__ import annotations

import asyncio
import threading

import httpx
import pytest

from service.client import AnswerError, AsyncClient, FileError, RefusedError, WaitTimeoutError
from service.client.frame_files import file_name, file_stem
from service.client.models import Render
from service.models.base import plain_file_name
from tests.service.client.fake import PICTURES, QUICK, RENDER, Fake, render_service, task


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_frames_are_fetched_once(tmp_path):
    service, told = render_service(), []
    out = tmp_path / "new" / "folder"
    with service.client() as client:
        paths = client.download("r-1", out, on_file=told.append)
        assert sorted(paths) == sorted(told) == [out / "night.0001.exr", out / "night.0002.exr"]
        assert [path.read_bytes() for path in sorted(paths)] == list(PICTURES.values())
        service.requests.clear()
        (out / "night.0002.exr").write_bytes(b"the second picturE")
        assert sorted(client.download("r-1", out)) == sorted(paths)
    assert [path for path in service.sent if "frames" in path] == ["GET /v1/renders/r-1/frames/2"]
    assert (out / "night.0002.exr").read_bytes() == PICTURES[2]
    assert names(out) == ["night.0001.exr", "night.0002.exr"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"the first picture and much more", "longer than the 17 bytes"),
        (b"the first pict", "damaged"),
        (b"the first picturE", "damaged"),
    ],
)
def test_a_frame_that_is_not_whole_is_not_kept(tmp_path, content, message):
    (tmp_path / "night.0001.exr").write_bytes(b"an older picture")
    service = render_service(pictures=PICTURES | {1: content})
    with service.client() as client, pytest.raises(AnswerError, match=message):
        client.download("r-1", tmp_path, at_once=1)
    assert set(names(tmp_path)) <= {"night.0001.exr", "night.0002.exr"}
    assert (tmp_path / "night.0001.exr").read_bytes() == b"an older picture"


def test_a_body_without_an_end_is_given_up(tmp_path):
    sent = []

    class Endless(httpx.SyncByteStream):
        def __iter__(self):
            while True:
                sent.append(1 << 20)
                yield bytes(1 << 20)

    def reply(request):
        if "/frames/" in request.url.path:
            return httpx.Response(200, headers={"Content-Type": "image/png"}, stream=Endless())
        return render_service().reply(request)

    with Fake(reply).client() as client, pytest.raises(AnswerError, match="longer"):
        client.download("r-1", tmp_path, at_once=1)
    assert len(sent) < 5
    assert names(tmp_path) == []


def test_a_broken_connection_begins_the_frame_anew(tmp_path):
    whole, tries = render_service(), []

    class Broken(httpx.SyncByteStream):
        def __iter__(self):
            yield PICTURES[1][:5]
            raise httpx.ReadError("the connection broke")

    def reply(request):
        answer = whole.reply(request)
        if request.url.path.endswith("/frames/1") and not tries:
            tries.append(request)
            return httpx.Response(200, headers=answer.headers, stream=Broken())
        return answer

    with Fake(reply).client() as client:
        client.download("r-1", tmp_path)
    assert (tmp_path / "night.0001.exr").read_bytes() == PICTURES[1]
    assert names(tmp_path) == ["night.0001.exr", "night.0002.exr"]


@pytest.mark.parametrize(
    "name", ["../../etc/passwd", "..", "a\\..\\b", "/abs", ".hidden", "a\0b", "x\n", "", "ü é", "*" * 200, "x" * 200]
)
def test_files_are_named_as_the_service_names_them(name):
    with render_service(render={"name": name}).client() as client:
        render = client.get("r-1")
    assert file_stem(render) == (plain_file_name(name) or "render")
    assert "/" not in file_name(render, 7, "exr")
    assert file_name(render, 7, "exr").endswith(".0007.exr")


def test_a_long_name_fits_a_file_system():
    render = Render(**dict.fromkeys(Render.__dataclass_fields__) | {"name": "雪" * 120})
    assert len(file_name(render, 10**6, "jpeg").encode()) < 255


def test_no_file_leaves_the_folder(tmp_path):
    out = tmp_path / "out"
    with render_service(render={"name": "../../escaped"}, type="image/x-exr; x=../..").client() as client:
        client.download("r-1", out)
    assert names(tmp_path) == ["out"]
    assert names(out) == ["escaped.0001.exr", "escaped.0002.exr"]


def test_what_is_no_picture_is_refused(tmp_path):
    with render_service(type="text/html").client() as client, pytest.raises(AnswerError, match="text/html"):
        client.download("r-1", tmp_path, at_once=1)
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ({"files": []}, "no file"),
        ({"file": {"format": "../../evil"}}, "unknown format"),
        ({"file": {"format": "png"}}, "png"),
    ],
)
def test_a_stored_frame_is_told_with_its_files(tmp_path, told, expected):
    service = render_service(tasks=[task(1, PICTURES[1], **told)])
    with service.client() as client, pytest.raises(AnswerError, match=expected):
        client.download("r-1", tmp_path)
    assert names(tmp_path) == []


def test_frames_that_are_not_stored_are_left_out(tmp_path):
    tasks = [task(1, PICTURES[1]), task(2, b"", state="failed", files=[])]
    with render_service(render={"state": "failed", "done": 1, "failed": 1}, tasks=tasks).client() as client:
        assert client.download("r-1", tmp_path) == [tmp_path / "night.0001.exr"]


def test_a_folder_that_takes_no_files_is_one_error(tmp_path):
    (tmp_path / "out").write_text("a file")
    with render_service().client() as client, pytest.raises(FileError, match="out"):
        client.download("r-1", tmp_path / "out")


def test_a_frame_that_fails_gives_the_others_up(tmp_path):
    frames = range(1, 200)
    whole = render_service(
        render={"count": 199, "done": 199},
        tasks=[task(frame, b"x") for frame in frames],
        pictures=dict.fromkeys(frames, b"x"),
    )

    def reply(request):
        if request.url.path.endswith("/frames/3"):
            return httpx.Response(404, json={"code": "frame_file_gone", "detail": "Frame 3 is gone."})
        return whole.reply(request)

    service = Fake(reply)
    with service.client() as client, pytest.raises(RefusedError, match="Frame 3 is gone"):
        client.download("r-1", tmp_path, at_once=2)
    assert not list(tmp_path.glob(".*"))


def test_downloads_at_once_are_bounded(tmp_path):
    frames = range(1, 30)
    whole = render_service(
        render={"count": 29, "done": 29},
        tasks=[task(frame, b"x") for frame in frames],
        pictures=dict.fromkeys(frames, b"x"),
    )
    lock, present, most = threading.Lock(), [0], [0]

    def reply(request):
        with lock:
            present[0] += 1
            most[0] = max(most[0], present[0])
        answer = whole.reply(request)
        with lock:
            present[0] -= 1
        return answer

    with Fake(reply).client() as client:
        assert len(client.download("r-1", tmp_path, at_once=3)) == 29
    assert 1 <= most[0] <= 3


def growing(*states: dict) -> Fake:
    """A service whose render is in some states in turn; the last one stays."""
    waiting = [RENDER | state for state in states]

    def reply(request):
        if request.url.path == "/v1/renders/r-1":
            return httpx.Response(200, json=waiting.pop(0) if len(waiting) > 1 else waiting[0])
        done = waiting[0]["done"]
        frames = [task(frame, content) for frame, content in list(PICTURES.items())[:done]]
        return render_service(tasks=frames).reply(request)

    return Fake(reply)


STATES = (
    {"state": "queued", "done": 0, "ready": 2},
    {"state": "running", "done": 1, "ready": 1},
    {"state": "running", "done": 1, "ready": 1},
    {"state": "done", "done": 2},
)


@pytest.fixture
def no_pauses(monkeypatch):
    """Pauses that a client would have made, s."""
    made = []
    monkeypatch.setattr("service.client.sync_client._pause", lambda seconds, stop: made.append(seconds))
    return made


def test_waiting_tells_every_change_once(no_pauses):
    told = []
    with growing(*STATES).client() as client:
        render = client.wait("r-1", on_progress=told.append)
    assert [(now.state, now.done) for now in told] == [("queued", 0), ("running", 1), ("done", 2)]
    assert render == told[-1]
    assert len(no_pauses) == 3


def test_looks_grow_rarer_up_to_a_few_seconds(no_pauses):
    queued = STATES[0]
    with growing(*[queued] * 12, STATES[3]).client() as client:
        client.wait("r-1")
    assert no_pauses == sorted(no_pauses)
    assert (no_pauses[0], no_pauses[-1]) == (0.25, 3.0)


def test_waiting_ends_after_its_time(no_pauses):
    with growing(STATES[0]).client() as client, pytest.raises(WaitTimeoutError, match="r-1 is queued after 0 s"):
        client.wait("r-1", timeout_s=0)


def test_a_service_that_restarts_is_waited_for(no_pauses):
    whole, answers = growing(*STATES), []

    def reply(request):
        answers.append(request)
        if 2 <= len(answers) < 20:
            raise httpx.ConnectError("nobody listens")
        return whole.reply(request)

    with Fake(reply).client() as client:
        assert client.wait("r-1").state == "done"


def test_frames_are_fetched_as_they_are_done(tmp_path, no_pauses):
    counts = []
    service = growing(*STATES)
    with service.client() as client:
        client.download("r-1", tmp_path, follow=True, on_progress=lambda now: counts.append(len(names(tmp_path))))
    assert counts == [0, 0, 1]
    assert names(tmp_path) == ["night.0001.exr", "night.0002.exr"]
    assert len([path for path in service.sent if "/frames/" in path]) == 2


def test_an_event_loop_does_the_same(tmp_path, monkeypatch):
    async def no_pause(seconds):
        pass

    async def go():
        service = httpx.MockTransport(growing(*STATES))
        async with AsyncClient("http://service", retries=QUICK, transport=service) as client:
            paths = await client.download("r-1", tmp_path, follow=True, at_once=2)
            assert (await client.wait("r-1")).state == "done"
            return paths

    monkeypatch.setattr("service.client.async_client.asyncio.sleep", no_pause)
    assert [path.name for path in asyncio.run(go())] == ["night.0001.exr", "night.0002.exr"]
    assert [(tmp_path / name).read_bytes() for name in names(tmp_path)] == list(PICTURES.values())


def test_an_event_loop_leaves_no_half_file(tmp_path):
    async def go():
        service = httpx.MockTransport(render_service(pictures=PICTURES | {2: b"the second picturE"}))
        async with AsyncClient("http://service", retries=QUICK, transport=service) as client:
            await client.download("r-1", tmp_path)

    with pytest.raises(AnswerError, match="frame 2 is damaged"):
        asyncio.run(go())
    assert set(names(tmp_path)) <= {"night.0001.exr"}
