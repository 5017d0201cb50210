"""The cache folder of a worker, as the worker itself sees it; see `service.workers.caches`."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from pathlib import Path

from service.workers.sandbox import cache_environment


def begin_cache(folder: Path, base: Path | None) -> None:
    """Have the libraries of this process use a cache folder. Runs in the worker.

    Args:
        folder: the folder, which is empty.
        base: what it begins as a copy of; None for nothing.
    """
    os.environ.update(cache_environment(folder))
    tempfile.tempdir = str(folder)
    if base is not None:
        with suppress(OSError):  # what cannot be copied is made again
            _copy(base, folder)


def _copy(source: Path, target: Path) -> None:
    """Copy the files of a folder, each whole or not at all: a sandbox sets no modes or times, as `shutil.copytree` would."""
    for entry in list(os.scandir(source)):
        copy = target / entry.name
        if entry.is_dir(follow_symlinks=False):
            copy.mkdir()
            _copy(Path(entry.path), copy)
            continue
        try:
            copy.write_bytes(Path(entry.path).read_bytes())
        except OSError:
            copy.unlink(missing_ok=True)
            raise
