"""Splines and their values as usd-core has them, which the page's own curves are compared with (`tests/web/spline.test.ts`).

``python -m tests.usd_schemas.spline_cases`` writes the file anew.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Ts, Usd

from usd_schemas.keys import Interpolation, Key, Tangents, keys, set_key

FILE = Path(__file__).parents[1] / "web" / "splines.json"
SHAPES: dict[str, list[Key]] = {
    "one key": [Key(5, 2.0, "auto")],
    "held and linear": [Key(0, 1.0, "held"), Key(8, 3.0, "linear"), Key(20, -2.0, "held"), Key(24, 0.0, "linear")],
    "eased, monotone": [Key(0, 0.0, "auto"), Key(10, 1.0, "auto"), Key(20, 5.0, "auto"), Key(40, 4.0, "auto")],
    "eased, falling at uneven steps": [Key(t, v, "auto") for t, v in ((0, 9.0), (1, 8.5), (13, 3.0), (14.5, 0.1))],
    "eased between straight ones": [
        Key(0, 0.0, "linear"),
        Key(6, 2.0, "auto"),
        Key(12, 5.0, "linear"),
        Key(18, 6.0, "held"),
        Key(20, 7.0, "auto"),
        Key(25, 8.0, "auto"),
    ],
    "own handles": [
        Key(0, 0.0, "bezier", Tangents(0.0, 0.0, 0.5, 4.0)),
        Key(12, 3.0, "bezier", Tangents(-0.25, 6.0, 1.0, 2.0)),
        Key(24, 1.0, "bezier", Tangents(0.0, 3.0, 0.0, 0.0)),
    ],
    "handles of no width": [Key(0, 0.0, "bezier", Tangents(0.0, 0.0, 0.2, 0.0)), Key(9, 2.0, "bezier", Tangents(0.3))],
    "handles that run past each other": [
        Key(0, 0.0, "bezier", Tangents(0.0, 0.0, 0.1, 18.0)),
        Key(10, 4.0, "bezier", Tangents(0.2, 15.0, 0.0, 1.0)),
        Key(20, 2.0, "bezier", Tangents(0.0, 12.0, 0.0, 0.0)),
    ],
    "curved into a straight key": [Key(0, 1.0, "bezier", Tangents(0.0, 0.0, 0.4, 5.0)), Key(10, 2.0, "linear")],
}


def make_cases() -> list[dict[str, Any]]:
    """Author each spline and evaluate it, between its keys and beyond them."""
    return [_case(name, shape) for name, shape in SHAPES.items()]


def _case(name: str, shape: list[Key]) -> dict[str, Any]:
    stage = Usd.Stage.CreateInMemory()
    attribute = stage.DefinePrim("/spline").CreateAttribute("value", Sdf.ValueTypeNames.Double)
    with Ts.AntiRegressionAuthoringSelector(Ts.AntiRegressionNone):  # as files of other tools have it
        for key in shape:
            set_key(attribute, key.time, key.value, key.interpolation, key.tangents)
    times = np.linspace(shape[0].time - 2, shape[-1].time + 2, 58).round(4)
    return {
        "name": name,
        "keys": [_in_rest(key) for key in keys(attribute)],
        "values": [[float(time), attribute.Get(float(time))] for time in times],
    }


def _in_rest(key: Key) -> dict[str, Any]:
    interpolation: Interpolation = key.interpolation
    sent: dict[str, Any] = {"time": key.time, "value": key.value, "interpolation": interpolation}
    if key.tangents is not None:
        slopes = key.tangents
        sent["tangents"] = {
            "inSlope": slopes.in_slope,
            "inWidth": slopes.in_width,
            "outSlope": slopes.out_slope,
            "outWidth": slopes.out_width,
        }
    return sent


if __name__ == "__main__":
    FILE.write_text(json.dumps(make_cases(), separators=(",", ":")) + "\n")
