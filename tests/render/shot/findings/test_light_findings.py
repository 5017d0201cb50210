"""Lights that the renderer has no room for are findings, not dropped in silence (DESIGN, section 7)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.layers.lights import MAX_LIGHTS, select_lights
from render.model.light_filters import MAX_FILTERS, Barn, LightFilter, Window
from render.model.scene import Light
from render.shot.findings.camera_findings import light_findings


def bulb(number: int, radiance: float = 1.0, *, casts: bool = True) -> Light:
    return Light("sphere", (radiance,) * 3, np.eye(4), radius_m=0.1, casts_shadow=casts, path=f"/bulb{number}")


def test_six_bare_bulbs_cast_shadows_and_the_weakest_of_seven_none() -> None:
    others = tuple(bulb(i, 2.0 + i) for i in range(2, 7))
    assert light_findings((bulb(0, 3.0), *others)) == []
    notes = light_findings((bulb(0, 3.0), bulb(1, 1.0), *others, bulb(7, 0.1, casts=False)))
    assert [(f.code, f.path) for f in notes] == [("shadow_maps", "/bulb1")]


def test_the_weakest_of_too_many_lights_are_named() -> None:
    lights = tuple(bulb(i, 1.0 + i, casts=False) for i in range(MAX_LIGHTS + 2))
    assert len(select_lights(lights)) == MAX_LIGHTS
    assert [f.path for f in light_findings(lights)] == ["/bulb0", "/bulb1"]


def test_lights_with_more_filters_than_there_is_room_for() -> None:
    window = Window((1.0, 1.0, 1.0, 1.0))
    filters = (LightFilter(Barn(window), np.eye(4)),) * MAX_FILTERS
    lights = replace(bulb(0, casts=False), filters=filters), replace(bulb(1, casts=False), filters=filters[:1])
    (finding,) = light_findings(lights)
    assert (finding.code, finding.path) == ("too_many_filters", "/bulb1")
