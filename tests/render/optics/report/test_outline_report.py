"""The sheet of a lens with openings and obscurations: its light, its T-stop, its bokeh, its notes."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import SettingsError
from render.model.camera import Camera
from render.model.lens import Glass, Lens, Outline, Prescription, Surface
from render.optics.prescription.completion import complete_prescription
from render.optics.report.data_sheet import data_sheet
from render.optics.report.lens_report import LensReport, film_rays, lens_report
from render.shot.lens.lens_alone import LensAlone
from render.shot.lens.measured_lens import measured_lens

GLASS, STOP_MM = Glass(1.6, 60.0), 6.0


def report_of(
    opening: Outline | None = None, obscuration: Outline | None = None, ghosts: float = 0.0, f_stop: float | None = None
) -> LensReport:
    prescription = complete_prescription(
        Prescription(
            (
                Surface(60.0, 5.0, GLASS, 14.0),
                Surface(-300.0, 6.0, semi_diameter_mm=14.0),
                Surface(0.0, 6.0, semi_diameter_mm=STOP_MM, is_stop=True, opening=opening, obscuration=obscuration),
                Surface(300.0, 5.0, GLASS, 14.0),
                Surface(-60.0, 0.0, semi_diameter_mm=14.0),
            )
        ),
        image_height_mm=14.0,
    )
    lens = Lens("prescription", "outlined", prescription, ghosts=ghosts)
    return lens_report(
        Camera(np.eye(4), 50.0, 12.0, 8.0, f_stop=f_stop or prescription.f_stop, focus_distance_m=0.5, lens=lens)
    )


@pytest.fixture(scope="module")
def ring() -> LensReport:
    return report_of(obscuration=Outline("ellipse", (3.0, 3.0)))


def test_the_t_stop_counts_what_an_obscuration_stops(ring: LensReport) -> None:
    assert ring.open_share == pytest.approx(0.75, abs=0.004)
    assert ring.t_stop == pytest.approx(ring.f_stop / np.sqrt(0.75), rel=0.003)
    told = dict(row for group in data_sheet(ring) for row in group)
    assert told["T-stop"] == f"T{ring.t_stop:.3g}: 75 % of the light pass, 75 % its openings"
    assert any(note.startswith("Openings and obscurations of its surfaces let 7") for note in ring.notes)
    assert not any("all around" in note for note in ring.notes)


@pytest.mark.parametrize(
    ("outline", "share"),
    [(Outline("rectangle", (4.0, 3.0)), 48.0), (Outline("ellipse", (5.0, 2.0), (0.5, 0.0)), 10 * np.pi)],
)
def test_the_sheet_has_the_light_that_an_opening_leaves(outline: Outline, share: float) -> None:
    report = report_of(outline, ghosts=1.0)
    assert report.open_share == pytest.approx(
        share / (np.pi * STOP_MM**2), rel=0.015
    )  # of the stop, not quite of the light
    assert any("not the same all around" in note for note in report.notes)
    assert any("ghosts are drawn as if it had none" in note for note in report.notes)


def test_the_bokeh_of_the_sheet_is_a_doughnut(ring: LensReport) -> None:
    assert ring.bokeh is not None
    light = ring.bokeh.places[0].light[..., 1]
    y, x = np.mgrid[: len(light), : len(light)] + 0.5 - len(light) / 2
    radius = np.hypot(x, y) / np.sqrt((light > 0.3 * light.max()).sum() / np.pi / 0.75)
    assert light[radius < 0.3].max() < 0.02 * light.max()
    assert light[(radius > 0.6) & (radius < 0.85)].min() > 0.4 * light.max()


def test_the_middle_of_a_ring_is_dark_in_exact_rays(ring: LensReport) -> None:
    beams = film_rays(ring.camera).beams(np.zeros((1, 2)), np.array([[0.0, 0.0], [0.45, 0.0], [0.0, 0.55]]), 587.56)
    assert list(beams.open[0]) == [False, False, True]


def test_a_data_sheet_cannot_describe_it(ring: LensReport) -> None:
    alone = LensAlone("ring", "ring", "", 4.0, ring.camera)
    with pytest.raises(SettingsError, match="ring has openings or obscurations: a data sheet knows no shape"):
        measured_lens(alone, ring)


def test_a_ring_that_is_stopped_down_is_dark() -> None:
    """The obscuration hides the whole iris."""
    with pytest.raises(SettingsError, match=r"dark in the middle of the picture at f/22.* open the iris"):
        report_of(obscuration=Outline("ellipse", (3.0, 3.0)), f_stop=22.0)
