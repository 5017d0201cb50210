"""Frames of renders and their shots in a bucket that two services share."""

from __future__ import annotations

import os
import time

import pytest

from render.errors import InputError, SettingsError
from service.jobs import shot_archive
from service.jobs.files import FolderFiles
from service.jobs.shared_storage import SharedStorage
from service.storage.bucket import Bucket
from service.storage.database.tables import TaskRow


@pytest.fixture
def storage(bucket, tmp_path):
    """Opens the storage of one more service."""

    def opened(name: str, fetched_bytes: int = 1 << 20) -> SharedStorage:
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        return SharedStorage.open(Bucket(bucket["bucket"], bucket["bucket_endpoint"]), folder, fetched_bytes)

    return opened


def task(frame: int, files: dict, state: str = "done", attempts: int = 1) -> TaskRow:
    return TaskRow(render="r-1", frame=frame, state=state, attempts=attempts, files=files)


def test_a_frame_of_one_service_is_found_by_another(storage):
    first, second = storage("first").frames, storage("second").frames
    entry = first.write("r-1", 7, 2, "png", b"picture")
    assert entry == first.write("r-1", 7, 2, "png", b"picture")  # twice does no harm
    assert second.find("r-1", 7, 2, "png", entry).read_bytes() == b"picture"
    assert second.find("r-1", 7, 1, "png", entry) is None
    assert second.find("r-1", 7, 2, "png", None) is None
    damaged = entry | {"sha256": "0" * 64}
    assert first.find("r-1", 7, 2, "png", damaged) is None


def test_a_copy_is_kept_until_it_is_old(storage):
    frames = storage("one").frames
    entry = frames.write("r-1", 1, 1, "png", b"picture")
    copy = frames.find("r-1", 1, 1, "png", entry)
    made = copy.stat().st_ino
    assert frames.find("r-1", 1, 1, "png", entry).stat().st_ino == made
    frames.forget_copies(60)
    assert copy.exists()
    os.utime(copy, times=(time.time() - 61,) * 2)
    frames.forget_copies(60)
    assert not copy.exists()
    assert frames.find("r-1", 1, 1, "png", entry) == copy


def test_frames_that_are_lost_are_named(storage):
    frames = storage("one").frames
    whole = {"png": frames.write("r-1", 1, 1, "png", b"picture")}
    short = {"png": frames.write("r-1", 2, 1, "png", b"picture") | {"size_bytes": 99}}
    gone = {"png": frames.write("r-1", 3, 1, "png", b"picture")}
    frames.remove_attempt("r-1", 3, 1, ["png", "exr"])
    assert frames.lost("r-1", [task(1, whole), task(2, short), task(3, gone), task(4, {}, "ready")]) == [2, 3]


def test_a_render_is_removed_with_its_copies(storage, tmp_path):
    one = storage("one")
    for render in ("r-1", "r-11"):
        entry = one.frames.write(render, 1, 1, "png", b"picture")
        one.frames.find(render, 1, 1, "png", entry)
    assert one.frames.render_ids() == {"r-1", "r-11"}
    one.frames.set_aside("r-1")
    one.frames.remove("r-1")
    assert one.bucket.sizes("renders") == {"r-11/1.1.png": entry["size_bytes"]}
    assert [path.name for path in (tmp_path / "one").rglob("*.png")] == ["1.1.png"]


def test_frames_from_before_the_bucket_stay_and_are_found(storage, tmp_path):
    entry = FolderFiles(tmp_path / "one").write("r-1", 1, 1, "png", b"picture")
    frames = storage("one").frames
    path = frames.find("r-1", 1, 1, "png", entry)
    assert path == tmp_path / "one" / "renders" / "r-1" / "1.1.png"
    os.utime(path, times=(1.0, 1.0))
    frames.forget_copies(60)
    assert frames.lost("r-1", [task(1, {"png": entry}), task(2, {"png": entry})]) == [2]
    frames.set_aside("r-1")
    frames.remove("r-1")
    assert not path.exists()


def test_a_bucket_belongs_to_one_database(storage):
    first, second = storage("first"), storage("second")
    first.claim("one")
    second.claim("one")
    with pytest.raises(SettingsError, match="belongs to another database"):
        second.claim("two")


