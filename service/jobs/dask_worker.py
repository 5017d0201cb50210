"""Functions that run on Dask's workers: they draw frames and receive the files of shots.

A worker is a process of `pullfocus worker`, or of a cluster on this machine. Its drawer is made when it is first needed.
"""

from __future__ import annotations

import asyncio
import atexit
import threading
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from service.jobs.drawer import DoneFrame, Drawer, DrawerSettings, FailedFrame, MissingShot
from service.jobs.frame_work import FrameWork
from service.jobs.shot_files import FileList

if TYPE_CHECKING:
    from distributed import Worker

_drawer: Drawer | None = None
_lock = threading.Lock()


def start_drawer(settings: DrawerSettings) -> Drawer:
    """Make the drawer of this process. Raises `OutputError`: its folder cannot be written."""
    global _drawer
    with _lock:
        if _drawer is None:
            _drawer = Drawer(settings)
            atexit.register(_drawer.close)
        return _drawer


async def greet(read: Sequence[str], dask_worker: Worker) -> str:
    """Make sure that there is a drawer, and return the version of the program.

    Args:
        read: folders beside a shot's own that may be read, where the drawer is made now.
        dask_worker: given by Dask.
    """
    if _drawer is None:
        folder = Path(dask_worker.local_directory) / "pullfocus"  # Dask removes it with the worker
        drawer = await asyncio.to_thread(start_drawer, DrawerSettings(folder, read=tuple(map(Path, read))))
        threading.Thread(target=drawer.warm_up, daemon=True).start()
    return version("pullfocus")


async def draw(work: FrameWork, files: FileList) -> DoneFrame | FailedFrame | MissingShot:
    """Draw a frame; see `service.jobs.drawer.Drawer.draw`."""
    return await _own_drawer().draw(work, files)


async def stop(key: str) -> None:
    """Give a frame up."""
    _own_drawer().stop(key)


async def read_output(key: str) -> str:
    """Return what the process of a frame has written so far."""
    return _own_drawer().output(key)


async def begin_shot() -> str:
    """Begin to receive a shot; see `service.jobs.shot_files.ShotFiles`."""
    return await asyncio.to_thread(_own_drawer().shots.begin)


async def receive_part(token: str, path: str, content: bytes) -> None:
    """Receive a part of a file."""
    await asyncio.to_thread(_own_drawer().shots.receive, token, path, content)


async def abandon_shot(token: str) -> None:
    """Drop what was received of a shot."""
    await asyncio.to_thread(_own_drawer().shots.abandon, token)


async def end_shot(token: str, files: FileList) -> None:
    """Keep a shot that was received."""
    await asyncio.to_thread(_own_drawer().shots.end, token, files)


def _own_drawer() -> Drawer:
    if _drawer is None:
        raise RuntimeError("the worker was not greeted")
    return _drawer
