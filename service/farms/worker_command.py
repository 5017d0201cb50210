"""`pullfocus worker`: draw frames of renders on this machine, for services that use the same Dask scheduler."""

from __future__ import annotations

import argparse
import asyncio
import fcntl
import logging
import os
import signal
import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, get_args

from render.errors import OutputError, SettingsError
from service.http.logs import LogFormat, set_up_logs
from service.jobs.dask_executor import THREADS, DaskAddress
from service.jobs.dask_worker import start_drawer
from service.jobs.drawer import DrawerSettings
from service.workers.folders import default_cache_folder

log = logging.getLogger("pullfocus.worker")

RETRY_S = 2.0
"""Time until a scheduler that is gone is tried again."""


def worker(arguments: Sequence[str]) -> int:
    """Draw frames until this is stopped.

    Args:
        arguments: as typed after ``pullfocus worker``.

    Returns:
        The exit status.

    Raises:
        SettingsError: an argument is wrong, or Dask is not installed.
        OutputError: the folder cannot be written, or another worker uses it.
    """
    typed = _parser().parse_args(arguments)
    address = DaskAddress.parse(typed.dask)
    if address.scheduler is None:
        raise SettingsError("a worker joins a scheduler: expected tcp://HOST:PORT or tls://HOST:PORT", path="dask")
    for name in ("shots_mb", "memory_mb", "timeout_s"):
        if not getattr(typed, name) > 0:  # nor NaN
            raise SettingsError(
                f"--{name.replace('_', '-')} is greater than 0, got {getattr(typed, name):g}", path=name
            )
    set_up_logs(typed.log_format)
    folder = typed.folder.expanduser().absolute()
    with _locked(folder):
        limits = {name: getattr(typed, name) for name in ("shots_mb", "memory_mb", "timeout_s", "gpus")}
        read = tuple(path.expanduser().absolute() for path in typed.read)
        drawer = start_drawer(DrawerSettings(folder, read=read, **limits))
        log.info("shaders are compiled, where that was not done before")
        drawer.warm_up()
        asyncio.run(_serve(address.scheduler, typed.name, folder))
        drawer.close()
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pullfocus worker",
        description="Draw frames of renders on this machine. Services that use the same Dask scheduler (serve --dask) send them.",
        allow_abbrev=False,
    )
    parser.add_argument("--dask", metavar="ADDRESS", required=True, help="the scheduler, such as tcp://farm:8786")
    parser.add_argument(
        "--name",
        default=f"{socket.gethostname()}-{os.getpid()}",
        help="name of this worker, which no other one has (default: host and process)",
    )
    parser.add_argument(
        "--folder",
        metavar="DIR",
        type=Path,
        default=default_cache_folder("worker"),
        help="folder of shots and caches, one for each worker (default: %(default)s)",
    )
    parser.add_argument(
        "--shots-mb", type=float, default=DrawerSettings.shots_mb, help="size of the shots that are kept (%(default)s)"
    )
    parser.add_argument(
        "--memory-mb", type=int, default=DrawerSettings.memory_mb, help="memory of a process that draws (%(default)s)"
    )
    parser.add_argument(
        "--timeout-s", type=float, default=DrawerSettings.timeout_s, help="time for one frame (%(default)s)"
    )
    parser.add_argument(
        "--gpus", type=int, default=0, help="GPUs that processes are spread over; 0 leaves the choice to the driver"
    )
    parser.add_argument(
        "--read",
        metavar="PATH",
        type=Path,
        action="append",
        default=[],
        help="folder beside a shot's own that may be read, such as a library of assets; repeat it for several",
    )
    parser.add_argument(
        "--log-format",
        choices=get_args(LogFormat),
        help="format of the log (default: text on a terminal, else json)",
    )
    return parser


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Use a folder alone. Raises `OutputError`: another worker does, or it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = (folder / "lock").open("w")
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        detail = f"another worker uses {folder}; choose another folder with --folder"
        raise OutputError(detail, path=str(folder)) from error
    except OSError as error:
        raise OutputError(f"the folder {folder} cannot be written: {error.strerror}", path=str(folder)) from error
    with lock:
        yield


async def _serve(scheduler: str, name: str, folder: Path) -> None:
    """Work for a scheduler until a signal; join it again where it was gone."""
    try:
        distributed: Any = import_module("distributed")
    except ImportError as error:
        raise SettingsError(
            "Dask is not installed; install it with: pip install 'pullfocus[dask]'", path="dask"
        ) from error
    stopping = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, stopping.set)
    has_failed = False
    while not stopping.is_set():
        try:
            async with distributed.Worker(
                scheduler,
                name=name,
                nthreads=THREADS,
                memory_limit=0,
                dashboard=False,
                local_directory=str(folder / "dask"),
                death_timeout=RETRY_S,
            ) as joined:
                log.info("%s draws frames for %s", name, scheduler)
                has_failed = False
                waits = [asyncio.create_task(joined.finished()), asyncio.create_task(stopping.wait())]
                await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
                for wait in waits:
                    wait.cancel()
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:  # also a name that another worker has
            if not has_failed:
                log.warning(
                    "the scheduler %s cannot be joined, it is tried again: %s", scheduler, error.__cause__ or error
                )
            has_failed = True
        if not stopping.is_set():
            with suppress(TimeoutError):
                await asyncio.wait_for(stopping.wait(), RETRY_S)
