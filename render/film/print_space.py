"""OpenColorIO space of a print's light."""

from __future__ import annotations

import PyOpenColorIO as ocio

from render.colour import working_config


def print_space() -> str:
    """Name of the colour space in which the light of a print is: what `render.film.Grade.processor` takes as its ``light``.

    A projected print is display-referred: how bright it looks is in its curves already, and no view may bend it again. Its
    three records are taken as light of the primaries of the working space, in which the camera stock was exposed, and clear
    film as the display's white. So it is a space of the configuration that was rendered by, whichever one the grade is by.

    Raises:
        SettingsError: that configuration cannot be read.
    """
    return str(working_config().getRoleColorSpace(ocio.ROLE_SCENE_LINEAR))
