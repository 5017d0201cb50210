"""Garbage is not searched for while modules are imported, and it is while a command runs."""

from __future__ import annotations

import gc
from collections.abc import Callable

import pytest

from render.cli.main import main
from render.errors import SettingsError


def test_garbage_is_collected_while_a_command_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def parse(*_: object) -> Callable[[], None]:
        seen.append(gc.isenabled())
        return lambda: seen.append(gc.isenabled())

    monkeypatch.setattr("render.cli.commands.parse_command", parse)
    assert main(["record"]) == 0
    assert seen == [False, True]


def test_garbage_is_collected_after_wrong_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise SettingsError("no such option")

    monkeypatch.setattr("render.cli.commands.parse_command", refuse)
    assert main(["record"]) == 2
    assert gc.isenabled()


def test_only_the_first_command_of_a_process_exempts_objects(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("render.cli.commands.parse_command", lambda *_: lambda: None)
    before = gc.get_freeze_count()
    assert main(["record"]) == 0
    assert gc.get_freeze_count() == before
