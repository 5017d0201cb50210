"""`pullfocus serve`: one sentence for what is wrong, and a clean end."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
from importlib.metadata import entry_points

import httpx
import pytest

from render.cli.main import main
from service.storage.store import ShotStore


def test_the_command_is_found_by_its_entry_point():
    (entry_point,) = entry_points(group="pullfocus.commands", name="serve")
    assert entry_point.value == "service.http.command:serve"


def test_it_serves_until_it_is_stopped(tmp_path):
    command = [sys.executable, "-m", "render.cli", "serve", "--port", "0", "--no-demo", "--data", str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            message = next(line for line in process.stderr if "http://" in line)
            address = re.search(r"http://\S+/", message)[0]
            assert address.startswith("http://127.0.0.1:")
            assert str(tmp_path) in message
            assert httpx.get(f"{address}livez", timeout=60).json() == {"status": "ok"}
        finally:
            process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        assert process.wait(60) == 0
        assert "Traceback" not in rest
    ShotStore(tmp_path).close()  # the folder is free again


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["--port", "70000"], 2, "port"),
        (["--port", "x"], 2, "port"),
        (["--host", "192.0.2.1"], 2, "192.0.2.1"),
        (["--host", "no such host"], 2, "no such host"),
        (["--data", "/dev/null/shots"], 1, "/dev/null/shots"),
        (["--magic"], 2, "--magic"),
    ],
)
def test_wrong_arguments_are_one_sentence(capfd, arguments, status, message):
    try:
        got = main(["serve", "--port", "0", *arguments])
    except SystemExit as end:  # as argparse ends
        got = end.code
    assert got == status
    printed = capfd.readouterr().err
    assert message in printed
    assert "Traceback" not in printed


def test_a_port_in_use_and_a_folder_in_use_are_named(capfd, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert main(["serve", "--port", str(taken.getsockname()[1]), "--data", str(tmp_path)]) == 1
    assert "in use" in capfd.readouterr().err
    store = ShotStore(tmp_path)
    assert main(["serve", "--port", "0", "--data", str(tmp_path)]) == 1
    assert "another service" in capfd.readouterr().err
    store.close()
