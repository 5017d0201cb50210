"""A backup is one moment of each shot, also under edits; nothing that is damaged or hostile is restored."""

from __future__ import annotations

import fcntl
import gzip
import io
import json
import os
import shutil
import tarfile
import threading
from pathlib import Path
from tempfile import mkdtemp

import pytest

from render.errors import InputError, OutputError, PullfocusError
from render.model.edit_history import EditHistory
from render.removal import remove_tree
from service.http.settings import Settings
from service.storage import backup as backup_module
from service.storage.backup import back_up, edits_at_one_moment
from service.storage.edit_files import load_history, save_edits
from service.storage.restore import MANIFEST, restore
from service.storage.store import ShotStore
from tests.service.conftest import running

LAYOUT_1 = Path(__file__).parent / "layout_1"


@pytest.fixture
def data(tmp_path):
    folder = shutil.copytree(LAYOUT_1 / "data", tmp_path / "data")
    ShotStore(folder).close()  # brings it to the present layout
    (folder / "keys.json").write_text("{}")
    (folder / "keys.json").chmod(0o600)
    (folder / "audit.jsonl").write_text('{"what": "edit"}\n')
    (folder / "shots" / "half.part").write_text("being written")
    return folder


@pytest.fixture
def archive(data, tmp_path):
    back_up(data, tmp_path / "kept.tar.gz")
    return tmp_path / "kept.tar.gz"


