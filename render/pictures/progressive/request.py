"""Requests to the progressive renderer, and its pictures. Imports no OpenGL."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from render.film import GradeChoice
from render.model.arrays import FloatArray
from render.model.focus_map import FocusMap
from render.model.frame_settings import FrameSettings
from render.output import FrameMetadata

if TYPE_CHECKING:
    from render.pictures.picture import Picture

Stage = Literal["preview", "refining", "final"]


@dataclass(frozen=True)
class PreviewRequest:
    """A picture of a viewer.

    Attributes:
        camera_path: prim path; None for the shot's default camera.
        time: USD time code.
        settings: of the final picture.
        stock: a film of the library, in place of the shot's film.
        choice: display, view and look, in place of these parts of the shot's grade.
        budget_ms: time for the first picture, which is as good as fits.
        is_moving: True while a control is dragged, so that the next request follows at once: the preview is the only picture.
            Drawn by the processor, that of a new view shows nothing behind what the centre of the lens sees.
        is_hurried: True where others wait: likewise on any machine, and for a view that is shown again. Until a picture that is
            not hurried, no levels of meshes are made.
        maps_focus: whether the first picture, unless it is hurried, and the final one come with a focus map.
    """

    camera_path: str | None
    time: float
    settings: FrameSettings
    stock: str | None = None
    choice: GradeChoice | None = None
    budget_ms: float = 100.0
    is_moving: bool = False
    is_hurried: bool = False
    maps_focus: bool = False


@dataclass(frozen=True)
class Timing:
    """Times of a picture, in milliseconds.

    Attributes:
        total_ms: since its request.
        read_ms: to read the shot: camera, focus and scene.
        peel_ms: to draw shadows and peel layers; 0 where they were kept.
        blur_ms: to trace or blur it.
        finish_ms: to expose, develop and grade it.
    """

    total_ms: float = 0.0
    read_ms: float = 0.0
    peel_ms: float = 0.0
    blur_ms: float = 0.0
    finish_ms: float = 0.0


@dataclass(frozen=True, eq=False)
class ProgressivePicture:
    """One picture of the sequence that ends with the exact one.

    Attributes:
        stage: ``preview`` is the first one, ``final`` the last, equal to `make_picture`'s to the bit.
        graded: ``(height, width, 3)`` float32, encoded for the display, 0 to 1; a preview may be smaller than the request.
        metadata: for the header of a file.
        timing: times until it was made.
        rays: rays per pixel; 0 where it was not traced.
        share: of the final picture's work that is done.
        picture: the final picture with its frame; None before.
        focus: how sharp each pixel is; None where no map was made. That of a preview may be of another size.
    """

    stage: Stage
    graded: FloatArray
    metadata: FrameMetadata
    timing: Timing = field(default_factory=Timing)
    rays: int = 0
    share: float = 0.0
    picture: Picture | None = None
    focus: FocusMap | None = None

    @property
    def is_final(self) -> bool:
        """True for the last picture."""
        return self.stage == "final"
