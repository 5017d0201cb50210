"""`pullfocus lenses fit`, `stmap` and `opentrackio`: out, in again, and the lens is the same."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import OpenImageIO as oiio
import pytest
from pxr import Sdf

from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import IrisShape
from render.optics.distortion import distort_positions
from render.optics.iris import transmission
from render.optics.lens_files import read_measured_lens
from render.optics.measured.bokeh_photo import MeasuredIris
from render.optics.measured.stmap import StMap, make_stmap, stmap_pairs_mm
from render.optics.view import PinholeView
from render.shot import Shot
from render.shot.lens.fitted_lens import iris_layer
from render.shot.lens.lens_alone import lens_alone
from render.stage import read_camera
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot

WIDTH, HEIGHT = 480, 320


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def pixels(path: Path) -> FloatArray:
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT), np.float32)


def positions_px(lens: str | Path) -> DoubleArray:
    """Where a lens at full frame shows a grid of places of the undistorted picture."""
    camera = lens_alone(str(lens)).camera
    view = PinholeView.from_camera(camera, WIDTH, HEIGHT)
    grid = np.stack(np.meshgrid(np.linspace(30, WIDTH - 30, 25), np.linspace(30, HEIGHT - 30, 17)), axis=-1)
    return distort_positions(view, camera, grid.reshape(-1, 2))


@pytest.mark.parametrize("lens", ["distagon_35", "double_gauss_50", "zeiss_distagon_15", "fisheye_10"])
@pytest.mark.parametrize("direction", ["undistort", "distort"])
def test_an_stmap_read_again_is_the_lens(pullfocus: Command, tmp_path: Path, lens: str, direction: str) -> None:
    """Within a tenth of a pixel of the map."""
    out, sheet = tmp_path / "map.exr", tmp_path / "again.lens"
    assert pullfocus("lenses", "stmap", lens, "--width", WIDTH, "--out", out).status == 0
    focal = lens_alone(lens).camera.focal_length_mm
    file = tmp_path / f"map_{direction}.exr"
    ended = pullfocus("lenses", "fit", sheet, "--focal-length", focal, "--distortion", file, "--direction", direction)
    assert ended.status == 0, ended.err
    assert ("wider than a data sheet can say" in ended.err) == (lens == "fisheye_10" and direction == "distort")
    np.testing.assert_allclose(positions_px(sheet), positions_px(lens), atol=0.1)


def test_the_two_maps_undo_each_other(pullfocus: Command, tmp_path: Path) -> None:
    out = tmp_path / "map.exr"
    assert pullfocus("lenses", "stmap", "distagon_35", "--width", WIDTH, "--out", out).status == 0
    undistort, distort = (
        pixels(tmp_path / f"map_{name}.exr")[..., :2].astype(np.float64) for name in ("undistort", "distort")
    )
    x = undistort[..., 0] * WIDTH - 0.5
    y = (1 - undistort[..., 1]) * HEIGHT - 0.5
    inside = (x >= 0) & (x < WIDTH - 1) & (y >= 0) & (y < HEIGHT - 1)
    i, j = np.floor(y[inside]).astype(int), np.floor(x[inside]).astype(int)
    right, low = (x[inside] - j)[:, None], (y[inside] - i)[:, None]
    upper = distort[i, j] * (1 - right) + distort[i, j + 1] * right
    lower = distort[i + 1, j] * (1 - right) + distort[i + 1, j + 1] * right
    own = np.stack(np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH, 1 - (np.arange(HEIGHT) + 0.5) / HEIGHT), axis=-1)
    off_px = np.abs((upper * (1 - low) + lower * low) - own[inside]) * [WIDTH, HEIGHT]
    assert inside.mean() > 0.9
    assert off_px.max() < 0.01


def test_a_lens_without_distortion_has_the_identity_as_its_map(pullfocus: Command, tmp_path: Path) -> None:
    """Nuke's convention: the middle of the lower left pixel is at half a pixel from the corner."""
    out = tmp_path / "map.exr"
    ended = pullfocus("lenses", "stmap", "thin_50", "--width", 36, "--out", out, "--direction", "distort")
    assert (ended.status, sorted(path.name for path in tmp_path.iterdir())) == (0, ["map.exr"])
    places = pixels(out)
    assert places.shape == (24, 36, 3)
    assert places[-1, 0] == pytest.approx((0.5 / 36, 0.5 / 24, 0))
    assert places[0, -1] == pytest.approx((35.5 / 36, 23.5 / 24, 0))
    [part] = OpenEXR.File(str(out), separate_channels=True).parts
    assert {channel.type() for channel in part.channels.values()} == {OpenEXR.FLOAT}


