"""What changes with the image height: where it is sharp, how it is bent, how bright it is."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from render.drawing.page import BEAMS, FAINT, HAIRLINE, INK, TINY, say_instead
from render.model.arrays import DoubleArray
from render.optics.report import LensReport

_LEAST_FOCUS_MM, _LEAST_DISTORTION = 0.05, 1.0  # spans: what is below is not worth a steep line


def draw_field_curvature(axes: Axes, report: LensReport) -> None:
    """Sagittal and tangential focus against the image height."""
    axes.set_title("Field curvature")
    if not report.f_stop:
        say_instead(axes, "Through a pinhole all is sharp,\nwhatever the distance.")
        return
    curves = report.curves
    axes.plot(curves.sagittal_mm, curves.heights_mm, color=BEAMS[0], label="sagittal")
    axes.plot(curves.tangential_mm, curves.heights_mm, color=BEAMS[2], linestyle="--", label="tangential")
    _around_zero(axes, np.concatenate([curves.sagittal_mm, curves.tangential_mm]), _LEAST_FOCUS_MM)
    _height_upward(axes, report)
    axes.set_xlabel("mm: − before the film, + behind it")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)


def draw_distortion(axes: Axes, report: LensReport) -> None:
    """Distortion against the image height."""
    curves = report.curves
    axes.set_title("Distortion")
    percent, across = 100 * curves.distortion, 100 * curves.distortion_across
    axes.plot(percent, curves.heights_mm, color=INK, label="up")
    _around_zero(axes, np.concatenate([percent, across]), _LEAST_DISTORTION)
    _height_upward(axes, report)
    axes.set_xlabel("%: − barrel, + pincushion")
    if report.camera.lens.squeeze != 1:
        axes.plot(across, curves.heights_mm, color=BEAMS[0], linestyle="--", label="across")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)


def draw_illumination(axes: Axes, report: LensReport) -> None:
    """Relative illumination against the image height: of the lens, without its rims, and cos⁴."""
    curves = report.curves
    axes.set_title("Relative illumination")
    axes.plot(curves.heights_mm, 100 * curves.cos4, color=FAINT, linestyle=":", label="cos⁴")
    if report.focused is not None:
        axes.plot(curves.heights_mm, 100 * curves.geometric, color=BEAMS[0], linestyle="--", label="without rims")
    axes.plot(curves.heights_mm, 100 * curves.illumination, color=INK, label="this lens")
    brightest = float(np.nanmax([curves.illumination, curves.geometric]))
    axes.set_ylim(0, 105 * max(1.0, brightest))
    axes.set_xlim(0, report.corner_mm)
    axes.set_xlabel("image height, mm")
    axes.set_ylabel("% of the axis")
    axes.grid(color=HAIRLINE, linewidth=0.4)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3)


def _around_zero(axes: Axes, values: DoubleArray, least: float) -> None:
    seen = np.abs(values[np.isfinite(values)])
    reach = max(least, 1.08 * float(seen.max(initial=0.0)))
    axes.set_xlim(-reach, reach)
    axes.axvline(0, color=FAINT, linewidth=0.6, zorder=1)
    axes.locator_params(axis="x", nbins=6)


def _height_upward(axes: Axes, report: LensReport) -> None:
    """Image height, with the heights of the gate's edges."""
    camera = report.camera
    axes.set_ylim(0, report.corner_mm)
    axes.set_ylabel("image height, mm")
    axes.grid(color=HAIRLINE, linewidth=0.4)
    edges = {"top": camera.vertical_aperture_mm / 2, "sides": camera.horizontal_aperture_mm / 2}
    for name, height in edges.items():
        if math.isclose(height, report.corner_mm):
            continue
        axes.axhline(height, color=FAINT, linewidth=0.5, dashes=(2, 3), zorder=1)
        right = axes.get_xlim()[1]
        axes.text(right, height, f"{name} ", ha="right", va="bottom", fontsize=TINY, color=FAINT)
