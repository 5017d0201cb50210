"""Frames over HTTP: the command line's pixels, entity tags, and a picture process that may die."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from render.cli.main import main
from render.engines import engine_names
from render.model.frame_settings import SHADINGS
from service.http.routes.frames import MEDIA_TYPES, FrameQuery
from service.models import base
from tests.service.conftest import until

SMALL = {"time": 1, "width": 96, "height": 54, "rays": 8}


def frame(http, shot, **parameters):
    return http.get(f"/v1/shots/{shot}/frame", params=SMALL | parameters)


def pixels(answer) -> np.ndarray:
    assert answer.status_code == 200, answer.text
    return np.asarray(Image.open(BytesIO(answer.content)), np.int16)


@pytest.mark.parametrize(("file_format", "suffix"), [("png", ".png"), ("jpeg", ".jpg"), ("exr", ".exr")])
def test_rest_and_the_command_line_give_the_same_bytes(client, room, room_file, tmp_path, file_format, suffix):
    out = tmp_path / f"out{suffix}"
    arguments = ["record", str(room_file), str(out), "--frames", "12", "--imageWidth", "96", "--rays", "40"]
    assert main([*arguments, "--supersample", "1", "--seed", "3", "--no-connections", "--noise", "0.05"]) == 0
    parameters = {"time": 12, "width": 96, "rays": 40, "supersample": 1, "seed": 3, "format": file_format}
    parameters |= {"connections": False, "noise": 0.05}
    answer = client.get(f"/v1/shots/{room}/frame", params=parameters)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == MEDIA_TYPES[file_format]
    assert answer.content == out.read_bytes()


@pytest.mark.parametrize("finish", [{}, {"film": "vision3_500t_5219"}, {"display": "Display P3 - Display"}])
def test_a_live_picture_is_the_files_but_for_a_level(client, room, finish):
    file, live = (pixels(frame(client, room, live=live, **finish)) for live in (False, True))
    assert np.abs(file - live).max() <= 1
    assert np.ptp(file) > 50


def test_live_light_is_light(client, room):
    file, live = (frame(client, room, live=live, format="exr").content for live in (False, True))
    assert file == live


def test_rest_edits_render_the_same_by_the_command_line(client, room, room_file, tmp_path):
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 1, "focusDistanceM": 8})
    edits = tmp_path / "edits.usda"
    edits.write_text(client.get(f"/v1/shots/{room}/edits").text)
    out = tmp_path / "out.png"
    arguments = ["record", str(room_file), str(out), "--edits", str(edits), "--imageWidth", "96", "--rays", "8"]
    assert main(arguments) == 0
    answer = client.get(f"/v1/shots/{room}/frame", params={"time": 1, "width": 96, "rays": 8})
    assert answer.content == out.read_bytes()


def test_an_edit_is_seen_in_the_next_frame(client, room):
    first = frame(client, room)
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 1, "focusDistanceM": 8})
    second = frame(client, room)
    assert first.headers["etag"] != second.headers["etag"]
    changed = np.abs(pixels(first) - pixels(second)).max(axis=2)
    near_edge = changed[:, 2:10]  # the left edge of the near card, sharp before and soft now
    assert near_edge.max() > 20


def test_a_tag_names_the_pixels(client, room):
    answer = frame(client, room)
    tag = answer.headers["etag"]
    for header in (tag, f'"other", W/{tag}', "*"):
        again = client.get(f"/v1/shots/{room}/frame", params=SMALL, headers={"If-None-Match": header})
        assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
    other = client.get(f"/v1/shots/{room}/frame", params=SMALL, headers={"If-None-Match": '"other"'})
    assert (other.status_code, other.content) == (200, answer.content)
    small = ({"time": 2}, {"width": 97}, {"rays": 9}, {"seed": 1}, {"wavelengths": 5})
    for change in (*small, {"format": "jpeg"}, {"engine": "pinhole"}):
        assert frame(client, room, **change).headers["etag"] != tag


def test_a_frame_that_was_rendered_is_not_rendered_again(service, client, room):
    def rendered() -> float:
        return service.internal.metrics.frames.labels("rendered")._value.get()

    before = rendered()
    first, second = frame(client, room, seed=5), frame(client, room, seed=5, client="someone")
    assert first.content == second.content
    assert rendered() == before + 1


@pytest.mark.parametrize(
    ("killer", "refusal"), [(signal.SIGKILL, (503, "worker_died")), (signal.SIGSEGV, (422, "unfit"))]
)
def test_a_dead_picture_process_costs_at_most_one_frame(service, client, room, killer, refusal):
    assert frame(client, room, seed=6).status_code == 200
    with ThreadPoolExecutor() as pool:
        lost = pool.submit(frame, client, room, seed=int(killer), rays=2000, width=1000, height=500)
        until(lambda: service.internal.lanes.long.running)
        os.kill(service.working("long", room), killer)
        answer = lost.result()
    assert (answer.status_code, answer.json()["code"]) == refusal
    assert ("retry-after" in answer.headers) == (answer.status_code == 503)
    assert frame(client, room, seed=7).status_code == 200
    assert client.get("/readyz").status_code == 200


def test_the_newest_frame_of_a_viewer_wins(service, client, room):
    with ThreadPoolExecutor(8) as pool:
        running = pool.submit(frame, client, room, seed=100, rays=400, width=480, height=270)
        until(lambda: service.internal.lanes.final.running)
        answers = []
        for seed in range(101, 105):
            answers.append(pool.submit(frame, client, room, seed=seed, client="viewer"))
            until(
                lambda: service.internal.lanes.final.waiting == 1 and sum(a.done() for a in answers) == len(answers) - 1
            )
        other = pool.submit(frame, client, room, seed=105, client="other viewer")
        statuses = [answer.result().status_code for answer in answers]
    assert running.result().status_code == other.result().status_code == 200
    assert statuses == [409, 409, 409, 200]
    assert answers[0].result().json()["code"] == "superseded"


def test_the_height_follows_the_film_gate(client, room):
    answer = client.get(f"/v1/shots/{room}/frame", params={"time": 1, "width": 160, "rays": 1})
    assert pixels(answer).shape == (90, 160, 3)


def test_the_query_knows_what_the_renderer_knows():
    fields = FrameQuery.model_fields
    assert set(fields["engine"].annotation.__args__) == set(engine_names())
    assert set(fields["shading"].annotation.__args__) == set(SHADINGS)
    assert issubclass(FrameQuery, base.Model)


@pytest.mark.parametrize("height", [{"height": 8192}, {}])
def test_the_pixel_limit_holds_for_heights_from_the_film_gate(client, room, height):
    answer = client.get(f"/v1/shots/{room}/frame", params={"time": 1, "width": 8192, "rays": 1} | height)
    refusal = answer.json()
    assert (answer.status_code, refusal["code"], refusal["path"]) == (422, "too_many_pixels", "query.width")
    assert "8192 × " in refusal["detail"]


def test_pictures_whose_states_stay_are_the_same_after_an_edit(client, room):
    """A key that bends the focus of late frames leaves the early ones, to the byte."""

    def states() -> dict[float, str]:
        answer = client.get(f"/v1/shots/{room}/picture-states", params={"frames": "1:12"})
        assert answer.status_code == 200, answer.text
        return {one["time"]: one["state"] for one in answer.json()["states"]}

    def set_key(time: float, distance_m: float) -> None:
        key = {"time": time, "value": distance_m, "interpolation": "linear"}
        answer = client.put(f"/v1/shots/{room}/camera/keys/focusDistanceM", json=key)
        assert answer.status_code == 200, answer.text

    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 1})
    for time in (1, 6, 12):
        set_key(time, 4.0)
    before = states(), {time: pixels(frame(client, room, time=time)) for time in (3, 9)}
    set_key(12, 9.0)
    after = states(), {time: pixels(frame(client, room, time=time)) for time in (3, 9)}

    kept = [time for time, state in before[0].items() if after[0][time] == state]
    assert kept == [1, 2, 3, 4, 5, 6]
    np.testing.assert_array_equal(before[1][3], after[1][3])
    assert (before[1][9] != after[1][9]).any()


def test_states_of_too_many_frames_are_refused(client, room):
    answer = client.get(f"/v1/shots/{room}/picture-states", params={"frames": "1:1001"})
    assert answer.status_code == 422
    assert "at most 1,000" in answer.json()["detail"]


def test_states_and_pictures_say_which_edits_they_are_of(client, room):
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 2})
    revision = client.get(f"/v1/shots/{room}/edits/history").json()["revision"]
    states = client.get(f"/v1/shots/{room}/picture-states", params={"frames": "1"}).json()
    assert states["revision"] == frame(client, room).headers["Pullfocus-Revision"] == revision


@pytest.mark.parametrize("camera", ["/World/nothing", "/World"])
def test_states_of_no_camera_are_refused(client, room, camera):
    answer = client.get(f"/v1/shots/{room}/picture-states", params={"frames": "1:3", "camera": camera})
    assert answer.status_code == 422, answer.text
    assert "there is no camera at" in answer.json()["detail"]
