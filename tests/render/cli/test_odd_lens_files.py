"""Ninety odd lens files: each is read with right numbers and a note where something is assumed, or is one line of error."""

from __future__ import annotations

from pathlib import Path

import pytest

from render.cli.main import main
from render.optics.lens_files import parse_lens_file, read_lens_file
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import first_order
from tests.render.kits.lens_files import ACHROMAT_SEQ, DOUBLE_GAUSS_DAT, TRIPLET_ZMX, ZOOM_TXT
from tests.render.kits.odd_lens_files import READ, WRONG, OddFile

PLAIN = {
    "triplet": ("a.zmx", TRIPLET_ZMX),
    "achromat": ("a.seq", ACHROMAT_SEQ),
    "gauss": ("a.dat", DOUBLE_GAUSS_DAT),
    "zoom": ("a.txt", ZOOM_TXT),
}


def test_there_are_more_than_sixty() -> None:
    assert len(READ) + len(WRONG) > 60
    assert len({file.name for file in READ}) == len(READ)


@pytest.mark.parametrize("file", READ, ids=lambda file: file.name)
def test_a_file_in_other_clothes_has_the_same_numbers(tmp_path: Path, file: OddFile) -> None:
    path = tmp_path / file.name
    path.write_bytes(file.content)
    name, text = PLAIN[file.same_as]
    plain, lens = parse_lens_file(text.encode(), name), read_lens_file(path)
    assert first_order(lens).focal_length_mm == pytest.approx(file.scale * first_order(plain).focal_length_mm, rel=1e-5)
    if (
        len(lens.configurations) < 2
    ):  # the iris of a zoom opens to the stated number at each position, whatever its clear diameter
        assert complete_prescription(lens).f_stop == pytest.approx(complete_prescription(plain).f_stop, rel=1e-4)
    if file.says:
        assert any(file.says in note for note in lens.notes), lens.notes
    else:
        assert lens.notes == plain.notes


@pytest.mark.parametrize("file", WRONG, ids=lambda file: file.name)
def test_a_file_of_no_lens_is_one_line_of_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: OddFile
) -> None:
    path = tmp_path / file.name
    path.write_bytes(file.content)
    assert main(["lenses", "show", str(path)]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1
    assert file.says in printed.err
    assert "Traceback" not in printed.err


@pytest.mark.parametrize("name", ["a.zmx", "a.seq", "a.txt", "a.roa", "a.json", "a.dat", "a.lens"])
def test_a_folder_and_nothing_are_no_lens_files(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    (tmp_path / name).mkdir()
    for path in (tmp_path / name, tmp_path / f"no {name}"):
        assert main(["lenses", "show", str(path)]) == 1
        assert "cannot be read" in capsys.readouterr().err
