"""Height of a picture whose width is given."""

from __future__ import annotations

import numpy as np

from render.errors import CameraError
from render.model.limits import check_picture_size
from render.shot.shot import Shot
from render.stage import read_camera


def picture_height(shot: Shot, camera_path: str | None, time: float, width: int) -> int:
    """Give the height in pixels at which a picture shows the camera's film gate: that of usdrecord, to the pixel.

    It is the width over the aspect ratio in single precision, without its fraction, as in ``UsdAppUtilsFrameRecorder``
    (OpenUSD). The gate is conformed to that shape when the camera is read.

    Args:
        shot: the shot.
        camera_path: prim path; None for the shot's default camera.
        time: USD time code.
        width: of the picture in pixels.

    Raises:
        SettingsError: the width is out of range.
        CameraError: the prim is no camera, or has impossible values.
    """
    check_picture_size(width, 1)
    if camera_path is None:
        choice = shot.default_camera()
        camera = choice.framing or read_camera(shot.stage, str(choice.path), time)
    else:
        camera = read_camera(shot.stage, camera_path, time)
    if not (camera.horizontal_aperture_mm > 0 and camera.vertical_aperture_mm > 0):
        gate = f"{camera.horizontal_aperture_mm:g} × {camera.vertical_aperture_mm:g} mm"
        raise CameraError(f"the film gate of {camera.path} must be larger than 0, got {gate}", path=camera.path)
    aspect = np.float32(camera.horizontal_aperture_mm) / np.float32(camera.vertical_aperture_mm)
    return max(1, int(np.float32(width) / aspect))
