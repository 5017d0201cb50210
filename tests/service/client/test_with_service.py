"""Both clients against a real service: a shot is pushed, rendered, watched, fetched and removed."""

from __future__ import annotations

import asyncio
import json

import av
import pytest

from service.client import AsyncClient, Client, RefusedError, SettingError, sync_client
from service.http.settings import Settings
from tests.service.conftest import hold_back, running

pytestmark = pytest.mark.gl

SMALL = {"width": 64, "rays": 4, "engine": "pinhole"}


def test_a_shot_goes_all_the_way(service, room_file, tmp_path):
    progress = []
    with Client(str(service.client.base_url)) as client:
        shot = client.push(room_file.parent, name="stage")
        assert (shot.name, shot.root, shot.cameras) == ("stage.zip", "room.usda", ["/World/cam"])
        assert shot.id in [each.id for each in client.shots()]
        assert client.shot(shot.id).frame_range == shot.frame_range
        plan = client.plan(shot, frames="1-2", **SMALL)
        assert (plan.frames, plan.count) == ("1-2", 2)
        render = client.render(shot, frames="1-2", name="dailies", formats=["png"], **SMALL)
        paths = client.download(render, tmp_path, follow=True, on_progress=progress.append)
        assert sorted(path.name for path in paths) == ["dailies.0001.png", "dailies.0002.png"]
        assert (progress[-1].state, progress[-1].done) == ("done", 2)
        fetched = service.client.get(f"/v1/renders/{render.id}/frames/2").content
        assert (tmp_path / "dailies.0002.png").read_bytes() == fetched
        assert client.log(render, 2, tail=1).startswith(client.log(render, 2, attempt=1).splitlines()[-1])
        assert render.id in [each.id for each in client.renders()]
        assert client.wait(render.id).state == "done"
        with av.open(str(client.movie(render, tmp_path / "dailies.mp4"))) as movie:
            assert sum(1 for _ in movie.decode(video=0)) == 2
        assert client.contact_sheet(render, tmp_path / "sheet.png").read_bytes().startswith(b"\x89PNG")
        report = json.loads(client.focus_report(render, tmp_path / "focus.json", frames="2").read_text())
        assert (report["render"], [sample["frame"] for sample in report["samples"]]) == (render.id, [2])
        assert client.focus_report(render, tmp_path / "focus.html").read_text().startswith("<!doctype html>")
        with pytest.raises(SettingError, match=r"\.mp4"):
            client.movie(render, tmp_path / "dailies.gif")
        with pytest.raises(SettingError, match=r"\.csv, \.json, \.html"):
            client.focus_report(render, tmp_path / "focus.xls")
        with pytest.raises(RefusedError) as refused:
            client.pause(render)
        assert refused.value.status == 409
        client.remove(render)
        client.delete(shot)
        with pytest.raises(RefusedError) as refused:
            client.get(render)
        assert refused.value.code == "render_not_found"


def test_an_event_loop_goes_all_the_way(service, room, tmp_path):
    async def go():
        async with AsyncClient(str(service.client.base_url)) as client:
            render = await client.render(room, frames="1-2", idempotency_key="loop", **SMALL)
            again = await client.render(room, frames="1-2", idempotency_key="loop", **SMALL)
            assert again.id == render.id
            paths = await client.download(render, tmp_path, follow=True)
            tasks = await client.tasks(render)
            texts: list[str] = []
            await client.follow_log(render, 1, texts.append)
            assert texts == [await client.log(render, 1)]
            report = await client.focus_report(render, tmp_path / "report" / "focus.csv")
            assert report.read_text().count("\n") == 3
            await client.remove(render)
            return sorted(path.name for path in paths), [task.attempts[0].outcome for task in tasks]

    assert asyncio.run(go()) == (["room.usda.0001.exr", "room.usda.0002.exr"], ["done", "done"])


def test_a_log_is_followed_from_before_its_frame_is_begun(service, room, monkeypatch):
    queue, texts = service.internal.renders, []
    claim, read = queue.claim, queue.logs.read
    hold_back(queue, monkeypatch)
    with Client(str(service.client.base_url)) as client:
        render = client.render(room, frames="1-2", **SMALL)
        steps = iter(
            [None, lambda held: queue.logs.append(held, "one\n"), lambda held: queue.fail(held, "no", may_pass=False)]
        )
        held = []

        def read_next(*arguments):
            step = next(steps, None)
            if step is not None:
                held[:] = held or [claim("one", 60.0)]
                step(held[0])
            return read(*arguments)

        monkeypatch.setattr(queue.logs, "read", read_next)
        monkeypatch.setattr("service.client.operations._LOG_LOOK_S", 0.0)
        client.follow_log(render, 1, texts.append)
        assert texts[0] == "one\n"
        assert texts[1].endswith("failed: no\n")
        client.cancel(render)
        with pytest.raises(RefusedError) as refused:
            client.follow_log(render, 2, texts.append)
        assert refused.value.code == "frame_given_up"


def test_a_render_is_waited_for_by_its_events(service, room, monkeypatch):
    pauses, streams = [], []
    pause = sync_client._pause
    monkeypatch.setattr(sync_client, "_pause", lambda seconds, stop: (pauses.append(seconds), pause(seconds, stop)))
    monkeypatch.setattr("service.client.operations.LISTEN_S", 300.0)  # no look comes by itself

    def note(response):
        if response.url.path == "/v1/events":
            streams.append((response.status_code, "after" in response.url.params))

    def resume(now):
        if now.state == "paused":
            client.resume(now)

    with Client(str(service.client.base_url)) as client:
        client._http.event_hooks = {"response": [note]}
        render = client.render(room, frames="1-24", **SMALL)
        client.pause(render)
        assert client.wait(render, on_progress=resume).state == "done"
        client.remove(render)
    assert streams[0] == (200, False)
    assert streams[1:] == [(200, True)] * len(streams[1:])
    assert len(streams) > 1
    assert max(pauses, default=0) <= 0.25, "nothing was looked at without an event"


def test_a_render_is_listed_over_several_pages_and_canceled(service, room, monkeypatch):
    monkeypatch.setattr("service.client.operations.MOST_LISTED", 2)
    with Client(str(service.client.base_url)) as client:
        sent = [client.render(room, frames="1-24", **SMALL) for _ in range(5)]
        for render in sent:
            client.cancel(render)
        assert [render.id for render in client.renders(most=5)] == [render.id for render in reversed(sent)]
        assert len(client.renders(most=3)) == 3
        for render in sent:
            client.wait(render)


def test_a_key_is_needed_where_the_service_asks_for_one(tmp_path):
    with running(Settings(data=tmp_path, demo=False, access="keys")) as service:
        url = str(service.client.base_url)
        key = service.app.state.identity.keys.create("Mara", {"read"}, "default")[1]
        with Client(url, key) as client:
            assert client.shots() == []
        with Client(url) as client, pytest.raises(RefusedError) as refused:
            client.shots()
        assert refused.value.status == 401
