"""Packing of shots for their upload."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

import pytest

from service.client import FileError
from service.client.packing import open_package


@pytest.fixture
def folder(tmp_path) -> Path:
    """A folder of a shot."""
    shot = tmp_path / "night"
    (shot / "textures").mkdir(parents=True)
    (shot / "shot.usda").write_text("#usda 1.0")
    (shot / "textures" / "wall.png").write_bytes(b"png")
    (shot / ".DS_Store").write_text("of a desktop")
    (shot / ".git").mkdir()
    (shot / ".git" / "config").write_text("of git")
    return shot


def entries(path: Path, files=None) -> dict[str, bytes]:
    package = open_package(path, None, None, files)
    with package.file, zipfile.ZipFile(package.file) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_a_folder_goes_with_all_that_is_not_hidden(folder):
    assert entries(folder) == {"shot.usda": b"#usda 1.0", "textures/wall.png": b"png"}
    assert entries(folder, [Path("shot.usda")]) == {"shot.usda": b"#usda 1.0"}


def test_a_file_goes_as_it_is(folder):
    package = open_package(folder / "shot.usda", None, None, None)
    with package.file:
        assert (package.name, package.file.read()) == ("shot.usda", b"#usda 1.0")


@pytest.mark.parametrize(("path", "sent"), [("", "dailies.zip"), ("shot.usda", "dailies.usda")])
def test_a_name_keeps_the_suffix(folder, path, sent):
    package = open_package(folder / path, "dailies", "shot.usda", None)
    package.file.close()
    assert (package.name, package.root) == (sent, "shot.usda")


def test_a_link_to_what_lies_outside_is_refused(folder, tmp_path):
    (tmp_path / "secret").write_text("not of the shot")
    (folder / "wall.png").symlink_to(tmp_path / "secret")
    with pytest.raises(FileError, match=r"wall\.png leads out of the folder"):
        entries(folder)
    with pytest.raises(FileError, match="leads out"):
        entries(folder, [Path("../secret")])


def test_a_link_to_a_folder_is_refused(folder):
    (folder / "more").symlink_to(folder / "textures")
    with pytest.raises(FileError, match="link to a folder"):
        entries(folder)


def test_a_link_within_the_folder_is_followed(folder):
    (folder / "wall.png").symlink_to("textures/wall.png")
    assert entries(folder)["wall.png"] == b"png"


@pytest.mark.parametrize("target", ["loop", "gone"])
def test_a_link_that_leads_nowhere_is_one_error(folder, target):
    (folder / "loop").symlink_to(target)
    with pytest.raises(FileError, match=r"loop|gone"):
        entries(folder)


def test_a_pipe_is_refused(folder):
    os.mkfifo(folder / "pipe")
    with pytest.raises(FileError, match="no plain file"):
        entries(folder)
    with pytest.raises(FileError, match="neither a file nor a folder"):
        open_package(folder / "pipe", None, None, None)


def test_what_is_missing_or_empty_is_one_error(tmp_path):
    with pytest.raises(FileError, match=r"none\.usda: No such file"):
        open_package(tmp_path / "none.usda", None, None, None)
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileError, match="is empty"):
        entries(tmp_path / "empty")


def test_a_file_from_before_1980_is_packed(folder):
    os.utime(folder / "shot.usda", (0, 0))
    assert entries(folder)["shot.usda"] == b"#usda 1.0"
