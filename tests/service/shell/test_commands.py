"""`pullfocus push`, `render` and `jobs` against a real service."""

from __future__ import annotations

import contextlib
import io
import json
import logging
import os
import pty
import re
from pathlib import Path

import pytest

from render.cli.console import FrameProgress
from render.errors import InputError, NotFoundError, PullfocusError, SettingsError, StageError
from service.client import Client
from service.http.settings import Settings
from service.shell import commands, watching
from tests.service.conftest import running

SMALL = ("--width", "64", "--rays", "4", "--engine", "pinhole")


@pytest.fixture(autouse=True)
def _service(service, monkeypatch):
    """The shared service is the one that commands work with."""
    monkeypatch.setenv("PULLFOCUS_URL", str(service.client.base_url))
    monkeypatch.delenv("PULLFOCUS_KEY", raising=False)
    # A handler of logs that an earlier test has left may write to a closed output, and would complain on this one's.
    monkeypatch.setattr(logging, "raiseExceptions", False)


def result(capsys) -> str:
    """The last result that was printed."""
    return capsys.readouterr().out.strip()


@pytest.fixture
def sent(room, capsys) -> str:
    """A render of the room that has ended; its id."""
    assert commands.render([room, "--frames", "1-2", "--name", "dailies", *SMALL]) == 0
    return result(capsys)


@pytest.mark.gl
def test_a_path_is_pushed_rendered_watched_and_fetched(room_file, client, tmp_path, capsys):
    arguments = [str(room_file), "--frames", "1-2", "--format", "png", "--out", str(tmp_path), *SMALL]
    assert commands.render(arguments) == 0
    printed = capsys.readouterr()
    render = client.get(f"/v1/renders/{printed.out.strip()}").json()
    assert (render["state"], render["frames"]) == ("done", "1-2")
    assert [path.read_bytes()[1:4] for path in sorted(tmp_path.glob("room.usda.000?.png"))] == [b"PNG"] * 2
    lines = printed.err.splitlines()
    assert re.fullmatch(r"pushed room\.usda: shot room-\w+, 1 file, 0\.0 MiB, frames 1 to 24", lines[0])
    assert f"2/2 {render['id']} done" in lines
    assert lines[-1] == f"render {render['id']} is done"


@pytest.mark.gl
def test_a_stage_goes_with_its_files_and_no_others(room_file, client, tmp_path, capsys):
    stage = tmp_path / "stage"
    (stage / "layers").mkdir(parents=True)
    (stage / "layers" / "room.usda").write_text(room_file.read_text())
    (stage / "shot.usda").write_text("#usda 1.0\n(\n    subLayers = [@./layers/room.usda@, @./gone.usda@]\n)\n")
    (stage / "other.usda").write_text(room_file.read_text())
    (stage / "private.txt").write_text("not of the shot")
    assert commands.push([str(stage / "shot.usda"), "--name", "evening"]) == 0
    shot = client.get(f"/v1/shots/{result(capsys)}").json()
    assert (shot["name"], shot["root"], shot["fileCount"]) == ("evening.zip", "shot.usda", 2)
    assert commands.push([str(stage), "--root", "other.usda"]) == 0
    assert client.get(f"/v1/shots/{result(capsys)}").json()["fileCount"] == 4


@pytest.mark.gl
def test_files_outside_the_folder_are_named_and_not_sent(tmp_path, capsys):
    (tmp_path / "stage").mkdir()
    (tmp_path / "out.usda").write_text("#usda 1.0")
    (tmp_path / "stage" / "shot.usda").write_text("#usda 1.0\n(\n    subLayers = [@../out.usda@]\n)\n")
    with pytest.raises(InputError, match="outside"):
        commands.push([str(tmp_path / "stage" / "shot.usda")])
    assert "such as" in (said := capsys.readouterr().err)
    assert "out.usda are" not in said
    assert str(tmp_path / "out.usda") in said


@pytest.mark.parametrize(
    ("name", "content", "error", "message"),
    [
        ("none.usda", None, NotFoundError, "does not exist"),
        ("bad.usda", "#usda 1.0\n(((", StageError, "no stage"),
        ("notes.txt", "text", InputError, "expected .usda"),
        ("empty", "", PullfocusError, "is empty"),
    ],
)
def test_what_is_no_shot_is_one_error(tmp_path, name, content, error, message):
    path = tmp_path / name
    if content == "":
        path.mkdir()
    elif content is not None:
        path.write_text(content)
    with pytest.raises(error, match=re.escape(message)):
        commands.push([str(path)])


@pytest.mark.gl
def test_a_render_is_tried_without_being_sent(room, client, capsys):
    before = client.get("/v1/renders").json()
    assert commands.render([room, "--frames", "1-9:4", "--dry-run", *SMALL]) == 0
    printed = result(capsys)
    assert re.match(r"3 frames, 1-9:4: about [\d.]+ s of processor time\n", printed)
    assert re.search(r"camera +/World/cam\b", printed)
    assert re.search(r"formats +exr\b", printed)
    assert commands.render([room, "--frames", "1-30", "--lens", "nothing_50", "--dry-run", *SMALL]) == 1
    printed = result(capsys)
    assert "error: " in printed
    assert "nothing_50" in printed
    assert "warning: frames: Frames 25-30 are outside the shot, which is 1 to 24" in printed
    assert client.get("/v1/renders").json() == before