@pytest.fixture
def shot(tmp_path):
    files = tmp_path / "shot" / "files"
    (files / "textures").mkdir(parents=True)
    (files / "shot.usda").write_bytes(b"#usda 1.0\n")
    for name in ("a b", "c%20d é"):
        (files / "textures" / name).write_bytes(b"pixels")
    (files / "empty.txt").touch()
    return files


def contents(folder) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_shot_of_one_service_is_fetched_by_another(storage, shot):
    first, second = storage("first"), storage("second")
    shot_hash = first.shots.store(shot)
    assert len(first.bucket.sizes("shots")) == 4  # its list, and three contents
    for _ in range(2):
        second.shots.fetch(shot_hash)
        with second.shots.use(shot_hash) as folder:
            assert contents(folder / "files") == contents(shot)


def test_a_shot_that_is_there_is_not_stored_again(storage, shot, monkeypatch):
    shots = storage("one").shots
    shot_hash = shots.store(shot)
    monkeypatch.setattr(Bucket, "put", lambda *_: pytest.fail("it is stored again"))
    assert shots.store(shot) == shot_hash


def test_a_damaged_shot_is_refused(storage, shot, tmp_path):
    one = storage("one")
    shot_hash = one.shots.store(shot)
    for name in (n for n in one.bucket.sizes(f"shots/{shot_hash}") if n != "files.json"):
        one.bucket.put(f"shots/{shot_hash}/{name}", b"other")
    with pytest.raises(InputError, match="not received as it was sent"):
        one.shots.fetch(shot_hash)
    one.bucket.put(f"shots/{shot_hash}/files.json", b'[["../../out", 5, "x"]]')
    with pytest.raises(InputError, match="gone from the bucket, or damaged"):
        one.shots.fetch(shot_hash)
    with pytest.raises(InputError, match="gone from the bucket"):
        one.shots.fetch("0" * 32)
    assert list((tmp_path / "one" / "fetched" / "parts").iterdir()) == []


def test_shots_that_no_render_needs_are_removed_later(storage, shot, monkeypatch):
    one = storage("one")
    needed = one.shots.store(shot)
    (shot / "shot.usda").write_bytes(b"#usda 1.0\n# another")
    other = one.shots.store(shot)
    one.shots.forget([needed])
    assert set(one.bucket.folders("shots")) == {needed, other}  # too young
    monkeypatch.setattr(shot_archive, "KEPT_S", -1.0)
    one.shots.forget([needed])
    assert one.bucket.folders("shots") == [needed]


def test_a_shot_that_is_being_stored_is_not_removed(storage, shot, monkeypatch):
    one = storage("one")
    stored = one.shots.store(shot)
    one.bucket.delete([f"shots/{stored}/files.json"])  # as it was when another service was killed, or is on it now
    names = sorted(one.bucket.sizes(f"shots/{stored}"))
    ages = {f"shots/{stored}/{name}": 10 * shot_archive.KEPT_S for name in names[:-1]}
    monkeypatch.setattr(Bucket, "age_s", lambda _, name: ages.get(name, 1.0))
    one.shots.forget([])
    assert one.bucket.folders("shots") == [stored]
    ages |= {f"shots/{stored}/{name}": 10 * shot_archive.KEPT_S for name in names}
    one.shots.forget([])
    assert one.bucket.folders("shots") == []


def test_what_is_missing_of_a_shot_is_stored_again(storage, shot):
    one = storage("one")
    stored = one.shots.store(shot)
    name = next(name for name in one.bucket.sizes(f"shots/{stored}") if name != "files.json")
    one.bucket.delete([f"shots/{stored}/{name}"])
    assert one.shots.store(shot) == stored
    assert name in one.bucket.sizes(f"shots/{stored}")


def test_a_shot_that_is_drawn_is_not_forgotten(storage, shot, tmp_path):
    one = storage("one", fetched_bytes=1)
    first = one.shots.store(shot)
    one.shots.fetch(first)
    with one.shots.use(first):
        (shot / "shot.usda").write_bytes(b"#usda 1.0\n# another")
        second = one.shots.store(shot)
        one.shots.fetch(second)
        with one.shots.use(second) as folder:
            assert folder is not None
    kept = {path.name for path in (tmp_path / "one" / "fetched" / "shots").iterdir()}
    assert kept == {first, second}
