"""The shot that a worker holds open."""

from __future__ import annotations

from pathlib import Path

import pytest

from render.errors import StageError
from service.stage.opened import OpenedShot


def test_what_usd_raises_is_an_error_of_the_shot_and_logged(record, caplog):
    with pytest.raises(StageError, match=r"room\.usda is damaged") as refused, OpenedShot().use(record):
        raise RuntimeError("a C++ exception about a value")
    assert refused.value.code == "stage_unreadable"
    assert "a C++ exception" in caplog.text


def test_errors_name_files_as_they_were_sent(record):
    with pytest.raises(StageError) as refused, OpenedShot().use(record):
        raise StageError(f"{record.root_path} is odd", path=str(record.root_path))
    assert (refused.value.detail, refused.value.path) == ("room.usda is odd", "room.usda")


def test_a_picture_worker_opens_a_shot_without_its_saved_edits(record):
    Path(record.edits_folder).mkdir()
    record.edits.write_text("no USD at all")
    with OpenedShot().use(record, "") as shot:
        assert shot.edits.history.present.text == ""