@pytest.mark.gl
def test_the_same_key_gives_the_same_render(room, capsys):
    ids = set()
    for _ in range(2):
        assert commands.render([room, "--frames", "1", "--idempotency-key", "shell", "--detach", *SMALL]) == 0
        printed = capsys.readouterr()
        ids.add(printed.out.strip())
    assert len(ids) == 1
    assert printed.err.strip() == f"`pullfocus jobs watch {ids.pop()}` watches it"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["demo", "--frames", "1-"], "frames are expected like"),
        (["demo", "--rays", "0"], "--rays: "),
        (["demo", "--width", "9999"], "--width: "),
        (["demo", "--camera", "main"], "--camera: "),
        (["demo", "--detach", "--out", "x"], "--detach does not wait"),
        (["./demo", "--dry-run"], "push ./demo first"),
        (["demo", "--on", "ftp://elsewhere"], "no address"),
        (["demo", "--key-file", "/none/key"], "--key-file /none/key: No such file"),
    ],
)
def test_wrong_arguments_are_refused_before_anything_is_sent(monkeypatch, arguments, message):
    monkeypatch.setattr(Client, "_exchange", lambda *_: pytest.fail("a request was sent"))
    with pytest.raises(SettingsError, match=re.escape(message)):
        commands.render(arguments)


def test_options_that_do_not_exist_end_with_status_2(capsys):
    for arguments in (["demo", "--format", "tiff"], ["demo", "--rays", "many"], ["demo", "--ray", "1"], []):
        with pytest.raises(SystemExit) as end:
            commands.render(arguments)
        assert end.value.code == 2
        assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.gl
def test_a_frame_that_fails_says_why(room, capsys):
    assert commands.render([room, "--frames", "3", "--camera", "/none", *SMALL]) == 1
    printed = capsys.readouterr()
    assert "frame 3: there is no camera at /none" in printed.err
    render_id = printed.out.strip()
    assert f"`pullfocus jobs retry {render_id}` draws them again" in printed.err
    assert f"`pullfocus jobs log {render_id} 3` prints the log of the first" in printed.err
    assert commands.jobs(["log", render_id, "3", "--tail", "1"]) == 0
    assert "Z failed: there is no camera at /none" in result(capsys)
    assert commands.jobs(["show", render_id]) == 0
    assert "/none" in result(capsys)


@pytest.mark.gl
def test_renders_are_listed_and_shown(sent, capsys):
    assert commands.jobs(["list", "--most", "1"]) == 0
    assert re.search(rf"{sent} +done +2/2 +1-2 +50 .* dailies", result(capsys))
    assert commands.jobs(["list", "--most", "1", "--json"]) == 0
    (listed,) = json.loads(result(capsys))["renders"]
    assert (listed["id"], listed["secondsLeft"]) == (sent, None)
    assert commands.jobs(["show", sent, "--json"]) == 0
    shown = json.loads(result(capsys))
    assert [task["state"] for task in shown.pop("tasks")] == ["done", "done"]
    assert shown == listed


@pytest.mark.gl
def test_json_is_that_of_the_service(sent, client, capsys):
    assert commands.jobs(["show", sent, "--json"]) == 0
    shown = json.loads(result(capsys))
    tasks = client.get(f"/v1/renders/{sent}/tasks").json()["tasks"]
    assert [task.keys() for task in shown.pop("tasks")] == [task.keys() for task in tasks]
    assert shown.keys() == client.get(f"/v1/renders/{sent}").json().keys()


@pytest.mark.gl
def test_a_log_is_printed_and_followed_to_its_end(sent, client, capsys):
    whole = client.get(f"/v1/renders/{sent}/frames/2/log").text
    for more in ((), ("--follow",), ("--attempt", "1"), ("--tail", "1000")):
        assert commands.jobs(["log", sent, "2", *more]) == 0
        assert capsys.readouterr().out == whole
    with pytest.raises(SettingsError, match="leave --tail out"):
        commands.jobs(["log", sent, "2", "--follow", "--tail", "3"])


@pytest.mark.gl
def test_frames_are_fetched_later(sent, tmp_path, capsys):
    for _ in range(2):
        assert commands.jobs(["fetch", sent, "--out", str(tmp_path)]) == 0
        assert f"2 of 2 frames of render {sent} are in {tmp_path}" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dailies.0001.exr", "dailies.0002.exr"]


