"""Damage, missing files and references that reach outside are told apart, and named in one sentence."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, UsdGeom

from render.errors import InputError, StageError
from render.stage import StageReader, find_not_honoured, open_stage, read_camera
from render.stage.options import Resolver
from tests.render.kits.stages import (
    ASSETS,
    add_mesh,
    add_textured_material,
    codes,
    needs_assets,
    new_stage,
    write_picture,
)


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#usda 1.0\n" + text)
    return path


def failure(path: Path, **options: object) -> StageError:
    with pytest.raises(StageError) as caught:
        open_stage(path, **options)
    assert "\n" not in caught.value.detail
    return caught.value


def test_what_is_no_file(tmp_path: Path) -> None:
    assert failure(tmp_path / "gone.usda").code == "stage_missing"
    assert failure(tmp_path).code == "stage_missing"


@pytest.mark.parametrize("name", ["a.usda", "a.usdc", "a.usdz", "a.usd", "a.txt"])
def test_what_is_no_usd(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"these are not the bytes you are looking for")
    error = failure(tmp_path / name)
    assert error.code == "stage_unreadable"
    assert name in error.detail


@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.9, 0.999])
def test_a_truncated_usdc(tmp_path: Path, share: float) -> None:
    stage = new_stage()
    add_mesh(stage, "/m", np.random.default_rng(1).random((3000, 3)), [3] * 1000, range(3000))
    whole = tmp_path / "whole.usdc"
    stage.Export(str(whole))
    data = whole.read_bytes()
    cut = tmp_path / "cut.usdc"
    cut.write_bytes(data[: int(len(data) * share)])
    assert failure(cut).code == "stage_unreadable"


@pytest.mark.parametrize("seed", range(20))
def test_a_corrupt_usdc_is_an_error_or_findings_and_nothing_else(tmp_path: Path, seed: int) -> None:
    """Bytes go wrong anywhere: what is read is a scene, or one clear error when the values are asked for."""
    stage = new_stage()
    rng = np.random.default_rng(seed)
    mesh = add_mesh(stage, "/m", rng.random((300, 3)), [3] * 500, rng.integers(0, 300, 1500))
    mesh.GetPointsAttr().Set(mesh.GetPointsAttr().Get(), 1.0)
    mesh.AddTranslateOp().Set((1, 2, 3), 1.0)
    mesh.CreateVelocitiesAttr(rng.random((300, 3)).astype(np.float32))
    UsdGeom.Camera.Define(stage, "/cam").GetFocusDistanceAttr().Set(2.0, 1.0)
    whole = tmp_path / "whole.usdc"
    stage.Export(str(whole))
    data = bytearray(whole.read_bytes())
    for position in rng.integers(0, len(data), 30):
        data[position] = rng.integers(0, 256)
    broken = tmp_path / "broken.usdc"
    broken.write_bytes(data)
    with contextlib.suppress(InputError):
        stage = open_stage(broken)
        find_not_honoured(stage)
        StageReader(stage).read(1)
        read_camera(stage, "/cam", 1)


@pytest.mark.parametrize("unit", ["0", "-1", "nan"])
def test_a_scene_unit_must_be_a_length(tmp_path: Path, unit: str) -> None:
    error = failure(write(tmp_path / "a.usda", f"(metersPerUnit = {unit})"))
    assert error.code == "bad_unit"
    assert "metersPerUnit" in error.detail


@pytest.mark.parametrize("arc", ["references", "payload"])
def test_a_missing_reference_is_a_finding_and_the_rest_is_read(tmp_path: Path, arc: str) -> None:
    asks = "".join(f'def "{name}" ({arc} = @./props/chair.usda@) {{}}\n' for name in "AB")
    reader = StageReader(open_stage(write(tmp_path / "a.usda", f'def Sphere "Ball" {{}}\n{asks}')))
    assert len(reader.read(0).batches) == 1
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("missing_reference", "props/chair.usda")
    assert finding.message == "props/chair.usda is missing: prim /A and 1 more refer to it and are read without it"


@pytest.mark.parametrize("depth", [0, 1])
def test_a_missing_sublayer_is_a_finding_and_the_rest_is_read(tmp_path: Path, depth: int) -> None:
    text = '(subLayers = [@./gone.usda@])\ndef Sphere "Ball" {}'
    names = ["a.usda", "b.usda"][: depth + 1]
    write(tmp_path / names[-1], text)
    if depth:
        write(tmp_path / "a.usda", "(subLayers = [@./b.usda@])")
    reader = StageReader(open_stage(tmp_path / "a.usda"))
    assert len(reader.read(0).batches) == 1
    (finding,) = reader.findings
    assert finding.message == f"gone.usda is missing: layer {names[-1]} refers to it and is read without it"


@pytest.mark.parametrize("content", [b"PXR-USDC" + bytes(40), b"these are no bytes of USD"])
def test_a_damaged_reference_is_a_finding(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "b.usd").write_bytes(content)
    text = 'def "A" (references = @./b.usd@) {}\ndef Sphere "Ball" {}'
    reader = StageReader(open_stage(write(tmp_path / "a.usda", text)))
    assert len(reader.read(0).batches) == 1
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("unreadable_reference", "b.usd")
    assert finding.message.startswith("b.usd cannot be read (")
    assert str(tmp_path) not in finding.message


def test_a_missing_materialx_file_is_a_finding(tmp_path: Path) -> None:
    reader = StageReader(open_stage(write(tmp_path / "a.usda", 'def "A" (references = @./gone.mtlx@</MaterialX>) {}')))
    assert [(finding.code, finding.path) for finding in reader.findings] == [("missing_reference", "gone.mtlx")]


def test_missing_value_clips_are_findings(tmp_path: Path) -> None:
    write(tmp_path / "here.usda", 'def "A" {}')
    text = OUTSIDE["clip"].format("./gone.usda@, @./here.usda").replace('def "A"', 'def Sphere "A"')
    reader = StageReader(open_stage(write(tmp_path / "a.usda", text)))
    assert len(reader.read(0).batches) == 1
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("missing_clip", "./gone.usda")
    assert "prim /A refers to it as a value clip" in finding.message


def test_a_missing_file_in_a_variant_that_is_not_chosen_does_no_harm(tmp_path: Path) -> None:
    text = """def "A" (
    variants = {
        string v = "x"
    }
    prepend variantSets = "v"
) {
    variantSet "v" = {
        "x" { }
        "y" (references = @./gone.usda@) { }
    }
}"""
    assert open_stage(write(tmp_path / "a.usda", text))


def test_a_reference_to_a_prim_that_is_not_there_is_a_finding(tmp_path: Path) -> None:
    reader = StageReader(open_stage(write(tmp_path / "a.usda", 'def "A" (references = </Nowhere>) {}')))
    reader.read(0)
    assert codes(reader) == {"composition"}


def test_usd_says_nothing_on_the_terminal(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    StageReader(open_stage(write(tmp_path / "a.usda", 'def "A" (references = </Nowhere>) {}'))).read(0)
    assert capfd.readouterr().err == ""


def test_edits_go_to_the_edit_layer(tmp_path: Path) -> None:
    file = write(tmp_path / "a.usda", 'def Sphere "ball" {}')
    edits = Sdf.Layer.CreateAnonymous("edits.usda")
    stage = open_stage(file, edit_layer=edits)
    UsdGeom.Sphere(stage.GetPrimAtPath("/ball")).GetRadiusAttr().Set(3.0)
    assert edits.GetAttributeAtPath("/ball.radius").default == 3.0
    assert not stage.GetRootLayer().dirty


# Session layer and resolver


def test_a_session_layer_is_put_over_the_stage_and_below_the_edits(tmp_path: Path) -> None:
    file = write(tmp_path / "a.usda", 'def Sphere "a" {}\ndef Sphere "b" {}')
    overs = "".join(f'over "{name}" {{\n double radius = 5\n}}\n' for name in "ab")
    session = write(tmp_path / "s.usda", f'(renderSettingsPrimPath = "/R")\n{overs}')
    edits = Sdf.Layer.CreateAnonymous("edits.usda")
    stage = open_stage(file, edit_layer=edits, session_layer=session)
    UsdGeom.Sphere(stage.GetPrimAtPath("/b")).GetRadiusAttr().Set(7.0)
    assert [stage.GetAttributeAtPath(f"/{name}.radius").Get() for name in "ab"] == [5, 7]
    assert stage.GetMetadata("renderSettingsPrimPath") == "/R"
    assert edits.GetAttributeAtPath("/b.radius").default == 7
    assert "7" not in session.read_text()


def test_a_session_layer_that_cannot_be_opened(tmp_path: Path) -> None:
    file = write(tmp_path / "a.usda", "")
    assert failure(file, session_layer=tmp_path / "gone.usda").code == "stage_missing"
    broken = tmp_path / "broken.usda"
    broken.write_text("these are no bytes of USD")
    error = failure(file, session_layer=broken)
    assert error.code == "stage_unreadable"
    assert "broken.usda" in error.detail


def test_a_session_layer_lies_inside_too(tmp_path: Path) -> None:
    secret = write(tmp_path / "secret.usda", 'def "A" {}')
    root = write(tmp_path / "shot" / "a.usda", "")
    link = write(tmp_path / "shot" / "s.usda", 'def "A" (references = @../secret.usda@) {}')
    for session in (secret, link):
        assert failure(root, session_layer=session, confined_to=root.parent).code == "outside_reference"


@pytest.mark.parametrize("resolver", ["root", "inherit"])
def test_the_resolver_searches_the_folder_of_the_root_or_not(tmp_path: Path, resolver: Resolver) -> None:
    write(tmp_path / "props" / "c.usda", 'def Sphere "A" {}')
    write(tmp_path / "sub" / "b.usda", 'def "A" (references = @props/c.usda@</A>) {}')
    root = write(tmp_path / "a.usda", 'def "A" (references = @sub/b.usda@</A>) {}')
    reader = StageReader(open_stage(root, resolver=resolver))
    assert len(reader.read(0).batches) == (1 if resolver == "root" else 0)
    assert codes(reader) == (set() if resolver == "root" else {"missing_reference"})


# Confinement

OUTSIDE = {
    "reference": 'def "A" (references = @{}@) {{}}',
    "payload": 'def "A" (payload = @{}@) {{}}',
    "sublayer": "(subLayers = [@{}@])",
    "texture": 'def Shader "A"\n{{\n    asset inputs:file = @{}@\n}}',
    "texture array": 'def Shader "A"\n{{\n    asset[] files = [@{}@]\n}}',
    "texture over time": 'def Shader "A"\n{{\n    asset inputs:file.timeSamples = {{\n0: @{}@\n}}\n}}',
    "clip": """def "A" (
    clips = {{
        dictionary default = {{
            asset[] assetPaths = [@{}@]
            string primPath = "/A"
        }}
    }}
) {{}}""",
    "unused variant": """def "A" (
    prepend variantSets = "v"
) {{
    variantSet "v" = {{
        "x" (references = @{}@) {{ }}
    }}
}}""",
}


@pytest.mark.parametrize("kind", list(OUTSIDE))
@pytest.mark.parametrize("way", ["absolute", "dots", "link", "scheme"])
def test_nothing_may_lie_outside(tmp_path: Path, kind: str, way: str) -> None:
    secret = write(tmp_path / "secret.usda", 'def "A" {}')
    folder = tmp_path / "shot"
    folder.mkdir()
    (folder / "link.usda").symlink_to(secret)
    target = {
        "absolute": str(secret),
        "dots": "./sub/../../secret.usda",
        "link": "./link.usda",
        "scheme": "https://studio.example/secret.usda",
    }[way]
    root = write(folder / "a.usda", OUTSIDE[kind].format(target))
    error = failure(root, confined_to=folder)
    assert error.code == "outside_reference"
    assert target in error.detail


def test_a_path_through_the_working_directory_is_outside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path / "work" / "props" / "secret.usda", 'def "A" {}')
    monkeypatch.chdir(tmp_path / "work")
    root = write(tmp_path / "shot" / "a.usda", 'def "A" (references = @props/secret.usda@) {}')
    assert failure(root, confined_to=root.parent).code == "outside_reference"


def test_an_expression_cannot_be_checked_and_is_refused(tmp_path: Path) -> None:
    text = '(expressionVariables = { string P = "/etc" })\ndef "A" (references = @`"${P}/x.usda"`@) {}'
    root = write(tmp_path / "a.usda", text)
    assert failure(root, confined_to=tmp_path).code == "outside_reference"


def test_a_chain_of_references_is_followed(tmp_path: Path) -> None:
    folder = tmp_path / "shot"
    write(tmp_path / "secret.usda", 'def "A" {}')
    write(folder / "c" / "c.usda", 'def "A" (references = @../../secret.usda@) {}')
    write(folder / "b.usda", 'def "A" (references = @./c/c.usda@) {}')
    root = write(folder / "a.usda", 'def "A" (references = @./b.usda@) {}')
    error = failure(root, confined_to=folder)
    assert error.code == "outside_reference"
    assert "c.usda refers to ../../secret.usda" in error.detail


def test_the_root_itself_must_be_inside(tmp_path: Path) -> None:
    file = write(tmp_path / "a.usda", "")
    assert failure(file, confined_to=tmp_path / "elsewhere").code == "outside_reference"


def test_what_lies_inside_is_opened(tmp_path: Path) -> None:
    write(tmp_path / "sub" / "b.usda", 'def Sphere "A" {}')
    root = write(tmp_path / "a.usda", 'def "A" (references = @./sub/b.usda@</A>) {}')
    stage = open_stage(root, confined_to=tmp_path)
    assert stage.GetPrimAtPath("/A").IsA(UsdGeom.Sphere)
    missing = write(tmp_path / "m.usda", 'def "A" (references = @./sub/gone.usda@</A>) {}')
    assert codes(StageReader(open_stage(missing, confined_to=tmp_path))) == {"missing_reference"}


def test_a_package_is_confined_to_itself(tmp_path: Path) -> None:
    secret = write(tmp_path / "secret.usda", 'def Sphere "A" {}')
    folder = tmp_path / "shot"
    inner = write(tmp_path / "inner.usda", f'def "A" (references = @{secret}@</A>) {{}}')
    folder.mkdir()
    package = folder / "p.usdz"
    with Sdf.ZipFileWriter.CreateNew(str(package)) as writer:
        writer.AddFile(str(inner), "inner.usda")
    assert failure(package, confined_to=folder).code == "outside_reference"


def test_a_confined_reader_reads_no_texture_outside(tmp_path: Path) -> None:
    """A texture authored after the check, in an edit layer, is refused when its pixels are read."""
    secret = write_picture(tmp_path / "secret.png", np.full((1, 1, 3), 77, np.uint8))
    folder = tmp_path / "shot"
    root = write(folder / "a.usda", "")
    stage = open_stage(root, edit_layer=Sdf.Layer.CreateAnonymous(".usda"), confined_to=folder)
    add_textured_material(stage, add_mesh(stage, "/m").GetPrim(), secret)
    reader = StageReader(stage)
    assert reader.read(0).batches[0].material.lookups == {}
    assert codes(reader) == {"texture_unreadable"}


@needs_assets
@pytest.mark.parametrize(
    "name", ["OpenChessSet/chess_set.usda", "Teapot/DrawModes.usd", "AnimatedCube/AnimatedCube.usdz"]
)
def test_real_assets_are_confined_to_their_folders(name: str) -> None:
    file = ASSETS / name
    assert open_stage(file, confined_to=file.parent)


def test_a_message_names_a_file_relative_to_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "odd.usda").write_text("#usda 1.0\ndef Xform {")
    monkeypatch.chdir(tmp_path)
    for given in (Path("odd.usda"), tmp_path / "odd.usda"):
        with pytest.raises(StageError) as refused:
            open_stage(given)
        assert "odd.usda" in refused.value.detail
        assert refused.value.detail.count(str(tmp_path)) == (0 if given == Path("odd.usda") else 1)
        assert "@anon" not in refused.value.detail
