"""The client for an event loop of asyncio."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from types import TracebackType
from typing import TypeVar, Unpack

import httpx

from . import operations
from .connecting import DEFAULT_URL, http_arguments
from .errors import AnswerError
from .models import Render, RenderPlan, RenderSettings, RenderTask, Shot, ShotSummary
from .operations import ENDED, AnyRender, AnyShot, Download, LogReader, Watch
from .steps import Answer, Exchange, Pause, Receiver, Retries, Steps, Work
from .sync_client import AnyPath

T = TypeVar("T")


class AsyncClient:
    """A client of a Pullfocus service, for asyncio. Its methods are those of `Client`, to be awaited.

    Files are read, written and packed by threads, so that the event loop goes on.

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
        transport: httpx.AsyncBaseTransport | None = None,
    ) -> None:
        self._retries = retries or Retries()
        self._http = httpx.AsyncClient(**http_arguments(url, key), transport=transport)

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def shots(self) -> list[ShotSummary]:
        """List the shots, as `Client.shots` does."""
        return await self._run(operations.shots(self._retries))

    async def shot(self, shot: AnyShot) -> Shot:
        """Read a shot, as `Client.shot` does."""
        return await self._run(operations.shot(shot, self._retries))

    async def push(
        self,
        path: AnyPath,
        *,
        name: str | None = None,
        root: str | None = None,
        project: str | None = None,
        files: Sequence[AnyPath] | None = None,
    ) -> Shot:
        """Upload a shot, as `Client.push` does."""
        chosen = None if files is None else [Path(file) for file in files]
        return await self._run(operations.push(Path(path), name, root, project, chosen, self._retries))

    async def delete(self, shot: AnyShot) -> None:
        """Move a shot to the trash, as `Client.delete` does."""
        await self._run(operations.delete(shot, self._retries))

    async def plan(self, shot: AnyShot, **settings: Unpack[RenderSettings]) -> RenderPlan:
        """Tell what a render costs, as `Client.plan` does."""
        return await self._run(operations.plan(shot, settings, self._retries))

    async def render(
        self, shot: AnyShot, *, idempotency_key: str | None = None, **settings: Unpack[RenderSettings]
    ) -> Render:
        """Send a render, as `Client.render` does."""
        return await self._run(operations.render(shot, settings, idempotency_key, self._retries))

    async def renders(self, most: int = 50) -> list[Render]:
        """List the newest renders, as `Client.renders` does."""
        return await self._run(operations.renders(most, self._retries))

    async def get(self, render: AnyRender) -> Render:
        """Read how far a render is, as `Client.get` does."""
        return await self._run(operations.get(render, self._retries))

    async def tasks(self, render: AnyRender) -> list[RenderTask]:
        """List the frames of a render, as `Client.tasks` does."""
        return await self._run(operations.tasks(render, self._retries))

    async def pause(self, render: AnyRender) -> Render:
        """Begin no more frames, as `Client.pause` does."""
        return await self._run(operations.act(render, "pause", self._retries))

    async def resume(self, render: AnyRender) -> Render:
        """Go on, as `Client.resume` does."""
        return await self._run(operations.act(render, "resume", self._retries))

    async def cancel(self, render: AnyRender) -> Render:
        """End a render, as `Client.cancel` does."""
        return await self._run(operations.act(render, "cancel", self._retries))

    async def accept(self, render: AnyRender) -> Render:
        """Take a render for done, as `Client.accept` does."""
        return await self._run(operations.act(render, "accept", self._retries))

    async def retry(self, render: AnyRender) -> Render:
        """Draw frames again, as `Client.retry` does."""
        return await self._run(operations.act(render, "retry", self._retries))

    async def remove(self, render: AnyRender) -> None:
        """Remove a render, as `Client.remove` does."""
        await self._run(operations.remove(render, self._retries))

    async def wait(
        self,
        render: AnyRender,
        *,
        on_progress: Callable[[Render], object] | None = None,
        timeout_s: float | None = None,
    ) -> Render:
        """Wait until a render has ended, as `Client.wait` does."""
        watch = Watch(render, timeout_s, self._retries)
        while True:
            now = await self._run(watch.next_change())
            if on_progress is not None:
                on_progress(now)
            if now.state in ENDED:
                return now

    async def download(
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
        """Fetch the frames of a render that are stored, as `Client.download` does."""
        watch, download = Watch(render, timeout_s, self._retries), Download(Path(folder), self._retries)
        paths: list[Path] = []

        def note(path: Path) -> None:
            paths.append(path)
            if on_file is not None:
                on_file(path)

        while True:
            now = await self._run(watch.next_change())
            if on_progress is not None:
                on_progress(now)
            files = await self._run(download.new_files(now)) if now.done else []
            await self._run_all([download.fetch(now, file) for file in files], note, at_once)
            if not follow or now.state in ENDED:
                return paths

    async def movie(self, render: AnyRender, path: AnyPath) -> Path:
        """Fetch the movie of a render that has ended, as `Client.movie` does."""
        return await self._run(operations.fetch_movie(render, Path(path), self._retries))

    async def contact_sheet(self, render: AnyRender, path: AnyPath) -> Path:
        """Fetch the contact sheet of a render that has ended, as `Client.contact_sheet` does."""
        return await self._run(operations.fetch_contact_sheet(render, Path(path), self._retries))

    async def focus_report(self, render: AnyRender, path: AnyPath, *, frames: str | None = None) -> Path:
        """Fetch the focus report of a render, whether it has ended or not.

        Args:
            render: the render.
            path: file to write; its ending is the kind of the report: .csv, .json or .html.
            frames: those of the report, as a range of frames of the render; all of them when left out.
        """
        return await self._run(operations.fetch_focus_report(render, Path(path), frames, self._retries))

    async def log(self, render: AnyRender, frame: int, *, attempt: int | None = None, tail: int | None = None) -> str:
        """Read the log of an attempt at a frame.

        Args:
            render: the render.
            frame: number of the frame.
            attempt: number of the attempt; None for the last one.
            tail: number of lines from its end; None for all.
        """
        return await self._run(operations.log(render, frame, attempt, tail, self._retries))

    async def follow_log(
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
            text = await self._run(reader.next_text())
            if text:
                on_text(text)

    async def _run_all(self, all_steps: Sequence[Steps[T]], note: Callable[[T], None], at_once: int) -> None:
        """Carry out operations, some at once. Where one fails, the others are given up."""
        turns = asyncio.Semaphore(at_once)

        async def run(steps: Steps[T]) -> T:
            async with turns:
                return await self._run(steps)

        running = [asyncio.create_task(run(steps)) for steps in all_steps]
        try:
            for one in asyncio.as_completed(running):
                note(await one)
        finally:
            for task in running:
                task.cancel()
            await asyncio.gather(*running, return_exceptions=True)

    async def _run(self, steps: Steps[T]) -> T:
        """Carry out an operation."""
        with closing(steps):
            try:
                step = next(steps)
                while True:
                    match step:
                        case Exchange():
                            try:
                                answer = await self._exchange(step)
                            except (httpx.TransportError, OSError) as error:
                                step = steps.throw(error)
                            except (httpx.InvalidURL, UnicodeError) as error:  # of where a redirect leads
                                step = steps.throw(AnswerError(f"the answer leads to no address: {error}"))
                            else:
                                step = steps.send(answer)
                        case Pause(seconds):
                            await asyncio.sleep(seconds)
                            step = steps.send(None)
                        case Work(function):
                            step = steps.send(await asyncio.to_thread(function))
            except StopIteration as end:
                result: T = end.value
                return result

    async def _exchange(self, exchange: Exchange) -> Answer:
        async with self._http.stream(**exchange.call.arguments()) as response:
            receiver = Receiver(response, exchange.sink)
            async for chunk in response.aiter_raw(exchange.chunk_bytes):
                await asyncio.to_thread(receiver.write, chunk)
                if exchange.is_over():
                    break
            return receiver.answer()
