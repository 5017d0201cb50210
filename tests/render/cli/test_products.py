"""`pullfocus record --products` writes what a stage's RenderSettings prim asks for, in one run."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenEXR
import OpenImageIO
import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot
from tests.render.kits.cryptomattes import read_cryptomattes

OTHER_CAMERA = CAMERA.replace("main_cam", "other_cam").replace("(0, 0, 5)", "(0.4, 0, 3)")
SETTINGS = """
    def RenderSettings "settings"
    {
        rel camera = </World/main_cam>
        rel products = [</World/beauty>, </World/crop>, </World/sharp>]
        uniform int2 resolution = (48, 32)
        int pullfocus:rays = 4
        float pullfocus:supersample = 1
        token pullfocus:shading = "unlit"
    }
    def RenderProduct "beauty"
    {
        token productName = "beauty/shot.####.exr"
        rel orderedVars = [</World/rgba>, </World/depth>, </World/Neye>, </World/uv>, </World/ids>, </World/mattes>]
    }
    def RenderProduct "crop"
    {
        token productName = "crop.####.exr"
        rel camera = </World/other_cam>
        float4 dataWindowNDC = (0.25, 0.25, 0.75, 1.125)
        rel orderedVars = [</World/half>]
    }
    def RenderProduct "sharp"
    {
        token productName = "sharp.####.png"
        bool disableDepthOfField = 1
        float pixelAspectRatio = 2
        rel orderedVars = [</World/rgba>, </World/depth>]
    }
    def RenderVar "rgba"
    {
        uniform string sourceName = "color"
        uniform token dataType = "color4f"
    }
    def RenderVar "half"
    {
        uniform string sourceName = "color"
        uniform token dataType = "color3h"
    }
    def RenderVar "depth"
    {
        uniform string sourceName = "cameraDepth"
        uniform token dataType = "float"
    }
    def RenderVar "Neye"
    {
        uniform token dataType = "normal3f"
    }
    def RenderVar "uv"
    {
        uniform string sourceName = "displayColor"
        uniform token sourceType = "primvar"
    }
    def RenderVar "ids"
    {
        uniform string sourceName = "primId"
        uniform token dataType = "int"
    }
    def RenderVar "mattes"
    {
        uniform string sourceName = "cryptoObject"
    }
"""
NAMED = ("timeCodesPerSecond = 24", 'timeCodesPerSecond = 24\n    renderSettingsPrimPath = "/World/settings"')


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


def write_products(folder: Path, settings: str = SETTINGS) -> Path:
    """A shot with products."""
    shot = write_shot(folder / "shot.usda", SQUARE, CAMERA, OTHER_CAMERA, settings)
    shot.write_text(shot.read_text().replace(*NAMED))
    return shot


def parts(file: Path) -> dict[str, tuple[tuple[str, ...], str]]:
    """Channels and type of samples of an EXR's parts, by their names, in order."""
    found = {}
    for i in range(OpenImageIO.ImageBuf(str(file)).nsubimages):
        spec = OpenImageIO.ImageBuf(str(file), i, 0).spec()
        found[spec.getattribute("oiio:subimagename")] = (tuple(spec.channelnames), str(spec.format))
    return found


