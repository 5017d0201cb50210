"""The last tram, its lights on, waiting at the end of the street. It faces +Z; its wheels stand on the origin's plane."""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import box, lathe, plate, ring, rounded_box, smooth_curve, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge

WIDTH_M, LENGTH_M = 2.2, 7.5


def _body_shell(y0: float, y1: float, bulge: float) -> Mesh:
    """A band of the body between two heights: flat flanks and a bowed front, as one upright surface."""
    half = WIDTH_M / 2
    plan = smooth_curve(
        [[half, -LENGTH_M], [half, -3.0], [half, -0.5], [half * 0.93, -0.16], [half * 0.6, 0.06], [0, 0.14],
         [-half * 0.6, 0.06], [-half * 0.93, -0.16], [-half, -0.5], [-half, -3.0], [-half, -LENGTH_M]], 61
    )  # fmt: skip

    def shape(u: Array, v: Array) -> Array:
        index = np.clip((1 - u) * 60, 0, 60)
        x, z = (np.interp(index, np.arange(61), plan[:, k]) for k in range(2))
        lean = bulge * np.sin(np.pi * v)
        return np.stack([x * (1 + lean), y0 + v * (y1 - y0), z + lean], axis=-1)

    return surface(shape, 61, 7)


def _front_windows() -> tuple[Mesh, Mesh]:
    """The three panes of the driver's cab, and their frames."""
    panes, frames = [], []
    for x, width, yaw, z in ((-0.70, 0.52, -27, 0.06), (0.0, 0.72, 0, 0.17), (0.70, 0.52, 27, 0.06)):
        panes.append(plate(width, 0.86).rotate(y=yaw).at(x, 1.92, z))
        bars = [rounded_box([width + 0.08, 0.07, 0.06], 0.02, 1).at(0, y, 0) for y in (-0.45, 0.45)]
        bars += [rounded_box([0.07, 0.96, 0.06], 0.02, 1).at(side * (width / 2 + 0.01), 0, 0) for side in (-1, 1)]
        frames.append(merge(bars).rotate(y=yaw).at(x, 1.92, z))
    return merge(panes), merge(frames)


def _side_windows() -> Mesh:
    panes = []
    for k in range(6):
        for side in (-1, 1):
            pane = plate(0.86, 0.80).rotate(y=90 * side)
            panes.append(pane.at(side * (WIDTH_M / 2 + 0.02), 1.93, -1.1 - 1.03 * k))
    return merge(panes)


def tram() -> dict[str, Mesh]:
    """The tram, by look."""
    panes, frames = _front_windows()
    roof = rounded_box([WIDTH_M + 0.06, 0.34, LENGTH_M + 0.1], 0.16, 4).at(0, 2.62, -LENGTH_M / 2 + 0.05)
    monitor = rounded_box([1.2, 0.2, LENGTH_M * 0.7], 0.08, 3).at(0, 2.82, -LENGTH_M / 2)
    sign = rounded_box([1.0, 0.28, 0.16], 0.05, 2).at(0, 2.60, 0.16)
    lamps = [lathe([[0.11, 0.0], [0.08, 0.03], [0.0, 0.045]], 24).rotate(x=90).at(x, 0.98, 0.09) for x in (-0.62, 0.62)]
    rims = [ring(0.125, 0.022, 28, 8).rotate(x=90).at(x, 0.98, 0.09) for x in (-0.62, 0.62)]
    bumper = rounded_box([1.7, 0.2, 0.3], 0.08, 3).at(0, 0.42, 0.12)
    skirt = box([WIDTH_M - 0.2, 0.4, LENGTH_M - 0.6]).at(0, 0.3, -LENGTH_M / 2)
    pole = tube([[0, 2.9, -3.2], [0, 3.5, -2.2], [0, 4.25, -3.3]], 0.025, 8)
    mouldings = [rounded_box([1.9, 0.05, 0.05], 0.02, 1).at(0, y, 0.13) for y in (1.36, 0.72)]
    return {
        "EnamelTeal": merge([_body_shell(0.45, 1.38, 0.012), bumper]),
        "EnamelCream": merge([_body_shell(1.38, 2.52, 0.0), roof, monitor]),
        "TramGlow": merge([panes, _side_windows(), plate(0.86, 0.18).at(0, 2.60, 0.245)]),
        "HeadLamp": merge(lamps),
        "Brass": merge([*rims, *mouldings]),
        "Iron": merge([frames, sign, skirt, pole]),
    }
