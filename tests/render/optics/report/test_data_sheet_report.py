"""Data sheets measured, drawn and written: a lens known by what was measured of it is the lens, as far as a sheet goes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from render.cli.main import main
from render.drawing import draw_lens_sheet
from render.model.data_sheet import DataSheet
from render.model.lens import IrisShape
from render.optics.lens_files import read_measured_lens
from render.optics.report import lens_report
from render.optics.report.field import spots
from render.optics.report.lens_report import film_rays
from render.optics.report.measuring import measure_sheet
from render.optics.report.sheet_rays import SheetRays
from render.shot.lens.lens_alone import lens_alone
from tests.render.kits.data_sheets import SHEET
from usd_schemas import library_lenses


def test_what_is_measured_of_a_data_sheet_is_the_sheet() -> None:
    sheet = replace(SHEET, light=(1.0, 0.999, 0.97, 0.9, 0.8), coma_mm=(0.0, 0.005, 0.01, -0.01, 0.02), f_stop=2.0)
    found = measure_sheet(SheetRays(sheet, 50.0, 2.0, 0.0), np.array(sheet.heights_mm), 2.0)
    for name, close in (
        ("distortion", 1e-6),
        ("light", 0.003),
        ("sagittal_blur_mm", 2e-4),
        ("tangential_blur_mm", 3e-4),
        ("coma_mm", 3e-4),
        ("field_curvature_mm", 1e-3),
        ("lateral_color_mm", 1e-6),
        ("axial_color_mm", 1e-3),
    ):
        np.testing.assert_allclose(getattr(found, name), getattr(sheet, name), atol=close, err_msg=name)
    assert (np.sign(found.spherical[:4]) == np.sign(sheet.spherical[:4])).all()


@pytest.mark.parametrize("name", ["planar_50", "distagon_35"])
def test_spots_of_a_measured_lens_are_as_large_as_those_of_its_glass(name: str) -> None:
    lens = lens_alone(name)
    glass, heights = film_rays(lens.camera), np.array([0.0, 6.0, 12.0, 18.0, 21.6])
    sheet = measure_sheet(glass, heights, lens.camera.f_stop)
    by_sheet = SheetRays(sheet, lens.camera.focal_length_mm, lens.camera.f_stop, 0.0)
    sizes = [[spot.rms_um for spot in spots(rays, heights, IrisShape())] for rays in (glass, by_sheet)]
    np.testing.assert_allclose(sizes[1], sizes[0], rtol=0.15)
    np.testing.assert_allclose(by_sheet.seen(heights), glass.seen(heights), rtol=2e-3)  # the film is moved a little


def test_curves_and_places_of_a_sheet_are_its_tables() -> None:
    lens = lens_alone("zeiss_planar_50")
    report, sheet = lens_report(lens.camera, lens.f_stop), lens.camera.lens.data_sheet
    assert sheet is not None
    seen = np.array(sheet.heights_mm) <= report.corner_mm
    for ours, name in ((report.curves.distortion, "distortion"), (report.curves.illumination, "light")):
        told = np.interp(np.array(sheet.heights_mm)[seen], report.curves.heights_mm, ours)
        np.testing.assert_allclose(told, np.array(getattr(sheet, name))[seen], atol=0.004)
    np.testing.assert_allclose(report.curves.sagittal_mm[0], -sheet.field_curvature_mm[0])
    rays = film_rays(lens.camera)
    aside, above = (rays.beams(np.array([place]), np.array([[0.3, 0.8]]), 500.0) for place in ([9.0, 0], [0, 9.0]))
    turned = rays.beams(np.array([[0, 9.0]]), np.array([[-0.8, 0.3]]), 500.0)
    np.testing.assert_allclose(aside.landing_mm[0, 0], turned.landing_mm[0, 0, ::-1] * [1, -1], atol=1e-12)
    assert not np.allclose(aside.landing_mm[0, 0], above.landing_mm[0, 0, ::-1])


def test_the_papers_three_lenses_are_there_with_their_sources() -> None:
    names = [entry.name for entry in library_lenses() if entry.lens.model == "dataSheet"]
    assert names == ["zeiss_distagon_15", "zeiss_planar_50", "zeiss_planar_85"]
    text = Path(__file__).parents[4].joinpath("usd_schemas/libraries/lenses.usda").read_text()
    for part in text.split("def Camera")[1:]:
        tables = [line for line in part.splitlines() if "double[] lens:table:" in line and "height" not in line]
        assert part.count('doc = "Derived: ') + part.count('doc = "Estimated: ') == len(tables)


def test_a_sheet_is_shown_drawn_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    written = tmp_path / "swirly.lens"
    assert main(["lenses", "show", "swirly_58", "--tables", str(written)]) == 0
    again = read_measured_lens(written)
    assert (again.focal_length_mm, again.sheet.f_stop) == (58.0, 2.0)
    assert "measured on the rays of Swirly 58 mm f/2 at f/2, focused at infinity" in again.sources[0]
    capsys.readouterr()
    assert main(["lenses", "show", str(written), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["model"], told["fStop"]) == ("dataSheet", 2.0)
    assert main(["lenses", "show", "pinhole_35", "--tables", str(tmp_path / "x.lens")]) == 2
    assert main(["lenses", "show", "thin_50", "--tables", str(tmp_path / "x.txt")]) == 2
    lens = lens_alone(str(written))
    assert draw_lens_sheet(lens, lens_report(lens.camera, lens.f_stop), "png").startswith(b"\x89PNG")


def test_a_sheet_without_tables_is_drawn_too() -> None:
    lens = lens_alone("zeiss_planar_50")
    bare = replace(lens, camera=replace(lens.camera, lens=replace(lens.camera.lens, data_sheet=DataSheet((0.0,)))))
    assert draw_lens_sheet(bare, lens_report(bare.camera, 1.4), "svg").startswith(b"<?xml")
