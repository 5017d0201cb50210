"""Limits of a frame's settings. Settings are checked against them before anything slow is done; the code that works within
them imports them from here."""

from __future__ import annotations

from render.errors import SettingsError

MAX_PICTURE_SIDE_PX = 16384
MAX_RAYS = 4096
"""Lens rays per pixel."""
MAX_LAYERS = 8
"""Peeled layers."""
MAX_WAVELENGTHS = 64
MAX_CLIP_PLANES = 8
"""Clip planes of a camera: as many as OpenGL guarantees."""


def check_picture_size(width: int, height: int) -> None:
    """Raise `SettingsError` unless the picture has a size that can be rendered."""
    for name, value in (("width", width), ("height", height)):
        if not 1 <= value <= MAX_PICTURE_SIDE_PX:
            raise SettingsError(f"picture {name} must be from 1 to {MAX_PICTURE_SIDE_PX} pixels, got {value}")