def windows(file: Path) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Data window and display window of an EXR: left, top, right, bottom, ends included, read from the bytes of its header."""
    data, found = file.read_bytes(), []
    for name in (b"dataWindow", b"displayWindow"):
        at = data.index(name + b"\0box2i\0") + len(name) + 1 + 6 + 4
        found.append(tuple(np.frombuffer(data, "<i4", 4, at).tolist()))
    return found[0], found[1]


@pytest.mark.gl
def test_one_run_writes_every_product(pullfocus: Command, tmp_path: Path) -> None:
    ended = pullfocus("record", write_products(tmp_path), tmp_path / "out", "--products", "-f", "1,2", "--json")
    assert ended.status == 0, ended.err
    written = [(Path(entry["file"]), entry["product"], entry["camera"]) for entry in json.loads(ended.out)["frames"]]
    assert [(str(file.relative_to(tmp_path / "out")), product.rpartition("/")[2]) for file, product, _ in written] == [
        (f"{name}.{frame:04}.{ending}", name.rpartition("/")[0] or name)
        for frame in (1, 2)
        for name, ending in (("beauty/shot", "exr"), ("crop", "exr"), ("sharp", "png"))
    ]
    assert [camera.rpartition("/")[2] for *_, camera in written[:3]] == ["main_cam", "other_cam", "main_cam"]
    beauty, crop, sharp = (file for file, *_ in written[:3])
    xyz = ("X", "Y", "Z")
    assert parts(beauty) == {
        "rgba": (("R", "G", "B", "A"), "float"),
        "depth": (("Z",), "float"),
        "Neye": (xyz, "float"),
        "uv": (("R", "G", "B"), "float"),
        "ids": (("id",), "uint"),
        "cryptoObject": (parts(beauty)["cryptoObject"][0], "float"),
    }
    assert parts(crop) == {"half": (("R", "G", "B"), "half")}
    assert windows(beauty) == ((0, 0, 47, 31), (0, 0, 47, 31))
    assert windows(crop) == ((12, -4, 35, 23), (0, 0, 47, 31))
    picture = OpenImageIO.ImageBuf(str(sharp)).spec()
    assert (picture.width, picture.height) == (48, 32)
    matte = read_cryptomattes(beauty)["cryptoObject"].of("/World/Square")
    np.testing.assert_allclose(matte, OpenImageIO.ImageBuf(str(beauty)).get_pixels()[..., 3], atol=1e-3)
    assert 0.05 < matte.mean() < 0.95
    assert "cameraDepth" in next(
        found["message"] for found in json.loads(ended.out)["findings"] if found["code"] == "dropped_vars"
    )


@pytest.mark.gl
@pytest.mark.parametrize(
    ("authored", "options", "named"),
    [
        ("bool disableDepthOfField = 1", (), "disableDepthOfField"),
        (
            "float4 dataWindowNDC = (0, 0, 0.5, 1)\n        float pixelAspectRatio = 2",
            (),
            "dataWindowNDC and pixelAspectRatio",
        ),
        ("bool disableMotionBlur = 1", ("--motion", 3), "disableMotionBlur"),
        ("bool disableMotionBlur = 1", (), None),
        ("float pixelAspectRatio = 1\n        bool disableDepthOfField = 0", (), None),
    ],
)
def test_what_plain_pictures_do_not_obey_is_named(
    authored: str, options: tuple[object, ...], named: str | None, pullfocus: Command, tmp_path: Path
) -> None:
    shot = write_products(tmp_path, SETTINGS.replace("rel products", f"{authored}\n        rel products", 1))
    ended = pullfocus("record", shot, tmp_path / "f.exr", "--imageWidth", 48, *options)
    assert ended.status == 0, ended.err
    message = f"/World/settings authors {named}, which only --products obeys"
    assert (message in ended.err) == (named is not None)
    assert ("which only --products obeys" in ended.err) == (named is not None)
    picture = OpenImageIO.ImageBuf(str(tmp_path / "f.exr")).spec()
    assert (picture.width, picture.height, picture.full_width) == (48, 32, 48)


@pytest.mark.gl
def test_without_depth_of_field_a_product_is_a_pinholes(pullfocus: Command, tmp_path: Path) -> None:
    """The square is out of focus; its rim is blurred but where the product is sharp."""
    blurred = SETTINGS.replace("sharp.####.png", "sharp.####.exr")
    rims = []
    for name, flag in (("sharp", "1"), ("soft", "0")):
        (tmp_path / name).mkdir()
        shot = write_products(
            tmp_path / name, blurred.replace("disableDepthOfField = 1", f"disableDepthOfField = {flag}")
        )
        shot.write_text(shot.read_text().replace("focusDistance = 5", "focusDistance = 0.5"))
        assert pullfocus("record", shot, tmp_path / name / "out", "--products").status == 0
        alpha = OpenImageIO.ImageBuf(str(tmp_path / name / "out/sharp.0001.exr"), 0, 0).get_pixels()[..., 3]
        rims.append(float(((alpha > 0.02) & (alpha < 0.98)).mean()))
    assert rims[0] < 0.05
    assert rims[1] > 2 * rims[0] + 0.05


@pytest.mark.gl
def test_a_window_shows_what_the_whole_picture_has_there(pullfocus: Command, tmp_path: Path) -> None:
    whole = SETTINGS.replace("float4 dataWindowNDC = (0.25, 0.25, 0.75, 1.125)", 'token pullfocus:engine = "pinhole"')
    cut = SETTINGS.replace(
        'token productName = "crop', 'token pullfocus:engine = "pinhole"\n        token productName = "crop'
    )
    pictures = []
    for name, settings in (("whole", whole), ("cut", cut)):
        (tmp_path / name).mkdir()
        ended = pullfocus("record", write_products(tmp_path / name, settings), tmp_path / name / "out", "--products")
        assert ended.status == 0, ended.err
        pictures.append(OpenImageIO.ImageBuf(str(tmp_path / name / "out/crop.0001.exr")).get_pixels())
    np.testing.assert_allclose(pictures[1][4:], pictures[0][:24, 12:36], atol=0.02)
    assert pictures[1].std() > 0.05


DEEP = """
    def RenderSettings "settings"
    {
        rel camera = </World/main_cam>
        rel products = [</World/flat>, </World/deep>]
        uniform int2 resolution = (48, 32)
        float4 dataWindowNDC = (0, 0.25, 0.75, 1)
        int pullfocus:rays = 16
        float pullfocus:supersample = 1
        bool pullfocus:connections = 0
        int pullfocus:motion = 3
        uniform token renderingColorSpace = "lin_rec709_scene"
    }
    def RenderProduct "flat"
    {
        token productName = "flat.exr"
        rel orderedVars = </World/picture>
    }
    def RenderProduct "deep"
    {
        token productName = "deep.exr"
        token productType = "deepRaster"
        rel orderedVars = </World/picture>
    }
    def RenderVar "picture"
    {
        uniform string sourceName = "Ci"
        uniform token dataType = "color4f"
    }
    def DomeLight "sky"
    {
        color3f inputs:color = (0.2, 0.4, 0.8)
    }
