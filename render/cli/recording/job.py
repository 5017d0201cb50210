"""The data that all ways of recording share: the shot, its camera, and how its pictures are rendered and finished."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from render.film import GradeChoice
from render.model.arrays import FloatArray
from render.model.frame_settings import FrameSettings
from render.output import FrameMetadata
from render.shot import Shot

Overlay = Callable[[FloatArray, FrameMetadata], FloatArray]
"""Draws over a graded picture ``(height, width, 3)`` with its metadata, such as framing guides and burn-ins."""


@dataclass(frozen=True)
class RecordJob:
    """A run of `pullfocus record`.

    Attributes:
        shot: the shot.
        camera_path: prim path; None for a camera that frames the whole stage.
        settings: of each picture.
        stock: film of the library; None keeps the shot's own.
        grade: replaces parts of the shot's grade; None keeps it.
        overlay: drawn over each graded picture.
    """

    shot: Shot
    camera_path: str | None
    settings: FrameSettings
    stock: str | None
    grade: GradeChoice | None
    overlay: Overlay
