"""Stages of a few kilobytes that ask for gigabytes or minutes are refused, or drawn in part, with one clear message."""

from __future__ import annotations

import os
import resource
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdGeom

from render.errors import CameraError, StageError
from render.shot import Shot
from render.stage import limits
from render.stage.instancer_loops import find_instancer_loop
from render.stage.layer_files import check_layer_content, check_layer_file
from render.stage.opening import open_stage
from render.stage.reader import StageReader
from tests.render.kits.hostile_stages import HEAD, LINK, STAGE_BOMBS


def refusal(file: Path) -> StageError:
    """Error of opening a file, within five seconds and 300 MB."""
    before_kb, begun_s = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.monotonic()
    with pytest.raises(StageError) as caught:
        Shot.open(file, confined_to=file.parent)
    assert time.monotonic() - begun_s < 5
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < 300_000
    assert str(file.parent) not in f"{caught.value.detail}{caught.value.path}"
    assert len(caught.value.detail) < 500
    return caught.value


@pytest.mark.parametrize("name", STAGE_BOMBS)
def test_a_layer_that_would_explode_is_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_text(STAGE_BOMBS[name])

    assert refusal(tmp_path / "a.usda").code in ("stage_unreadable", "too_many_prims", "too_many_clips")


@pytest.mark.parametrize("arc", ["subLayers = [@b.usda@]", "customLayerData = {asset x = @b.usda@}"])
def test_layers_that_are_named_are_judged_too(arc: str, tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_text(f"{HEAD}({arc})")
    (tmp_path / "b.usda").write_text(STAGE_BOMBS["parentheses"])

    assert "nested" in refusal(tmp_path / "a.usda").detail


def test_layers_in_a_package_are_judged_too(tmp_path: Path) -> None:
    (tmp_path / "b.usda").write_text(STAGE_BOMBS["parentheses"])
    with Sdf.ZipFileWriter.CreateNew(str(tmp_path / "a.usdz")) as package:
        package.AddFile(str(tmp_path / "b.usda"), "b.usda")

    assert "nested" in refusal(tmp_path / "a.usdz").detail


def test_sublayers_do_not_multiply(tmp_path: Path) -> None:
    for i in range(25):
        (tmp_path / f"l{i}.usda").write_text(f"{HEAD}(subLayers = [@l{i + 1}.usda@, @l{i + 1}.usda@ (offset = 1)])")
    (tmp_path / "l25.usda").write_text(HEAD)

    assert refusal(tmp_path / "l0.usda").code == "too_many_prims"


def test_instanceable_prims_and_variants_count_once(tmp_path: Path) -> None:
    links = "".join(LINK.format(i, "instanceable = true\n", i + 1, "instanceable = true\n", i + 1) for i in range(12))
    text = HEAD + links + 'def Sphere "p12" {}\ndef Camera "c" {}\n'
    (tmp_path / "a.usda").write_text(text)

    assert Shot.open(tmp_path / "a.usda", confined_to=tmp_path).cameras() == ["/c"]


def test_a_circle_of_references_is_left_to_usd(tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_text(f'{HEAD}def "a" (references = </b>) {{}}\ndef "b" (references = </a>) {{}}\n')

    Shot.open(tmp_path / "a.usda", confined_to=tmp_path)


@pytest.fixture(scope="module")
def crate(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    file = tmp_path_factory.mktemp("crate") / "a.usdc"
    layer = Sdf.Layer.CreateNew(str(file))
    stage = Usd.Stage.Open(layer)
    UsdGeom.Sphere.Define(stage, "/World/Ball")
    UsdGeom.Mesh.Define(stage, "/World/Card").GetPointsAttr().Set([(0, 0, 0), (1, 0, 0), (0, 1, 0)] * 9)
    layer.Save()
    return file.read_bytes()


def test_a_crate_passes(crate: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.usdc").write_bytes(crate)

    check_layer_file(str(tmp_path / "a.usdc"))


LENGTHS = {"array": 27, "compressed array": 501, "times": 6, "samples": 5}


@pytest.fixture(scope="module", params=["0.4.0", "0.6.0", "0.10.0"])
def crate_with_lists(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Crate of a version, with values of all `LENGTHS`."""
    file = tmp_path_factory.mktemp("crate") / "a.usdc"
    code = (
        "import sys; from pxr import Sdf, Usd; stage = Usd.Stage.CreateNew(sys.argv[1])\n"
        "prim, types = stage.DefinePrim('/A'), Sdf.ValueTypeNames\n"
        "prim.CreateAttribute('a', types.DoubleArray).Set([n * n + 0.1 for n in range(27)])\n"
        "prim.CreateAttribute('b', types.IntArray).Set(list(range(501)))\n"
        "changes, moves = prim.CreateAttribute('c', types.Double3), prim.CreateAttribute('d', types.DoubleArray)\n"
        "for n in range(6): changes.Set((n, 0.3, 0.1), n)\n"
        "for n in range(5): moves.Set([0.1] * (30 + n), n + 0.5)\n"
        "stage.Save()"
    )
    environment = {**os.environ, "USD_WRITE_NEW_USDC_FILES_AS_VERSION": request.param}
    subprocess.run([sys.executable, "-c", code, str(file)], env=environment, check=True)
    return file.read_bytes()


@pytest.mark.parametrize("what", LENGTHS)
def test_a_length_that_cannot_be_true_is_refused(what: str, crate_with_lists: bytes) -> None:
    check_layer_content(crate_with_lists, "a.usdc")
    width = "<Q" if crate_with_lists[9] >= 7 or "array" not in what else "<I"
    length, refused = struct.pack(width, LENGTHS[what]), 0
    (start,) = struct.unpack_from("<q", crate_with_lists, 16)
    at = crate_with_lists.find(length)
    while 0 <= at < start:
        damaged = crate_with_lists[:at] + struct.pack(width, 2**31) + crate_with_lists[at + len(length) :]
        try:
            check_layer_content(damaged, "a.usdc")
        except StageError as error:
            refused += "fit into it" in error.detail
        at = crate_with_lists.find(length, at + 1)
    assert refused > 0


def test_a_table_of_contents_that_cannot_be_true_is_refused(crate: bytes, tmp_path: Path) -> None:
    (start,) = struct.unpack_from("<q", crate, 16)
    (count,) = struct.unpack_from("<Q", crate, start)
    damaged = [crate[:50], crate[:start], crate[:16] + struct.pack("<q", 2**40) + crate[24:]]
    damaged.append(crate[:start] + struct.pack("<Q", 2**60) + crate[start + 8 :])
    for section in range(count):
        at = start + 8 + 32 * section
        name, offset, size = struct.unpack_from("<16sqq", crate, at)
        for bad in ((2**40, size), (offset, 2**40), (-1, size)):
            damaged.append(crate[:at] + struct.pack("<16sqq", name, *bad) + crate[at + 32 :])
        damaged.append(crate[:offset] + struct.pack("<Q", 2**33) + crate[offset + 8 :])
    for content in damaged:
        (tmp_path / "a.usdc").write_bytes(content)
        with pytest.raises(StageError, match="is not a readable USD file"):
            check_layer_file(str(tmp_path / "a.usdc"))


@pytest.mark.parametrize("text", [b"custom asset a = @\xff\xfe.png@", b'custom string s = "\xff"', b'def "\xff" {}'])
def test_text_that_is_no_utf_8_is_one_clear_error(text: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_bytes(b'#usda 1.0\ndef "W" {\n' + text + b"\n}")

    assert refusal(tmp_path / "a.usda").code == "stage_unreadable"


def test_an_instancer_among_its_own_prototypes_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_text(
        f'{HEAD}def PointInstancer "I" {{\n rel prototypes = [</I>]\n int[] protoIndices = [0]\n'
        " point3f[] positions = [(0, 0, 0)]\n}\n"
    )
    shot = Shot.open(tmp_path / "a.usda", confined_to=tmp_path)

    assert find_instancer_loop(shot.stage) == Sdf.Path("/I")
    with pytest.raises((StageError, CameraError), match="among its own prototypes"):
        shot.default_camera()


def test_more_triangles_than_can_be_drawn_are_left_out(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "a.usda"))
    instancer = UsdGeom.PointInstancer.Define(stage, "/Many")
    instancer.GetPrototypesRel().AddTarget(UsdGeom.Sphere.Define(stage, "/Many/Ball").GetPath())
    instancer.GetProtoIndicesAttr().Set([0] * 400_000)
    instancer.GetPositionsAttr().Set([(0, 0, 0)] * 400_000)
    UsdGeom.Cube.Define(stage, "/Box")
    stage.Save()
    reader = StageReader(open_stage(tmp_path / "a.usda", confined_to=tmp_path))
    begun_s = time.monotonic()

    scene = reader.read(0)

    assert time.monotonic() - begun_s < 20
    assert sum(len(b.geometry.triangles) * len(b.poses) for b in scene.batches) < limits.MAX_DRAWN_TRIANGLES
    assert len(scene.batches) == 1
    assert [f.path for f in reader.findings if f.code == "too_many_triangles"] == ["/Many/Ball"]
