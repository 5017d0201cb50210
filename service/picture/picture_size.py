"""How many pixels a picture may have, whether its height is asked for or follows from the camera's film gate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.errors import SettingsError

if TYPE_CHECKING:
    from render.shot import Shot


def check_pixels(width: int, height: int | None, max_px: int, path: str = "query.width") -> None:
    """Raise `SettingsError` where more pixels are asked for than are rendered.

    Args:
        width: px.
        height: px; None where it is not known yet, and at least 1.
        max_px: pixels (width · height) of one picture.
        path: of the parameter that says the width.
    """
    if width * (height or 1) > max_px:
        size = f"{width} px wide" if height is None else f"of {width} × {height} px"
        detail = f"A picture {size} was asked for; at most {max_px:,} px are rendered."
        raise SettingsError(detail, code="too_many_pixels", path=path)


def height_at(shot: Shot, camera: str | None, time: float, width: int, max_px: int, path: str = "query.width") -> int:
    """The height in pixels at which a picture shows the camera's own film gate.

    Args:
        shot: the shot.
        camera: prim path, or None for the default camera.
        time: USD time code.
        width: px.
        max_px: as for `check_pixels`.
        path: likewise.

    Raises:
        SettingsError: that many pixels are not rendered.
        CameraError: it is no camera, or has impossible numbers.
    """
    from render.pictures.picture_height import picture_height

    height = picture_height(shot, camera, time, width)
    check_pixels(width, height, max_px, path)
    return height