def test_a_barrel_shows_what_lies_farther_out(pullfocus: Command, tmp_path: Path) -> None:
    """Over the undistorted picture a place near the corner is nearer to the middle of the picture that the lens takes."""
    out = tmp_path / "map.exr"
    assert pullfocus("lenses", "stmap", "distagon_35", "--width", WIDTH, "--out", out).status == 0
    corner = np.array([0.5 / WIDTH, 0.5 / HEIGHT])
    assert (pixels(tmp_path / "map_undistort.exr")[-1, 0, :2] > corner).all()
    assert (pixels(tmp_path / "map_distort.exr")[-1, 0, :2] < corner).all()


def test_overscan_is_in_the_data_window(pullfocus: Command, tmp_path: Path) -> None:
    plain, wide = tmp_path / "plain.exr", tmp_path / "wide.exr"
    for out, options in ((plain, ()), (wide, ("--overscan", 1.2))):
        ended = pullfocus(
            "lenses", "stmap", "distagon_35", "--width", WIDTH, "--direction", "undistort", "--out", out, *options
        )
        assert ended.status == 0
    spec = oiio.ImageBuf(str(wide)).spec()
    assert (spec.x, spec.y, spec.width, spec.height) == (-48, -32, 576, 384)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, WIDTH, HEIGHT)
    assert np.array_equal(pixels(wide)[32:-32, 48:-48], pixels(plain))
    sheet = tmp_path / "again.lens"
    assert pullfocus("lenses", "fit", sheet, "--focal-length", 35, "--distortion", wide).status == 0
    np.testing.assert_allclose(positions_px(sheet), positions_px("distagon_35"), atol=0.1)


def test_opentrackio_read_again_is_the_lens(pullfocus: Command, tmp_path: Path) -> None:
    out, sheet = tmp_path / "lens.json", tmp_path / "again.lens"
    assert pullfocus("lenses", "opentrackio", "distagon_35", "--f-stop", 2, "--focus", 3, "--out", out).status == 0
    sample = json.loads(out.read_text())
    assert sample["lens"]["distortion"][0]["model"] == "Brown-Conrady D-U"
    assert (sample["lens"]["fStop"], sample["lens"]["focusDistance"]) == (2, 3)
    assert pullfocus("lenses", "fit", sheet, "--distortion", out).status == 0
    camera = lens_alone("distagon_35").set_to(2.0, 3.0, (36, 24))
    view = PinholeView.from_camera(camera, WIDTH, HEIGHT)
    grid = np.array([(30.0, 30.0), (240.0, 30.0), (400.0, 250.0), (470.0, 310.0)])
    measured = replace(lens_alone(str(sheet)).camera, f_stop=2.0, focus_distance_m=3.0)
    np.testing.assert_allclose(distort_positions(view, measured, grid), distort_positions(view, camera, grid), atol=0.1)
    assert pullfocus("lenses", "opentrackio", "anamorphic_50_2x").status == 1


def tracked(tmp_path: Path, width: float) -> Path:
    sensor = {"activeSensorPhysicalDimensions": {"width": width, "height": 16.0}}
    lens = {"pinholeFocalLength": 35.0, "distortion": [{"model": "Brown-Conrady D-U", "radial": [1e-5, 0.0]}]}
    path = tmp_path / "tracked.json"
    path.write_text(json.dumps({"static": {"camera": sensor}, "lens": lens}))
    return path


