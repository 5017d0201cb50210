"""`--lens` mounts a lens for one run: of the library or of a file, and the shot's own files stay as they are."""

from __future__ import annotations

import json
from pathlib import Path

import OpenImageIO
import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot
from tests.render.kits.lens_files import ACHROMAT_SEQ, FILES


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A red square, 5 m before a camera of 50 mm at f/2."""
    return write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)


def _lens(pullfocus: Command, shot: Path, lens: object) -> tuple[float, float, str]:
    """Focal length, f-number, and what was said of it."""
    ended = pullfocus("focus-curve", shot, "--camera", "/World/main_cam", "--frames", "1", "--lens", lens)
    assert ended.status == 0, ended.err
    [sample] = json.loads(ended.out)["samples"]
    return sample["focalLengthMm"], sample["fStop"], ended.err


def test_a_library_lens_sets_focal_length_and_widest_f_number(pullfocus: Command, shot: Path) -> None:
    before = shot.read_bytes()
    focal_length, f_stop, said = _lens(pullfocus, shot, "telephoto_250")
    assert (focal_length, f_stop) == pytest.approx((249.57, 5.6))
    assert said.splitlines() == ["lens: Telephoto 250 mm f/5.6 (focal length 249.57 mm, f-number raised to f/5.6)"]
    assert shot.read_bytes() == before
    assert [path.name for path in shot.parent.iterdir()] == [shot.name]


def test_an_f_number_that_the_lens_has_is_kept(pullfocus: Command, shot: Path) -> None:
    focal_length, f_stop, said = _lens(pullfocus, shot, "Planar-50")
    assert (focal_length, f_stop) == (50, 2)
    assert "f-number" not in said


def test_unknown_glass_is_mounted_where_it_is_allowed(pullfocus: Command, shot: Path) -> None:
    file = shot.parent / "triplet.zmx"
    file.write_text(FILES["triplet.zmx"].replace("GLAS N-SK16 0 0 1.5 4.0E+1", "GLAS XYZZY 0 0 1.62 60.3"))
    options = ("focus-curve", shot, "--camera", "/World/main_cam", "--frames", "1", "--lens", file)
    refused = pullfocus(*options)
    assert refused.status == 1
    assert "glass XYZZY is in no catalogue; --allow-unknown-glass takes it" in refused.err
    allowed = pullfocus(*options, "--allow-unknown-glass")
    assert allowed.status == 0
    assert "lens: Glass XYZZY is in no catalogue: n_d 1.62 and V_d 60.3 are the file's." in allowed.err


@pytest.mark.parametrize(("name", "focal_length"), [("achromat.seq", 100.03), ("double gauss.dat", 50.36)])
def test_a_lens_file_is_mounted_and_its_gaps_are_reported(
    name: str, focal_length: float, pullfocus: Command, shot: Path
) -> None:
    file = shot.parent / name
    file.write_text(FILES[name])
    got, f_stop, said = _lens(pullfocus, shot, file)
    assert got == pytest.approx(focal_length, rel=1e-3)
    assert f_stop >= 2
    assert len(said.splitlines()) > 1
    assert all(line.startswith("lens: ") for line in said.splitlines())


def test_a_mounted_lens_is_in_the_picture(pullfocus: Command, shot: Path) -> None:
    plain, through = shot.parent / "plain.exr", shot.parent / "through.exr"
    assert pullfocus("record", shot, plain, *small()).status == 0
    assert pullfocus("record", shot, through, "--lens", "telephoto_250", *small()).status == 0
    pixels = [OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT) for path in (plain, through)]
    # Five times as long, the lens sees nothing but the square.
    red = [(picture[..., 0] > 2 * picture[..., 2]).mean() for picture in pixels]
    assert red[0] < 0.55 < red[1]


def test_a_wrong_lens_ends_with_one_line_and_its_exit_status(pullfocus: Command, shot: Path) -> None:
    broken = shot.parent / "broken.seq"
    broken.write_text(ACHROMAT_SEQ.replace("NBK7_SCHOTT", "XYZZY"))
    for lens, status, words in (
        ("planr_50", 2, "--lens: there is no lens named 'planr_50' in the library: did you mean planar_50"),
        (broken, 1, "broken.seq, line 10, surface 1: glass XYZZY is in no catalogue"),
        (shot.parent / "none.zmx", 1, "none.zmx cannot be read"),
    ):
        ended = pullfocus("focus-curve", shot, "--camera", "/World/main_cam", "--lens", lens)
        assert (ended.status, ended.out) == (status, "")
        assert words in ended.err
        assert len(ended.err.splitlines()) == 1


def test_a_shot_without_a_camera_has_none_to_mount_a_lens_on(pullfocus: Command, tmp_path: Path) -> None:
    bare = write_shot(tmp_path / "bare.usda", SQUARE)
    ended = pullfocus("record", bare, tmp_path / "frame.png", "--lens", "planar_50", *small())
    assert ended.status == 1
    assert "has no camera" in ended.err