"""


@pytest.mark.gl
def test_a_deep_product_flattens_to_the_flat_one(pullfocus: Command, tmp_path: Path) -> None:
    """A lit square in stage units of centimetres that moves, through glass, before a dome."""
    moving = SQUARE.replace(
        "color3f[]",
        """double3 xformOp:translate.timeSamples = {1: (0, 0, 0), 2: (0.4, 0, 0)}
        uniform token[] xformOpOrder = ["xformOp:translate"]
        color3f[]""",
    )
    lens = CAMERA.replace(
        "float fStop", "double shutter:open = 0\n        double shutter:close = 0.5\n        float fStop"
    )
    shot = write_shot(tmp_path / "shot.usda", moving, lens, DEEP)
    text = shot.read_text().replace(*NAMED).replace("metersPerUnit = 1", "metersPerUnit = 0.5")
    shot.write_text(text)
    ended = pullfocus("record", shot, tmp_path / "out", "--products", "--json", "--frames", 1)
    assert ended.status == 0, ended.err
    flat = OpenImageIO.ImageBuf(str(tmp_path / "out/flat.exr"))
    deep = OpenImageIO.ImageBuf(str(tmp_path / "out/deep.exr"))
    assert windows(tmp_path / "out/deep.exr") == windows(tmp_path / "out/flat.exr") == ((0, 0, 35, 23), (0, 0, 47, 31))
    flattened = OpenImageIO.ImageBufAlgo.flatten(deep).get_pixels()
    np.testing.assert_allclose(flattened[..., :4], flat.get_pixels(), atol=3e-6)
    (part,) = OpenEXR.File(str(tmp_path / "out/deep.exr"), separate_channels=True).parts
    assert part.name() == "picture"
    samples = part.channels["Z"].pixels.reshape(-1)
    depths = np.concatenate([depths for depths in samples if depths is not None])
    np.testing.assert_allclose(
        np.unique(np.round(depths, 3)), [5, 100]
    )  # the square, in stage units, and the far plane
    alpha = flat.get_pixels()[..., 3]
    assert ((alpha > 0.02) & (alpha < 0.98)).sum() > 30


@pytest.mark.gl
@pytest.mark.parametrize("f_stop", [0, 2])
def test_a_deep_orthographic_picture_has_its_own_depths(f_stop: int, pullfocus: Command, tmp_path: Path) -> None:
    """Sharp, and through a lens of parallel rays with the focus elsewhere: 5 m before the camera."""
    lens = CAMERA.replace("float focalLength", 'token projection = "orthographic"\n        float focalLength')
    lens = lens.replace("fStop = 2", f"fStop = {f_stop}").replace("0.36", "36").replace("0.24", "24")
    lens = lens.replace("focusDistance = 5", "focusDistance = 3")
    shot = write_shot(tmp_path / "shot.usda", SQUARE, lens, DEEP)
    shot.write_text(shot.read_text().replace(*NAMED))
    ended = pullfocus("record", shot, tmp_path / "out", "--products", "--frames", 1)
    assert ended.status == 0, ended.err
    flattened = OpenImageIO.ImageBufAlgo.flatten(OpenImageIO.ImageBuf(str(tmp_path / "out/deep.exr"))).get_pixels()
    flat = OpenImageIO.ImageBuf(str(tmp_path / "out/flat.exr")).get_pixels()
    np.testing.assert_allclose(flattened[..., :4], flat, atol=3e-6)
    (part,) = OpenEXR.File(str(tmp_path / "out/deep.exr"), separate_channels=True).parts
    depths = np.concatenate([own for own in part.channels["Z"].pixels.reshape(-1) if own is not None])
    assert (np.abs(depths - 5) < 0.01).sum() > 50
    assert ((np.abs(depths - 5) < 0.01) | (np.abs(depths - 100) < 0.1)).all()


@pytest.mark.gl
def test_colours_are_in_the_rendering_space_of_the_stage(pullfocus: Command, tmp_path: Path) -> None:
    """The square's displayColor comes out as it is authored, by products and without; its primvar, which is data, always does."""
    for space, is_rec709 in (("lin_rec709_scene", True), ("lin_ap1_scene", False)):
        named = f'uniform token renderingColorSpace = "{space}"\n        rel products'
        folder = tmp_path / space
        folder.mkdir()
        shot = write_products(folder, SETTINGS.replace("rel products", named))
        ended = pullfocus("record", shot, folder / "out", "--products")
        assert ended.status == 0, ended.err
        assert ("is not the scene_linear space of OpenColorIO's configuration" in ended.err) == is_rec709
        assert pullfocus("record", shot, folder / "f.exr", "--imageWidth", 48).status == 0
        for file in (folder / "out/beauty/shot.0001.exr", folder / "f.exr"):
            seen = np.asarray(OpenImageIO.ImageBuf(str(file)).get_pixels())[16, 24, :3]
            assert (seen == pytest.approx([0.8, 0.2, 0.1], rel=2e-3)) == is_rec709, (file, seen)
        primvar = np.asarray(OpenImageIO.ImageBuf(str(folder / "out/beauty/shot.0001.exr"), 3, 0).get_pixels())
        assert primvar[16, 24] == pytest.approx([0.8, 0.2, 0.1])