def test_the_sensor_of_a_tracked_lens_is_its_gate(pullfocus: Command, tmp_path: Path) -> None:
    sample, out = tracked(tmp_path, 30.0), tmp_path / "out.lens"
    ended = pullfocus("lenses", "fit", out, "--distortion", sample)
    assert ended.status == 0, ended.err
    assert "The gate is 30 x 16 mm by tracked.json." in ended.err
    by_sensor = read_measured_lens(out)
    assert pullfocus("lenses", "fit", out, "--distortion", sample, "--gate", "30x16").status == 0
    assert read_measured_lens(out).sheet == by_sensor.sheet
    assert pullfocus("lenses", "fit", out, "--distortion", sample, "--gate", "36x24").status == 0
    assert read_measured_lens(out).sheet != by_sensor.sheet


def test_a_sensor_of_no_size_is_refused(pullfocus: Command, tmp_path: Path) -> None:
    ended = pullfocus("lenses", "fit", tmp_path / "out.lens", "--distortion", tracked(tmp_path, -1.0))
    assert (ended.status, ended.err.count("\n")) == (1, 1)
    assert "sides from 0.1 to 1000 mm, got -1 x 16" in ended.err


@pytest.mark.parametrize("name", ["lens_iris.exr", "a@b.exr", "a@@@b.exr"])
def test_a_mask_of_any_name_is_found_from_its_layer(name: str) -> None:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(iris_layer(MeasuredIris((1.0, 0.5), np.ones((4, 4)), (1.5, 1.5), 2.0, ()), name))
    assert layer.GetAttributeAtPath("/Iris.aperture:mask").default.path == f"./{name}"


def test_opentrackio_refuses_a_fisheye_that_it_cannot_describe(pullfocus: Command) -> None:
    ended = pullfocus("lenses", "opentrackio", "fisheye_10")
    assert (ended.status, ended.out, ended.err.count("\n")) == (1, "", 1)
    assert "cannot describe" in ended.err


def test_tables_of_one_f_number_are_not_stated_at_another(pullfocus: Command, tmp_path: Path) -> None:
    base = str(tmp_path / "base.lens")
    pullfocus("lenses", "show", "double_gauss_50", "--tables", base)
    ended = pullfocus("lenses", "fit", str(tmp_path / "other.lens"), "--base", base, "--f-stop", "5.6")
    assert (ended.status, ended.err.count("\n")) == (2, 1)
    assert "measured at f/2.02: leave --f-stop out" in ended.err


def test_what_is_fitted_completes_a_sheet(pullfocus: Command, tmp_path: Path) -> None:
    base, chart, out = tmp_path / "base.lens", tmp_path / "chart.csv", tmp_path / "out.lens"
    assert pullfocus("lenses", "show", "planar_50", "--tables", base).status == 0
    chart.write_text("0,10,92,92\n0,40,55,55\n10,10,90,85\n10,40,50,40\n20,10,80,70\n20,40,35,25\n")
    ended = pullfocus("lenses", "fit", out, "--base", base, "--mtf", chart, "--f-stop", 1.4, "--name", "My Planar")
    assert ended.status == 0, ended.err
    assert "MTF: " in ended.err
    assert "% rms of contrast are left" in ended.err
    before, after = read_measured_lens(base), read_measured_lens(out)
    assert after.name == "My Planar"
    assert after.sheet.light[-1] == pytest.approx(before.sheet.light[-1], rel=1e-4)
    assert after.sheet.sagittal_blur_mm[0] != before.sheet.sagittal_blur_mm[0]
    assert after.sources[-1] == "blur from chart.csv at f/1.4"


def test_a_photograph_becomes_an_iris_that_a_camera_takes(pullfocus: Command, tmp_path: Path) -> None:
    drawn = IrisShape(blades=6, roundness=0.1, radial_weights=(0.6, 0.8, 1.0))
    picture = np.zeros((300, 300, 1), np.float32)
    picture[50:250, 50:250, 0] = 0.5 * transmission(drawn, side=200)
    buffer = oiio.ImageBuf(oiio.ImageSpec(300, 300, 1, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), picture)
    buffer.write(str(tmp_path / "photo.exr"))
    ended = pullfocus("lenses", "fit", tmp_path / "my.lens", "--bokeh", tmp_path / "photo.exr")
    assert ended.status == 0, ended.err
    assert not (tmp_path / "my.lens").exists()
    camera = CAMERA.replace('def Camera "main_cam"', 'def Camera "main_cam" (prepend references = @./my_iris.usda@)')
    write_shot(tmp_path / "shot.usda", camera, SQUARE)
    shot = Shot.open(str(tmp_path / "shot.usda"))
    iris = read_camera(shot.stage, "/World/main_cam", 1).iris
    again, wanted = transmission(iris, side=96), transmission(drawn, side=96)
    assert np.abs(again / again.max() - wanted / wanted.max()).mean() < 0.05


