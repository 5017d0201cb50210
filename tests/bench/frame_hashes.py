"""Hashes of what `pullfocus` draws: two checkouts that print the same table draw the same pictures, to the last bit.

    scripts/frame_hashes OUT.json [--against BEFORE.json]

Each case is one command line. A picture's hash is that of its decoded pixels and channel names, so it holds no date and no file
name; text output is hashed as it is. Pixels agree between runs on one machine with one driver, and not between machines: keep a
table with the machine that made it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from importlib import metadata
from pathlib import Path

import OpenImageIO as oiio

pullfocus: Callable[[Sequence[str]], int] = next(
    iter(metadata.entry_points(group="console_scripts", name="pullfocus"))
).load()  # found by name: this file also runs in checkouts whose rooms lie elsewhere

ENGINES = ("lens", "pinhole", "accumulation", "flag", "gather", "scatter", "linear", "importance")
AOVS = "color,depth,coc,defocus,focus_depth,albedo,prim_id,face_id"
SMALL = ("--imageWidth", "160", "--rays", "16")

PILLARS = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 0.01
    upAxis = "Y"
    startTimeCode = 1
    endTimeCode = 24
    timeCodesPerSecond = 24
)
def Xform "World"
{
    def Camera "Camera"
    {
        float focalLength = 50
        float horizontalAperture = 36
        float verticalAperture = 24
        float focusDistance = 300
        float fStop = 1.4
        float2 clippingRange = (1, 100000)
        double shutter:open = -0.25
        double shutter:close = 0.25
        double3 xformOp:translate.timeSamples = { 1: (0, 60, 500), 24: (40, 80, 480) }
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def DistantLight "Sun"
    {
        float inputs:intensity = 2
        bool inputs:normalize = 1
        float3 xformOp:rotateXYZ = (-50, 30, 0)
        uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]
    }
    def DomeLight "Sky"
    {
        float inputs:intensity = 0.3
        color3f inputs:color = (0.7, 0.85, 1)
    }
    def Cube "Floor"
    {
        double size = 2
        color3f[] primvars:displayColor = [(0.4, 0.42, 0.38)]
        float3 xformOp:scale = (1000, 1, 1000)
        double3 xformOp:translate = (0, -1, 0)
        uniform token[] xformOpOrder = ["xformOp:scale", "xformOp:translate"]
    }
PRIMS}
"""

PILLAR = """    def {kind} "P{i}"
    {{
        {size}
        color3f[] primvars:displayColor = [({r}, {g}, {b})]
        double3 xformOp:translate.timeSamples = {{ 1: ({x}, 40, {z}), 24: ({x2}, 70, {z}) }}
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }}
"""


def write_pillars(path: Path, count: int) -> None:
    """Author a row of solids that move to one side, before and behind what is in focus."""
    prims = ""
    for i in range(count):
        x, z = (i % 5 - 2) * 70, 380 - 110 * i
        kind, size = (("Sphere", "double radius = 30"), ("Cube", "double size = 45"), ("Cone", "double radius = 25"))[
            i % 3
        ]
        r, g, b = (round(0.2 + 0.7 * ((i * k) % 7) / 6, 3) for k in (1, 2, 3))
        prims += PILLAR.format(kind=kind, i=i, size=size, r=r, g=g, b=b, x=x, x2=x + 60, z=z)
    path.write_text(PILLARS.replace("PRIMS", prims))


