"""Executor that has frames of renders drawn by the worker processes of this service."""

from __future__ import annotations

import os
import secrets
import socket
from collections.abc import Mapping

from service.http.service import Service
from service.jobs.frame_logs import FrameLog
from service.jobs.frame_work import FrameWork
from service.picture.calls import frames
from service.picture.requests import DrawnFrame
from service.workers.calls import call
from service.workers.output import JobOutput


class LaneExecutor:
    """Draws frames in the lane that gives way to all others.

    Args:
        service: whose lane it is.
    """

    def __init__(self, service: Service) -> None:
        self._service = service
        self._name = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(2)}"

    def places(self) -> Mapping[str, int]:
        """Return this process, and how many frames it draws at a time."""
        return {self._name: self._service.lanes.long.slots}

    async def draw(self, worker: str, work: FrameWork, log: FrameLog) -> DrawnFrame:
        """Draw a frame; see `service.jobs.frame_work.Executor`."""
        output = JobOutput()
        log.follow(output.text)
        try:
            return await self._service.lanes.long.result(
                call(frames.render_files, work.request, work.formats),
                self._service.place_of(work.request.record),
                work.client,
                estimate_s=work.estimate_s,
                output=output,
            )
        finally:
            output.end()

    async def close(self) -> None:
        """Do nothing: the service ends its lanes itself."""