def exr(path: Path, places: FloatArray) -> Path:
    height, width, channels = places.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(places, np.float32))
    buffer.write(str(path))
    return path


IDENTITY = make_stmap(lens_alone("thin_50").camera, (36, 24), "undistort").places


@pytest.mark.parametrize(
    ("places", "words"),
    [
        (np.full((24, 36, 2), np.nan), "are no places"),
        (np.full((24, 36, 2), np.inf), "are no places"),
        (np.zeros((24, 36, 3)), "are no places"),
        (np.full((24, 36, 2), 0.5), "folds or turns over"),
        (IDENTITY[::-1], "folds or turns over"),
        (np.abs(IDENTITY - 0.5) + 0.1, "folds or turns over"),
        (IDENTITY[:4, :4], "expected 8 or more"),
        (IDENTITY[..., :1], "has no two channels"),
    ],
)
def test_an_absurd_stmap_is_one_line(pullfocus: Command, tmp_path: Path, places: FloatArray, words: str) -> None:
    file = exr(tmp_path / "absurd.exr", places)
    ended = pullfocus("lenses", "fit", tmp_path / "out.lens", "--focal-length", 50, "--distortion", file)
    assert (ended.status, ended.err.count("\n")) == (1, 1)
    assert words in ended.err
    assert not (tmp_path / "out.lens").exists()


def test_holes_of_an_stmap_do_not_count() -> None:
    places = IDENTITY.copy()
    places[:6, :6] = np.nan
    shown, ideal = stmap_pairs_mm(StMap(places, (36, 24)), "undistort", (36, 24), "map")
    assert len(shown) == 36 * 24 - 36
    np.testing.assert_allclose(shown, ideal)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("stmap", "thin_50", "--width", "0", "--out", "map.exr"), "--width takes 8 pixels or more"),
        (("stmap", "thin_50", "--width", "100000", "--out", "map.exr"), "--width takes 8 pixels or more"),
        (("stmap", "thin_50", "--width", "1000000000", "--out", "map.exr"), "--width takes 8 pixels or more"),
        (("stmap", "thin_50", "--width", "64", "--overscan", "nan", "--out", "map.exr"), "--overscan takes a factor"),
        (("stmap", "thin_50", "--width", "64", "--out", "map.png"), "writes an .exr file"),
        (("fit", "out.txt", "--mtf", "chart.csv"), "writes a .lens file"),
        (("fit", "out.lens"), "the focal length is not known"),
        (("fit", "out.lens", "--focal-length", "50"), "there is nothing to fit"),
        (("fit", "out.lens", "--focal-length", "nan"), "--focal-length takes a number"),
        (("fit", "out.lens", "--focal-length", "50", "--gate", "0x0"), "--gate takes sides from 0.1"),
    ],
)
def test_settings_out_of_range_are_one_line(
    pullfocus: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    ended = pullfocus("lenses", *arguments)
    assert (ended.status, ended.err.count("\n")) == (2, 1)
    assert words in ended.err


@pytest.mark.parametrize("option", ["--mtf", "--distortion", "--bokeh"])
def test_files_that_are_none_are_one_line(pullfocus: Command, tmp_path: Path, option: str) -> None:
    garbage = tmp_path / "garbage.exr"
    garbage.write_bytes(b"\x76\x2f\x31\x01" + bytes(range(256)) * 20)
    for file in (tmp_path / "missing", tmp_path, garbage, Path("/dev/zero")):
        ended = pullfocus("lenses", "fit", tmp_path / "o.lens", "--focal-length", 50, "--f-stop", 2, option, file)
        assert (ended.status, ended.err.count("\n")) == (1, 1), ended.err
