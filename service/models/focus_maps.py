"""Focus maps: the sharpness of each pixel of a picture."""

from __future__ import annotations

from pydantic import Field

from service.models.base import Model, PrimPath, TimeCode, shown_as


class FocusMapQuery(Model):
    """A picture whose sharpness is asked for."""

    is_text = True

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/main_cam"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    width: int = Field(default=960, ge=1, le=8192, description="px", examples=[960])
    height: int | None = Field(
        default=None, ge=1, le=8192, description="px; from the camera's film gate when left out.", examples=[540]
    )


class FocusMapHead(Model):
    """Head of a focus map."""

    model_config = shown_as({"width": 480, "height": 270, "filmMmPerPx": 0.075})

    width: int = Field(description="px")
    height: int = Field(description="px; there may be fewer pixels than the picture has.")
    film_mm_per_px: float = Field(
        description="Width of a pixel on the film: twice this times a radius in px is the diameter in mm."
    )
