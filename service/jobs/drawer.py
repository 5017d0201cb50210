"""Drawer of frames on a machine of its own: sandboxed worker processes, and the files of the shots that they draw."""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from dataclasses import dataclass, field, replace
from pathlib import Path

from render.errors import PullfocusError
from service.hidden_folders import hide_folder, without_folders
from service.jobs.frame_work import FrameWork, end_of, may_pass
from service.jobs.shot_files import FileList, ShotFiles
from service.picture.cache_filling import fill_cache
from service.picture.calls import PRELOAD, frames, state
from service.picture.requests import DrawnFrame
from service.workers.caches import Caches
from service.workers.calls import call
from service.workers.errors import End, WorkerError
from service.workers.folders import default_cache_folder
from service.workers.forking import Template
from service.workers.jobs import Finished, observer
from service.workers.lane import Lane
from service.workers.output import JobOutput
from service.workers.places import Place
from service.workers.pool import WorkerPool
from service.workers.process import NotBegunError
from service.workers.roles import role
from service.workers.sandbox import Limits, worker_environment

log = logging.getLogger("pullfocus.worker")

MEBIBYTE = 1 << 20


@dataclass(frozen=True)
class DrawerSettings:
    """Limits of a machine that draws frames.

    Attributes:
        folder: of the shots that it keeps; no other drawer uses it.
        cache: folder of compiled shaders, tables and temporary files, which others may share.
        shots_mb: size of the shots that are kept, MiB.
        memory_mb: memory of a process that draws, MiB.
        disk_mb: space for the compiled shaders, tables and temporary files of one such process, MiB.
        timeout_s: time for one frame, s.
        read: folders beside a shot's own that a process may read, such as libraries of assets.
        gpus: GPUs that the processes are spread over; 0 leaves the choice to the driver.
    """

    folder: Path
    cache: Path = field(default_factory=default_cache_folder)
    shots_mb: int = 20_480
    memory_mb: int = 8192
    disk_mb: int = 2048
    timeout_s: float = 300.0
    read: tuple[Path, ...] = ()
    gpus: int = 0


@dataclass(frozen=True)
class DoneFrame:
    """A frame that was drawn.

    Attributes:
        frame: its files.
        cpu_s: processor time that it took, s.
        output: all that its process has written.
    """

    frame: DrawnFrame
    cpu_s: float
    output: str = ""


@dataclass(frozen=True)
class FailedFrame:
    """A frame that could not be drawn.

    Attributes:
        message: why, for people.
        may_pass: whether another try may succeed.
        end: why the process ended that drew it; None where it did not.
        cpu_s: processor time that it took, s.
        output: all that its process has written.
    """

    message: str
    may_pass: bool
    end: End | None
    cpu_s: float
    output: str = ""


@dataclass(frozen=True)
class MissingShot:
    """The answer of a machine that does not keep the shot of a frame."""


class Drawer:
    """Draws frames, one at a time.

    Args:
        settings: limits.

    Raises:
        OutputError: its folder cannot be written.
    """

    def __init__(self, settings: DrawerSettings) -> None:
        self._read = settings.read
        self.shots = ShotFiles(settings.folder, settings.shots_mb * MEBIBYTE)
        for folder in (settings.folder, settings.cache):  # what is told of a frame goes to other machines
            hide_folder(folder)
        environment = worker_environment(os.environ)
        self._caches = Caches(settings.cache, environment, settings.disk_mb * MEBIBYTE)
        self._pool = WorkerPool(
            Template(PRELOAD, environment),
            max_bytes=settings.memory_mb * MEBIBYTE,
            gpus=settings.gpus,
            caches=self._caches,
        )
        limits = Limits(
            memory_bytes=settings.memory_mb * MEBIBYTE,
            cpu_s=None,
            file_bytes=settings.disk_mb * MEBIBYTE,
            descriptors=512,
            processes=256,
        )
        self._lane: Lane[state.PictureWorkerState] = Lane(
            role("long", state.PictureWorkerState, limits, draws=True),
            self._pool,
            max_waiting=64,
            timeout_s=settings.timeout_s,
        )
        self._drawing: dict[str, asyncio.Task[DrawnFrame]] = {}
        self._outputs: dict[str, JobOutput] = {}
        self._filling = threading.Lock()

    def warm_up(self) -> None:
        """Compile the shaders that all shots need, where that was not done on this machine yet; a failure is logged."""
        with self._filling:
            try:
                self._caches.fill_base(lambda folder: fill_cache(self._pool.template, self._lane.role, folder))
            except (PullfocusError, WorkerError, NotBegunError, OSError) as error:
                log.warning(
                    "shaders cannot be compiled in advance, so that the first frame of a shot is late: %s", error
                )

    async def draw(self, work: FrameWork, files: FileList) -> DoneFrame | FailedFrame | MissingShot:
        """Draw a frame.

        Args:
            work: the frame.
            files: those of its shot.
        """
        finished: list[Finished] = []
        with self.shots.use(files.hash) as folder:
            if folder is None:
                return MissingShot()
            record = replace(work.request.record, folder=folder)
            wanted = call(frames.render_files, replace(work.request, record=record), work.formats)
            output = self._outputs[work.key] = JobOutput()
            token = observer.set(finished.append)
            drawing = asyncio.ensure_future(
                self._lane.result(
                    wanted,
                    Place(files.hash, (record.files, *self._read)),
                    work.client,
                    estimate_s=work.estimate_s,
                    output=output,
                )
            )
            observer.reset(token)
            self._drawing[work.key] = drawing
            drawing.add_done_callback(lambda _: output.end())
            try:
                return DoneFrame(await drawing, _cpu_s(finished), without_folders(output.text()))
            except asyncio.CancelledError:
                if not drawing.cancelled():
                    raise
                return FailedFrame("it was given up", True, None, _cpu_s(finished), without_folders(output.text()))
            except (PullfocusError, WorkerError, OSError) as error:
                message, told = without_folders(str(error)), without_folders(output.text())
                return FailedFrame(message, may_pass(error), end_of(error), _cpu_s(finished), told)
            finally:
                del self._drawing[work.key], self._outputs[work.key]

    def output(self, key: str) -> str:
        """Return what the process of a frame has written so far; nothing where it is not drawn now."""
        output = self._outputs.get(key)
        return "" if output is None else without_folders(output.text())

    def stop(self, key: str) -> None:
        """Give a frame up that is drawn, or waits. Does nothing where it has ended."""
        drawing = self._drawing.get(key)
        if drawing is not None:
            drawing.cancel()

    def close(self) -> None:
        """End the worker processes."""
        self._lane.close()
        self._pool.close()
        self._caches.close()


def _cpu_s(finished: list[Finished]) -> float:
    return sum(one.cpu_s for one in finished)
