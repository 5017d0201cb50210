"""Lanes of the service: which work runs beside which, in what kind of worker, and within which limits.

::

    check      throw-away workers that open an upload for the first time
    stage      workers that read and edit shots; a shot has one, the only writer of its edits
    read       workers for those readings of a shot that may take long; they hold up no edit of it
    live       workers that draw live pictures, pick surfaces and meter light
    final      workers that draw frames which are requested over HTTP; they give way to the others
    long       workers that draw frames of renders, and those which are expected to take long; they give way to all
    exposure   workers that hold a long exposure; a shot has one
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from service.http.settings import MEBIBYTE, Settings
from service.picture.calls import state
from service.stage.calls import opened
from service.workers.jobs import Finished
from service.workers.lane import Lane
from service.workers.pool import WorkerPool
from service.workers.roles import role
from service.workers.sandbox import Limits

STAGE_SLOTS = 4
READ_SLOTS = 2
CHECK_SLOTS = 2
CORES_PER_PICTURE, CORES_PER_PREVIEW = 4, 1.4
"""Cores that a picture and a preview keep busy, where the processor draws them."""
LONG_S = 60.0
"""Expected processor time from which on a frame takes long, s."""
DESCRIPTORS = 512
PROCESSES = 256


@dataclass(frozen=True)
class Lanes:
    """All lanes; see the module."""

    check: Lane[opened.OpenedShot]
    stage: Lane[opened.OpenedShot]
    read: Lane[opened.OpenedShot]
    live: Lane[state.PictureWorkerState]
    final: Lane[state.PictureWorkerState]
    long: Lane[state.PictureWorkerState]
    exposure: Lane[state.PictureWorkerState]

    @classmethod
    def start(cls, settings: Settings, pool: WorkerPool, on_finished: Callable[[Finished], None]) -> Lanes:
        """Start the lanes; their processes start with the first call.

        Args:
            settings: of the service.
            pool: of the processes.
            on_finished: called after each job, in a thread of its lane; it must not raise.
        """

        def lane(name: str, make_state: Any, memory_mb: int, timeout_s: float, slots: int, **options: Any) -> Lane[Any]:
            limits = Limits(
                memory_bytes=memory_mb * MEBIBYTE,
                cpu_s=None,
                file_bytes=settings.max_unpacked_mb * MEBIBYTE,
                descriptors=DESCRIPTORS,
                processes=PROCESSES,
            )
            return Lane(
                role(name, make_state, limits, **options),
                pool,
                slots=slots,
                max_waiting=settings.max_waiting,
                max_waiting_each=settings.max_waiting_each,
                timeout_s=timeout_s,
                on_finished=on_finished,
            )

        stage, picture = opened.OpenedShot, state.PictureWorkerState
        memory_mb, stage_s, frame_s = settings.picture_memory_mb, settings.stage_timeout_s, settings.frame_timeout_s
        cores = os.cpu_count() or 1
        pictures, previews = (
            settings.pictures_at_a_time or settings.gpus or math.ceil(cores / share)
            for share in (CORES_PER_PICTURE, CORES_PER_PREVIEW)
        )
        return cls(
            check=lane("check", stage, settings.check_memory_mb, stage_s, CHECK_SLOTS, niceness=5, is_thrown_away=True),
            stage=lane("stage", stage, settings.stage_memory_mb, stage_s, STAGE_SLOTS, is_single=True),
            read=lane("read", stage, settings.stage_memory_mb, stage_s, READ_SLOTS, niceness=5),
            live=lane("live", picture, memory_mb, frame_s, previews, draws=True),
            final=lane("final", picture, memory_mb, frame_s, pictures, draws=True, niceness=10),
            long=lane("long", picture, memory_mb, frame_s, pictures, draws=True, niceness=15),
            exposure=lane(
                "exposure",
                picture,
                memory_mb,
                frame_s,
                pictures,
                draws=True,
                niceness=10,
                is_single=True,
                keeps_state=True,
            ),
        )

    def __iter__(self) -> Iterator[Lane[Any]]:
        """Iterate over the lanes."""
        return iter((self.check, self.stage, self.read, self.live, self.final, self.long, self.exposure))

    def frame_lane(self, expected_s: float) -> Lane[state.PictureWorkerState]:
        """Return the lane of a frame that is requested over HTTP.

        Args:
            expected_s: processor time that it is expected to take, s.
        """
        return self.final if expected_s < LONG_S else self.long

    def close(self) -> None:
        """Fail the work that waits and that runs."""
        for lane in self:
            lane.close()
