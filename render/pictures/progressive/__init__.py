"""Better and better pictures of one change after the other. What needs OpenGL is imported by name, from `driver`."""

from render.pictures.progressive.asked import Asked, Shown, Timing

__all__ = ["Asked", "Shown", "Timing"]
