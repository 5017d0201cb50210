"""How a camera exposes and what a light meter says of it, for people and for programs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.table import Table

from render.cli.report import finite, print_result
from render.shot.exposure.metering import Metered
from render.shot.exposure.readout import ExposureReadout


def meter_json(said: Metered) -> dict[str, Any]:
    """What a meter says, under the names that the service uses too; what is infinite or no number is null.

    Args:
        said: by the meter.
    """
    reading = said.reading
    numbers = {
        "luminanceNits": reading.luminance_nits,
        "ev100": reading.ev100,
        "incidentLux": reading.incident_lux,
        "luxOnFilm": said.lux_on_film,
        "stops": reading.stops,
        "compensationStops": said.compensation_stops,
    }
    place = None if said.place is None else list(said.place)
    return {"time": said.time, "mode": said.mode, "place": place, **finite(numbers), **exposure_json(said.exposure)}


def exposure_json(read: ExposureReadout) -> dict[str, Any]:
    """How a camera exposes, for programs.

    Args:
        read: of the camera.
    """
    settings, path = read.settings, read.path
    lens = (
        {
            "fStop": path.f_stop,
            "tStop": path.t_stop,
            "effectiveFStop": path.effective_f_stop,
            "effectiveTStop": path.effective_t_stop,
            "magnification": path.magnification,
            "pupilMagnification": path.pupil_magnification,
            "bellowsFactor": path.bellows_factor,
        }
        if path
        else None
    )
    return {
        "exposure": finite(
            {
                "timeS": settings.time_s,
                "iso": settings.iso,
                "stop": settings.f_stop,
                "stopFrom": read.stop,
                "isTStop": read.is_t_stop,
                "compensationStops": settings.compensation_stops,
                "responsivity": settings.responsivity,
                "ev100": read.ev100,
                "scale": read.scale,
                "greyNits": read.grey_nits,
                "neutralDensity": read.neutral_density,
                "ndStops": read.nd_stops,
                "shutterAngleDeg": math.degrees(read.shutter_angle_rad),
                "shutterTimeS": read.shutter_time_s,
            }
        ),
        "lens": finite(lens) if lens else None,
        "equivalents": [{"stop": e.f_stop, "timeS": e.time_s} for e in read.equivalents()],
    }


def print_meter(said: Sequence[Metered]) -> None:
    """Print what a meter says, for people.

    Args:
        said: by the meter, in order of time; at least once.
    """
    print("\n".join(exposure_lines(said[0].exposure)))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title in ("frame", "looks at", "nits", "EV 100", "lux on film", "over, under", "compensation"):
        table.add_column(title, no_wrap=True, justify="left" if title == "looks at" else "right")
    for one in said:
        reading = one.reading
        where = f"{one.mode} {one.place[0]:.2f}, {one.place[1]:.2f}" if one.place else one.mode
        is_dark = reading.luminance_nits == 0
        table.add_row(
            f"{one.time:g}",
            f"{where}, not in the picture" if one.mode == "spot" and not one.place else where,
            f"{reading.luminance_nits:.4g}",
            "black" if is_dark else f"{reading.ev100:.2f}",
            f"{one.lux_on_film:.3g}",
            "" if is_dark else f"{reading.stops:+.2f}",
            "" if math.isnan(one.compensation_stops) else f"{one.compensation_stops:+.2f}",
        )
    print_result(table)


def exposure_lines(read: ExposureReadout) -> list[str]:
    """How a camera exposes, for people.

    Args:
        read: of the camera.
    """
    path, mark = read.path, _mark(read)
    lines = [
        read.camera,
        f"  exposed   {exposed_line(read)}",
        f"  shutter   {math.degrees(read.shutter_angle_rad):.4g}°, {_seconds(read.shutter_time_s)}",
    ]
    if path is not None:
        lines.append(
            f"  lens      f/{path.f_stop:.3g}, T{path.t_stop:.3g}; as focused f/{path.effective_f_stop:.3g},"
            f" T{path.effective_t_stop:.3g} (m {path.magnification:.3g}, pupils {path.pupil_magnification:.3g},"
            f" bellows {path.bellows_factor:.3g})"
        )
    if read.neutral_density:
        lines.append(f"  filter    ND {read.neutral_density:g}, {read.nd_stops:.2g} stops")
    same = "   ".join(f"{mark}{e.f_stop:.2g} {_seconds(e.time_s)}" for e in read.equivalents((-2, -1, 0, 1, 2)))
    return [*lines, f"  the same  {same}"]


def exposed_line(read: ExposureReadout) -> str:
    """What a camera's exposure is set to, in a line.

    Args:
        read: of the camera.
    """
    settings = read.settings
    stop = f"{_mark(read)}{settings.f_stop:.3g} ({'the iris' if read.stop == 'iris' else 'exposure:fStop'})"
    return (
        f"{_seconds(settings.time_s)}, {stop}, ISO {settings.iso:g}, {settings.compensation_stops:+.2g} stops:"
        f" EV {read.ev100:.2f}, middle grey is {read.grey_nits:.4g} nits"
    )


def _mark(read: ExposureReadout) -> str:
    return "T" if read.is_t_stop else "f/"


def _seconds(time_s: float) -> str:
    return f"1/{1 / time_s:.4g} s" if 0 < time_s < 0.3 else f"{time_s:.3g} s"
