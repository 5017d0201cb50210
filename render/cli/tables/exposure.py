"""Exposure of a camera and readings of a light meter, as tables and as JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.table import Table

from render.cli.console import finite
from render.cli.rich_output import print_result
from render.shot.exposure.metering import Metered
from render.shot.exposure.readout import ExposureReadout


def meter_json(metered: Metered) -> dict[str, Any]:
    """Convert a reading to JSON with the keys of the REST service; infinities and NaN are null.

    Args:
        metered: by the meter.
    """
    reading = metered.reading
    numbers = {
        "luminanceNits": reading.luminance_nits,
        "ev100": reading.ev100,
        "incidentLux": reading.incident_lux,
        "luxOnFilm": metered.lux_on_film,
        "stops": reading.stops,
        "compensationStops": metered.compensation_stops,
    }
    place = None if metered.place is None else list(metered.place)
    return {
        "time": metered.time,
        "mode": metered.mode,
        "place": place,
        **finite(numbers),
        **exposure_json(metered.exposure),
    }


def exposure_json(exposure: ExposureReadout) -> dict[str, Any]:
    """Convert an exposure to JSON.

    Args:
        exposure: of a camera.
    """
    settings, path = exposure.settings, exposure.path
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
                "stopFrom": exposure.stop,
                "isTStop": exposure.is_t_stop,
                "compensationStops": settings.compensation_stops,
                "responsivity": settings.responsivity,
                "ev100": exposure.ev100,
                "scale": exposure.scale,
                "greyNits": exposure.grey_nits,
                "neutralDensity": exposure.neutral_density,
                "ndStops": exposure.nd_stops,
                "shutterAngleDeg": math.degrees(exposure.shutter_angle_rad),
                "shutterTimeS": exposure.shutter_time_s,
            }
        ),
        "lens": finite(lens) if lens else None,
        "equivalents": [{"stop": e.f_stop, "timeS": e.time_s} for e in exposure.equivalents()],
    }


def print_readings(readings: Sequence[Metered]) -> None:
    """Print readings of a meter as a table.

    Args:
        readings: in order of time; at least metered.
    """
    print("\n".join(exposure_lines(readings[0].exposure)))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title in ("frame", "looks at", "nits", "EV 100", "lux on film", "over, under", "compensation"):
        table.add_column(title, no_wrap=True, justify="left" if title == "looks at" else "right")
    for metered in readings:
        reading = metered.reading
        where = f"{metered.mode} {metered.place[0]:.2f}, {metered.place[1]:.2f}" if metered.place else metered.mode
        is_dark = reading.luminance_nits == 0
        table.add_row(
            f"{metered.time:g}",
            f"{where}, not in the picture" if metered.mode == "spot" and not metered.place else where,
            f"{reading.luminance_nits:.4g}",
            "black" if is_dark else f"{reading.ev100:.2f}",
            f"{metered.lux_on_film:.3g}",
            f"{reading.stops:+.2f}" if math.isfinite(reading.stops) else "",
            "" if math.isnan(metered.compensation_stops) else f"{metered.compensation_stops:+.2f}",
        )
    print_result(table)


def exposure_lines(exposure: ExposureReadout) -> list[str]:
    """Describe an exposure in lines.

    Args:
        exposure: of a camera.
    """
    path, mark = exposure.path, _mark(exposure)
    lines = [
        exposure.camera,
        f"  exposed   {exposure_line(exposure)}",
        f"  shutter   {math.degrees(exposure.shutter_angle_rad):.4g}°, {_seconds(exposure.shutter_time_s)}",
    ]
    if path is not None:
        lines.append(
            f"  lens      f/{path.f_stop:.3g}, T{path.t_stop:.3g}; as focused f/{path.effective_f_stop:.3g},"
            f" T{path.effective_t_stop:.3g} (m {path.magnification:.3g}, pupils {path.pupil_magnification:.3g},"
            f" bellows {path.bellows_factor:.3g})"
        )
    if exposure.neutral_density:
        lines.append(f"  filter    ND {exposure.neutral_density:g}, {exposure.nd_stops:.2g} stops")
    same = "   ".join(f"{mark}{e.f_stop:.2g} {_seconds(e.time_s)}" for e in exposure.equivalents((-2, -1, 0, 1, 2)))
    return [*lines, f"  the same  {same}"]


def exposure_line(exposure: ExposureReadout) -> str:
    """Describe the settings of an exposure in one line.

    Args:
        exposure: of a camera.
    """
    settings = exposure.settings
    stop = f"{_mark(exposure)}{settings.f_stop:.3g} ({'the iris' if exposure.stop == 'iris' else 'exposure:fStop'})"
    return (
        f"{_seconds(settings.time_s)}, {stop}, ISO {settings.iso:g}, {settings.compensation_stops:+.2g} stops:"
        f" EV {exposure.ev100:.2f}, middle grey is {exposure.grey_nits:.4g} nits"
    )


def _mark(exposure: ExposureReadout) -> str:
    return "T" if exposure.is_t_stop else "f/"


def _seconds(time_s: float) -> str:
    return f"1/{1 / time_s:.4g} s" if 0 < time_s < 0.3 else f"{time_s:.3g} s"
