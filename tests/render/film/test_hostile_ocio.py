"""A shot from outside brings OpenColorIO files: nothing outside of its folder is read, told or waited for."""

from __future__ import annotations

import os
import resource
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from render.colour.confined import ConfinedConfig, count_references
from render.errors import PullfocusError
from render.film import Grade, develop
from render.output.metadata import _grade_attributes
from tests.render.kits.colours import LOOK_WITH_A_FILE, OWN_CONFIG
from usd_schemas.settings import Asset, GradeData

HALF = "LUT_1D_SIZE 2\n0 0 0\n0.5 0.5 0.5\n"
CANARY = "canary-4711"
CTF = '<ProcessList id="a" version="1.7"><Reference path="{}" inBitDepth="32f" outBitDepth="32f"/></ProcessList>'


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    (tmp_path / "shot" / "luts").mkdir(parents=True)
    (tmp_path / "half.cube").write_text(HALF.replace("0.5", "0.25"))
    (tmp_path / "secret.txt").write_text(f"{CANARY}\n")
    return tmp_path / "shot"


def grade(shot: Path, src: str, *, head: str = "", look: str = "Dusk", name: str = "own.ocio") -> Grade:
    (shot / "own.ocio").write_text(head + OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", src))
    return Grade.from_film_data(GradeData(ocio_config=Asset(name, str(shot / name)), look=look), shot)


def refusal(shot: Path, src: str, *, sent: str = "", **named: str) -> str:
    """Message for a file that a look names. It may repeat the path that was sent, and no other of this machine."""
    with pytest.raises(PullfocusError) as caught:
        grade(shot, src, **named)
    text = f"{caught.value.detail} {caught.value.path}".replace(sent, "")
    assert str(shot.parent) not in text
    assert CANARY not in text
    return caught.value.detail


def grey(graded: Grade) -> float:
    return float(develop(np.full((1, 1, 3), 0.5, np.float32), 1.0, graded)[0, 0, 0])


@pytest.mark.parametrize("src", ["%CANARY%", "$CANARY", "${CANARY}", "%PATH%", "$HOME/a.cube"])
@pytest.mark.parametrize("declared", [False, True])
def test_a_configuration_sees_no_environment(
    src: str, declared: bool, shot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CANARY", CANARY)
    head = "environment: {CANARY: mine.cube, PATH: mine.cube}\n" if declared else ""

    said = refusal(shot, src, head=head)

    assert not any(value in said for value in (os.environ["PATH"], os.environ["HOME"]))


def test_a_variable_has_the_default_that_is_declared(shot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CANARY", "../../half.cube")
    (shot / "mine.cube").write_text(HALF)

    assert grey(grade(shot, "$CANARY", head="environment: {CANARY: mine.cube}\n")) == pytest.approx(0.25, abs=1e-5)


@pytest.mark.parametrize("suffix", ["ctf", "clf", "cube", "foo"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_reference_leads_nowhere_outside(suffix: str, encoding: str, shot: Path) -> None:
    def said(path: str) -> str:
        (shot / f"a.{suffix}").write_text(CTF.format(path), encoding)
        return refusal(shot, f"a.{suffix}", sent=path)

    for outside in (str(shot.parent), "../.."):
        there, not_there = said(f"{outside}/half.cube"), said(f"{outside}/some.cube")
        assert there.replace("half.cube", "some.cube") == not_there
    said(f"{shot.parent}/secret.txt")


def test_a_reference_through_a_link_leads_nowhere(shot: Path) -> None:
    (shot / "link.cube").symlink_to(shot.parent / "half.cube")
    (shot / "a.ctf").write_text(CTF.format("link.cube"))

    refusal(shot, "a.ctf")
    refusal(shot, "link.cube")


@pytest.mark.parametrize("inside", [True, False])
def test_a_pipe_is_not_waited_for(inside: bool, shot: Path) -> None:
    pipe = (shot if inside else shot.parent) / "pipe.cube"
    os.mkfifo(pipe)
    (shot / "a.ctf").write_text(CTF.format(pipe.name if inside else pipe))
    begun_s = time.monotonic()

    refusal(shot, "a.ctf", sent=str(pipe))

    assert time.monotonic() - begun_s < 5


def test_a_reference_to_a_file_of_the_shot_is_followed(shot: Path) -> None:
    (shot / "luts" / "half.cube").write_text(HALF)
    (shot / "a.ctf").write_text(CTF.format("luts/half.cube"))

    assert grey(grade(shot, "a.ctf")) == pytest.approx(0.25, abs=1e-5)


def test_references_do_not_multiply(shot: Path) -> None:
    twice = CTF.replace("/></P", '/><Reference path="{0}" inBitDepth="32f" outBitDepth="32f"/></P').replace("{}", "{0}")
    for number in range(30):
        (shot / f"a{number}.ctf").write_text(twice.format(f"a{number + 1}.ctf"))
    (shot / "a30.ctf").write_text(CTF.format("half.cube"))
    begun_s = time.monotonic()

    refusal(shot, "a0.ctf")

    assert time.monotonic() - begun_s < 5


def test_references_are_counted_as_the_parser_sees_them() -> None:
    hidden = "<!DOCTYPE a [<!ENTITY r \"<&#82;eference path='x'/>\">]><ProcessList>&r;</ProcessList>"

    assert count_references(hidden.encode()) is None
    assert count_references(CTF.format("x").encode("utf-16")) == 1
    assert count_references(b"<!-- <Reference/> --><ProcessList/>") == 0
    assert count_references(HALF.encode()) == 0


def test_yaml_does_not_multiply(shot: Path) -> None:
    steps = "".join(f"  a{n}: &a{n} !<GroupTransform> {{children: [*a{n - 1}, *a{n - 1}]}}\n" for n in range(1, 30))
    head = "doubled:\n  a0: &a0 !<MatrixTransform> {offset: [1, 1, 1, 1]}\n" + steps

    assert "aliases" in refusal(shot, "a.cube", head=head)


def packed(shot: Path, src: str, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(shot / "own.ocioz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("config.ocio", OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", src))
        for name, content in files.items():
            archive.writestr(name, content)
    return shot / "own.ocioz"


def test_an_archive_reads_its_own_files(shot: Path) -> None:
    packed(shot, "half.cube", {"half.cube": HALF.encode()})

    assert grey(grade(shot, "", name="own.ocioz")) == pytest.approx(0.25, abs=1e-5)


@pytest.mark.parametrize("src", ["{}/half.cube", "../half.cube", "a.ctf", "%CANARY%", "../luts/x.cube"])
def test_an_archive_reads_nothing_else(src: str, shot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CANARY", CANARY)
    (shot / "luts" / "x.cube").write_text(HALF)
    packed(shot, src.format(shot.parent), {"a.ctf": CTF.format(shot.parent / "half.cube").encode()})

    refusal(shot, "", sent=str(shot.parent / "half.cube"), name="own.ocioz")


def test_an_archive_that_is_a_bomb_is_refused(shot: Path) -> None:
    packed(shot, "a.cube", {"a.cube": HALF.encode() + b"\n" * 2**29})
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    refusal(shot, "", name="own.ocioz")

    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < 200_000


@pytest.mark.parametrize("content", [b"", b"PK\x05\x06", b"no archive", b"PK\x03\x04" + bytes(200)])
def test_an_archive_that_is_damaged_is_refused(content: bytes, shot: Path) -> None:
    (shot / "own.ocioz").write_bytes(content)

    refusal(shot, "", name="own.ocioz")


def test_a_picture_names_the_configuration_from_the_shot(shot: Path) -> None:
    (shot / "luts" / "half.cube").write_text(HALF)
    made = grade(shot, "luts/half.cube")

    named = {name: value for name, _, value in _grade_attributes(made)}

    assert made.config == ConfinedConfig(str(shot / "own.ocio"), shot)
    assert named["pullfocus:colorConfig"] == "own.ocio"
