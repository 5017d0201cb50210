"""Limit of the pixels of one picture. The worker checks it where the height follows from the film gate."""

from __future__ import annotations

from render.errors import SettingsError


def check_pixels(width: int, height: int | None, max_px: int, path: str = "query.width") -> None:
    """Check that a picture is not too large.

    Args:
        width: px.
        height: px; None where it is not known yet, which counts as 1.
        max_px: limit of width times height.
        path: the parameter that sets the width, for the message.

    Raises:
        SettingsError: it has more pixels than are rendered.
    """
    if width * (height or 1) > max_px:
        size = f"{width} px wide" if height is None else f"of {width} × {height} px"
        detail = f"A picture {size} was requested; at most {max_px:,} px are rendered."
        raise SettingsError(detail, code="too_many_pixels", path=path)
