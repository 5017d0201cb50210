"""Exposure maps: how bright each pixel of a picture is, in stops from grey."""

from __future__ import annotations

from pydantic import Field

from service.models.base import Model, shown_as


class ExposureMapHead(Model):
    """Head of an exposure map."""

    model_config = shown_as({"width": 480, "height": 270, "stepsPerStop": 256})

    width: int = Field(description="px")
    height: int = Field(description="px")
    steps_per_stop: int = Field(description="Steps of the map's numbers to a stop.")
