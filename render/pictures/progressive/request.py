"""What is asked of the progressive driver, and what it answers. Imports no OpenGL."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from render.film import GradeChoice
from render.model.arrays import FloatArray
from render.model.frame_settings import FrameSettings
from render.output import FrameMetadata

if TYPE_CHECKING:
    from render.pictures.picture import Picture

Stage = Literal["preview", "refining", "final"]


@dataclass(frozen=True)
class PreviewRequest:
    """A picture that somebody waits for.

    Attributes:
        camera: prim path; None for the shot's default camera.
        time: USD time code.
        settings: of the picture at rest.
        stock: a film of the library, in place of what the shot says.
        choice: what is wanted of the grade, in place of parts of what the shot says.
        budget_ms: the first picture should be there after so long, and is as good as fits.
        is_moving: whether the hand is still on the slider, so that another is asked for at once: the first picture is the last.
    """

    camera: str | None
    time: float
    settings: FrameSettings
    stock: str | None = None
    choice: GradeChoice | None = None
    budget_ms: float = 100.0
    is_moving: bool = False


@dataclass(frozen=True)
class Timing:
    """What a picture took, in milliseconds.

    Attributes:
        total_ms: since it was asked for.
        read_ms: to read the shot: camera, focus and scene.
        peel_ms: to peel its layers, shadows before them included; nothing where they were kept.
        blur_ms: to trace or blur it.
        finish_ms: to expose, develop and grade it.
    """

    total_ms: float = 0.0
    read_ms: float = 0.0
    peel_ms: float = 0.0
    blur_ms: float = 0.0
    finish_ms: float = 0.0


@dataclass(frozen=True, eq=False)
class Shown:
    """One of the pictures that are better and better.

    Attributes:
        stage: ``preview`` is the first one, ``final`` the last, equal to `make_picture`'s to the bit.
        graded: ``(height, width, 3)`` float32, encoded for the display, 0 to 1; a preview may be smaller than what was asked for.
        metadata: what a file says about it.
        timing: what it took so far.
        rays: for each of its pixels; 0 where it was not traced.
        share: of the final picture's work that is done.
        picture: all of the final picture; None before.
    """

    stage: Stage
    graded: FloatArray
    metadata: FrameMetadata
    timing: Timing = field(default_factory=Timing)
    rays: int = 0
    share: float = 0.0
    picture: Picture | None = None

    @property
    def is_final(self) -> bool:
        """Whether no better one comes."""
        return self.stage == "final"
