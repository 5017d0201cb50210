"""Curves over the image height: field curvature, distortion and relative illumination."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from render.drawing.page import BEAMS, FAINT, HAIRLINE, INK, TINY, draw_message
from render.model.arrays import DoubleArray
from render.optics.report import LensReport

_MIN_FOCUS_SPAN_MM, _MIN_DISTORTION_SPAN = 0.05, 1.0
"""Least half-widths of the diagrams, so that negligible errors look small."""


def draw_field_curvature(axes: Axes, report: LensReport) -> None:
    """Draw sagittal and tangential focus over the image height."""
    axes.set_title("Field curvature")
    if not report.f_stop:
        draw_message(axes, "Through a pinhole all is sharp,\nwhatever the distance.")
        return
    curves = report.curves
    axes.plot(curves.sagittal_mm, curves.heights_mm, color=BEAMS[0], label="sagittal")
    axes.plot(curves.tangential_mm, curves.heights_mm, color=BEAMS[2], linestyle="--", label="tangential")
    _center_on_zero(axes, np.concatenate([curves.sagittal_mm, curves.tangential_mm]), _MIN_FOCUS_SPAN_MM)
    _height_upward(axes, report)
    axes.set_xlabel("mm: − before the film, + behind it")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)


def draw_distortion(axes: Axes, report: LensReport) -> None:
    """Draw distortion over the image height."""
    curves = report.curves
    axes.set_title("Distortion")
    percent, across = 100 * curves.distortion, 100 * curves.distortion_across
    axes.plot(percent, curves.heights_mm, color=INK, label="up")
    _center_on_zero(axes, np.concatenate([percent, across]), _MIN_DISTORTION_SPAN)
    _height_upward(axes, report)
    axes.set_xlabel("%: − barrel, + pincushion")
    if report.camera.lens.squeeze != 1:
        axes.plot(across, curves.heights_mm, color=BEAMS[0], linestyle="--", label="across")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)


def draw_illumination(axes: Axes, report: LensReport) -> None:
    """Draw relative illumination over the image height: of the lens, without its rims, and cos⁴."""
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


def _center_on_zero(axes: Axes, values: DoubleArray, least: float) -> None:
    magnitudes = np.abs(values[np.isfinite(values)])
    reach = max(least, 1.08 * float(magnitudes.max(initial=0.0)))
    axes.set_xlim(-reach, reach)
    axes.axvline(0, color=FAINT, linewidth=0.6, zorder=1)
    axes.locator_params(axis="x", nbins=6)


def _height_upward(axes: Axes, report: LensReport) -> None:
    """Set up the axis of image height, with marks at the gate's edges."""
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
