"""The commands of the README and of the guide run as they stand there, except for the size of their pictures."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import OpenImageIO
import pytest

from render.cli.main import main
from service import client as pullfocus_client

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs" / "guide").glob("*.md"))]
ADDRESS = "http://127.0.0.1:8000"
QUICK = ("--imageWidth", "64", "--rays", "4", "--supersample", "1")
QUICK_RENDER = ("--width", "64", "--rays", "4", "--supersample", "1")
PICTURES = (".png", ".jpg", ".exr")
OUTPUT_OPTIONS = ("--out", "--key", "--tables")


def blocks(page: Path, language: str) -> list[str]:
    """The code blocks of a page that are in a language."""
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(), re.DOTALL)


def commands(page: Path, program: str) -> list[list[str]]:
    """The shell lines of a page that call a program, as words, in the order of the page."""
    typed = [words for block in blocks(page, "sh") for words in split_commands(block)]
    assert {words[0] for words in typed} <= {"pullfocus", "curl"}, f"{page.name} calls a program that is not typed here"
    return [words for words in typed if words[0] == program]


def programs() -> list[str]:
    """The Python programs of the pages."""
    return [block for page in PAGES for block in blocks(page, "python")]


def split_commands(block: str) -> Iterator[list[str]]:
    """The commands of a shell block as words; a command goes on over the lines of a quoted text."""
    command = ""
    for line in block.replace("\\\n", "").splitlines():
        if not command and line.startswith("#"):
            continue
        command += f"{line}\n"
        try:
            words = shlex.split(command)
        except ValueError:  # the quotation is still open
            continue
        if words:
            yield words
        command = ""
    assert not command, f"an open quotation: {command}"


def in_few_frames(words: list[str]) -> list[str]:
    """The words with ranges of frames cut to their first and last frame."""
    return [re.sub(r"^(\d+):(\d+)(x\d+)?$", lambda m: f"{m[1]}:{m[2]}x{int(m[2]) - int(m[1])}", word) for word in words]


def is_picture(path: Path) -> bool:
    """Whether a file can be read as a picture to its end."""
    return bool(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT).size)


def outputs(words: list[str]) -> list[Path]:
    """The files that a `pullfocus` command has written."""
    names = [words[words.index(option) + 1] for option in OUTPUT_OPTIONS if option in words]
    names += [words[3]] if words[1] == "record" else []
    return [path for name in names for path in (sorted(Path().glob(re.sub("#+", "*", name))) or [Path(name)])]


def send(client: httpx.Client, words: list[str], service: str) -> httpx.Response:
    """Send the request of a `curl` command to a service, frames small."""

    def value(option: str) -> str | None:
        return words[words.index(option) + 1] if option in words else None

    url = words[-1].replace(ADDRESS, service)
    url += "&width=64&rays=4&supersample=1" if "/frame?" in url else ""
    form = [words[i + 1].partition("=") for i, word in enumerate(words) if word == "-F"]
    if form:
        files = {name: (path[1:], Path(path[1:]).read_bytes()) for name, _, path in form if path.startswith("@")}
        return client.post(url, files=files, data={name: text for name, _, text in form if name not in files})
    body, method = value("--json"), value("-X")
    return client.request(method or ("POST" if body else "GET"), url, json=json.loads(body) if body else None)


@pytest.fixture(scope="module")
def demo(demo_file: Path) -> Path:
    """Folder of the demo shot."""
    return demo_file.parent


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page, "pullfocus")], ids=lambda page: page.stem)
def test_the_commands_of_a_page_run(
    page: Path, service: str, demo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PULLFOCUS_URL", service)
    httpx.get(f"{service}/livez", timeout=300).raise_for_status()  # answers once the demo shot is written
    typed = commands(page, "pullfocus")
    if ["pullfocus", "demo", "demo"] not in typed:
        shutil.copytree(demo, tmp_path / "demo")
    for words in map(in_few_frames, typed):
        quick = QUICK[2:] if "--products" in words else QUICK  # products have sizes of their own
        small = {"record": quick, "render": QUICK_RENDER}.get(words[1], ())
        assert main([*words[1:], *small]) == 0, shlex.join(words)
        for path in outputs(words):
            assert path.stat().st_size > 0, shlex.join(words)
            assert path.suffix not in PICTURES or is_picture(path), shlex.join(words)


def test_the_pages_show_every_command_that_ends() -> None:
    shown = {words[1] for page in PAGES for words in commands(page, "pullfocus")}
    assert shown == {
        "demo",
        "inspect",
        "record",
        "focus-curve",
        "meter",
        "lenses",
        "films",
        "bodies",
        "keys",
        "export-openjd",
        "push",
        "render",
        "jobs",
    }


def test_the_requests_of_the_pages_are_answered(
    service: str, demo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.make_archive("night_street", "zip", demo)
    requests = [words for page in PAGES for words in commands(page, "curl")]
    with httpx.Client(timeout=300) as client:
        for words in requests:
            answer = send(client, words, service)
            assert answer.is_success, f"{shlex.join(words)}: {answer.text}"
            if "-o" in words:
                Path(words[words.index("-o") + 1]).write_bytes(answer.content)
    assert is_picture(tmp_path / "frame.png")
    assert (tmp_path / "focus.csv").read_text().count("\n") == 97


def test_the_live_pictures_program_runs(service: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = (program for program in programs() if "ws://" in program)
    monkeypatch.chdir(tmp_path)
    httpx.get(f"{service}/livez", timeout=300).raise_for_status()  # answers once the demo shot is written
    small = program.replace('"width": 480', '"width": 64, "rays": 4')
    exec(small.replace("ws://127.0.0.1:8000", service.replace("http", "ws")), {})
    pictures = sorted(Path().glob("live.*"))
    assert [picture.suffix for picture in pictures][-1] == ".png"
    assert all(is_picture(picture) for picture in pictures)


def test_the_focus_map_program_runs(service: str, capsys: pytest.CaptureFixture[str]) -> None:
    (program,) = (program for program in programs() if "/focus-map" in program)
    httpx.get(f"{service}/livez", timeout=300).raise_for_status()
    exec(program.replace(ADDRESS, service).replace("width=480", "width=64"), {})
    assert re.fullmatch(r"\d+% of the picture is sharp\n", capsys.readouterr().out)


def test_the_client_program_runs(service: str, demo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = (program for program in programs() if "pullfocus_client" in program)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "pullfocus_client", pullfocus_client)  # as its own wheel has it
    shutil.copytree(demo, tmp_path / "demo")
    exec(program.replace(ADDRESS, service).replace("width=480, rays=16", "width=64, rays=4"), {})
    files = sorted(Path("frames").iterdir())
    assert len(files) == 6  # three frames in two formats
    assert all(is_picture(path) for path in files)


def test_the_other_python_programs_run(demo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = (
        program for program in programs() if not any(word in program for word in ("ws://", "http://", "hmac"))
    )
    monkeypatch.chdir(tmp_path)
    shutil.copytree(demo, tmp_path / "demo")
    exec(program.replace("width=480, height=270", "width=64, height=36, rays=4"), {})
    assert is_picture(tmp_path / "stopped_down.png")
    assert "fStop" in (tmp_path / "edits.usda").read_text()


def test_the_links_of_the_readme_lead_somewhere() -> None:
    links = re.findall(r"\]\((?!http)([^)#]+)\)", README.read_text())
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_the_readme_is_short() -> None:
    assert len(README.read_text().splitlines()) < 150
