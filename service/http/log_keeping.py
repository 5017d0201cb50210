"""Keeps the log of an attempt at a frame while it goes on, for those who follow it."""

from __future__ import annotations

import asyncio

from starlette.concurrency import run_in_threadpool

from render.errors import OutputError
from service.hidden_folders import without_folders
from service.jobs.claims import Claim
from service.jobs.frame_logs import FrameLog, FrameLogs

PAUSE_S = 1.0
"""Time after which new lines are kept."""


class LogKeeper:
    """See the module. Used in one event loop.

    Args:
        logs: that are kept.
        claim: the attempt.

    Attributes:
        log: of the attempt.
    """

    def __init__(self, logs: FrameLogs, claim: Claim) -> None:
        self.log = FrameLog()
        self._logs = logs
        self._claim = claim
        self._writing = asyncio.Lock()
        self._kept_bytes = 0

    async def run(self) -> None:
        """Keep what is new, again and again, until this is cancelled. What cannot be kept now is kept later."""
        while True:
            await asyncio.sleep(PAUSE_S)
            async with self._writing:
                lines = self.new_lines()
                if lines:
                    try:
                        await run_in_threadpool(self._logs.append, self._claim, lines, self._kept_bytes)
                        self._kept_bytes += len(lines.encode("utf-8", "replace"))
                    except OutputError:
                        self.log.put_back(lines)

    async def end(self) -> str:
        """Return the lines that are not kept yet."""
        async with self._writing:
            return self.new_lines()

    def new_lines(self) -> str:
        """Return the lines that are not kept yet, or are being kept. They name no folder of this machine."""
        return without_folders(self.log.take())
