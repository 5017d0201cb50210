"""`DrawRequest`: the picture that an engine is to draw. Loads no OpenGL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.mattes import MatteSum
from render.optics.view import PinholeView

Part = tuple[int, int]
"""Part of a picture's rays: the number of the part, and how many parts there are."""
ALL_RAYS: Part = (0, 1)
Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class DrawRequest:
    """A picture of the loaded scene.

    Attributes:
        view: projection of the picture, from the centre of the entrance pupil.
        camera: lens, iris, focus; its aperture is closed where the engine is sharp (`Engine.is_sharp`).
        settings: resolution of rays and layers, shading and seed.
        part: rays to draw, for an engine that has rays. An engine without rays draws the whole picture each time.
        on_progress: called with the share that is done, from 0 to 1.
        mattes: sum that an engine which `Engine.draws_mattes` adds to; None where the settings name none.
    """

    view: PinholeView
    camera: Camera
    settings: FrameSettings
    part: Part = ALL_RAYS
    on_progress: Progress | None = None
    mattes: MatteSum | None = None

    @property
    def is_unlit(self) -> bool:
        """True where base colour is taken for radiance."""
        return self.settings.shading == "unlit"