@pytest.mark.gl
def test_flags_win_over_our_settings_on_the_prim(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_products(tmp_path)
    for flags, rays in (((), 4), (("--rays", 9), 9)):
        ended = pullfocus("record", shot, tmp_path / "a.exr", "--imageWidth", 16, *flags, "--json")
        assert ended.status == 0, ended.err
        used = json.loads(ended.out)["settings"]
        assert (used["rays"], used["supersample"], used["shading"]) == (rays, 1, "unlit")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("crop.####.exr", "../crop.####.exr", "must be a file below"),
        ("crop.####.exr", "/elsewhere/crop.####.exr", "must be a file below"),
        ("crop.####.exr", "crop.####.gif", "gif"),
        ("crop.####.exr", "crop.exr", "####"),
        ("crop.####.exr", "beauty/shot.####.exr", "several pictures are written to"),
        ("</World/other_cam>", "</World/Square>", "not a camera"),
        ("crop.####.exr", ".", "productName of product /World/crop must be the name of a file"),
        ("int pullfocus:rays = 4", 'token pullfocus:engine = "pinhle"', "pinhole"),
    ],
)
def test_bad_products_are_refused_before_anything_is_rendered(
    pullfocus: Command, tmp_path: Path, old: str, new: str, words: str
) -> None:
    shot = write_products(tmp_path, SETTINGS.replace(old, new))
    ended = pullfocus("record", shot, tmp_path / "out", "--products", "-f", "1:2")
    assert ended.status == 2 or ended.status == 1
    assert words in ended.err.splitlines()[-1]
    assert not list(tmp_path.rglob("*.exr"))


def test_what_products_say_themselves_is_refused(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_products(tmp_path)
    ended = pullfocus("record", shot, tmp_path / "out", "--products", "--imageWidth", 8, "--camera", "/World/main_cam")
    assert "leave out --camera, --imageWidth" in ended.err
    bare = write_shot(tmp_path / "bare.usda", SQUARE, CAMERA)
    assert "no RenderSettings prim" in pullfocus("record", bare, tmp_path / "out", "--products").err


def test_the_default_time_has_no_number_for_names(pullfocus: Command, tmp_path: Path) -> None:
    ended = pullfocus("record", write_products(tmp_path), tmp_path / "out", "--products", "--defaultTime")
    assert "no frame number for the # of productName" in ended.err


@pytest.mark.gl
def test_rays_of_the_command_line_replace_a_noise_of_the_stage(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_products(tmp_path, SETTINGS.replace("int pullfocus:rays = 4", "double pullfocus:noise = 0.05"))
    for flags, noise in (((), 0.05), (("--rays", 9), 0.0), (("--rays", 9, "--noise", 0.02), 0.02)):
        ended = pullfocus("record", shot, tmp_path / "a.exr", "--imageWidth", 8, *flags, "--json")
        assert json.loads(ended.out)["settings"]["noise"] == noise
