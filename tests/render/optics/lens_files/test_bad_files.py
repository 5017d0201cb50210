"""Lens files that are wrong: one sentence that names file, line and surface, whatever is wrong with them."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file, read_lens_file
from tests.render.kits.lens_files import ACHROMAT_SEQ, DOUBLE_GAUSS_DAT, FILES, TRIPLET_ZMX, ZOOM_TXT


def _refused(name: str, text: str, expected: str) -> None:
    with pytest.raises(InputError, match=expected) as caught:
        parse_lens_file(text.encode(), name)
    assert name in caught.value.detail
    assert "\n" not in caught.value.detail


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("29.475\t3.76", "29.475\tthick", "line 4, surface 1: the thickness must be a number, got 'thick'"),
        ("29.475\t3.76", "nan\t3.76", "line 4, surface 1: the radius must be a number, got 'nan'"),
        ("29.475\t3.76", "1e999\t3.76", "line 4, surface 1: the radius must be a number"),
        (
            "29.475\t3.76\t1.67",
            "29.475\t3.76",
            "line 4, surface 1: a row has radius, thickness, index and diameter, got 3",
        ),
        (
            "29.475\t3.76\t1.67",
            "29.475\t3.76\t-1.67",
            "line 4, surface 1: the refractive index must be from 1 to 5, got -1.67",
        ),
        ("29.475\t3.76\t1.67", "29.475\t3.76\t0", "line 4, surface 1: the refractive index must be from 1 to 5, got 0"),
        ("29.475\t3.76\t1.67\t25.2", "29.475\t3.76\t1.67\t-2", "surface 1: the diameter must be 0 or more, got -2"),
        ("29.475\t3.76", "29.475\t3e7", "line 4, surface 1: the thickness must be at most 100000 mm"),
        ("29.475\t3.76", "1e-6\t3.76", "line 4, surface 1: the radius must be 0 or at least 0.001 mm"),
        ("-39.73\t72.2\t1\t20", "", "surface 10: it is the last one, and has glass behind it"),
        ("19.275\t4.025", "0 1 0 5\n0 1 0 5\n19.275\t4.025", "line 7, surface 4: surface 3 is the stop already"),
    ],
)
def test_a_wrong_row_of_a_pbrt_file(old: str, new: str, expected: str) -> None:
    assert old in DOUBLE_GAUSS_DAT
    _refused("wrong.dat", DOUBLE_GAUSS_DAT.replace(old, new, 1), expected)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "TYPE EVENASPH",
            "TYPE ZERNSAG",
            "line 32, surface 4: surfaces of TYPE STANDARD and .* TOROIDAL are supported, got ZER",
        ),
        ("MODE SEQ", "MODE NSC", "line 2: the MODE must be SEQ"),
        ("UNIT MM", "UNIT FURLONG", "line 4: the UNIT must be one of MM, CM, IN.*got FURLONG"),
        ("GLAS N-SK16 0 0", "GLAS XYZZY 0 0", "line 17, surface 1: glass XYZZY is in no catalogue"),
        (
            "GLAS N-SK16 0 0 1.5",
            "GLAS MIRROR 0 0 1.5",
            r"line 17, surface 1: mirrors \(GLAS MIRROR\) are not supported",
        ),
        ("1.62004 36.37", "1.62004 -36.37", "surface 3: the Abbe number must be 0 .* got -36.37"),
        ("CURV 5.0E-002", "CURV x", r"surface 1: the curvature \(CURV\) must be a number, got 'x'"),
        ("DISZ 5.2", "DISZ", r"surface 2: the thickness \(DISZ\) must be a number, got ''"),
        ("DISZ 5.2", "DISZ INFINITY", "surface 2: the thickness must be at most 100000 mm, got inf"),
        ("PARM 1 0", "PARM 1 1e9", r"surface 4: its term of r\^2 cannot be told by a conic and even powers"),
        ("PARM 1 0", "PARM one 0", "surface 4: PARM must be followed by its number and by its value"),
        ("PARM 1 0", "PARM 9 0.1", "surface 4: PARM 9 must be 0: an even asphere has those from 1 to 8"),
        ("ENPD 14.2857", "CONI 3", "line 5: CONI stands before the first SURF"),
        ("SURF 4\n  STOP", "SURF 4\n  STOP\nSURF 4.5\n  STOP", "surface 4.5: surface 4 is the stop already"),
    ],
)
def test_a_wrong_line_of_a_zemax_file(old: str, new: str, expected: str) -> None:
    assert old in TRIPLET_ZMX
    _refused("wrong.zmx", TRIPLET_ZMX.replace(old, new, 1), expected)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "NBK7_SCHOTT",
            "NBK77_SCHOTT",
            "line 10, surface 1: glass NBK77_SCHOTT is in no catalogue, did you mean N-BK7 ",
        ),
        ("NBK7_SCHOTT", "REFL", r"line 10, surface 1: mirrors \(REFL\) are not supported"),
        ("DIM   M", "DIM   Q", "line 4: DIM must be M, C or I, got Q"),
        ("SI    0.0 0.0", "", "it ends before the image surface"),
        ("  PIM", "  DIF", "line 17, surface 3: DIF is not supported"),
        ("  PIM", "  ADE 5.0", r"line 17, surface 3: tilts and decentres \(ADE 5\.0\) are not supported"),
        ("  PIM", "STO S7", "line 17: there is no surface 7"),
        (
            "S     61.46999999999995 6.0",
            "S     61.46999999999995",
            "line 10, surface 1: the thickness must be a number",
        ),
        ("SO    0.0 0.1e14", "", "the surfaces must begin with the object's"),
        (
            "  PIM",
            "  PIM\nPRV\nPWL 650 550\n'x' 1.5\nEND",
            "line 20: glass X: expected one index for each of the 2 wavelengths",
        ),
        (
            "  PIM",
            "  PIM\nPRV\nPWL 650 1e9\n'x' 1.5 1.4\nEND",
            "line 20: wavelengths .PWL. must be at most 100000 nm",
        ),
        (
            "  PIM",
            "  PIM\nPRV\nPWL 650 640 630\n'x' 1.5 1.7 1.5\nEND",
            "line 20: (glass x has an impossible refractive index|the (refractive index|Abbe number) must be)",
        ),
    ],
)
def test_a_wrong_command_of_a_code_v_file(old: str, new: str, expected: str) -> None:
    assert old in ACHROMAT_SEQ
    _refused("wrong.seq", ACHROMAT_SEQ.replace(old, new, 1), expected)


@pytest.mark.parametrize(("until", "surface"), [("DIAM 9 1 0 0 1", 1), ("SURF 3", 2), ("SURF 4", 3), ("SURF 7", 6)])
def test_a_zemax_file_that_is_cut_off_before_its_image(until: str, surface: int) -> None:
    cut = TRIPLET_ZMX[: TRIPLET_ZMX.index(until)]
    expected = "expected SURF sections" if surface == 1 else f"surface {surface}: the last one must be the image"
    _refused("cut.zmx", cut, expected)


def test_a_pipe_is_not_waited_for(tmp_path) -> None:
    os.mkfifo(tmp_path / "pipe.dat")
    with pytest.raises(InputError, match="cannot be read: it is no file with an end"):
        read_lens_file(tmp_path / "pipe.dat")


def test_a_tilt_of_nothing_is_none() -> None:
    assert len(parse_lens_file(ACHROMAT_SEQ.replace("  PIM", "  ADE 0.0; BDE 0").encode(), "a.seq").surfaces) == 3


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("d5\t9.20\t5.2\t8.15\t4.1\n", "", "line 17, surface 5: the thickness must be a number, got 'd5'"),
        ("d5\t9.20", "d5\tundefined", "line 10, surface 5: the thickness d5 must be a number, got 'undefined'"),
        ("6\t45\t-0.5", "66\t45\t-0.5", "line 24: .aspherical data. names surface 66"),
        (
            "6\t45\t4.0\t1.618",
            "6\t45\t4.0\t0.618",
            "line 19, surface 6: the refractive index must be from 1 to 5, got 0.618",
        ),
        (
            "6\t45\t4.0\t1.618\t19\t63.3",
            "6 45 4.0 1.618 19 63.3",
            "line 19: expected surface, radius and thickness",
        ),
        ("[lens data]", "[some data]", "there is no surface in it"),
    ],
)
def test_a_wrong_row_of_an_optical_bench_file(old: str, new: str, expected: str) -> None:
    assert old in ZOOM_TXT
    text = ZOOM_TXT.replace(old, new, 1) + ("" if "[lens data]" not in old else "[lens data]\n")
    _refused("wrong.txt", text, expected)


def test_files_that_are_no_lens(tmp_path) -> None:
    _refused("empty.dat", "", "there is no surface in it")
    _refused("empty.zmx", "", "expected SURF sections")
    _refused("a poem.txt", "O rose, thou art sick\n", "is no lens file that is known")
    _refused("air.dat", "10 1 1 5\n20 1 1 5\n", "no surface has glass behind it")
    _refused("long.dat", "# long\n" * 200_000, "is too long for a lens file")
    _refused("many.dat", "10 1 1.5 5\n-10 1 1 5\n" * 101, "a lens has at most 200 surfaces, got 202")
    for name in ("there is none.dat", "."):
        with pytest.raises(InputError, match="cannot be read"):
            read_lens_file(tmp_path / name)


@pytest.mark.parametrize("data", [b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"\xff\xfe\x00", b"\x01\x02\x03" * 50])
def test_binary_files_are_refused(data: bytes) -> None:
    with pytest.raises(InputError, match="expected text, got binary data"):
        parse_lens_file(data, "picture.zmx")


def test_long_runs_of_the_same_take_no_time() -> None:
    for name in ("a.txt", "a.seq", "a.zmx", "a.dat"):
        for run in ("\n", "1", " ", "0 ", "'", ";", "-", "[", "\t"):
            with pytest.raises(InputError):
                parse_lens_file((run * (2**20 // len(run))).encode(), name)


def _numbers(lens: Prescription) -> Iterator[float]:
    yield lens.f_stop
    for surface in lens.surfaces:
        yield from (surface.radius_mm, surface.thickness_mm, surface.semi_diameter_mm, surface.conic, *surface.aspheric)
        yield from (surface.glass.index, surface.glass.abbe)


def _parsed(data: bytes, name: str) -> tuple[Prescription | None, str]:
    try:
        return parse_lens_file(data, name), ""
    except InputError as error:
        return None, error.detail


def _is_refused_or_good(data: bytes, name: str) -> None:
    lens, refusal = _parsed(data, name)
    if lens is None:
        assert refusal.startswith(name)
        assert "\n" not in refusal
        return
    assert all(math.isfinite(number) for number in _numbers(lens))
    assert all(1 <= surface.glass.index <= 5 for surface in lens.surfaces)
    assert sum(surface.is_stop for surface in lens.surfaces) <= 1
    if lens.focus_group is not None:
        assert 0 <= lens.focus_group[0] <= lens.focus_group[1] < len(lens.surfaces)


@given(name=st.sampled_from(sorted(FILES)), share=st.floats(0, 1), wide=st.booleans())
@settings(max_examples=300)
def test_a_truncated_file_is_refused_or_is_a_lens(name: str, share: float, wide: bool) -> None:
    data = FILES[name].encode("utf-16" if wide else "utf-8")
    _is_refused_or_good(data[: int(len(data) * share)], name)


_WORDS = st.sampled_from(
    ["", "0", "-1", "1e308", "1e-308", "nan", "inf", "x", "1", "1.5", "\t", "\n", "S3", "STOP", "AS", ";", "'"]
)


@given(
    name=st.sampled_from(sorted(FILES)),
    places=st.lists(st.tuples(st.integers(0, 10_000), _WORDS | st.text(max_size=4)), min_size=1, max_size=6),
)
@settings(max_examples=500)
def test_a_corrupted_file_is_refused_or_is_a_lens(name: str, places: list[tuple[int, str]]) -> None:
    words = FILES[name].replace("\t", " \t ").replace("\n", " \n ").split(" ")
    for place, word in places:
        words[place % len(words)] = word
    text = " ".join(words).replace(" \t ", "\t").replace(" \n ", "\n")
    _is_refused_or_good(text.encode("utf-8", "surrogatepass"), name)


@given(name=st.sampled_from(sorted(FILES)), data=st.binary(max_size=200), at=st.integers(0, 2000))
@settings(max_examples=200)
def test_foreign_bytes_are_refused_or_leave_a_lens(name: str, data: bytes, at: int) -> None:
    file = FILES[name].encode()
    _is_refused_or_good(file[:at] + data + file[at + len(data) :], name)
