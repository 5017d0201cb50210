"""The sheet of a lens with cylinders: places of its picture, both meridians, oval bokeh, both sections."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.model.camera import Camera
from render.model.lens import Lens
from render.optics.glass import D_LINE_NM
from render.optics.prescription.mounting import mount_lens
from render.optics.report.data_sheet import data_sheet
from render.optics.report.field import radial
from render.optics.report.lens_report import LensReport, film_rays, lens_report
from render.optics.report.section import lens_section
from render.shot.findings.camera_findings import camera_findings
from render.stage.camera.lenses import make_lens
from tests.render.kits.stages import new_stage
from usd_schemas import AberrationScales, LensCamera, library_lens
from usd_schemas import mount_lens as mount_on

FOCUS_M, GATE_MM, SQUEEZE = 2.0, (43.9, 18.6), 2.0


@pytest.fixture(scope="module")
def camera() -> Camera:
    lens: Lens = make_lens(library_lens("anamorphic_75_2x").lens, "/cam")
    return Camera(np.eye(4), 75.0, *GATE_MM, f_stop=2.8, focus_distance_m=FOCUS_M, near_m=0.1, lens=lens)


@pytest.fixture(scope="module")
def report(camera: Camera) -> LensReport:
    return lens_report(camera)


def test_chief_rays_land_on_their_places(camera: Camera) -> None:
    places = np.array([(0.0, 0.0), (20.0, 0.0), (0.0, 9.0), (-18.0, 7.0), (12.0, -5.0)])
    landing = film_rays(camera).beams(places, np.zeros((1, 2)), D_LINE_NM).landing_mm[:, 0]
    np.testing.assert_allclose(landing, places, atol=2e-3)


def test_heights_are_measured_toward_the_corner(camera: Camera) -> None:
    corner = radial(film_rays(camera), np.array([np.hypot(*GATE_MM) / 2]))
    np.testing.assert_allclose(corner, [np.array(GATE_MM) / 2])


def test_the_sheet_tells_both_meridians(report: LensReport) -> None:
    told = dict(row for group in data_sheet(report) for row in group)
    squeeze = mount_lens(report.camera).squeeze
    assert told["squeeze"] == f"{squeeze:.3f} as focused; the picture is stretched back by 2"
    assert told["focal length"].startswith("75.00 mm from top to bottom, 4")
    assert told["focuses by"] == "moving surfaces 7 to 20, from side to side 1 to 3 too"
    assert report.curves.distortion_across[0] == pytest.approx(SQUEEZE / squeeze - 1, abs=1e-3)
    assert report.curves.distortion[0] == pytest.approx(0.0, abs=1e-3)


def test_the_bokeh_sheet_is_oval_and_cut(report: LensReport) -> None:
    assert report.bokeh is not None
    lit = [place.light[..., 1] > 0.3 for place in report.bokeh.places]
    wide, high = (int(lit[0].any(axis=axis).sum()) for axis in (0, 1))
    squeeze = mount_lens(report.camera).squeeze
    assert high / wide == pytest.approx(
        squeeze**2 / SQUEEZE, rel=0.06
    )  # blur on the film goes by the focal length squared
    assert report.bokeh.places[0].share == pytest.approx(1.0)
    assert report.bokeh.places[-1].share < 0.95


def test_cylinders_are_plates_in_one_section_alone(camera: Camera) -> None:
    upright, sideways = (lens_section(camera, sideways=sideways) for sideways in (False, True))
    flat, curved = (section.glasses[0][0][:, 0] for section in (upright, sideways))
    assert len(np.unique(np.round(flat, 9))) == 2
    assert len(np.unique(np.round(curved, 9))) > 20
    np.testing.assert_allclose(upright.glasses[-1][0], sideways.glasses[-1][0])  # the spherical lens is the same


def test_a_shot_is_told_what_cylinders_do_not_draw() -> None:
    stage = new_stage(0.01)
    prim = stage.DefinePrim("/cam", "Camera")
    lens = library_lens("anamorphic_75_2x").lens
    asked = replace(lens, flare_ghosts=1.0, aberration=AberrationScales(coma=2.0))
    mount_on(LensCamera(prim), asked)
    assert camera_findings(stage, ["/cam"]) == []  # what the photographer sets is not the lens's
    prim.GetAttribute("lens:flare:ghosts").Set(1.0)
    prim.GetAttribute("lens:aberration:coma").Set(2.0)
    found = {finding.code: finding.message for finding in camera_findings(stage, ["/cam"])}
    assert "scales coma" in found["no_factors"]
    assert "cylinders are not traced" in found["no_ghosts"]
