"""From radiance to the picture that is shown: exposure, film or sensor, then the display transform.

This is the only room that leaves scene-linear light.
"""

from render.film.cdl import Cdl, read_cdl
from render.film.develop import develop, project
from render.film.grade import Grade, list_displays, list_looks
from render.film.grade_choice import GradeChoice
from render.film.print_space import print_space
from render.film.process import develop_on_film
from render.film.settings import FilmSettings, film_settings

__all__ = [
    "Cdl",
    "FilmSettings",
    "Grade",
    "GradeChoice",
    "develop",
    "develop_on_film",
    "film_settings",
    "list_displays",
    "list_looks",
    "print_space",
    "project",
    "read_cdl",
]
