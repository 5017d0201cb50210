"""The hostile corpus: files that somebody could upload to do harm, the same ones in every run."""

from __future__ import annotations

import io
import random
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal

from tests.hostile.absurd_numbers import absurd_numbers
from tests.hostile.stage_attacks import stage_attacks
from tests.render.kits.colours import LOOK_WITH_A_FILE, OWN_CONFIG
from tests.render.kits.hostile_images import IMAGE_BOMBS, file_name
from tests.render.kits.hostile_stages import STAGE_BOMBS
from tests.service.conftest import ROOM

SEED = 4711
NUMBERS = (0, 1, -1, 2**15, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1)
CTF = '<ProcessList id="a" version="1.7"><Reference path="{}" inBitDepth="32f" outBitDepth="32f"/></ProcessList>'
CUBE = "LUT_1D_SIZE 2\n0 0 0\n0.5 0.5 0.5\n"
CDL = (
    '<ColorCorrection id="a"><SOPNode><Slope>1 1 1</Slope><Offset>0 0 0</Offset><Power>1 1 1</Power></SOPNode>'
    "</ColorCorrection>"
)


Kind = Literal["shot", "curve", "lens"]


@dataclass(frozen=True)
class Canaries:
    """Secrets outside of every upload.

    Attributes:
        text: file with a line of text.
        cube: a look-up table.
        variable: name of an environment variable.
        values: what must never be seen.
        colour: of every pixel of a picture that the table grades, 0 to 255; None where it is not known.
    """

    text: Path
    cube: Path
    variable: str
    values: tuple[str, ...]
    colour: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Case:
    """One upload.

    Attributes:
        name: of the attack, such as ``usdc/flip-12``.
        file: name of the file that is sent.
        content: its bytes.
        kind: ``shot``, or what it is to a shot: ``curve`` or ``lens``.
    """

    name: str
    file: str
    content: bytes
    kind: Kind = "shot"


