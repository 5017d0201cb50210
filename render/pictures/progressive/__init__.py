"""Better and better pictures of one change after the other. What needs OpenGL is imported by name, from `driver`."""

from render.pictures.progressive.request import PreviewRequest, Shown, Timing

__all__ = ["PreviewRequest", "Shown", "Timing"]
