"""From radiance to the picture that is shown: exposure, then the display transform.

This is the only room that leaves scene-linear light.
"""

from render.film.develop import develop
from render.film.grade import Grade, list_displays

__all__ = ["Grade", "develop", "list_displays"]
