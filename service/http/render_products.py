"""Files of the products of renders: movies and contact sheets, which are made of stored frames, and reports, which need none.

The name of a file has a hash of what it is made of, so that it is made anew only once this has changed; the file of before is
then removed.
"""

from __future__ import annotations

import asyncio
import hashlib
import threading
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from weakref import WeakValueDictionary

from starlette.concurrency import run_in_threadpool

from render.files import write_atomic
from service.http.clients import present_client
from service.http.errors import ServiceError
from service.http.quotas import Quotas
from service.jobs.files import FrameFiles
from service.jobs.queue import RenderQueue
from service.jobs.states import state_of
from service.models.render_products import ProductName
from service.picture.calls import state as picture_state
from service.storage.database.tables import RenderRow
from service.workers.calls import Call
from service.workers.lane import Lane
from service.workers.places import Place

GRADED = ("png", "jpeg")
"""Formats that products are made of, the best one first."""
VERSION = 1
"""Changes where the same frames give another product than before."""

Frames = list[tuple[int, Path]]
"""Frames in rising order, and their graded pictures."""
MakeCall = Callable[[Frames, Path], Call[picture_state.PictureWorkerState, None]]
"""Makes the call that writes a product of frames to a file."""
Write = Callable[[], Awaitable[str]]
"""Writes the text of a product that needs no frames."""


@dataclass(frozen=True)
class Product:
    """A product that is stored.

    Attributes:
        path: its file.
        etag: changes with the frames.
    """

    path: Path
    etag: str


