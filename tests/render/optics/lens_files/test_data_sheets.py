"""`.lens` files: what they say, and what is told of those that are wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from render.errors import InputError
from render.model.data_sheet import DataSheet
from render.optics.lens_files import MeasuredLens, data_sheet_text, parse_measured_lens, read_measured_lens
from render.shot.lens.lens_alone import lens_alone
from render.shot.lens.lens_choice import choose_lens

PLANAR = """\
# read off a sheet
name         = Planar #2 50/1.4      # for people
focal length = 50 # mm
f-stops      = 1.4 16
close focus  = 0.45
source       = read off the maker's curves
source       = the colours are estimates

height_mm  distortion_%  light_%
0          0             100
# a remark does not end a table
10         -0.8          80
20         -1.5          35

height_mm  sagittal_blur_um  tangential_blur_um  coma_um
0          8                 8                   0
20         15                21                  12
"""
FULL = DataSheet(
    heights_mm=(0.0, 10.0, 21.6),
    distortion=(0.0, -0.0081234, -0.015),
    light=(1.0, 0.8, 0.35),
    sagittal_blur_mm=(0.008, 0.01, 0.015),
    tangential_blur_mm=(0.008, 0.012, 0.021),
    spherical=(0.5, 0.4, -0.2),
    coma_mm=(0.0, 0.006, -0.012),
    field_curvature_mm=(0.0, 0.03, -0.1),
    lateral_color_mm=(0.0, 0.001, 0.004),
    axial_color_mm=(0.05, 0.05, 0.04),
    f_stop=1.4,
)


def test_a_file_says_a_lens(tmp_path: Path) -> None:
    file = tmp_path / "planar.LENS"
    file.write_text(PLANAR)
    lens = read_measured_lens(file)
    assert (lens.name, lens.focal_length_mm, lens.f_stops) == ("Planar #2 50/1.4", 50.0, (1.4, 16.0))
    assert lens.close_focus_m == 0.45
    assert lens.sources == ("read off the maker's curves", "the colours are estimates")
    sheet = lens.sheet
    assert sheet.f_stop == 1.4  # measured wide open, as it says nothing else
    assert sheet.heights_mm == (0.0, 10.0, 20.0)
    np.testing.assert_allclose(sheet.distortion, (0.0, -0.008, -0.015))
    np.testing.assert_allclose(sheet.light, (1.0, 0.8, 0.35))
    np.testing.assert_allclose([sheet.tangential_blur_mm[i] for i in (0, 2)], (0.008, 0.021))
    assert 0.008 < sheet.sagittal_blur_mm[1] < 0.015  # between the entries of its own table
    assert (sheet.spherical, sheet.axial_color_mm) == ((), ())
    choice, alone = choose_lens(str(file)), lens_alone(str(file))
    assert (choice.f_stop, choice.lens.model, choice.notes) == (1.4, "dataSheet", lens.sources)
    assert (alone.f_stop, alone.camera.lens.data_sheet) == (1.4, sheet)


def test_what_is_written_is_read_again() -> None:
    lens = MeasuredLens("Some lens", 50.0, FULL, (1.4, 22.0), 0.45, ("one source", "another"))
    text = data_sheet_text(lens)
    again = parse_measured_lens(text.encode(), "x.lens")
    assert (again.name, again.focal_length_mm, again.f_stops, again.sources) == (
        "Some lens",
        50.0,
        (1.4, 22.0),
        ("one source", "another"),
    )
    for field, values in vars(FULL).items():
        np.testing.assert_allclose(getattr(again.sheet, field), values, rtol=1e-6)
    assert data_sheet_text(again) == text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("height_mm light_%\n0 100\n", "x.lens: it has no focal length"),
        ("focal length = 50\n", "x.lens: it has no table that begins with height_mm"),
        (
            "focal length = 0\nheight_mm light_%\n0 100\n",
            "line 1: the focal length must be from 0.1 to 100000 mm, got 0",
        ),
        ("focal length = 50 60\nheight_mm light_%\n0 100\n", "line 1: focal length takes 1 numbers, got '50 60'"),
        ("focal length = \n", "line 1: focal length has nothing behind the ="),
        ("focal lenght = 50\n", "line 1: expected one of name, focal length"),
        ("hello\n", "line 1: expected one of name, focal length"),
        ("focal length = 50\nfocal length = 51\n", "line 2: focal length was said already on line 1"),
        ("focal length = 50\nheight_mm glow\n", "line 2: there is no column 'glow': expected distortion_%"),
        ("focal length = 50\nheight_mm light_% light_%\n", "line 2: a table has height_mm and each other column once"),
        ("focal length = 50\nheight_mm light_%\n0 100 3\n", "line 3: a row of this table has 2 numbers, got 3 words"),
        ("focal length = 50\nheight_mm light_%\n0 bright\n", "line 3: the light_% must be a number, got 'bright'"),
        ("focal length = 50\nheight_mm light_%\n5 100\n", "image heights must increase from 0, got 5"),
        ("focal length = 50\nheight_mm light_%\n", "image heights must increase from 0, got none"),
        (
            "focal length = 50\nheight_mm light_%\n0 100\n\nheight_mm light_%\n0 100\n",
            "two tables have the same column",
        ),
        ("f-stops = 1.4\nfocal length = 50\nheight_mm light_%\n0 100\n", "line 1: f-stops takes 2 numbers, got '1.4'"),
        (
            "focal length = 50\nf-stops = 22 1.4\nheight_mm light_%\n0 100\n",
            "line 2: f-stops go from wide open to closed down, 0 for an end that is unknown and 1000 at most, got 22 and 1.4",
        ),
        (
            "focal length = 50\nclose focus = 1e9\nheight_mm light_%\n0 100\n",
            "line 2: the close focus must be at most 1000 m, got 1e+09",
        ),
        (
            "focal length = 50\nheight_mm light_%\n0 100\n1e308 50\n",
            "image heights must be at most 1000 mm, got 1e+308 mm",
        ),
        ("focal length = 50\nheight_mm light_%\n0 100\n1e-300 50\n", "image heights must be at least 1e-06 mm apart"),
        ("focal length = 50\nheight_mm coma_um\n0 1e200\n", "coma_mm must be from -1000 to 1000 mm, got 1e+197"),
        ("focal length = 50\nmeasured at = 1e9\nheight_mm light_%\n0 1\n", "f-number must be from 0 to 1000"),
        ("focal length = 50\nmeasured at = -2\nheight_mm light_%\n0 1\n", "line 2: the measured at must be 0 or more"),
    ],
)
def test_a_fault_in_a_file_is_reported_with_its_line(text: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_measured_lens(text.encode(), "x.lens")
    assert caught.value.code == "bad_lens_file"
    assert words in caught.value.detail


def test_a_missing_file_is_reported(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        choose_lens(str(tmp_path / "none.lens"))


def test_the_sheet_in_the_guide_can_be_read() -> None:
    text = (Path(__file__).parents[4] / "docs/guide/lenses.md").read_text()
    sheet = next(block for block in text.split("```\n") if block.startswith("name         ="))
    lens = parse_measured_lens(sheet.encode(), "guide.lens")
    assert (lens.name, lens.sheet.f_stop, lens.sheet.heights_mm) == ("Some 50/1.4", 1.4, (0.0, 12.0, 21.6))
    assert lens.sheet.coma_mm[-1] == pytest.approx(0.012)
