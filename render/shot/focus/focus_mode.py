"""What decides the focus of a camera."""

from __future__ import annotations

from dataclasses import replace

from usd_schemas import LensCamera


def set_focus_mode(camera: LensCamera, mode: str) -> None:
    """Author what decides the focus, unless the camera says it already, in the stage's edit target.

    Args:
        camera: the camera.
        mode: manual, points, tiltPlane or surface.

    Raises:
        SchemaError: it is none of these.
    """
    said = camera.focus.read()
    if mode != said.mode:
        camera.focus.author(replace(said, mode=mode))  # type: ignore[arg-type]
