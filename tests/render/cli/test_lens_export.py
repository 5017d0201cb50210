"""`pullfocus lenses export`: a lens as a lens file of another program."""

from __future__ import annotations

import pytest

from render.cli.main import main
from render.optics.lens_files import read_lens_file
from render.optics.prescription.paraxial import first_order
from tests.render.kits.lens_files import TRIPLET_ZMX


@pytest.mark.parametrize("suffix", [".zmx", ".seq", ".txt"])
def test_a_lens_of_the_library_is_written(tmp_path, capsys, suffix: str) -> None:
    path = tmp_path / f"gauss{suffix}"
    assert main(["lenses", "export", "double_gauss_50", str(path)]) == 0
    assert len(read_lens_file(path).surfaces) == 11
    printed = capsys.readouterr()
    assert "note: Coatings are not written." in printed.out + printed.err
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_a_lens_file_is_written_as_another(tmp_path) -> None:
    source, target = tmp_path / "triplet.zmx", tmp_path / "triplet.seq"
    source.write_text(TRIPLET_ZMX)
    assert main(["lenses", "export", str(source), str(target)]) == 0
    assert len(read_lens_file(target).surfaces) == 6


def test_a_zoom_is_written_at_a_focal_length(tmp_path, capsys) -> None:
    path = tmp_path / "tele.zmx"
    assert main(["lenses", "export", "tele_zoom_70_200", str(path), "--focal-length", "135"]) == 0
    assert first_order(read_lens_file(path)).focal_length_mm == pytest.approx(135, rel=1e-4)
    assert "the first is written" not in "".join(capsys.readouterr())


@pytest.mark.parametrize(
    ("lens", "said"), [("tele_zoom_70_200", "zooms from 72.09 to 194 mm, got 300"), ("planar_50", "is no zoom")]
)
def test_a_focal_length_that_it_has_not_is_not_written(tmp_path, capsys, lens: str, said: str) -> None:
    path = tmp_path / "lens.zmx"
    assert main(["lenses", "export", lens, str(path), "--focal-length", "300"]) != 0
    assert said in capsys.readouterr().err
    assert not path.exists()


@pytest.mark.parametrize(
    ("lens", "file", "message"),
    [
        ("double_gauss_50", "gauss.dat", "a lens file is written as .zmx, .seq, .txt, got"),
        ("double_gauss_50", "no/such/folder/gauss.zmx", "no/such/folder"),
        ("pinhole_35", "pinhole.zmx", "pinhole_35 has no surfaces to write: its model is pinhole"),
        ("nobody_50", "nobody.zmx", "nobody_50"),
    ],
)
def test_what_cannot_be_written_is_one_line(tmp_path, capsys, lens: str, file: str, message: str) -> None:
    assert main(["lenses", "export", lens, str(tmp_path / file)]) != 0
    error = capsys.readouterr().err
    assert message in error
    assert len(error.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
