"""The six kinds of lens, of one focal length and, but for the pinhole, one f-number."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import HeightField
from tests.bench.lens_gallery.aberrations import with_errors, with_f_stop
from tests.bench.lens_gallery.entries import STREET, Entry, Section, as_it_is

_LIGHTS = (0.66, 0.16)
_F_STOP = 2.8


def model_sections() -> tuple[Section, ...]:
    """One section of all the models."""
    seidel = with_errors(_F_STOP, w040=80, w131=120, w222=60, w220=60)
    return (
        Section(
            "Kinds of lens",
            "The seven models on the shot, 50 mm at f/2.8: from a hole in a wall to surfaces measured point by point.",
            (
                _entry("pinhole", "Pinhole", "Everything is sharp.", None, with_f_stop(0.0)),
                _entry("thin", "Thin lens", "Ideal: round, even disks.", None, with_f_stop(_F_STOP)),
                _entry("seidel", "Seidel lens", "A thin lens with wavefront errors.", None, seidel),
                _entry("spherical", "Spherical lens", "Two spherical surfaces of BK7 glass.", "singlet_50", as_it_is),
                _entry(
                    "height-field",
                    "Height fields",
                    "The same glass as if cast and badly polished: waves of a few µm on both surfaces.",
                    "singlet_50",
                    cast_glass,
                ),
                _entry(
                    "data-sheet",
                    "Data sheet",
                    "The Planar by what was measured of it, and no more.",
                    "zeiss_planar_50",
                    with_f_stop(_F_STOP),
                ),
                _entry("prescription", "Prescription", "The Planar's 13 surfaces.", "planar_50", with_f_stop(_F_STOP)),
            ),
        ),
    )


def cast_glass(camera: Camera) -> Camera:
    """Give a lens of two surfaces those of badly polished glass."""
    front, back = waves(0), waves(1)
    return replace(camera, lens=replace(camera.lens, model="heightField", height_field=HeightField(front, back)))


def waves(seed: int, side: int = 128) -> DoubleArray:
    """``(side, side)`` mm: a few waves of random directions, three to six across the glass."""
    random = np.random.default_rng(seed)
    line = np.linspace(-1, 1, side)
    x, y = np.meshgrid(line, line)
    heights = np.zeros((side, side))
    for turn, count, phase in zip(
        random.uniform(0, np.pi, 5), random.uniform(1.5, 3, 5), random.uniform(0, 2 * np.pi, 5), strict=True
    ):
        heights += 1.3e-3 * np.sin(2 * np.pi * count * (x * np.cos(turn) + y * np.sin(turn)) + phase)
    return heights


def _entry(slug: str, title: str, note: str, lens: str | None, change: Callable[[Camera], Camera]) -> Entry:
    return Entry(f"model-{slug}", title, note, STREET, lens=lens, change=change, detail=_LIGHTS)
