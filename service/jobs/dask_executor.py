"""Executor that has frames drawn by the workers of a Dask scheduler, or of a cluster on this machine.

Dask carries calls and answers, no more. Which frame is next and which is tried again are the queue's business: at most two frames
are with a worker, each is bound to it, and none is stolen or tried again by Dask. A worker that the scheduler no longer has has
lost its frames. Cancelling a task of Dask does not end what its worker does, so that the worker is told to stop.
"""

from __future__ import annotations

import asyncio
import logging
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

from render.errors import SettingsError
from service.jobs import dask_worker
from service.jobs.drawer import DoneFrame, FailedFrame, MissingShot
from service.jobs.frame_logs import FrameLog
from service.jobs.frame_work import FrameError, FrameWork, LostFrameError
from service.jobs.shot_files import PART_BYTES, FileList, list_files, read_part
from service.picture.requests import DrawnFrame
from service.storage.store import ShotRecord
from service.workers.errors import BLAMED, End
from service.workers.jobs import Client

log = logging.getLogger("pullfocus.service")

PLACES = 2
"""Frames that may be with a worker: one that it draws, and one that is there when that one is done."""
LOOK_PAUSE_S = 1.0
"""Time between two looks at which workers there are."""
ANSWER_S = 10.0
"""Time that a scheduler or worker has to answer, s."""
CALL_S = 60.0
"""Time that a worker has for a call beside its frames, s."""
THREADS = 4
"""Calls that a worker may run at a time; the drawing itself is one at a time."""
SENDS = 3
"""Times that a shot is sent to a worker that has forgotten it meanwhile."""
MOST_LISTS = 256
"""Shots whose lists of files are remembered."""
_LOCAL = re.compile(r"local(?::([1-9][0-9]?))?")
_REMOTE = re.compile(r"(tcp|tls|ws|wss)://([^\s/:]+|\[[0-9a-fA-F:]+\]):[0-9]{1,5}")


@dataclass(frozen=True)
class DaskAddress:
    """Where frames are drawn.

    Attributes:
        scheduler: address of a scheduler; None for a cluster on this machine.
        workers: of that cluster.
    """

    scheduler: str | None
    workers: int = 1

    @classmethod
    def parse(cls, text: str) -> DaskAddress:
        """Read an address: ``tcp://HOST:PORT``, ``tls://HOST:PORT``, ``local`` or ``local:WORKERS``. Raises `SettingsError`."""
        local = _LOCAL.fullmatch(text)
        if local:
            return cls(None, int(local[1] or 1))
        if not _REMOTE.fullmatch(text):
            expected = "tcp://HOST:PORT, tls://HOST:PORT, local or local:WORKERS"
            raise SettingsError(f"the address of Dask is expected as {expected}, got {text[:80]!r}", path="dask")
        return cls(text)


@dataclass
class _Output:
    """Output of a frame, as far as its worker has told it."""

    text: str = ""

    def read(self) -> str:
        return self.text