def packed(files: dict[str, bytes | str]) -> bytes:
    """Zip archive of files, the same bytes for the same files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return out.getvalue()


def graded(**files: bytes | str) -> bytes:
    """Shot whose camera is graded by own.ocio, or a CDL where there is one; names have ``__`` for the dot."""
    sent = {name.replace("__", "."): content for name, content in files.items()}
    grade = 'asset film:ocio:config = @own.ocio@\n string film:ocio:look = "Dusk"\n'
    if "a.cc" in sent:
        grade = "asset film:cdl:file = @a.cc@\n"
    schema = 'def Camera "cam" (prepend apiSchemas = ["FilmAPI"])\n    {\n'
    return packed({"room.usda": ROOM.replace('def Camera "cam"\n    {\n', schema + grade), **sent})


def textured(name: str, content: bytes) -> bytes:
    """Shot with a dome light and a plate of an image."""
    dome = f'def DomeLight "dome" {{\n asset inputs:texture:file = @{name}@\n}}\n'
    return packed({"room.usda": ROOM + dome, name: content})


def corpus(canaries: Canaries) -> Iterator[Case]:
    """All cases, at least 500."""
    yield from holes(canaries)
    for kind, base, count, wrap in _bases():
        mutate = random.Random(f"{SEED}/{kind}")
        for number in range(count):
            how, content = mutated(base, mutate)
            file, sent = wrap(content)
            yield Case(f"{kind}/{number}-{how}", file, sent)


def controls() -> Iterator[Case]:
    """The same kinds of files without harm, which are taken and drawn."""
    yield Case("good/usda", "a.usda", ROOM.encode())
    for kind, base, _, wrap in _bases():
        if kind not in ("ocio", "ctf", "clf", "cube", "cdl"):
            yield Case(f"good/{kind}", *wrap(base))
    yield Case(
        "good/ocio", "a.zip", graded(own__ocio=OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", "b.cube"), b__cube=CUBE)
    )
    yield Case("good/suffix", "a.zip", textured("a.null", _image("png")))
    yield Case("good/cdl", "a.zip", graded(a__cc=CDL))


def holes(canaries: Canaries) -> Iterator[Case]:
    """Every hole that was known, and its relations."""
    for name, text in STAGE_BOMBS.items():
        yield Case(f"stage/{name}", "a.usda", text.encode())
    for name, text in (*absurd_numbers(), *stage_attacks()):
        yield Case(f"attack/{name}", "a.usda", text.encode())
    for name, content in IMAGE_BOMBS.items():
        yield Case(f"image/{name}", "a.zip", textured(file_name(name), content))
    for src in (
        f"%{canaries.variable}%",
        f"${canaries.variable}",
        "%PATH%",
        str(canaries.cube),
        f"../{canaries.cube.name}",
    ):
        yield Case(f"ocio/{src}", "a.zip", graded(own__ocio=OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", src)))
    for path in (
        canaries.cube,
        canaries.text,
        "/etc/passwd",
        "../../../../etc/passwd",
        "/dev/zero",
        "/no/such/file.cube",
    ):
        for suffix in ("ctf", "clf", "foo"):
            config = OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", f"a.{suffix}")
            yield Case(f"ctf/{suffix}-{path}", "a.zip", graded(own__ocio=config, **{f"a__{suffix}": CTF.format(path)}))
    for asset in (
        "x.null?RES=100000x100000",
        "x.term",
        str(canaries.text),
        "/dev/zero",
        "../../../etc/passwd",
        "file:///etc/passwd",
    ):
        yield Case(
            f"texture/{asset}",
            "a.usda",
            (ROOM + f'def DomeLight "d" {{\n asset inputs:texture:file = @{asset}@\n}}\n').encode(),
        )
    for text in (b"custom asset a = @\xff\xfe.png@", b'custom string s = "\xff"', b'def "\xff" {}'):
        yield Case(f"utf8/{text!r}", "a.usda", b'#usda 1.0\ndef "W" {\n' + text + b"\n}")
    for arc in ("references", "payload"):
        for target in (
            f"@{canaries.text}@",
            "@/etc/passwd@",
            "@../../a.usda@",
            "@http://localhost/a.usda@",
            "@`${X}`@",
        ):
            yield Case(f"arc/{arc}-{target}", "a.usda", f'#usda 1.0\ndef "W" ({arc} = {target}) {{}}\n'.encode())
    yield Case(
        "usda/instancer-loop",
        "a.usda",
        b'#usda 1.0\ndef PointInstancer "I" {\n rel prototypes = [</I>]\n int[] protoIndices = [0]\n'
        b" point3f[] positions = [(0, 0, 0)]\n}\n",
    )
    yield Case("cdl/laughs", "a.zip", graded(a__cc=_laughs() + CDL.replace('id="a"', 'id="&a9;"')))
    yield Case(
        "cdl/external",
        "a.zip",
        graded(a__cc=f'<!DOCTYPE a [<!ENTITY x SYSTEM "{canaries.text}">]>' + CDL.replace('id="a"', 'id="&x;"')),
    )
    many = packed(
        {
            "room.usda": ROOM,
            "plugInfo.json": '{"Plugins": [{"Type": "python", "Name": "x", "Root": "."}]}',
            "x.py": "import os; os._exit(9)",
        }
    )
    yield Case("zip/plugin", "a.zip", many)


def mutated(base: bytes, mutate: random.Random) -> tuple[str, bytes]:
    """A damaged copy and the kind of its damage."""
    how = mutate.choice(("flip", "flips", "cut", "splice", "double", "number"))
    data, at = bytearray(base), mutate.randrange(len(base))
    if how == "flip":
        data[at] ^= 1 << mutate.randrange(8)
    elif how == "flips":
        for _ in range(mutate.randrange(2, 40)):
            data[mutate.randrange(len(data))] = mutate.randrange(256)
    elif how == "cut":
        del data[at:]
    elif how == "splice":
        end = mutate.randrange(len(base))
        data[at:at] = data[min(at, end) : max(at, end)]
    elif how == "double":
        data += data[at:]
    else:
        number = struct.pack("<q", mutate.choice(NUMBERS))[: mutate.choice((4, 8))]
        data[at : at + len(number)] = number
    return how, bytes(data)


Wrap = Callable[[bytes], tuple[str, bytes]]


def _bases() -> Iterator[tuple[str, bytes, int, Wrap]]:
    """Kinds of files: a good one, how many damaged copies, and how one is sent."""
    config, archive = (
        OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", "a.ctf"),
        packed({"room.usda": ROOM, "b/c.usda": ROOM}),
    )
    crate, package = _usd(".usdc"), _usd(".usdz")
    yield "usda", ROOM.encode(), 70, lambda content: ("a.usda", content)
    yield "usdc", crate, 130, lambda content: ("a.usdc", content)
    yield "usdz", package, 50, lambda content: ("a.usdz", content)
    yield "zip", archive, 60, lambda content: ("a.zip", content)
    for kind in ("png", "exr", "tif", "jpg"):
        yield kind, _image(kind), 35, lambda content, kind=kind: ("a.zip", textured(f"a.{kind}", content))
    yield (
        "ocio",
        config.encode(),
        40,
        lambda content: ("a.zip", graded(own__ocio=content, a__ctf=CTF.format("b.cube"), b__cube=CUBE)),
    )
    for kind, good in (("ctf", CTF.format("b.cube")), ("clf", CTF.format("b.cube")), ("cube", CUBE)):
        look = OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", f"a.{kind}")
        yield (
            kind,
            good.encode(),
            20,
            lambda content, kind=kind, look=look: (
                "a.zip",
                graded(own__ocio=look, b__cube=CUBE, **{f"a__{kind}": content}),
            ),
        )
    yield "cdl", CDL.encode(), 20, lambda content: ("a.zip", graded(a__cc=content))


def _laughs() -> str:
    steps = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))
    return f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a0 "ha">{steps}]>'


@lru_cache
def _usd(suffix: str) -> bytes:
    from pxr import Sdf, UsdUtils

    with tempfile.TemporaryDirectory() as folder:
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.ImportFromString(ROOM)
        crate = Path(folder) / "room.usdc"
        layer.Export(str(crate))
        if suffix == ".usdc":
            return crate.read_bytes()
        UsdUtils.CreateNewUsdzPackage(str(crate), str(Path(folder) / "room.usdz"))
        return (Path(folder) / "room.usdz").read_bytes()


@lru_cache
def _image(kind: str) -> bytes:
    import numpy as np
    import OpenImageIO as oiio

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"a.{kind}"
        output = oiio.ImageOutput.create(str(file))
        output.open(str(file), oiio.ImageSpec(16, 8, 3, "half" if kind == "exr" else "uint8"))
        output.write_image(np.linspace(0, 1, 16 * 8 * 3, dtype=np.float32).reshape(8, 16, 3))
        output.close()
        return file.read_bytes()


def graded_by_secret() -> Case:
    """A shot that holds the secret look-up table itself, to learn what its pictures look like."""
    config = OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", "b.cube")
    return Case("secret", "a.zip", graded(own__ocio=config, b__cube=secret_cube()))


def secret_cube() -> str:
    """Look-up table that makes every picture one colour that no room has."""
    return "LUT_1D_SIZE 2\n0.1 0.9 0.3\n0.1 0.9 0.3\n"


def checksum(cases: list[Case]) -> int:
    """Sum that tells whether two corpora are the same."""
    return zlib.crc32(b"".join(case.name.encode() + case.content for case in cases))
