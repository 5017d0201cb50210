"""Glasses of the catalogue, for tests that are sure of their names."""

from __future__ import annotations

from render.model.lens import Glass
from render.optics.dispersion.names import find_glass


def glass(name: str) -> Glass:
    """The glass of that name."""
    found = find_glass(name)
    assert found is not None, name
    return found
