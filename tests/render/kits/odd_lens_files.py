"""Odd lens files: as people have them, cut off, absurd and foreign. Each is generated from one of the kit's lenses."""

from __future__ import annotations

import json
from dataclasses import dataclass

from tests.render.kits.lens_files import ACHROMAT_SEQ, DOUBLE_GAUSS_DAT, TRIPLET_ZMX, ZOOM_TXT


@dataclass(frozen=True)
class OddFile:
    """One file.

    Attributes:
        name: of the file.
        content: all of its bytes.
        same_as: lens whose numbers it must have, of ``triplet``, ``achromat``, ``gauss`` and ``zoom``; "" for an error.
        scale: focal length over that of the lens.
        says: part of the note, or of the error; "" for a lens without a note of its own.
    """

    name: str
    content: bytes
    same_as: str = ""
    scale: float = 1.0
    says: str = ""


def _zmx(old: str, new: str) -> bytes:
    assert old in TRIPLET_ZMX, old
    return TRIPLET_ZMX.replace(old, new, 1).encode()


def _seq(old: str, new: str) -> bytes:
    assert old in ACHROMAT_SEQ, old
    return ACHROMAT_SEQ.replace(old, new, 1).encode()


def _txt(old: str, new: str) -> bytes:
    assert old in ZOOM_TXT, old
    return ZOOM_TXT.replace(old, new, 1).encode()


def _upto(text: str, mark: str, more: int = 0) -> bytes:
    return text[: text.index(mark) + more].encode()


_BREAK = "SURF 1.5\n  TYPE COORDBRK\n  CURV 0\n  PARM 1 0\n  PARM 3 0.0\n  DISZ 0\nSURF 2\n"
_PRIVATE = "PRV\n PWL 656.27 587.56&\n 486.13\n 'bk' 1.51432 1.51680&\n 1.52238\nEND\n"
_OSLO = 'LEN NEW "triplet" 50 7\nEBR 6.25\nUNI 1.0\nAIR\nTH 1.0e+20\nNXT\nRD 21.25\nTH 2.0\nGLA SK16\nNXT\nEND 7\n'
_PLAIN_TRIPLET = TRIPLET_ZMX.encode()

