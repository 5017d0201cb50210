"""ApertureAPI: the shape and weighting of the iris."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.setting import Asset, Floats, schema_group, setting


@schema_group("Aperture")
@dataclass(frozen=True)
class ApertureData:
    """ApertureAPI: the shape and weighting of the iris."""

    blades: int = setting(
        "aperture:blades",
        0,
        "Blades",
        "Number of blades, the corners of an out-of-focus point; 0 for a round iris.",
        "1 and 2 make no iris.",
        unit="none, a count",
        hard=(0, None),
        soft=(None, 15),
    )
    roundness: float = setting(
        "aperture:roundness",
        0.0,
        "Roundness",
        "Curvature of the blades: 0 a polygon with straight sides, 1 a circle.",
        unit="none, a ratio from 0 to 1",
        hard=(0, 1),
    )
    rotation: float = setting(
        "aperture:rotation",
        0.0,
        "Rotation",
        "Turn of the iris about the view axis, counter-clockwise as seen in the picture; at 0 one corner is on the "
        "right.",
        unit="degrees",
        soft=(-180, 180),
    )
    mask: Asset = setting(
        "aperture:mask",
        Asset(),
        "Mask",
        "Image of the pupil as a point behind the focus shows it in the picture, inscribed in the square around it: "
        "its first channel, read as raw numbers, is how much light passes.",
        "It takes the place of blades and roundness.",
        unit="none, a file",
    )
    radial_weights: Floats = setting(
        "aperture:radialWeights",
        (),
        "Radial Weights",
        "Light that each radius of the pupil lets through, at even steps from centre to edge, joined by "
        "straight lines: falling for soft bokeh, rising for hard edges, 0 in the middle for the rings of a mirror "
        "lens.",
        "The mean over the pupil is brought to 1, so that exposure does not change. Empty for an even pupil.",
        unit="none, ratios of 0 or more",
    )