@dataclass(frozen=True)
class RenderProducts:
    """The products of all renders.

    Attributes:
        lane: of the workers that make them.
        queue: the renders.
        files: their frames.
        quotas: judge what senders and projects may use.
    """

    lane: Lane[picture_state.PictureWorkerState]
    queue: RenderQueue
    files: FrameFiles
    quotas: Quotas
    _keeping: threading.Lock = field(default_factory=threading.Lock)
    _making: WeakValueDictionary[Path, asyncio.Lock] = field(default_factory=WeakValueDictionary)

    async def find(self, render: RenderRow, name: ProductName, make_call: MakeCall) -> Product:
        """Return a product of frames, which is made where it is missing.

        Args:
            render: its frames have ended.
            name: of the product.
            make_call: makes the call that writes it.

        Raises:
            ServiceError: 409, the render is under way, or has no graded frames; 404, a frame is gone; 403, the project has
                no room.
            PullfocusError: the product cannot be made.
            WorkerError: the worker ended, or took too long.
        """
        frames, digest = await run_in_threadpool(self._frames_of, render)

        async def make(path: Path) -> None:
            self.quotas.check_work()
            place = Place(read=(path.parent.parent,), write=(path.parent,))
            await self.lane.result(make_call(frames, path), place, present_client())

        return await self._find(render, name, digest, make)

    async def find_text(self, render: RenderRow, name: ProductName, write: Write) -> Product:
        """Return a product that needs no frames, which is made where it is missing.

        Args:
            render: the render.
            name: of the product.
            write: writes its text.

        Raises:
            ServiceError: 403, the project has no room.
            OutputError: it cannot be stored.
            Exception: as `write`.
        """

        async def make(path: Path) -> None:
            text = await write()
            await run_in_threadpool(write_atomic, path, text.encode())

        return await self._find(render, name, _digest_of(render), make)

    def stored(self, render: RenderRow, name: ProductName) -> Product | None:
        """Return a product that needs no frames where it was made; None where it was not."""
        digest = _digest_of(render)
        path = self._path(render, name, digest)
        return Product(path, f'"{digest}"') if path.is_file() else None

    async def _find(
        self, render: RenderRow, name: ProductName, digest: str, make: Callable[[Path], Awaitable[None]]
    ) -> Product:
        path = self._path(render, name, digest)
        lock = self._making.setdefault(path, asyncio.Lock())
        async with lock:
            if not await run_in_threadpool(path.is_file):
                await run_in_threadpool(path.parent.mkdir, parents=True, exist_ok=True)
                _remove_unfinished(path)
                try:
                    await make(path)
                finally:
                    _remove_unfinished(path)
                await run_in_threadpool(self._keep, render, path)
        return Product(path, f'"{digest}"')

    def _path(self, render: RenderRow, name: ProductName, digest: str) -> Path:
        kind, _, suffix = name.replace("contact-sheet", "sheet").partition(".")
        return self.files.products(render.id).resolve() / f"{kind}.{digest}.{suffix}"

    def _keep(self, render: RenderRow, path: Path) -> None:
        """Remove the product of before, and count the new one. Raises `ServiceError` 403: the project has no room for it."""
        with self._keeping:
            self._count(render, path)

    def _count(self, render: RenderRow, path: Path) -> None:
        name, _, suffix = path.name.split(".")
        for old in path.parent.glob(f"{name}.*.{suffix}"):
            if old != path:
                old.unlink(missing_ok=True)
        if not self.files.counts_products:
            return
        size = path.stat().st_size
        total = sum(_size_of(each) for each in path.parent.iterdir())
        self.queue.products.note_size(render.id, total - size)  # what was there before counts no longer
        try:
            self.quotas.check_room(render.project, size)
        except ServiceError:
            path.unlink(missing_ok=True)
            raise
        self.queue.products.note_size(render.id, total)

    def _frames_of(self, render: RenderRow) -> tuple[Frames, str]:
        """Return the graded frames of a render that has ended, and a hash of them and of what else products depend on."""
        if render.ready + render.running > 0:
            detail = f"Render {render.id!r} has not ended: it is {state_of(render)}."
            raise ServiceError(409, "render_not_ended", detail, path="render")
        suffix = next((name for name in GRADED if name in render.request["formats"]), None)
        if suffix is None:
            detail = (
                f"Render {render.id!r} has no graded frames, of which movies and contact sheets are made: send it with "
                '"formats": ["exr", "png"].'
            )
            raise ServiceError(409, "no_graded_frames", detail, path="render")
        files, frames = self.files, []
        digest = hashlib.sha256(repr((VERSION, render.name, render.time_codes_per_second)).encode())
        for task, _ in self.queue.tasks(render.id):
            if task.state != "done":
                continue
            entry = task.files.get(suffix)
            path = files.find(render.id, task.frame, task.attempts, suffix, entry)
            if entry is None or path is None:
                raise frame_file_gone(render.id, task.frame)
            frames.append((task.frame, path.resolve()))
            digest.update(f"{task.frame} {entry['sha256']}\n".encode())
        if not frames:
            raise ServiceError(
                409, "no_graded_frames", f"Render {render.id!r} has ended without a frame.", path="render"
            )
        return frames, digest.hexdigest()[:32]


def _digest_of(render: RenderRow) -> str:
    """Return a hash of what a product depends on that needs no frames: a render keeps its edits."""
    return hashlib.sha256(repr((VERSION, render.id, render.revision, render.frames)).encode()).hexdigest()[:32]


def _size_of(path: Path) -> int:
    """Return the size of a product, bytes; 0 for what is written meanwhile, whose name is hidden, or was removed."""
    if not path.name.startswith("."):
        with suppress(FileNotFoundError):
            return path.stat().st_size
    return 0


def _remove_unfinished(path: Path) -> None:
    """Remove what a worker that was ended has left of a product."""
    for part in path.parent.glob(f".{path.name}.*.part"):
        part.unlink(missing_ok=True)


def frame_file_gone(render_id: str, frame: int) -> ServiceError:
    """Return the error that the file of a frame is gone or damaged."""
    detail = f"The file of frame {frame} of render {render_id!r} is gone or damaged; retry the render to draw it again."
    return ServiceError(404, "frame_file_gone", detail, path="frame")
