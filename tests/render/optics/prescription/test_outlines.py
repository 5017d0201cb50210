"""Openings and obscurations of surfaces, by closed forms of the light that they let through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.lens import Across, Outline, Prescription, Surface
from render.optics.prescription.beams import best_focus_mm
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.focusing import focus_lens
from render.optics.prescription.meridians import turned
from render.optics.prescription.outlines import clearance, excess, reach_mm
from render.optics.prescription.stop_rays import rays_from_film
from render.optics.prescription.tracing import Fate, trace_forward
from render.optics.prescription.validation import check_prescription
from tests.render.kits.outlined_lenses import DISC, RADIUS, lens, passed_share

LENS_OF_CIRCLES = 2 * np.arccos(0.25) * RADIUS**2 - 2.5 * np.sqrt(4 * RADIUS**2 - 25)  # two circles 5 mm apart


@pytest.mark.parametrize(
    ("opening", "obscuration", "area"),
    [
        (None, Outline("ellipse", (4.0, 4.0)), DISC - 16 * np.pi),
        (Outline("rectangle", (6.0, 3.0)), None, 72.0),
        (Outline("ellipse", (8.0, 3.0)), None, 24 * np.pi),
        (None, Outline("ellipse", (5.0, 2.0), (1.0, -3.0)), DISC - 10 * np.pi),
        (None, Outline("rectangle", (2.0, 5.0), (2.0, 1.0)), DISC - 40),
        (Outline("ellipse", (10.0, 10.0), (5.0, 0.0)), None, LENS_OF_CIRCLES),
        (Outline("rectangle", (6.0, 3.0)), Outline("ellipse", (2.0, 2.0)), 72 - 4 * np.pi),
    ],
)
def test_the_light_that_passes_is_the_area_left_open(
    opening: Outline | None, obscuration: Outline | None, area: float
) -> None:
    assert passed_share(lens(opening, obscuration)) == pytest.approx(area / DISC, abs=1e-3)


def test_a_ring_leaves_the_f_number_as_it_was() -> None:
    plain, ring = (complete_prescription(lens(obscuration=each)) for each in (None, Outline("ellipse", (4.0, 4.0))))
    assert ring.f_stop == plain.f_stop
    assert ring.notes == plain.notes


def test_a_ring_is_focused_for_the_rays_that_pass() -> None:
    """Spherical aberration brings them together nearer than the whole beam, whose middle focuses longest."""
    plain, narrow, beside = (
        best_focus_mm(lens(obscuration=each), -np.inf, RADIUS)
        for each in (
            None,
            Outline("ellipse", (8.0, 8.0)),
            Outline("ellipse", (1.0, 1.0), (9.0, 0.0)),  # beside the rays that are looked at
        )
    )
    assert narrow < plain - 0.1
    assert beside == plain


def test_rays_from_the_film_have_the_clearance_of_outlines() -> None:
    closed = complete_prescription(lens(Outline("rectangle", (6.0, 3.0)), Outline("ellipse", (1.0, 1.0))))
    focused = focus_lens(closed, np.inf, 5.0)
    stops = np.array([[0.5, 0.1], [0.7, 0.0], [0.0, 0.4], [0.02, 0.02]])
    found = rays_from_film(focused, np.zeros((4, 2)), stops * RADIUS / focused.stop_radius_mm)
    assert list(found.front > 0) == [False, True, True, True]
    np.testing.assert_allclose(
        found.front[:3], [25 / 36 - 1, 49 / 36 - 1, 16 / 9 - 1], atol=2e-3
    )  # of the rectangle, in squares


def test_directions_of_outlines_are_those_of_the_picture() -> None:
    points = np.array([[3.0, 0.0], [-3.0, 0.0], [0.0, 3.0]])
    right = Surface(0.0, 1.0, obscuration=Outline("ellipse", (2.0, 2.0), (3.0, 0.0)))
    assert list(clearance(right, points) > 0) == [True, False, False]
    up = turned(Prescription((right,))).surfaces[0]
    assert list(clearance(up, points) > 0) == [False, False, True]


def test_a_blocked_ray_says_where() -> None:
    traced = trace_forward(lens(obscuration=Outline("ellipse", (4.0, 4.0))), np.zeros((1, 3)), np.array([[0, 0, 1.0]]))
    assert (traced.fates[0], traced.stopped_by[0]) == (Fate.BLOCKED, 0)
    free = trace_forward(
        lens(obscuration=Outline("ellipse", (4.0, 4.0))), np.zeros((1, 3)), np.array([[0, 0, 1.0]]), clip=False
    )
    assert free.passes[0]


def test_a_scaled_lens_has_scaled_outlines() -> None:
    whole = lens(Outline("rectangle", (6.0, 3.0), (1.0, 2.0)), Outline("ellipse", (1.0, 1.5)))
    half = scale_prescription(whole, 0.5).surfaces[0]
    assert half.opening == Outline("rectangle", (3.0, 1.5), (0.5, 1.0))
    assert half.obscuration == Outline("ellipse", (0.5, 0.75))


@pytest.mark.parametrize("kind", ["ellipse", "rectangle"])
@pytest.mark.parametrize("half", [(5.0, 5.0), (2.0, 7.0)])
def test_the_farthest_point_of_an_outline(kind: str, half: tuple[float, float]) -> None:
    outline = Outline("ellipse" if kind == "ellipse" else "rectangle", half, (-3.0, 2.0))
    line = np.linspace(-20, 20, 2001)
    points: DoubleArray = np.stack(np.meshgrid(line, line), axis=-1)
    inside = points[excess(outline, points) <= 0]
    assert reach_mm(outline) == pytest.approx(np.hypot(*inside.T).max(), abs=0.03)


@pytest.mark.parametrize(
    ("opening", "obscuration", "message"),
    [
        (
            Outline("rectangle", (-6.0, 3.0)),
            None,
            "opening must be from 0.002 to 200000 mm wide and high, got -12 and 6",
        ),
        (Outline("ellipse", (np.nan, 3.0)), None, "opening must be from 0.002 .* got nan and 6"),
        (None, Outline("ellipse", (1e300, 1e300)), "obscuration must be from 0.002 .* got 2e\\+300"),
        (None, Outline("ellipse", (0.0, 1.0)), "obscuration must be from 0.002 .* got 0 and 2"),
        (None, Outline("ellipse", (1.0, 1.0), (np.inf, 0.0)), "centre of its obscuration must be within 100000 mm"),
        (None, Outline("ellipse", (12.0, 12.0)), "clear diameter, opening and obscuration leave nothing open"),
        (Outline("ellipse", (4.0, 4.0), (40.0, 0.0)), None, "leave nothing open"),
        (Outline("ellipse", (4.0, 4.0)), Outline("rectangle", (4.0, 4.0)), "leave nothing open"),
    ],
)
def test_impossible_outlines_are_refused(opening: Outline | None, obscuration: Outline | None, message: str) -> None:
    with pytest.raises(InputError, match=f"surface 1 of the singlet: .*{message}"):
        complete_prescription(lens(opening, obscuration))


def test_outlines_that_together_stop_all_light_are_refused() -> None:
    half = lens(Outline("rectangle", (5.0, 20.0), (6.0, 0.0)))
    other = replace(half.surfaces[1], opening=Outline("rectangle", (5.0, 20.0), (-6.0, 0.0)))
    with pytest.raises(InputError, match="surface 2 of the singlet: no light gets through"):
        complete_prescription(replace(half, surfaces=(half.surfaces[0], other, half.surfaces[2])))


def test_narrow_rings_and_slits_are_open() -> None:
    for opening, obscuration in (
        (None, Outline("ellipse", (9.999, 9.999))),
        (Outline("rectangle", (0.01, 0.01), (3.3333, 4.4444)), None),
    ):
        check_prescription(lens(opening, obscuration))


def test_cylinders_may_have_outlines() -> None:
    surfaces = lens(Outline("rectangle", (6.0, 3.0))).surfaces
    bent = replace(surfaces[2], across=Across(-80.0))
    whole = complete_prescription(Prescription((*surfaces[:2], bent)))
    assert passed_share(whole) == pytest.approx(72 / DISC, abs=1e-3)