class DaskExecutor:
    """See the module. Used in one event loop.

    Args:
        address: of the scheduler.
        on_used: told of the processor time that was used, s, and for whom.
        on_blame: told of the shot that has ended a worker's process, and how.
        read: folders beside a shot's own that the workers of this machine may read.
    """

    def __init__(
        self,
        address: DaskAddress,
        on_used: Callable[[Client, float], None],
        on_blame: Callable[[str, End], None],
        read: Sequence[Path] = (),
    ) -> None:
        self._address = address
        self._on_used = on_used
        self._on_blame = on_blame
        self._read = tuple(map(str, read)) if address.scheduler is None else ()
        self._cluster: Any = None  # `distributed` has few types
        self._client: Any = None
        self._workers: dict[str, str] = {}
        self._greeted: dict[str, bool] = {}
        self._silent: set[str] = set()
        self._doubtful: set[str] = set()
        self._sending: defaultdict[tuple[str, str], asyncio.Lock] = defaultdict(asyncio.Lock)
        self._lists: dict[tuple[str, str], FileList] = {}
        self._looking = asyncio.create_task(self._look_for_workers())

    def places(self) -> Mapping[str, int]:
        """Return the workers of this version of the program, and how many frames may be with each."""
        return {name: PLACES for name, address in self._workers.items() if address not in self._doubtful}

    async def draw(self, worker: str, work: FrameWork, log: FrameLog) -> DrawnFrame:
        """Have a worker draw a frame. Raises `FrameError`, `LostFrameError`, `OSError`: its shot cannot be read."""
        files = await self._files_of(work.request.record)
        for _ in range(SENDS):
            output = _Output()
            log.follow(output.read)
            answer = await self._ask(worker, work, files, output)
            if isinstance(answer, MissingShot):
                await self._send(worker, work.request.record, files)
                continue
            output.text = answer.output
            self._on_used(work.client, answer.cpu_s)
            if isinstance(answer, FailedFrame):
                if answer.end in BLAMED:
                    self._on_blame(work.request.record.id, answer.end)
                raise FrameError(answer.message, answer.may_pass)
            return answer.frame
        raise FrameError(f"worker {worker} does not keep the shot, which may be larger than its budget", may_pass=False)

    async def close(self) -> None:
        """Let go of the workers, and end those of this machine."""
        self._looking.cancel()
        with suppress(asyncio.CancelledError):
            await self._looking
        await self._disconnect()
        if self._cluster is not None:
            await self._cluster.close()

    async def _look_for_workers(self) -> None:
        """Connect to the scheduler, again where it was lost, and keep the list of workers."""
        has_failed = False
        while True:
            try:
                client = await self._connected()
                async with asyncio.timeout(ANSWER_S):
                    found = (await client.scheduler.identity(n_workers=-1))["workers"]
                known = {str(one["name"]): address for address, one in found.items()}
                self._greeted = {address: fits for address, fits in self._greeted.items() if address in found}
                self._silent &= found.keys()
                for gone in [key for key in self._sending if key[0] not in found]:
                    del self._sending[gone]
                await asyncio.gather(*(self._greet(address) for address in found if address not in self._greeted))
                self._workers = {name: address for name, address in known.items() if self._greeted.get(address)}
                self._doubtful.clear()
                has_failed = False
            except Exception as error:
                if not has_failed:
                    log.warning("the scheduler of the workers cannot be reached: %s", error or type(error).__name__)
                has_failed = True
                self._workers = {}
                await self._disconnect()
            await asyncio.sleep(LOOK_PAUSE_S)

    async def _connected(self) -> Any:
        """Return a client that is connected. Raises `ImportError`, `OSError`, `TimeoutError`."""
        distributed: Any = import_module("distributed")  # takes half a second

        if self._client is None or self._client.status != "running":
            await self._disconnect()
            if self._address.scheduler is None and self._cluster is None:
                self._cluster = await distributed.LocalCluster(
                    n_workers=self._address.workers,
                    threads_per_worker=THREADS,
                    memory_limit=0,
                    dashboard_address="127.0.0.1:0",  # a scheduler has a port for that anyway
                    scheduler_kwargs={"dashboard": False},
                    asynchronous=True,
                )
            self._client = await distributed.Client(
                self._cluster or self._address.scheduler, asynchronous=True, timeout=ANSWER_S, set_as_default=False
            )
        return self._client

    async def _disconnect(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            with suppress(Exception):  # it is gone, whatever is wrong with it
                await client.close(timeout=2)

    async def _greet(self, address: str) -> None:
        """Find out whether a worker can draw frames."""
        try:
            async with asyncio.timeout(ANSWER_S):
                theirs = await self._call(address, dask_worker.greet, self._read)
        except Exception as error:  # it is asked again
            if address not in self._silent:
                log.warning("worker %s cannot draw frames now: %s", address, error or type(error).__name__)
            self._silent.add(address)
            return
        self._greeted[address] = theirs == version("pullfocus")
        if not self._greeted[address]:
            log.warning("worker %s has version %s, and this service %s", address, theirs, version("pullfocus"))

    async def _ask(
        self, worker: str, work: FrameWork, files: FileList, output: _Output
    ) -> DoneFrame | FailedFrame | MissingShot:
        """Ask a worker for a frame."""
        address, client = self._workers.get(worker), self._client
        if address is None or client is None:
            raise LostFrameError(f"worker {worker} is gone")
        try:
            future = client.submit(
                dask_worker.draw, work, files, key=work.key, pure=False, retries=0, workers=[address]
            )
        except Exception as error:  # of a client that has lost its scheduler
            raise self._lost(worker, address, error) from error
        waiting = asyncio.ensure_future(future.result())
        try:
            while not (await asyncio.wait((waiting,), timeout=LOOK_PAUSE_S))[0]:
                if self._workers.get(worker) != address:
                    raise LostFrameError(f"worker {worker} is gone")
                with suppress(Exception):  # it is there with the answer, at the latest
                    output.text = await self._call(address, dask_worker.read_output, work.key, within_s=LOOK_PAUSE_S)
            answer: DoneFrame | FailedFrame | MissingShot = waiting.result()
            return answer
        except LostFrameError:
            raise
        except asyncio.CancelledError:
            if not waiting.cancelled():
                with suppress(Exception):  # it is gone, or ends by itself
                    await asyncio.shield(self._call(address, dask_worker.stop, work.key))
                raise
            raise self._lost(worker, address, "it was cancelled") from None
        except Exception as error:  # of Dask: the function itself answers with what is wrong
            raise self._lost(worker, address, error) from error
        finally:
            waiting.cancel()
            future.release()

    def _lost(self, worker: str, address: str, reason: object) -> LostFrameError:
        """Return the error that a worker has lost a frame; it gets no other one before the scheduler is looked at again."""
        self._doubtful.add(address)
        return LostFrameError(f"worker {worker} has lost the frame: {reason}")

    async def _call(
        self, address: str, function: Callable[..., Any], *arguments: object, within_s: float = CALL_S
    ) -> Any:
        """Call a function on a worker, beside its frames."""
        if self._client is None:
            raise LostFrameError("the scheduler of the workers is gone")
        async with asyncio.timeout(within_s):
            return (await self._client.run(function, *arguments, workers=[address]))[address]

    async def _send(self, worker: str, record: ShotRecord, files: FileList) -> None:
        """Send the files of a shot to a worker; two frames of it send them once."""
        address = self._workers.get(worker)
        if address is None:
            raise LostFrameError(f"worker {worker} is gone")
        lock = self._sending[address, files.hash]
        is_being_sent = lock.locked()
        async with lock:
            if is_being_sent:  # for another frame, and it has been by now
                return
            token = ""
            try:
                token = await self._call(address, dask_worker.begin_shot)
                for file in files.files:
                    for offset in range(0, max(file.size_bytes, 1), PART_BYTES):
                        content = await asyncio.to_thread(read_part, record.files, file, offset)
                        await self._call(address, dask_worker.receive_part, token, file.path, content)
                await self._call(address, dask_worker.end_shot, token, files)
                token = ""
            except LostFrameError:
                raise
            except Exception as error:
                raise self._unsent(worker, address, record, error) from error
            finally:
                if token:
                    with suppress(Exception):  # the worker is gone
                        await asyncio.shield(self._call(address, dask_worker.abandon_shot, token))

    def _unsent(self, worker: str, address: str, record: ShotRecord, error: Exception) -> Exception:
        """Return the error of a shot that could not be sent to a worker, which is gone or cannot keep it."""
        if self._workers.get(worker) != address:
            return LostFrameError(f"worker {worker} is gone")
        return FrameError(f"shot {record.id} cannot be sent to worker {worker}: {error}", True)

    async def _files_of(self, record: ShotRecord) -> FileList:
        key = record.id, record.created_at.isoformat()
        if key not in self._lists:
            self._lists[key] = await asyncio.to_thread(list_files, record.files)
            while len(self._lists) > MOST_LISTS:
                del self._lists[next(iter(self._lists))]
        return self._lists[key]