READ = (
    OddFile("crlf.zmx", TRIPLET_ZMX.replace("\n", "\r\n").encode(), "triplet"),
    OddFile("mac.zmx", TRIPLET_ZMX.replace("\n", "\r").encode(), "triplet"),
    OddFile("tabs.zmx", TRIPLET_ZMX.replace("  ", "\t").replace("CURV ", "CURV\t").encode(), "triplet"),
    OddFile("utf16.zmx", TRIPLET_ZMX.encode("utf-16"), "triplet"),
    OddFile("utf16-be.zmx", b"\xfe\xff" + TRIPLET_ZMX.encode("utf-16-be"), "triplet"),
    OddFile("utf16-without-mark.zmx", TRIPLET_ZMX.encode("utf-16-le"), "triplet"),
    OddFile("utf16-be-without-mark.zmx", TRIPLET_ZMX.encode("utf-16-be"), "triplet"),
    OddFile("utf8-mark.zmx", TRIPLET_ZMX.encode("utf-8-sig"), "triplet"),
    OddFile("latin1.zmx", TRIPLET_ZMX.replace("A triplet", "Für Elise").encode("latin-1"), "triplet"),
    OddFile("small letters.zmx", TRIPLET_ZMX.lower().replace("n-sk16", "N-SK16").encode(), "triplet"),
    OddFile("SHOUTED.ZMX", _PLAIN_TRIPLET, "triplet"),
    OddFile("no suffix", _PLAIN_TRIPLET, "triplet"),
    OddFile("a triplet.txt", _PLAIN_TRIPLET, "triplet"),
    OddFile("no end.zmx", TRIPLET_ZMX.rstrip("\n").encode(), "triplet"),
    OddFile("old dos.zmx", TRIPLET_ZMX.encode() + b"\x1a", "triplet"),
    OddFile("nameless.zmx", _zmx("NAME A triplet\n", ""), "triplet"),
    OddFile("inches.zmx", _zmx("UNIT MM", "UNIT IN"), "triplet", 25.4),
    OddFile("metres.zmx", _zmx("UNIT MM", "UNIT M"), "triplet", 1000.0),
    OddFile("centimetres.zmx", _zmx("UNIT MM", "UNIT CM"), "triplet", 10.0),
    OddFile("near.zmx", _zmx("DISZ INFINITY", "DISZ 700"), "triplet", 1.0, "The file's object is near"),
    OddFile("far.zmx", _zmx("DISZ INFINITY", "DISZ 1.0E+10"), "triplet"),
    OddFile("zoom.zmx", _zmx("MNUM 1 1", "MNUM 2 2\nTHIC 2 1 5.2 0\nTHIC 2 2 6 0"), "triplet", 1.0, "2 configurations"),
    OddFile("zeros.zmx", _zmx("  PARM 3 2.5E-8\n", "  PARM 3 2.5E-8\n  PARM 9 0.0\n  PARM 10 0\n"), "triplet"),
    OddFile("break.zmx", _zmx("SURF 2\n", _BREAK), "triplet"),
    OddFile("unknown words.zmx", _zmx("GCAT", "XYZZY 1 2 3\nGCAT"), "triplet"),
    OddFile("fortran.zmx", _zmx("PARM 2 1.5E-5", "PARM 2 1.5D-05"), "triplet"),
    OddFile("wide rim.zmx", _zmx("DIAM 9 1", "DIAM 20.5 1"), "triplet", 1.0, "was trimmed from 41 to 40 mm"),
    OddFile("glued.seq", _seq("NBK7_SCHOTT", "&\n NBK7_SCHOTT"), "achromat"),
    OddFile("glued tight.seq", _seq(" 6.0 NBK7", " 6.0&\n NBK7"), "achromat"),
    OddFile("private.seq", _PRIVATE.encode() + _seq("NBK7_SCHOTT", "'bk'"), "achromat"),
    OddFile("small.seq", ACHROMAT_SEQ.lower().encode(), "achromat"),
    OddFile("no go.seq", _seq("GO\n", ""), "achromat"),
    OddFile("remarks.seq", b"! made by hand\n" + _seq("DIM   M", "DIM   M ! millimetres"), "achromat"),
    OddFile("inches.seq", _seq("DIM   M", "DIM   I"), "achromat", 25.4),
    OddFile("infinite.seq", _seq("0.1e14", "Infinity"), "achromat"),
    OddFile("tilt of nothing.seq", _seq("  STO\n", "  STO\n  ADE 0; YDE 0.0\n"), "achromat"),
    OddFile(
        "zoom.seq", _seq("GO\n", "ZOO 2\nZOO THI S3 95.95194415183156 99\nGO\n"), "achromat", 1.0, "2 zoom positions"
    ),
    OddFile("code v.txt", ACHROMAT_SEQ.encode(), "achromat"),
    OddFile("no colour.dat", DOUBLE_GAUSS_DAT.encode(), "gauss", 1.0, "no Abbe numbers"),
    OddFile("iset.dat", b"# a lens\n50\n" + DOUBLE_GAUSS_DAT.encode(), "gauss", 1.0, "no Abbe numbers"),
    OddFile("iset 6.dat", b"6\n" + DOUBLE_GAUSS_DAT.encode(), "gauss", 1.0, "The file says 6 mm"),
    OddFile("bench zoom.txt", ZOOM_TXT.encode(), "zoom", 1.0, "4 positions of zoom and focus"),
    OddFile(
        "bench field stop.txt", _txt("7\t-45\td7\t", "7\t-45\t-0.4\t\t19\n71\tFS\t1.0\t"), "zoom", 1.0, "it is left out"
    ),
    OddFile("bench infinity.txt", _txt("d0\tInfinity", "d0\tinfinity"), "zoom", 1.0, "4 positions"),
)

