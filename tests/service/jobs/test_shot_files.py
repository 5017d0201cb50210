"""Files of shots on machines that draw: received as a whole or not at all, and kept within a budget."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from render.errors import InputError, OutputError
from service.jobs import shot_files
from service.jobs.shot_files import FileList, ShotFiles, list_files, read_part


def shot(folder: Path, **contents: bytes) -> Path:
    """A folder of files by name; ``__`` in a name is a slash, and its ending is `.usda`."""
    for name, content in contents.items():
        path = folder / f"{name.replace('__', '/')}.usda"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder


def send(kept: ShotFiles, folder: Path) -> FileList:
    """Send a shot part by part, as an executor does."""
    files, token = list_files(folder), kept.begin()
    for file in files.files:
        for offset in range(0, max(file.size_bytes, 1), shot_files.PART_BYTES):
            kept.receive(token, file.path, read_part(folder, file, offset))
    kept.end(token, files)
    return files


@pytest.fixture
def kept(tmp_path) -> ShotFiles:
    return ShotFiles(tmp_path / "worker", 1 << 30)


def test_a_shot_is_received_as_it_was_sent(kept, tmp_path, monkeypatch):
    monkeypatch.setattr(shot_files, "PART_BYTES", 4)
    folder = shot(tmp_path / "sent", root=b"#usda 1.0", textures__wood=os.urandom(23), empty=b"")
    with kept.use(list_files(folder).hash) as none:
        assert none is None
    files = send(kept, folder)
    with kept.use(files.hash) as found:
        assert found is not None
        assert list_files(found / "files") == files == list_files(folder)
    assert send(kept, folder) == files  # twice is no harm


def test_other_files_have_another_hash(tmp_path):
    one = list_files(shot(tmp_path / "one", root=b"a", part=b"b"))
    assert one.size_bytes == 2
    others = [
        shot(tmp_path / "two", root=b"a", part=b"c"),
        shot(tmp_path / "three", root=b"a", part__b=b"b"),
        shot(tmp_path / "four", root=b"a"),
    ]
    assert len({one.hash, *(list_files(other).hash for other in others)}) == 4


def test_a_damaged_shot_is_not_kept(kept, tmp_path):
    files, token = list_files(shot(tmp_path / "sent", root=b"#usda 1.0")), kept.begin()
    kept.receive(token, "root.usda", b"#usda 1.")
    with pytest.raises(InputError, match="not received as it was sent"):
        kept.end(token, files)
    with kept.use(files.hash) as found:
        assert found is None
    assert list((tmp_path / "worker/parts").iterdir()) == []


@pytest.mark.parametrize("path", ["../evil.usda", "/etc/evil", "a/../../b", "", "."])
def test_no_file_lies_outside_its_shot(kept, path):
    with pytest.raises(InputError, match="lies in its folder"):
        kept.receive(kept.begin(), path, b"x")


def test_the_shots_used_last_are_kept(tmp_path):
    kept = ShotFiles(tmp_path / "worker", 25)
    one, two, three = (shot(tmp_path / name, root=name.encode() * 3) for name in ("one", "two", "six"))
    first, second = send(kept, one), send(kept, two)
    os.utime(tmp_path / "worker/shots" / first.hash, (1, 1))
    with kept.use(second.hash), kept.use(first.hash):
        third = send(kept, three)  # both others are in use
    names = {folder.name for folder in (tmp_path / "worker/shots").iterdir()}
    assert names == {first.hash, second.hash, third.hash}
    os.utime(tmp_path / "worker/shots" / second.hash, (1, 1))
    send(kept, shot(tmp_path / "four", root=b"tenth"))
    names = {folder.name for folder in (tmp_path / "worker/shots").iterdir()}
    assert second.hash not in names
    assert third.hash in names


def test_a_folder_that_cannot_be_written_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        ShotFiles(tmp_path / "file", 1)


def test_a_shot_that_is_given_up_leaves_nothing(kept, tmp_path):
    token = kept.begin()
    kept.receive(token, "root.usda", b"#usda")
    kept.abandon(token)
    assert list((tmp_path / "worker/parts").iterdir()) == []
