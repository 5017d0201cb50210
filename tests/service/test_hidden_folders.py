"""Errors name nothing of the machine."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

import service.hidden_folders
from render.errors import OutputError
from service.hidden_folders import hide_folder, without_folders
from service.http.errors import answer_to


def test_a_full_disk_does_not_tell_where_the_data_is(tmp_path: Path) -> None:
    hide_folder(tmp_path / "data")
    edits = tmp_path / "data" / "shots" / "abc123" / "edits" / "edits.usda"
    error = OutputError(f"cannot write {edits}: the disk is full (no space)", code="disk_full", path=str(edits))

    body = json.loads(bytes(answer_to(error).body))

    assert body["detail"] == "cannot write edits.usda: the disk is full (no space)"
    assert body["path"] == "edits.usda"


def test_no_folder_of_the_program_is_named() -> None:
    program = Path(service.hidden_folders.__file__).parents[1]

    for place in (program / "render" / "x.py", Path(sys.prefix) / "lib" / "y.py"):
        assert without_folders(f"'{place}' failed") == f"'{'/'.join(place.parts[-2:])}' failed"
    assert without_folders(f"cannot read {tempfile.gettempdir()}/pullfocus-ab12/image.png") == "cannot read image.png"


def test_paths_of_prims_stay() -> None:
    text = "the transform of /srv/Chair and of /World/shots/a is not finite"

    assert without_folders(text) == text
