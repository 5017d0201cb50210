"""The README's tour runs as it stands there, but for the size of its pictures."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import OpenImageIO
import pytest

from render.cli.main import main

README = Path(__file__).parents[2] / "README.md"
ADDRESS = "http://127.0.0.1:8000"
QUICK = ("--imageWidth", "64", "--rays", "4", "--supersample", "1")


def commands(name: str) -> list[list[str]]:
    """The README's shell lines that call a program, in their order, as words."""
    text = README.read_text().replace("\\\n", "")  # lines that go on
    blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines() if line and not line.startswith("#")]
    assert all(line.startswith(("pullfocus ", "curl ")) for line in lines), "the test knows how to run these two"
    return [shlex.split(line) for line in lines if line.startswith(f"{name} ")]


def is_picture(path: Path) -> bool:
    """Whether a file can be read as a picture to its end."""
    return bool(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT).size)


def test_the_tour_in_the_shell_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    tour = commands("pullfocus")
    assert {words[1] for words in tour} == {
        "demo",
        "inspect",
        "record",
        "focus-curve",
        "meter",
        "lenses",
        "films",
        "bodies",
    }
    for words in tour:
        assert main([*words[1:], *(QUICK if words[1] == "record" else ())]) == 0, shlex.join(words)
    rack = sorted(Path().glob("rack.*.jpg"))
    written = [
        *map(
            Path,
            (
                "frame.png",
                "frame.exr",
                "quick.png",
                "flag.png",
                "spots.png",
                "gather.png",
                "better.png",
                "planar.png",
                "swirl.png",
                "flare.png",
                "5219.png",
                "slide.png",
                "contact.png",
                "trails.png",
                "p3.png",
                "framed.png",
            ),
        ),
        *rack,
    ]
    assert [str(path) for path in rack] == [f"rack.{frame:04}.jpg" for frame in range(40, 73, 4)]
    assert all(is_picture(path) for path in written)
    assert Path("focus.csv").read_text().count("\n") == 97
    assert "focusDistance" in Path("focus.usda").read_text()


@contextmanager
def served(data: Path) -> Iterator[str]:
    """`pullfocus serve` on a free port; its address."""
    command = [sys.executable, "-m", "render.cli", "serve", "--port", "0", "--data", str(data)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"})
    assert process.stderr is not None
    try:
        said = ""
        for line in process.stderr:
            said += line
            if found := re.search(r"http://127\.0\.0\.1:\d+", line):
                break
        else:
            pytest.fail(f"the service did not start: {said}")
        yield found[0]
    finally:
        process.terminate()
        process.communicate(timeout=60)


def test_the_tour_over_rest_runs(tmp_path: Path) -> None:
    with served(tmp_path / "data") as address, httpx.Client(timeout=300) as client:
        for words in commands("curl"):
            url = words[-1].replace(ADDRESS, address)
            small = "&width=64&rays=4&supersample=1" if "/frame?" in url else ""
            method = words[words.index("-X") + 1] if "-X" in words else "GET"
            sent = json.loads(words[words.index("--json") + 1]) if "--json" in words else None
            answer = client.request(method, url + small, json=sent)
            assert answer.status_code == 200, f"{url}: {answer.text}"
            if "-o" in words:
                (tmp_path / words[words.index("-o") + 1]).write_bytes(answer.content)
    assert is_picture(tmp_path / "frame.png")
    assert (tmp_path / "focus.csv").read_text().count("\n") == 97


def test_what_it_says_of_live_pictures_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    with served(tmp_path / "data") as address:
        httpx.get(f"{address}/livez", timeout=300).raise_for_status()  # the demo shot is there
        small = program.replace('"width": 480', '"width": 64, "rays": 4')
        exec(small.replace("ws://127.0.0.1:8000", address.replace("http", "ws")), {})
    pictures = sorted(Path().glob("live.*"))
    assert [picture.suffix for picture in pictures][-1] == ".png"
    assert all(is_picture(picture) for picture in pictures)


def test_what_the_readme_links_to_is_there() -> None:
    links = re.findall(r"\]\((?!http)([^)#]+)\)", README.read_text())
    assert links
    assert [link for link in links if not (README.parent / link).exists()] == []
