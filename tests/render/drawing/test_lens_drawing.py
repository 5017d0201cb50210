"""Drawings of lenses say what the numbers say, for every kind of lens."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from render.drawing import draw_lens_sheet, draw_section_svg
from render.drawing.field_curves import draw_distortion, draw_field_curvature, draw_illumination
from render.drawing.lens_sheet import _write_numbers
from render.drawing.point_images import draw_bokeh, draw_spots
from render.drawing.section import draw_section
from render.model.camera import Camera
from render.model.lens import HeightField, Lens, SeidelErrors
from render.optics.report import LensReport, lens_report
from render.shot.lens.lens_alone import LensAlone
from tests.render.kits.lenses import PLANAR, WIDE

CAMERA = Camera(
    np.eye(4),
    focal_length_mm=50.0,
    horizontal_aperture_mm=36.0,
    vertical_aperture_mm=24.0,
    f_stop=2.0,
    focus_distance_m=np.inf,
)
SINGLET = replace(PLANAR.prescription, surfaces=PLANAR.prescription.surfaces[:2])
KINDS = {
    "pinhole": replace(CAMERA, lens=Lens("pinhole"), f_stop=0.0),
    "thin": replace(CAMERA, lens=Lens(squeeze=1.8)),
    "seidel": replace(CAMERA, lens=Lens("seidel", seidel=SeidelErrors(w040=10, w131=5))),
    "spherical": replace(CAMERA, lens=Lens("spherical", prescription=SINGLET), f_stop=8.0),
    "heightField": replace(
        CAMERA,
        lens=Lens("heightField", prescription=SINGLET, height_field=HeightField(front=np.zeros((4, 4)))),
        f_stop=8.0,
    ),
    "prescription": replace(CAMERA, lens=Lens("prescription", prescription=WIDE.prescription), focal_length_mm=22.0),
}


@pytest.fixture(scope="module")
def planar() -> LensReport:
    return lens_report(replace(CAMERA, lens=Lens("prescription", prescription=PLANAR.prescription), f_stop=1.4))


def panels(count: int = 1) -> list[Axes]:
    figure = Figure(figsize=(3 * count, 3))
    return [figure.add_axes((i / count, 0.1, 0.9 / count, 0.8)) for i in range(count)]


def words(axes: Axes) -> set[str]:
    figure = axes.get_figure(root=True)
    assert figure is not None
    return {text.get_text() for text in figure.findobj(lambda part: hasattr(part, "get_text"))}


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_lens_has_a_sheet_and_a_section(kind: str) -> None:
    camera = KINDS[kind]
    lens = LensAlone(kind, f"A {kind} lens for $5 — レンズ", "", camera.f_stop, camera)
    assert draw_lens_sheet(lens, lens_report(camera), "svg").startswith(b"<?xml")
    svg = draw_section_svg(camera).decode()
    width, height = (float(number) for number in re.findall(r'(?:width|height)="([\d.]+)pt"', svg)[:2])
    assert width / height == pytest.approx(2.4, rel=0.01)
    assert "<script" not in svg


def test_many_notes_do_not_run_into_the_drawings(planar: LensReport) -> None:
    few, many = (replace(planar, notes=(f"Surface {count} is odd.",) * count) for count in (1, 40))
    for report, cut in ((few, False), (many, True)):
        figure = Figure(figsize=(16, 11))
        _write_numbers(figure, report)
        assert min(text.get_position()[1] for text in figure.texts) > 0.46
        assert any(text.get_text().startswith("and more") for text in figure.texts) is cut


def test_senseless_requests_are_reported_and_not_drawn() -> None:
    report = lens_report(KINDS["pinhole"])
    [axes] = panels()
    draw_field_curvature(axes, report)
    assert not axes.lines
    assert any("all is sharp" in text for text in words(axes))
    assert any("height field is left out" in note for note in lens_report(KINDS["heightField"]).notes)


def test_rays_are_bent_in_the_glass_and_meet_on_the_film(planar: LensReport) -> None:
    [axes] = panels()
    draw_section(axes, planar)
    assert len(axes.patches) == 7
    assert planar.focused is not None
    film = planar.focused.film_mm
    through = [
        np.asarray(line.get_xydata()) for line in axes.lines if len(line.get_xdata()) == 16
    ]  # 14 surfaces, both ends
    assert len(through) >= 10
    assert {round(float(ray[-1, 0]), 6) for ray in through} == {round(film, 6)}
    assert {"film", "H", "H′", "entrance pupil", "exit pupil", "on the axis", "blocked by a rim"} <= words(axes)
    assert axes.get_xlabel()
    assert axes.get_ylabel()


def test_glass_is_where_rays_pass_it(planar: LensReport) -> None:
    """No ray that gets through leaves an element's outline between its two surfaces."""
    [axes] = panels()
    draw_section(axes, planar)
    glasses = [patch.get_path() for patch in axes.patches]
    inside = 0
    for line in axes.lines:
        ray = np.asarray(line.get_xydata())
        if len(ray) == 16:
            middles = (ray[1:-2] + ray[2:-1]) / 2
            inside += sum(any(glass.contains_point(middle) for glass in glasses) for middle in middles)
            between = [any(glass.contains_point(middle) for glass in glasses) for middle in middles]
            assert sum(between) == 7
    assert inside >= 70


def test_spots_are_in_the_colours_of_their_light_at_one_scale(planar: LensReport) -> None:
    row = panels(5)
    draw_spots(row, planar)
    assert len({axes.get_xlim() for axes in row}) == 1
    for axes, spot in zip(row, planar.spots, strict=True):
        [cloud] = [part for part in axes.collections if isinstance(part, PathCollection)]
        assert len(cloud.get_offsets()) == sum(map(len, spot.points_um))
        assert len(np.unique(cloud.get_facecolors(), axis=0)) == 3
        assert "µm rms" in axes.get_xlabel()
    assert any(text.endswith("µm") for text in words(row[0]))


def test_bokeh_shows_the_cats_eye(planar: LensReport) -> None:
    row = panels(5)
    draw_bokeh(row, planar)
    lit = [np.asarray(axes.images[0].get_array())[..., 1] > 0.3 for axes in row]
    assert lit[2].sum() < 0.6 * lit[0].sum()
    assert all(np.asarray(axes.images[0].get_array()).max() <= 1 for axes in row)
    assert "100 % light" in row[0].get_xlabel()


def test_curves_are_those_of_the_report_with_units(planar: LensReport) -> None:
    for draw, values in (
        (draw_distortion, 100 * planar.curves.distortion),
        (draw_illumination, 100 * planar.curves.illumination),
        (draw_field_curvature, planar.curves.sagittal_mm),
    ):
        [axes] = panels()
        draw(axes, planar)
        drawn = [np.asarray(data) for line in axes.lines for data in (line.get_xdata(), line.get_ydata())]
        assert any(data.shape == values.shape and np.allclose(data, values, equal_nan=True) for data in drawn)
        assert re.search("mm|%", axes.get_xlabel())
        assert re.search("mm|%", axes.get_ylabel())