def files_below(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_a_backup_holds_uploaded_files_of_any_name_and_depth(data, tmp_path):
    shot = next((data / "shots").glob("*/shot.json")).parent
    deep = shot / "files" / "/".join("d" * 900)
    deep.mkdir(parents=True)
    for file in (deep / "deep.txt", shot / "files" / "half.part"):
        file.write_text("uploaded")
    back_up(data, tmp_path / "kept.tar.gz")
    restore(tmp_path / "kept.tar.gz", tmp_path / "new")
    for file in (deep / "deep.txt", shot / "files" / "half.part"):
        assert (tmp_path / "new" / file.relative_to(data)).read_text() == "uploaded"
    for folder in (data, tmp_path / "new"):  # pytest's own removal recurses
        remove_tree(folder)


def test_a_backup_restores_every_file(data, archive, tmp_path):
    restored = tmp_path / "new" / "data"
    count = restore(archive, restored)
    expected = {name: text for name, text in files_below(data).items() if name not in ("lock", "shots/half.part")}
    assert files_below(restored) == expected
    assert count == len(expected) > 15
    assert (restored / "keys.json").stat().st_mode & 0o777 == 0o600
    assert archive.stat().st_mode & 0o777 == 0o600
    assert all((shot / "edits").is_dir() for shot in (restored / "shots").iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["data", "kept.tar.gz", "new"]


def test_a_service_goes_on_with_a_restored_folder(tmp_path):
    answers = json.loads((LAYOUT_1 / "answers.json").read_text())
    shutil.copytree(LAYOUT_1 / "data", tmp_path / "old")
    with running(Settings(data=tmp_path / "old", demo=False)):
        back_up(tmp_path / "old", tmp_path / "b.tar.gz")  # while it runs
    restore(tmp_path / "b.tar.gz", tmp_path / "new")
    with running(Settings(data=tmp_path / "new", demo=False)) as service:
        for shot, then in answers.items():
            assert service.client.get(f"/v1/shots/{shot}/edits").text == then["edits"]
            assert service.client.get(f"/v1/shots/{shot}/edits/history").json()["undo"] == then["history"]["undo"]


def test_edits_are_of_one_moment_while_they_are_written(tmp_path):
    folder, ended = tmp_path / "edits", threading.Event()
    folder.mkdir()

    def state(number):
        history = EditHistory.beginning_with(f"#usda {number}\n" * 50)
        return history.after(f"#usda {number} after\n" * 50, "edit", "")

    def write():
        for number in range(100_000):
            if ended.is_set():
                return
            save_edits(folder, state(number), state(max(0, number - 1)))  # drops the states of the one before that

    writer = threading.Thread(target=write)
    writer.start()
    seen: set[str] = set()
    try:
        while not (folder / "edits.usda").is_file():
            pass
        while len(seen) < 10:
            copy = Path(mkdtemp(dir=tmp_path))
            for name, content in edits_at_one_moment(folder).items():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                (copy / name).write_bytes(content)
            history = load_history(copy)
            assert history is not None
            seen.add(history.present.revision)
    finally:
        ended.set()
        writer.join()


def test_a_missing_state_is_named_and_no_backup_is_left(data, tmp_path, monkeypatch):
    monkeypatch.setattr(backup_module, "_ATTEMPTS", 3)
    next((data / "shots").glob("room-*/edits/history/*.usda")).unlink()
    with pytest.raises(InputError, match="a state of their history is missing"):
        back_up(data, tmp_path / "b.tar.gz")
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_links_that_a_worker_left_are_not_followed(data, tmp_path):
    (tmp_path / "secret.usda").write_text("secret")
    edits = next((data / "shots").glob("untouched-*/edits"))
    (edits / "edits.usda").symlink_to(tmp_path / "secret.usda")
    index = {"now": 0, "states": [{"revision": "../../../../../secret"}]}
    (edits / "history").mkdir()
    (edits / "history" / "index.json").write_text(json.dumps(index))
    os.mkfifo(data / "shots" / "pipe")
    back_up(data, tmp_path / "b.tar.gz")
    assert b"secret" not in gzip.decompress((tmp_path / "b.tar.gz").read_bytes()).replace(b"/secret", b"")


def test_a_folder_that_is_not_empty_is_not_restored_over(archive, data):
    before = files_below(data)
    with pytest.raises(OutputError, match="is not empty"):
        restore(archive, data)
    assert files_below(data) == before


def test_an_archive_that_is_cut_or_changed_is_refused(archive, tmp_path):
    whole = archive.read_bytes()
    plain = gzip.decompress(whole)
    at = plain.index(b'def Camera "cam"')
    damaged = [whole[:n] for n in (0, 10, 200, len(whole) // 2, len(whole) - 600)]
    damaged.append(gzip.compress(plain[:at] + b"X" + plain[at + 1 :]))
    damaged.append(gzip.compress(plain[: plain.index(MANIFEST.encode())]))
    for number, content in enumerate(damaged):
        bad = tmp_path / f"{number}.tar.gz"
        bad.write_bytes(content)
        with pytest.raises(InputError):
            restore(bad, tmp_path / "restored")
    assert not (tmp_path / "restored").exists()
    assert not list(tmp_path.glob(".restored*"))


def hostile(path, *members):
    """Write an archive of members with a true manifest."""
    with tarfile.open(path, "w:gz") as tar:
        for member in members:
            tar.addfile(member, io.BytesIO(b"x" * member.size))
        text = json.dumps({"format": 1, "files": {}}).encode()
        manifest = tarfile.TarInfo(MANIFEST)
        manifest.size = len(text)
        tar.addfile(manifest, io.BytesIO(text))


def member(name, kind=tarfile.REGTYPE, target=""):
    info = tarfile.TarInfo(name)
    info.type, info.linkname, info.size = kind, target, 1 if kind == tarfile.REGTYPE else 0
    return info


@pytest.mark.parametrize(
    "members",
    [
        [member("../out")],
        [member("/tmp/out")],
        [member("a/../../out")],
        [member("a//b")],
        [member("./a")],
        [member("link", tarfile.SYMTYPE, "/etc")],
        [member("link", tarfile.SYMTYPE, ".."), member("link/out")],
        [member("link", tarfile.LNKTYPE, "/etc/passwd")],
        [member("pipe", tarfile.FIFOTYPE)],
        [member("disk", tarfile.BLKTYPE)],
        [member("tty", tarfile.CHRTYPE)],
        [member("a"), member("a")],
        [member("a"), member("a/b")],
        [member("unlisted")],
        [],
    ],
    ids=lambda members: " ".join(f"{m.name}:{m.type.decode()}" for m in members) or "no layout",
)
def test_hostile_members_are_refused(tmp_path, members):
    bad = tmp_path / "in" / "bad.tar.gz"
    bad.parent.mkdir()
    hostile(bad, *members)
    if members:
        with pytest.raises(PullfocusError):
            restore(bad, tmp_path / "in" / "restored")
        assert [path.name for path in bad.parent.iterdir()] == ["bad.tar.gz"]
    else:
        assert restore(bad, tmp_path / "in" / "restored") == 0
    assert [path.name for path in tmp_path.iterdir()] == ["in"]


def test_a_manifest_nested_deeply_is_refused(tmp_path):
    bad = tmp_path / "bad.tar.gz"
    with tarfile.open(bad, "w:gz") as tar:
        manifest = tarfile.TarInfo(MANIFEST)
        manifest.size = 200_000
        tar.addfile(manifest, io.BytesIO(b"[" * manifest.size))
    with pytest.raises(InputError, match="no backup, or is damaged"):
        restore(bad, tmp_path / "restored")


def test_edits_with_an_index_nested_deeply_are_backed_up(data, tmp_path):
    history = next((data / "shots").glob("untouched-*/edits")) / "history"
    history.mkdir()
    (history / "index.json").write_text("[" * 200_000)  # by a worker that a file has taken over
    back_up(data, tmp_path / "b.tar.gz")
    restore(tmp_path / "b.tar.gz", tmp_path / "restored")
    restored = tmp_path / "restored" / history.relative_to(data) / "index.json"
    assert restored.read_text() == "[" * 200_000


def test_a_member_that_would_fill_the_disk_is_refused(tmp_path):
    sparse = member("a")
    sparse.pax_headers = {"GNU.sparse.major": "1", "GNU.sparse.minor": "0", "GNU.sparse.realsize": str(1 << 26)}
    sparse.size = 512
    bad = tmp_path / "bad.tar.gz"
    with tarfile.open(bad, "w:gz", format=tarfile.PAX_FORMAT) as tar:
        tar.addfile(sparse, io.BytesIO(b"0\n".ljust(512, b"\0")))
    with pytest.raises(InputError, match="'a' has holes"):
        restore(bad, tmp_path / "restored")


def test_a_member_in_folders_without_end_is_refused(tmp_path):
    hostile(tmp_path / "bad.tar.gz", member("d/" * 1500 + "f"))
    with pytest.raises(InputError, match="no backup, or is damaged"):
        restore(tmp_path / "bad.tar.gz", tmp_path / "restored")


def test_a_folder_without_shots_is_no_data_folder(tmp_path):
    with pytest.raises(InputError, match="no data folder"):
        back_up(tmp_path, tmp_path / "b.tar.gz")


def test_a_backup_of_a_newer_layout_is_refused(data, archive, tmp_path):
    (data / "layout.json").write_text('{"layout": 99}')
    with pytest.raises(OutputError, match="newer"):
        back_up(data, tmp_path / "b.tar.gz")


def test_what_a_killed_restoration_left_is_removed(archive, tmp_path):
    left, working = tmp_path / ".again.abc.part", tmp_path / ".again.def.part"
    for folder in (left, working, tmp_path / ".again.part"):
        (folder / "shots").mkdir(parents=True)
    lock = os.open(working, os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    restore(archive, tmp_path / "again")
    os.close(lock)
    assert sorted(path.name for path in tmp_path.glob(".again*")) == [".again.def.part", ".again.part"]
