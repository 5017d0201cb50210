"""Arguments of `pullfocus bench` that cannot be: one sentence before anything is measured."""

from __future__ import annotations

import pytest

from tests.render.kits.cli_shots import Command


@pytest.mark.parametrize(
    ("typed", "status", "words"),
    [
        ((), 2, "BENCH"),
        (("coffee",), 2, "coffee"),
        (("lens", "--rays", "0"), 2, "rays must be from 1 to"),
        (("lens", "--supersample", "9"), 2, "supersample must be from 1 to 4, got 9"),
        (("lens", "--scene", "atlantis"), 2, "'atlantis' (choose from"),
        (("lens", "--json", "no such folder/bench.json"), 1, "the folder no such folder does not exist"),
        (("lens", "--json", "."), 1, "cannot write .: it is a folder, expected a file"),
        (("lens", "--json", "/dev/null"), 1, "cannot write /dev/null: it is a device or a pipe, expected a file"),
        (("live", "--before", "/"), 2, "--before must be a checkout of Pullfocus, but / has no render/frame.py"),
        (("quality", "--before", "/"), 2, "--before must be a checkout of Pullfocus"),
        (("quality", "--rays", "25,x"), 2, "--rays must be whole numbers from 1 to"),
        (("quality", "--views", "1"), 2, "--views must be from 2 to"),
        (("quality", "--noise-rays", "5000"), 2, "--noise-rays must be from 2 to 4096, got 5000"),
        (("quality", "--references", "no such folder"), 2, "the folder no such folder does not exist"),
        (("film", "--width", "0"), 2, "width"),
        (("motion", "--width", "0"), 2, "width"),
        (("soak", "--edits", "0"), 2, "--edits must be 1 or more"),
        (("start", "--runs", "0"), 2, "--runs must be 1 or more, got 0"),
        (("start", "--against", "no such folder"), 2, "--against takes the folder of a checkout"),
        (("postblur", "--plot", "blurs.gif"), 2, "blurs.gif"),
        (("importance", "--sizes", "256,x"), 2, "--sizes must be whole numbers from 32 to 2048"),
        (("importance", "--sizes", "8"), 2, "--sizes must be whole numbers"),
        (("importance", "--frames", "1"), 2, "--frames must be from 2 to 10000, got 1"),
        (("service", "--viewers", "0"), 2, "--viewers must be from 1 to 1000, got 0"),
        (("service", "--rate", "0"), 2, "--rate must be more than 0 and at most 3600, got 0"),
        (("scale", "--timeout", "0"), 2, "--timeout must be more than 0, got 0"),
        (("scale", "--axis", "beauty"), 2, "beauty"),
        (("scale", "--most", "0"), 2, "--most 0 leaves no case to measure"),
    ],
)
def test_bad_arguments_get_one_sentence(
    typed: tuple[str, ...], status: int, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    ended = Command(capsys)("bench", *typed)
    assert ended.status == status
    assert words in ended.err.splitlines()[-1]
    assert len(ended.err.splitlines()) == 1
    assert ended.out == ""
