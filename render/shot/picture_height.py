"""Height of a picture whose width is given."""

from __future__ import annotations

from render.model.gate_height import gate_height_px
from render.shot.shot import Shot
from render.stage import read_camera


def picture_height(shot: Shot, camera_path: str | None, time: float, width: int) -> int:
    """Give the height in pixels at which a picture shows the camera's film gate (`gate_height_px`).

    The gate is conformed to that shape when the camera is read.

    Args:
        shot: the shot.
        camera_path: prim path; None for the shot's default camera.
        time: USD time code.
        width: of the picture in pixels.

    Raises:
        SettingsError: the width is out of range.
        CameraError: the prim is no camera, or has impossible values.
    """
    if camera_path is None:
        choice = shot.default_camera()
        camera = choice.framing or read_camera(shot.stage, str(choice.path), time)
    else:
        camera = read_camera(shot.stage, camera_path, time)
    return gate_height_px(camera, width)
