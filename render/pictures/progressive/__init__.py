"""Progressive pictures: for each change a quick preview, then better pictures up to the exact one.

Importing this package loads no OpenGL. `renderer.ProgressiveRenderer` needs it, and is imported by its own name.
"""

from render.pictures.progressive.request import PreviewRequest, ProgressivePicture, Timing

__all__ = ["PreviewRequest", "ProgressivePicture", "Timing"]