def test_a_focus_report_is_fetched_before_the_end(service, room, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(service.internal.renders, "claim", lambda *_: None)
    assert commands.render([room, "--detach", "--frames", "3-5", "--aovs", "depth", "coc", *SMALL]) == 0
    render_id = result(capsys)
    path = tmp_path / "focus.csv"
    assert commands.jobs(["fetch", render_id, "--focus-report", str(path)]) == 0
    assert [line.split(",")[0] for line in path.read_text().splitlines()] == ["frame", "3", "4", "5"]
    assert service.client.get(f"/v1/renders/{render_id}").json()["aovs"] == ["depth", "coc"]
    commands.jobs(["cancel", render_id])


def test_products_are_made_with_a_render_of_no_frames(room, client, capsys, tmp_path):
    typed = ["--frames", "3-5", "--format", "--products", "focus-report.csv", "focus-curve.otio", *SMALL]
    assert commands.render([room, *typed]) == 0
    render = client.get(f"/v1/renders/{result(capsys)}").json()
    assert (render["count"], [each["state"] for each in render["products"]]) == (0, ["done", "done"])
    with pytest.raises(SettingsError, match="draws no frame: name formats, or products"):
        commands.render([room, "--format", *SMALL])


def test_what_is_no_aov_is_refused(room):
    with pytest.raises(SettingsError, match=r"--aovs: .* an AOV is one of depth"):
        commands.render([room, "--aovs", "depths", *SMALL])
    with pytest.raises(SettingsError, match=r"--aovs: .* add exr to the formats"):
        commands.render([room, "--format", "png", "--aovs", "depth", *SMALL])


@pytest.mark.gl
def test_a_render_is_paused_resumed_canceled_and_removed(room, client, capsys):
    assert commands.render([room, "--detach", *SMALL]) == 0
    render_id = result(capsys)
    for action, states in (("pause", "pause"), ("resume", "running|queued"), ("cancel", "cancel")):
        assert commands.jobs([action, render_id]) == 0
        assert re.search(f"render {render_id} is ({states})", capsys.readouterr().err)
    assert commands.jobs(["watch", render_id]) == 1
    assert commands.jobs(["remove", render_id]) == 0
    with pytest.raises(NotFoundError, match=render_id):
        commands.jobs(["show", render_id])


@pytest.mark.gl
def test_ctrl_c_leaves_the_render_running(room, client, capsys, monkeypatch, tmp_path):
    def interrupt(self, render):
        raise KeyboardInterrupt

    monkeypatch.setattr(watching.RenderProgress, "show", interrupt)
    url, out = os.environ["PULLFOCUS_URL"], tmp_path / "my frames"
    with pytest.raises(KeyboardInterrupt):
        commands.render([room, *SMALL, "--on", url, "--out", str(out)])
    printed = capsys.readouterr()
    render_id = printed.out.strip()
    command = f"pullfocus jobs watch {render_id} --out '{out}' --on {url}"
    assert printed.err.strip() == f"render {render_id} goes on: `{command}` watches it again"
    assert client.get(f"/v1/renders/{render_id}").json()["state"] in ("queued", "running")
    commands.jobs(["cancel", render_id])


def everything(shown: io.FileIO) -> str:
    """All that was written to a terminal, whose other end is closed."""
    parts = []
    with contextlib.suppress(OSError):
        while part := shown.read(65536):
            parts.append(part)
    return b"".join(parts).decode(errors="replace")


@pytest.mark.gl
def test_a_terminal_gets_a_bar(sent, monkeypatch):
    reader, terminal = pty.openpty()
    with open(reader, "rb", buffering=0) as shown:
        with open(terminal, "w") as stderr, monkeypatch.context() as patch:
            patch.setattr("sys.stderr", stderr)
            assert commands.jobs(["watch", sent]) == 0
        text = everything(shown)
    assert "dailies done" in text
    assert "2/2" in text
    assert FrameProgress.shown is None


def test_a_service_that_is_not_there_is_one_error(monkeypatch):
    monkeypatch.setattr("service.client.sync_client._pause", lambda seconds, stop: None)
    with pytest.raises(PullfocusError, match=r"http://127\.0\.0\.1:1: no answer .* `pullfocus serve`"):
        commands.jobs(["list", "--on", "http://127.0.0.1:1"])


def test_keys_come_from_a_file_or_the_environment(tmp_path, monkeypatch, capsys):
    with running(Settings(data=tmp_path / "data", demo=False, access="keys")) as service:
        on = ["--on", str(service.client.base_url)]
        key = service.app.state.identity.keys.create("Mara", {"read"}, "default")[1]
        with pytest.raises(PullfocusError, match="PULLFOCUS_KEY"):
            commands.jobs(["list", *on])
        (tmp_path / "key").write_text(f"{key}\n")
        assert commands.jobs(["list", "--json", *on, "--key-file", str(tmp_path / "key")]) == 0
        monkeypatch.setenv("PULLFOCUS_KEY", key)
        assert commands.jobs(["list", "--json", *on]) == 0
        assert json.loads(capsys.readouterr().out.split("}\n")[-2] + "}") == {"renders": []}


def test_the_command_line_names_the_commands() -> None:
    text = (Path(__file__).parents[3] / "pyproject.toml").read_text()
    for command in ("push", "render", "jobs"):
        assert f'{command} = "service.shell.commands:{command}"' in text
        assert callable(getattr(commands, command))
