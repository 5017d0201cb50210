"""Errors of renders."""

from __future__ import annotations

from render.errors import PullfocusError


class ConflictError(PullfocusError):
    """A render is not in a state in which that can be done."""

    default_code = "render_conflict"
