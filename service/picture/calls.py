"""Modules of the picture process as the HTTP process sees them; see `service.stage.calls`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from service.workers.calls import RemoteModule

if TYPE_CHECKING:
    from service.picture import (
        exposure_maps,
        focus_maps,
        frames,
        live,
        long_exposure,
        metering,
        render_products,
        state,
        warming,
    )
else:
    exposure_maps = RemoteModule("service.picture.exposure_maps")
    focus_maps = RemoteModule("service.picture.focus_maps")
    frames = RemoteModule("service.picture.frames")
    live = RemoteModule("service.picture.live")
    long_exposure = RemoteModule("service.picture.long_exposure")
    metering = RemoteModule("service.picture.metering")
    render_products = RemoteModule("service.picture.render_products")
    state = RemoteModule("service.picture.state")
    warming = RemoteModule("service.picture.warming")

PRELOAD = "service.picture.preload"
"""Module that the template of the workers imports."""

__all__ = [
    "PRELOAD",
    "exposure_maps",
    "focus_maps",
    "frames",
    "live",
    "long_exposure",
    "metering",
    "render_products",
    "state",
    "warming",
]
