"""Height of a picture that shows a camera's film gate."""

from __future__ import annotations

import numpy as np

from render.errors import CameraError
from render.model.camera import Camera
from render.model.limits import check_picture_size


def gate_height_px(camera: Camera, width_px: int) -> int:
    """Give the height in pixels at which a picture shows the camera's film gate: that of usdrecord, to the pixel.

    It is the width over the aspect ratio in single precision, without its fraction, as in ``UsdAppUtilsFrameRecorder``
    (OpenUSD).

    Args:
        camera: with its own film gate.
        width_px: of the picture.

    Raises:
        SettingsError: the width is out of range.
        CameraError: the film gate has no size.
    """
    check_picture_size(width_px, 1)
    if not (camera.horizontal_aperture_mm > 0 and camera.vertical_aperture_mm > 0):
        gate = f"{camera.horizontal_aperture_mm:g} × {camera.vertical_aperture_mm:g} mm"
        raise CameraError(f"the film gate of {camera.path} must be larger than 0, got {gate}", path=camera.path)
    aspect = np.float32(camera.horizontal_aperture_mm) / np.float32(camera.vertical_aperture_mm)
    return max(1, int(np.float32(width_px) / aspect))
