"""State of the picture process: the GL context, the opened shots and what is kept between pictures."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from functools import cached_property
from typing import Concatenate, ParamSpec, TypeVar

from render.frame import FrameRenderer
from render.pictures.live_finisher import LiveFinisher
from render.pictures.long_exposure import LongExposure
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot
from service.stage.opened import OpenedShots
from service.workers.calls import register

MAX_PROGRESSIVES = 2
"""Shots for which the process keeps the intermediate results of live pictures."""

Arguments = ParamSpec("Arguments")
Reply = TypeVar("Reply")


@register
class PictureWorkerState:
    """The GL context and the opened shots of the picture process.

    The context is created by the first call that needs it, so that a machine without GL answers that call with an error.

    Attributes:
        opened: the shots that are open.
        exposures: long exposures by their key, oldest first.
    """

    def __init__(self) -> None:
        self.opened = OpenedShots()
        self.exposures: dict[str, LongExposure] = {}
        self._progressives: OrderedDict[str, tuple[Shot, ProgressiveRenderer]] = OrderedDict()

    @cached_property
    def renderer(self) -> FrameRenderer:
        """Renderer with the process's one GL context. Raises `GraphicsError` where no context can be created."""
        return FrameRenderer()

    @cached_property
    def live_finisher(self) -> LiveFinisher:
        """Film and grade on the graphics device. Raises `GraphicsError` where no context can be created."""
        return LiveFinisher(self.renderer)

    def progressive(self, shot_id: str, shot: Shot) -> ProgressiveRenderer:
        """Return the progressive renderer of an opened shot, which keeps intermediate results between pictures.

        Args:
            shot_id: id of the shot.
            shot: the shot as it is open now; results of an earlier opening are discarded.

        Raises:
            GraphicsError: no context can be created.
        """
        kept = self._progressives.pop(shot_id, None)
        if kept is None or kept[0] is not shot:
            kept = shot, ProgressiveRenderer(self.renderer, shot, self.live_finisher)
        self._progressives[shot_id] = kept
        if len(self._progressives) > MAX_PROGRESSIVES:
            self._progressives.popitem(last=False)
        return kept[1]

    def close(self, shot_id: str) -> None:
        """Close a shot, if it is open, and discard its intermediate results."""
        self.opened.close(shot_id)
        self._progressives.pop(shot_id, None)


def picture_function(
    function: Callable[Concatenate[PictureWorkerState, Arguments], Reply],
) -> Callable[Concatenate[PictureWorkerState, Arguments], Reply]:
    """Register a function that the HTTP process may call in the picture process (see `service.workers.calls`)."""
    return register(function)
