"""Focus maps: the sharpness of each pixel of a picture."""

from __future__ import annotations

from pydantic import Field

from service.models.base import Model, shown_as


class FocusMapHead(Model):
    """Head of a focus map."""

    model_config = shown_as({"width": 480, "height": 270, "filmMmPerPx": 0.075})

    width: int = Field(description="px")
    height: int = Field(description="px; there may be fewer pixels than the picture has.")
    film_mm_per_px: float = Field(
        description="Width of a pixel on the film: twice this times a radius in px is the diameter in mm."
    )
