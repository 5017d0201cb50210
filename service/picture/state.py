"""State of a picture worker: the GL context, the opened shot and what is kept between pictures."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Concatenate, ParamSpec, TypeVar

from render.frame import FrameRenderer
from render.pictures.live_finisher import LiveFinisher
from render.pictures.long_exposure import LongExposure
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot
from service.stage.opened import OpenedShot
from service.workers.calls import register

Arguments = ParamSpec("Arguments")
Reply = TypeVar("Reply")


@register
class PictureWorkerState:
    """The GL context and the opened shot of a picture worker.

    The context is created by the first call that needs it, so that a machine without GL answers that call with an error.

    Attributes:
        opened: the shot that is open.
        exposure: the long exposure that it holds, after its key; or None.
    """

    def __init__(self) -> None:
        self.opened = OpenedShot()
        self.exposure: tuple[str, LongExposure] | None = None
        self._progressive: ProgressiveRenderer | None = None

    @cached_property
    def renderer(self) -> FrameRenderer:
        """Renderer with the process's one GL context. Raises `GraphicsError` where no context can be created."""
        return FrameRenderer()

    @cached_property
    def live_finisher(self) -> LiveFinisher:
        """Film and grade on the graphics device. Raises `GraphicsError` where no context can be created."""
        return LiveFinisher(self.renderer)

    def progressive(self, shot: Shot) -> ProgressiveRenderer:
        """Return the progressive renderer of the opened shot, which keeps intermediate results between pictures.

        Args:
            shot: the shot.

        Raises:
            GraphicsError: no context can be created.
        """
        if self._progressive is None:
            self._progressive = ProgressiveRenderer(self.renderer, shot, self.live_finisher)
        return self._progressive


def picture_function(
    function: Callable[Concatenate[PictureWorkerState, Arguments], Reply],
) -> Callable[Concatenate[PictureWorkerState, Arguments], Reply]:
    """Register a function that the HTTP process may call in the picture process (see `service.workers.calls`)."""
    return register(function)
