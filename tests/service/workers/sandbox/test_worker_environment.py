"""Environment of a worker process."""

from __future__ import annotations

import os
from pathlib import Path

from service.workers.sandbox import cache_environment, worker_environment
from tests.service.workers.sandbox.confined import Confined


def _environment(**environ: str) -> dict[str, str]:
    return worker_environment(environ) | cache_environment(Path("/data/cache"))


def test_no_secret_reaches_a_worker() -> None:
    secrets = {
        "AWS_SECRET_ACCESS_KEY": "s",
        "PULLFOCUS_KEY": "s",
        "DATABASE_URL": "s",
        "PATH": "/s",
        "HOME": "/s",
        "USER": "s",
    }

    kept = _environment(**secrets)

    assert "s" not in kept.values()
    assert "/s" not in kept.values()
    assert kept == _environment()


def test_choices_of_the_administrator_reach_a_worker() -> None:
    chosen = {
        "LANG": "C.UTF-8",
        "LC_ALL": "C",
        "GALLIUM_DRIVER": "llvmpipe",
        "PULLFOCUS_NO_GPU": "1",
        "OCIO": "/etc/ocio/config.ocio",
    }

    assert _environment(**chosen).items() >= chosen.items()


def test_caches_and_temporary_files_go_where_a_worker_writes() -> None:
    kept = _environment(MESA_SHADER_CACHE_DIR="/s", XDG_CACHE_HOME="/s", TMPDIR="/s", PULLFOCUS_CACHE="/s")

    assert kept["XDG_CACHE_HOME"] == "/data/cache"
    assert kept["TMPDIR"] == "/data/cache"
    assert kept.keys().isdisjoint({"MESA_SHADER_CACHE_DIR", "PULLFOCUS_CACHE"})
    assert _environment(PULLFOCUS_CACHE="off")["PULLFOCUS_CACHE"] == "off"


def test_a_process_has_that_environment_alone(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path)
    expected = {**worker_environment(os.environ), **cache_environment(sandbox.cache), "PYTHONPATH": ""}

    (names,) = sandbox.output("print(*sorted(os.environ))")

    assert set(names.split()) - {"LC_CTYPE"} == expected.keys() - {
        "LC_CTYPE"
    }  # Python sets it where there is no locale
