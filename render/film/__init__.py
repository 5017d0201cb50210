"""From radiance to the picture that is shown: exposure, then the display transform.

This is the only room that leaves scene-linear light.
"""

from render.film.cdl import Cdl, read_cdl
from render.film.develop import develop, project
from render.film.grade import Grade, list_displays, list_looks

__all__ = ["Cdl", "Grade", "develop", "list_displays", "list_looks", "project", "read_cdl"]
