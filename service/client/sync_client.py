"""The client for threads."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from pathlib import Path
from types import TracebackType
from typing import TypeVar, Unpack

import httpx

from . import operations
from .connecting import DEFAULT_URL, http_arguments
from .errors import AnswerError, ClientError
from .models import Render, RenderPlan, RenderSettings, RenderTask, Shot, ShotSummary
from .operations import ENDED, AnyRender, AnyShot, Download, LogReader, Watch
from .steps import Answer, Exchange, Pause, Receiver, Retries, Steps, Work

T = TypeVar("T")
AnyPath = str | os.PathLike[str]


class Client:
    """A client of a Pullfocus service. Threads may share it.

    Every method raises `ClientError`. What is safe to send again is sent again, by `retries`.

    Args:
        url: address of the service.
        key: of the service, or a token; None for a service that needs none.
        retries: how often a request is sent.
        transport: of httpx, for tests; None for the network.
    """

    def __init__(
        self,
        url: str = DEFAULT_URL,
        key: str | None = None,
        *,
        retries: Retries | None = None,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        self._retries = retries or Retries()
        self._http = httpx.Client(**http_arguments(url, key), transport=transport)

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def shots(self) -> list[ShotSummary]:
        """List the shots that the key sees, the newest last."""
        return self._run(operations.shots(self._retries))

    def shot(self, shot: AnyShot) -> Shot:
        """Read a shot with its frame range and cameras."""
        return self._run(operations.shot(shot, self._retries))

    def push(
        self,
        path: AnyPath,
        *,
        name: str | None = None,
        root: str | None = None,
        project: str | None = None,
        files: Sequence[AnyPath] | None = None,
    ) -> Shot:
        """Upload a shot. It is not sent again where no answer came: look at `shots` then.

        Args:
            path: a USD file or zip archive, which goes as it is, or a folder with all that the shot needs.
            name: of the shot; that of the file or folder when left out.
            root: root layer within the folder or archive; the only stage of its topmost folder when left out.
            project: of the shot, for those who see several.
            files: of a folder: those that are sent, relative to it; all but hidden ones when left out.
        """
        chosen = None if files is None else [Path(file) for file in files]
        return self._run(operations.push(Path(path), name, root, project, chosen, self._retries))

    def delete(self, shot: AnyShot) -> None:
        """Move a shot to the trash of the service."""
        self._run(operations.delete(shot, self._retries))

    def plan(self, shot: AnyShot, **settings: Unpack[RenderSettings]) -> RenderPlan:
        """Tell the frames of a render and what they cost, and send nothing."""
        return self._run(operations.plan(shot, settings, self._retries))

    def render(
        self, shot: AnyShot, *, idempotency_key: str | None = None, **settings: Unpack[RenderSettings]
    ) -> Render:
        """Send a render.

        Args:
            shot: the shot.
            idempotency_key: the same one gives the same render; a new one when left out, with which retries are safe.
            **settings: as `RenderSettings` has them.
        """
        return self._run(operations.render(shot, settings, idempotency_key, self._retries))

    def renders(self, most: int = 50) -> list[Render]:
        """List the newest renders, the newest first.

        Args:
            most: number of renders.
        """
        return self._run(operations.renders(most, self._retries))

    def get(self, render: AnyRender) -> Render:
        """Read how far a render is."""
        return self._run(operations.get(render, self._retries))

    def tasks(self, render: AnyRender) -> list[RenderTask]:
        """List the frames of a render, with the attempts at each."""
        return self._run(operations.tasks(render, self._retries))

    def pause(self, render: AnyRender) -> Render:
        """Begin no more frames of a render."""
        return self._run(operations.act(render, "pause", self._retries))

    def resume(self, render: AnyRender) -> Render:
        """Go on with a render that was paused."""
        return self._run(operations.act(render, "resume", self._retries))

    def cancel(self, render: AnyRender) -> Render:
        """End a render; stored frames stay."""
        return self._run(operations.act(render, "cancel", self._retries))

    def accept(self, render: AnyRender) -> Render:
        """Take a render for done whose other frames have failed or were given up."""
        return self._run(operations.act(render, "accept", self._retries))

    def retry(self, render: AnyRender) -> Render:
        """Draw those frames again that have failed, were given up, or are lost."""
        return self._run(operations.act(render, "retry", self._retries))

    def remove(self, render: AnyRender) -> None:
        """Remove a render that has ended, and its files."""
        self._run(operations.remove(render, self._retries))

    def wait(
        self,
        render: AnyRender,
        *,
        on_progress: Callable[[Render], object] | None = None,
        timeout_s: float | None = None,
    ) -> Render:
        """Wait until a render has ended, whether it is done, failed or canceled.

        Args:
            render: the render.
            on_progress: called at first, and whenever the render has changed.
            timeout_s: time until `WaitTimeoutError`, s; None waits for as long as it takes.
        """
        watch = Watch(render, timeout_s, self._retries)
        while True:
            now = self._run(watch.next_change())
            if on_progress is not None:
                on_progress(now)
            if now.state in ENDED:
                return now

    def download(
        self,
        render: AnyRender,
        folder: AnyPath,
        *,
        follow: bool = False,
        on_progress: Callable[[Render], object] | None = None,
        on_file: Callable[[Path], object] | None = None,
        timeout_s: float | None = None,
        at_once: int = 4,
    ) -> list[Path]:
        """Fetch the frames of a render that are stored, and compare each with its hash. Those that are there already stay.

        Args:
            render: the render.
            folder: made where it is missing; the files of other renders of the same name are replaced.
            follow: wait until the render has ended, and fetch each frame when it is stored.
            on_progress: called at first, and whenever the render has changed.
            on_file: called with each file that is there.
            timeout_s: as of `wait`.
            at_once: number of files that are fetched at once.

        Returns:
            The files, in the order in which they were complete.
        """
        watch, download = Watch(render, timeout_s, self._retries), Download(Path(folder), self._retries)
        paths: list[Path] = []

        def note(path: Path) -> None:
            paths.append(path)
            if on_file is not None:
                on_file(path)

        while True:
            now = self._run(watch.next_change())
            if on_progress is not None:
                on_progress(now)
            files = self._run(download.new_files(now)) if now.done else []
            self._run_all([download.fetch(now, file) for file in files], note, at_once)
            if not follow or now.state in ENDED:
                return paths

    def movie(self, render: AnyRender, path: AnyPath) -> Path:
        """Fetch the movie of a render that has ended; the ending of the path is its kind: .mp4, .mov or .webm."""
        return self._run(operations.fetch_movie(render, Path(path), self._retries))

    def contact_sheet(self, render: AnyRender, path: AnyPath) -> Path:
        """Fetch the contact sheet of a render that has ended, a PNG."""
        return self._run(operations.fetch_contact_sheet(render, Path(path), self._retries))

    def focus_report(self, render: AnyRender, path: AnyPath, *, frames: str | None = None) -> Path:
        """Fetch the focus report of a render, whether it has ended or not.

        Args:
            render: the render.
            path: file to write; its ending is the kind of the report: .csv, .json or .html.
            frames: those of the report, as a range of frames of the render; all of them when left out.
        """
        return self._run(operations.fetch_focus_report(render, Path(path), frames, self._retries))

    def log(self, render: AnyRender, frame: int, *, attempt: int | None = None, tail: int | None = None) -> str:
        """Read the log of an attempt at a frame.

        Args:
            render: the render.
            frame: number of the frame.
            attempt: number of the attempt; None for the last one.
            tail: number of lines from its end; None for all.
        """
        return self._run(operations.log(render, frame, attempt, tail, self._retries))

    def follow_log(
        self, render: AnyRender, frame: int, on_text: Callable[[str], object], *, attempt: int | None = None
    ) -> None:
        """Follow the log of an attempt at a frame until it has ended. A frame that waits is waited for.

        Args:
            render: the render.
            frame: number of the frame.
            on_text: called with the lines that there are, and with others as they come.
            attempt: number of the attempt; None for the last one.
        """
        reader = LogReader(render, frame, attempt, self._retries)
        while not reader.has_ended:
            text = self._run(reader.next_text())
            if text:
                on_text(text)

    def _run_all(self, all_steps: Sequence[Steps[T]], note: Callable[[T], None], at_once: int) -> None:
        """Carry out operations by some threads. Where one fails, or Ctrl-C comes, the others are given up."""
        stop = threading.Event()
        with ThreadPoolExecutor(at_once) as pool:
            futures = [pool.submit(self._run, steps, stop) for steps in all_steps]
            try:
                for future in as_completed(futures):
                    note(future.result())
            except BaseException:
                stop.set()
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    def _run(self, steps: Steps[T], stop: threading.Event | None = None) -> T:
        """Carry out an operation."""
        with closing(steps):
            try:
                step = next(steps)
                while True:
                    match step:
                        case Exchange():
                            try:
                                answer = self._exchange(step, stop)
                            except (httpx.TransportError, OSError) as error:
                                step = steps.throw(error)
                            except (httpx.InvalidURL, UnicodeError) as error:  # of where a redirect leads
                                step = steps.throw(AnswerError(f"the answer leads to no address: {error}"))
                            else:
                                step = steps.send(answer)
                        case Pause(seconds):
                            _pause(seconds, stop)
                            step = steps.send(None)
                        case Work(function):
                            step = steps.send(function())
            except StopIteration as end:
                result: T = end.value
                return result

    def _exchange(self, exchange: Exchange, stop: threading.Event | None) -> Answer:
        with self._http.stream(**exchange.call.arguments()) as response:
            receiver = Receiver(response, exchange.sink)
            for chunk in response.iter_raw(exchange.chunk_bytes):
                _check(stop)
                receiver.write(chunk)
                if exchange.is_over():
                    break
            return receiver.answer()


def _pause(seconds: float, stop: threading.Event | None) -> None:
    if stop is None:
        time.sleep(seconds)
    else:
        stop.wait(seconds)
        _check(stop)


def _check(stop: threading.Event | None) -> None:
    if stop is not None and stop.is_set():
        raise ClientError("given up, since something else has failed")