WRONG = (
    OddFile("empty.zmx", b"", says="expected SURF sections for the object"),
    OddFile("empty", b"", says="is no lens file that is known"),
    OddFile("head.zmx", _upto(TRIPLET_ZMX, "SURF 0"), says="got 0"),
    OddFile("cut in glass.zmx", _upto(TRIPLET_ZMX, "SURF 4"), says="the last one must be the image"),
    OddFile("cut in a word.zmx", _upto(TRIPLET_ZMX, "DISZ 5.2", 4), says="the thickness (DISZ) must be a number"),
    OddFile("cut.seq", _upto(ACHROMAT_SEQ, "SI "), says="it ends before the image surface (SI)"),
    OddFile("cut.txt", _upto(ZOOM_TXT, "[lens data]", 11), says="there is no surface in it"),
    OddFile(
        "cut in a row.txt", _upto(ZOOM_TXT, "4\t40\t2.0", 4), says="line 17: expected surface, radius and thickness"
    ),
    OddFile("zeros.zmx", bytes(4096), says="expected text, got binary data"),
    OddFile("picture.zmx", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", says="expected text, got binary data"),
    OddFile("archive.zar.zmx", b"PK\x03\x04\x14\x00\x00\x00", says="expected text, got binary data"),
    OddFile("page.zmx", b"<!DOCTYPE html><html><body>404 Not Found</body></html>", says="expected SURF sections"),
    OddFile("page.txt", b"<!DOCTYPE html><html><body>404</body></html>", says="is no lens file that is known"),
    OddFile("pointer.zmx", b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n", says="got 0"),
    OddFile("prose.txt", b"My lens is sharp.\n", says="is no lens file that is known"),
    OddFile("long.zmx", b"SURF 1\n" * 200_000, says="is too long for a lens file"),
    OddFile("not a number.zmx", _zmx("CURV 5.0E-002", "CURV NaN"), says="the curvature (CURV) must be a number"),
    OddFile("beyond.zmx", _zmx("DISZ 5.2", "DISZ 1E999"), says="the thickness (DISZ) must be a number"),
    OddFile("far apart.zmx", _zmx("DISZ 5.2", "DISZ 1E9"), says="the thickness must be at most 100000 mm"),
    OddFile("backwards.zmx", _zmx("DISZ 4.0", "DISZ -4.0"), says="its thickness must be 0 or more"),
    OddFile("comma.zmx", _zmx("DISZ 5.2", "DISZ 5,2"), says="the thickness (DISZ) must be a number, got '5,2'"),
    OddFile("two stops.zmx", _zmx("SURF 5\n", "SURF 5\n  STOP\n"), says="surface 4 is the stop already"),
    OddFile("mirror.zmx", _zmx("GLAS N-SK16", "GLAS MIRROR"), says="mirrors (GLAS MIRROR) are not supported"),
    OddFile("tilt.zmx", _zmx("SURF 2\n", _BREAK.replace("PARM 3 0.0", "PARM 3 9")), says="got a tilt about x of 9"),
    OddFile(
        "gradient.zmx", _zmx("EVENASPH", "GRADIUM"), says="gradient-index glasses (TYPE GRADIUM) are not supported"
    ),
    OddFile("nonsequential.zmx", _zmx("MODE SEQ", "MODE NSC"), says="the MODE must be SEQ"),
    OddFile("no glass.zmx", TRIPLET_ZMX.replace("  GLAS", "  NOTE").encode(), says="no surface has glass behind it"),
    OddFile(
        "unknown glass.zmx", _zmx("N-SK16 0 0", "N-SK61 0 0"), says="glass N-SK61 is in no catalogue, did you mean"
    ),
    OddFile("thin glass.zmx", _zmx("1.62004 36.37", "0.5 36.37"), says="the refractive index must be from 1 to 5"),
    OddFile("fast.zmx", _zmx("ENPD 14.2857", "ENPD 900"), says="wide open is impossible"),
    OddFile("many.dat", b"10 1 1.5 5\n-10 1 1 5\n" * 150, says="a lens has at most 200 surfaces"),
    OddFile("three.dat", b"10 1 1.5\n", says="a row has radius, thickness, index and diameter, got 3 words"),
    OddFile("diverging.dat", b"-50 2 1.5 10\n50 10 1 10\n", says="expected a positive one: light must converge"),
    OddFile("tilt.seq", _seq("  STO\n", "  STO\n  ADE 45\n"), says="tilts and decentres (ADE 45) are not supported"),
    OddFile("mirror.seq", _seq("NBK7_SCHOTT", "REFL"), says="mirrors (REFL) are not supported"),
    OddFile(
        "gradient.seq", _seq("  STO\n", "  STO\n  GRN C10 1\n"), says="gradient-index glasses (GRN) are not supported"
    ),
    OddFile(
        "formula.seq", b"PRV\n'x' GMS 1 2 3\nEND\n" + ACHROMAT_SEQ.encode(), says="the formula GMS is not supported"
    ),
    OddFile(
        "spaces.txt",
        ZOOM_TXT.replace("\t", " ").encode(),
        says="expected surface, radius and thickness, parted by tabs",
    ),
    OddFile("missing distance.txt", _txt("d5\t9.20", "d55\t9.20"), says="the thickness must be a number, got 'd5'"),
    OddFile("package.json", b'{"name": "page", "version": "1.0"}', says="is no lens file that is known"),
    OddFile("broken.roa", b'{"optical_model": {', says="it is no JSON"),
    OddFile("deep.roa", b"[" * 50_000, says="it is no JSON of a lens"),
    OddFile("other.roa", json.dumps({"optical_model": []}).encode(), says="expected an object, at least one surface"),
    OddFile("few.json", json.dumps({"surface_group": {"surfaces": [1]}}).encode(), says="expected an object, at least"),
    OddFile("triplet.len", _OSLO.encode(), says="it is a lens of OSLO, whose .len files are not read"),
    OddFile("zemax as code v.seq", _PLAIN_TRIPLET, says="it ends before the image surface (SI)"),
    OddFile("zemax as pbrt.dat", _PLAIN_TRIPLET, says="the radius must be a number, got 'VERS'"),
)
