"""Part of a picture."""

from __future__ import annotations

Area = tuple[int, int, int, int]
"""Left, top, width and height in pixels."""
