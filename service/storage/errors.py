"""Errors of what the service stores in."""

from __future__ import annotations

from render.errors import OutputError


class UnavailableError(OutputError):
    """The database or the bucket cannot be used now; another try may succeed."""