def cases(stages: dict[str, tuple[Path, str]]) -> Iterator[tuple[str, list[str], str]]:
    """Name each picture with its command line and the suffix of its file.

    Args:
        stages: root layer and frame number of each scene, by name.
    """
    for scene, (path, frame) in stages.items():
        shot = ["record", str(path), "OUT", "--frames", frame, *SMALL]
        for engine in ENGINES:
            for shading in ("lit", "unlit"):
                yield f"{scene} {engine} {shading}", [*shot, "--engine", engine, "--shading", shading], ".exr"
        for engine in ("lens", "flag", "gather", "scatter", "linear", "importance"):
            yield f"{scene} {engine} prescription", [*shot, "--engine", engine, "--lens", "double_gauss_50"], ".exr"
        for engine in ("lens", "flag", "importance"):
            yield f"{scene} {engine} aovs", [*shot, "--engine", engine, "--aov", AOVS], ".exr"
            yield f"{scene} {engine} film", [*shot, "--engine", engine, "--film", "5219"], ".png"
        yield f"{scene} graded", shot, ".png"
        yield f"{scene} data sheet lens", [*shot, "--lens", "zeiss_planar_50"], ".exr"
        for motion in ("moments", "velocities"):
            yield f"{scene} motion by {motion}", [*shot, "--motion", "4", "--motion-by", motion], ".exr"
            yield (
                f"{scene} motion by {motion}, film",
                [*shot, "--motion", "4", "--motion-by", motion, "--film", "5219"],
                ".png",
            )
        yield f"{scene} flare and star", [*shot, "--lens", "double_gauss_50", "--flare", "4", "--star", "4"], ".exr"
        yield (
            f"{scene} guides, body",
            [*shot, "--guides", "2.39:1,safe", "--body", "super35_3perf", "--iso", "800"],
            ".png",
        )
        yield f"{scene} metered", [*shot, "--metering", "center", "--expose-by", "iris"], ".png"
        yield f"{scene} accumulated over motion", [*shot, "--engine", "accumulation", "--motion", "4"], ".exr"
        yield (
            f"{scene} long exposure",
            ["record", str(path), "OUT", *SMALL, "--long-exposure", f"{frame}:{float(frame) + 4:g}"],
            ".png",
        )
        yield f"{scene} contact sheet", [*shot, "--contact-sheet", "stop=2,8"], ".png"
        yield f"{scene} progressive", [*shot, "--progressive"], ".png"
        yield f"{scene} focus curve", ["focus-curve", str(path), "--format", "csv", "--out", "OUT"], ".csv"


def picture_hash(path: Path) -> str:
    """Hash a picture's size, channel names and pixels. Raises `OSError` where it cannot be read."""
    digest = hashlib.sha256()
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    part = 0
    while source.seek_subimage(part, 0):
        spec = source.spec()
        digest.update(f"{spec.width}x{spec.height} {list(spec.channelnames)}".encode())
        digest.update(source.read_image(part, 0, 0, spec.nchannels, spec.format).tobytes())
        part += 1
    source.close()
    return digest.hexdigest()[:16]


def hash_case(words: list[str], suffix: str, folder: Path) -> str:
    """Run one command line and hash what it wrote; an exit status other than 0 is the answer itself."""
    out = folder / f"out{suffix}"
    status = pullfocus([str(out) if word == "OUT" else word for word in words])
    if status:
        return f"exit {status}"
    if suffix == ".csv":
        return hashlib.sha256(out.read_bytes()).hexdigest()[:16]
    return picture_hash(out)


def main() -> int:
    """Print the table, write it, and compare it; returns 1 where a hash differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--against", type=Path, metavar="BEFORE.json")
    parser.add_argument("--only", default="", metavar="WORD", help="cases whose name has this word")
    options = parser.parse_args()
    table: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pullfocus(["demo", str(folder / "demo")])
        write_pillars(folder / "few.usda", 5)
        write_pillars(folder / "many.usda", 14)
        stages = {
            "demo": (folder / "demo" / "night_street.usda", "40"),
            "few": (folder / "few.usda", "6"),
            "many": (folder / "many.usda", "12.5"),
        }
        for case, words, suffix in cases(stages):
            if options.only in case:
                table[case] = hash_case(words, suffix, folder)
                print(f"{case}: {table[case]}", file=sys.stderr, flush=True)
    options.out.write_text(json.dumps(table, indent=1) + "\n")
    before = json.loads(options.against.read_text()) if options.against else {}
    differing = [case for case in table if before.get(case, table[case]) != table[case]]
    print(
        f"{len(table)} pictures and curves, {len(differing)} differ" if before else f"{len(table)} pictures and curves"
    )
    for case in differing:
        print(f"differs: {case}: {before[case]} before, {table[case]} now")
    return bool(differing)


if __name__ == "__main__":
    sys.exit(main())
