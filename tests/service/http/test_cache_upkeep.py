"""The caches of a service's workers: shaders are compiled once for all shots, and a service that cannot do so still works."""

from __future__ import annotations

import logging
import os
import signal
from contextlib import suppress
from pathlib import Path

import pytest

from service.http import cache_upkeep
from service.http.settings import Settings
from service.picture import cache_filling
from tests.service.conftest import ROOM, Running, running, send, until

FRAME = {"time": 1, "width": 64, "height": 36, "rays": 8}


def compiled_for(service: Running, shot: str) -> int:
    """Draw a frame of a shot, and count the entries of its worker's cache that it did not begin with."""
    assert service.client.get(f"/v1/shots/{shot}/frame", params=FRAME).status_code == 200
    (own,) = [process.cache for process in service.internal.pool.processes() if process.place.key == shot]
    base = service.internal.caches.base
    held = entries_of(base) if base is not None else set()
    assert held <= entries_of(own)
    return len(entries_of(own) - held)


def entries_of(folder: Path) -> set[Path]:
    return {file.relative_to(folder) for file in folder.rglob("mesa_shader_cache/??/*")}


def upload(service: Running) -> str:
    return send(service.client, "room.usda", ROOM.encode()).json()["id"]


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    """Let the shaders be compiled as if no user worked meanwhile, however busy the machine of the tests is."""
    monkeypatch.setattr(cache_filling, "NICENESS", 0)


def test_a_new_shot_begins_with_the_shaders_of_all_shots(tmp_path):
    with running(Settings(data=tmp_path / "data", demo=False, cache=tmp_path / "cache")) as service:
        alone = compiled_for(service, upload(service))
        assert service.client.get("/readyz").json() == {"status": "ok", "warming": True}
        until(lambda: service.internal.caches.base is not None)
        assert compiled_for(service, upload(service)) < alone / 2
        base = service.internal.caches.base
        assert not (base / "shot").exists()
        until(lambda: service.client.get("/readyz").json() == {"status": "ok", "warming": False})
    assert list((tmp_path / "cache").iterdir()) == [base]


def test_a_service_without_compiled_shaders_works(tmp_path, monkeypatch, caplog):
    tries: list[Path] = []

    def die(template: object, role: object, folder: Path, work: object) -> None:
        tries.append(folder)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(cache_filling, "_run", die)
    monkeypatch.setattr(cache_upkeep, "RETRY_S", 0.1)
    caplog.set_level(logging.WARNING, "pullfocus.service")
    with running(Settings(data=tmp_path / "data", demo=False, cache=tmp_path / "cache")) as service:
        until(lambda: len(tries) > 2)
        assert compiled_for(service, upload(service)) > 0
        assert service.internal.caches.base is None
    warnings = [record.message for record in caplog.records if "in advance" in record.message]
    assert len(warnings) == 1
    assert "No space left on device" in warnings[0]


def test_a_killed_worker_leaves_no_half_filled_base(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(cache_upkeep, "RETRY_S", 0.1)
    monkeypatch.setattr(cache_filling, "PASSES", 1)
    with running(Settings(data=tmp_path / "data", demo=False, cache=tmp_path / "cache")) as service:
        until(lambda: any((tmp_path / "cache").glob("run-*/base/mesa_shader_cache/*")))
        os.kill(service.internal.pool.template.pid, signal.SIGKILL)  # and all workers with it
        until(lambda: "in advance" in caplog.text)
        assert service.internal.caches.base is None
        until(
            lambda: any((tmp_path / "cache").glob("run-*/base/mesa_shader_cache/*"))
        )  # filled anew, from the beginning


def test_a_machine_without_a_driver_says_so_once(tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
    with running(Settings(data=tmp_path / "data", demo=False, cache=tmp_path / "cache")) as service:
        until(lambda: "in advance" in caplog.text)
        assert send(service.client, "room.usda", ROOM.encode()).status_code == 201
        assert service.internal.caches.base is None
    assert caplog.text.count("in advance") == 1
    with suppress(FileNotFoundError):
        assert list((tmp_path / "cache").iterdir()) == []
