"""`pullfocus lenses export`: a lens as a lens file of another program."""

from __future__ import annotations

import pytest

from render.cli.main import main
from render.optics.lens_files import read_lens_file
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
