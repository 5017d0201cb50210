"""`pullfocus record` with another body, stop and exposure for one run, and with framing guides."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from render.drawing.guides import draw_guides, parse_guides
from render.errors import SettingsError
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.optics.framing import ASPECTS
from render.optics.photometry.exposure import MIDDLE_GREY
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def pixels(path: Path) -> FloatArray:
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT), np.float32)


def recorded(command: Command, folder: Path, name: str, *options: object) -> FloatArray:
    shot = folder / "shot.usda"
    if not shot.exists():
        write_shot(shot, CAMERA, SQUARE)
    ended = command("record", shot, folder / name, *small(*options))
    assert ended.status == 0, ended.err
    return pixels(folder / name)


@pytest.mark.gl
def test_stops_of_time_iso_and_filter_are_stops_of_the_picture(command: Command, tmp_path: Path) -> None:
    plain = recorded(command, tmp_path, "plain.exr")[..., :3]
    assert plain[16, 24].max() > 0.05
    for options, factor in (
        (["--iso", 200], 2),
        (["--exposure-time", "1/4"], 0.25),
        (["--exposure-stop", 2], 0.25),
        (["--compensation", 1], 2),
        (["--filter", 0.30103], 0.5),
        (["--expose-by", "iris"], 0.25),
        (["--expose-by", "iris", "--stop", 4], 1 / 16),
    ):
        np.testing.assert_allclose(
            recorded(command, tmp_path, "other.exr", *options)[16, 24, :3], factor * plain[16, 24], rtol=2e-3
        )


@pytest.mark.gl
def test_channel_indices_draw_fringes_for_one_run(command: Command, tmp_path: Path) -> None:
    def drawn(indices: str) -> FloatArray:
        options = ("--lens", "singlet_50", "--channel-index", indices)
        return recorded(command, tmp_path, "fringe.exr", *options)[..., :3]

    even, spread = drawn("1.5,1.5,1.5"), drawn("1.4,1.5,1.6")
    assert (np.abs(spread - even).max(axis=(0, 1)) > 0.1 * even.max(axis=(0, 1)))[[0, 2]].all()
    assert np.abs(spread - even).max(axis=(0, 1))[1] < 0.7 * np.abs(spread - even).max(axis=(0, 1))[0]


@pytest.mark.gl
def test_half_the_shutter_time_is_a_stop_when_exposed_by_time(command: Command, tmp_path: Path) -> None:
    def opened(*options: object) -> tuple[float, float]:
        path = tmp_path / "shutter.exr"
        value = float(recorded(command, tmp_path, path.name, *options)[16, 24, 0])
        return value, oiio.ImageInput.open(str(path)).spec().getattribute("shutterAngle")

    plain = float(recorded(command, tmp_path, "plain.exr")[16, 24, 0])
    half, angle = opened("--shutter", "180deg")
    assert (half, angle) == (pytest.approx(plain), pytest.approx(180))  # exposure:time is USD's own 1: it says nothing
    assert opened("--shutter", "1/96")[1] == pytest.approx(90)
    timed = CAMERA.replace("float fStop = 2", "float fStop = 2\n        float exposure:time = 0.5")
    write_shot(tmp_path / "shot.usda", timed, SQUARE)
    assert float(recorded(command, tmp_path, "timed.exr")[16, 24, 0]) == pytest.approx(plain / 2, rel=1e-3)
    assert opened("--shutter", "90°") == (pytest.approx(plain / 96, rel=2e-3), pytest.approx(90))


@pytest.mark.gl
def test_metered_for_one_run(command: Command, tmp_path: Path) -> None:
    """The square fills the middle of the picture, which weighs most."""
    luminance = [0.27222872, 0.67408177, 0.05368952]
    spot = recorded(command, tmp_path, "spot.exr", "--metering", "spot")[16, 24, :3] @ luminance
    assert spot == pytest.approx(MIDDLE_GREY, rel=0.02)
    corner = recorded(command, tmp_path, "corner.exr", "--metering", "spot:0.5,0.45")[16, 24, :3] @ luminance
    assert corner == pytest.approx(MIDDLE_GREY, rel=0.02)
    more = recorded(command, tmp_path, "more.exr", "--metering", "spot", "--compensation", 1)[16, 24, :3] @ luminance
    assert more == pytest.approx(2 * spot, rel=1e-3)


@pytest.mark.gl
def test_another_body_has_another_gate_and_the_same_lens(command: Command, tmp_path: Path) -> None:
    full = recorded(command, tmp_path, "full.exr", "--body", "full_frame")
    narrow = recorded(command, tmp_path, "narrow.exr", "--body", "Super 16")
    assert full.shape[0] == 32
    assert narrow.shape[0] == round(48 * 7.41 / 12.52)
    covered = [(picture[..., 3] > 0.5).mean() for picture in (full, narrow)]
    assert covered[1] > 2 * covered[0]


@pytest.mark.gl
def test_a_crop_exposes_the_middle_of_the_gate(command: Command, tmp_path: Path) -> None:
    pinhole = "--engine", "pinhole", "--rays", 1  # through pixel centres, whatever the pixel's number
    whole, wide = (recorded(command, tmp_path, "c.exr", *pinhole, *crop) for crop in ((), ("--crop", "3:1")))
    assert wide.shape[:2] == (16, 48)
    np.testing.assert_allclose(wide, whole[8:24], atol=0.02)
    narrow = recorded(command, tmp_path, "c.exr", *pinhole, "--crop", "1:1", "--imageWidth", 32)
    assert narrow.shape[:2] == (32, 32)
    np.testing.assert_allclose(narrow, whole[:, 8:40], atol=0.02)


@pytest.mark.gl
def test_guides_are_drawn_on_the_graded_picture_and_not_on_light(command: Command, tmp_path: Path) -> None:
    plain = recorded(command, tmp_path, "plain.png")
    guided = recorded(command, tmp_path, "guided.png", "--guides", "1:1")
    changed = np.abs(guided - plain).max(axis=-1) > 0.02
    assert changed[:, 7:10].any(axis=1).all()  # 32 of 48 pixels: from 8 to 40
    assert changed[:, 38:41].any(axis=1).all()
    assert not changed[2:-2, 11:16].all()
    assert not changed[:, 44:].any()


def test_a_frame_is_where_the_shape_says(tmp_path: Path) -> None:
    camera = Camera(np.eye(4), horizontal_aperture_mm=36, vertical_aperture_mm=20.25)
    grey = np.full((540, 960, 3), 0.25, np.float32)
    drawn = draw_guides(grey, camera, parse_guides(("2.39:1",)))
    rows = np.flatnonzero(np.abs(drawn[:, 480] - 0.25).max(axis=-1) > 0.2)
    height = 960 / 2.39
    assert rows.min() == pytest.approx((540 - height) / 2, abs=2)
    assert rows.max() == pytest.approx((540 + height) / 2, abs=2)
    assert (grey == 0.25).all()
    for name in (*ASPECTS, "2.2:1", "safe", "thirds", "center"):
        assert np.abs(draw_guides(grey, camera, parse_guides((name,))) - grey).max() > 0.2, name


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--body", "alexa_36"], "did you mean"),
        (["--guides", "2.93"], "there is no framing guide named '2.93'"),
        (["--guides", "thrids"], "did you mean 'thirds'"),
        (["--guides", "0:1"], "there is no framing guide named '0:1'"),
        (["--crop", "2.93"], "there is no picture of the shape '2.93': did you mean '2.39:1'"),
        (
            ["--metering", "matrix"],
            "--metering takes manual, center, average, spot, spot:NAME or spot:X,Y, got 'matrix'",
        ),
        (["--metering", "average:hero"], "got 'average:hero'"),
        (["--metering", "spot:2,2"], "--metering spot: takes a place in the picture such as 0.5,0.5, got '2,2'"),
        (["--iso", 0], "must be"),
        (["--exposure-time", "fast"], "--exposure-time takes seconds such as 0.02 or 1/50, got 'fast'"),
        (["--exposure-time", "1/0"], "--exposure-time takes seconds such as 0.02 or 1/50, got '1/0'"),
        (["--shutter", "400deg"], "--shutter takes an angle above 0 and up to 360 degrees, got '400deg'"),
        (["--shutter", "long"], "--shutter takes seconds such as 0.02 or 1/50, got 'long'"),
        (["--stop", -1], "f-number must be 0 (a pinhole) or more"),
        (["--filter", -1], "--filter takes a density from 0 to 12, got -1"),
        (["--filter", "nan"], "--filter takes a density from 0 to 12, got nan"),
        (["--compensation", "nan"], "--compensation takes stops from -100 to 100, got nan"),
        (["--compensation", "-inf"], "--compensation takes stops from -100 to 100, got -inf"),
        (["--exposure-time", "1e300"], "--exposure-time takes seconds such as 0.02 or 1/50, up to 1e+06, got '1e300'"),
        (["--shutter", "-1/50"], "--shutter takes seconds such as 0.02 or 1/50, got '-1/50'"),
        (["--iso", "1e300"], "exposure:iso is of type float, got 1e+300"),
        (
            ["--channel-index", "1.5,1.6"],
            "--channel-index takes three numbers such as 1.515,1.521,1.528, got '1.5,1.6'",
        ),
        (["--crop", "1000:1"], "a picture's shape is from 1:20 to 20:1, got '1000:1'"),
        (["--guides", ""], "--guides takes shapes such as 2.39:1, and safe, thirds, center, got ''"),
        (["--look", "-Night"], "--look: expected one argument; a value that begins with - is written after a ="),
        (["--motion-by", "velocity"], "--motion-by: invalid choice: 'velocity'"),
        (["--motion", 1, "--motion-by", "moments"], "leave out one of them"),
    ],
)
def test_settings_that_no_camera_has_are_reported_in_one_line(
    command: Command, tmp_path: Path, options: list[object], words: str
) -> None:
    shot = write_shot(tmp_path / "shot.usda", CAMERA, SQUARE)
    ended = command("record", shot, tmp_path / "out.png", *small(*options))
    assert ended.status == 2
    assert words in ended.err
    assert not (tmp_path / "out.png").exists()


def test_guides_need_a_graded_frame(command: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "shot.usda", CAMERA, SQUARE)
    ended = command("record", shot, tmp_path / "out.exr", *small("--guides", "1:1"))
    assert ended.status == 2
    assert "--guides are drawn on graded pictures (.png, .jpg)" in ended.err
    with pytest.raises(SettingsError, match="no framing guide named 'wide'"):
        parse_guides(("wide",))
