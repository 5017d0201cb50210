"""Zemax files with parts that no lens on one axis has: refused by name, or read where they do nothing."""

from __future__ import annotations

import pytest

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files import parse_lens_file
from tests.render.kits.lens_files import TRIPLET_ZMX


def _read(text: str) -> Prescription:
    return parse_lens_file(text.encode(), "a.zmx")


def _with_break(*parameters: str) -> str:
    lines = "\n".join(f"  {parameter}" for parameter in parameters)
    section = f"SURF 1.5\n  TYPE COORDBRK\n  CURV 0.0\n{lines}\n  DISZ 1.5\n"
    return TRIPLET_ZMX.replace("  DISZ 4.0\n", "  DISZ 2.5\n", 1).replace("SURF 2\n", section + "SURF 2\n")


def test_a_break_of_nothing_is_left_out() -> None:
    lens, plain = _read(_with_break("PARM 1 0", "PARM 3 0.0", "PARM 6 1")), _read(TRIPLET_ZMX)
    assert lens.surfaces == plain.surfaces


def test_a_break_that_is_the_stop_is_a_plane_in_its_glass() -> None:
    text = _with_break("PARM 1 0").replace("SURF 4\n  STOP\n", "SURF 4\n").replace("SURF 1.5\n", "SURF 1.5\n  STOP\n")
    lens = _read(text)
    assert [s.is_stop for s in lens.surfaces].index(True) == 1
    assert lens.surfaces[1].glass == lens.surfaces[0].glass


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        (
            "PARM 1 0.5",
            r"surface 1\.5: decentres and tilts \(COORDBRK\) are not supported, got a decentre in x of 0\.5",
        ),
        ("PARM 2 -1", "got a decentre in y of -1"),
        ("PARM 3 4.5E+1", r"got a tilt about x of 4\.5E\+1"),
        ("PARM 5 90", "got a tilt about z of 90"),
        ("PARM 4 x", r"the tilt about y \(PARM 4\) must be a number"),
    ],
)
def test_a_break_is_refused_by_what_it_does(parameter: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(_with_break(parameter))


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("GRADIUM", r"surface 4: gradient-index glasses \(TYPE GRADIUM\) are not supported"),
        ("GRINSUR1", r"surface 4: gradient-index glasses \(TYPE GRINSUR1\) are not supported"),
        ("NONSEQCO", r"surface 4: non-sequential components \(TYPE NONSEQCO\) are not supported"),
        ("TILTSURF", r"surface 4: tilted surfaces \(TYPE TILTSURF\) are not supported"),
        ("PARAXIAL", r"surface 4: ideal lenses without glass \(TYPE PARAXIAL\) are not supported"),
    ],
)
def test_types_are_refused_by_what_they_are(kind: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(TRIPLET_ZMX.replace("TYPE EVENASPH", f"TYPE {kind}"))


def test_a_mirror_is_refused() -> None:
    with pytest.raises(InputError, match=r"line 17, surface 1: mirrors \(GLAS MIRROR\) are not supported"):
        _read(TRIPLET_ZMX.replace("GLAS N-SK16", "GLAS MIRROR"))
