"""Filling of the cache that the workers which draw begin with: the demo shot is drawn, so that the driver keeps its shaders."""

from __future__ import annotations

import os
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from service.picture.calls import state, warming
from service.workers.calls import Call, call
from service.workers.folders import remove_tree
from service.workers.forking import Template
from service.workers.places import NOWHERE
from service.workers.process import WorkerProcess
from service.workers.roles import Role

Reply = TypeVar("Reply")

FILL_S = 300.0
"""Time that one drawing of the demo shot may take."""
PASSES = 2
"""Times that it is drawn: a driver compiles some shaders in another way where it finds others compiled."""
NICENESS = 15
"""Priority of the worker that draws it: users come first."""


def fill_cache(template: Template, role: Role[Any], folder: Path) -> None:
    """Have a cache folder filled by workers that see nothing else.

    Args:
        template: forks them.
        role: of workers that draw.
        folder: of the cache.

    Raises:
        PullfocusError: nothing can be drawn on this machine.
        WorkerError: a worker did not complete its work.
        OSError: the folder cannot be written.
    """
    filling = replace(role, name="warming", niceness=NICENESS)
    shot = folder / "shot"
    shot.mkdir(mode=0o700)
    root = shot / _run(template, filling, folder, call(warming.write_shot, shot))
    for _ in range(PASSES):
        _run(template, filling, folder, call(warming.draw, root))
    remove_tree(shot)


def _run(template: Template, role: Role[Any], folder: Path, work: Call[state.PictureWorkerState, Reply]) -> Reply:
    """Run a call in a worker of its own, which ends with it."""
    process: WorkerProcess[state.PictureWorkerState] = WorkerProcess(template, role, NOWHERE, cache=folder)
    limit = threading.Timer(FILL_S, process.kill, ["timeout"])
    limit.start()
    try:
        return process.call(work, FILL_S * (os.cpu_count() or 1))
    finally:
        limit.cancel()
        process.close()
