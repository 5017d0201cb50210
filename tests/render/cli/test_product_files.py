"""Files of a settings prim with three products and vars of every kind, as OpenEXR and OpenImageIO read them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from render.model.mattes import id_bits
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, write_shot
from tests.render.kits.cryptomattes import read_cryptomattes
from tests.render.kits.exr_parts import READERS, ExrPart

pytestmark = pytest.mark.gl

OTHER_CAMERA = (
    CAMERA.replace("main_cam", "other_cam").replace("(0, 0, 5)", "(0.4, 0.1, 3)").replace("fStop = 2", "fStop = 4")
)
CARD = """
    def Mesh "Card"
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-0.8, -0.5, 1), (0.1, -0.5, 1), (0.1, 0.3, 1), (-0.8, 0.3, 1)]
        color3f[] primvars:displayColor = [(0.1, 0.3, 0.9)] (interpolation = "constant")
        float[] primvars:wear = [0.25] (interpolation = "constant")
        rel material:binding = </World/Paint>
    }
    def Material "Paint"
    {
        token outputs:surface.connect = </World/Paint/Surface.outputs:surface>
        def Shader "Surface"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (0.2, 0.5, 0.1)
            token outputs:surface
        }
    }
"""
SETTINGS = """
    def RenderSettings "settings"
    {
        rel camera = </World/main_cam>
        rel products = [</World/all>, </World/crop>, </World/sharp>]
        uniform int2 resolution = (48, 32)
        int pullfocus:rays = 16
        float pullfocus:supersample = 1
        token pullfocus:shading = "unlit"
        bool pullfocus:adaptive = 0
    }
    def RenderProduct "all"
    {
        token productName = "all.####.exr"
        rel orderedVars = [
            </World/Z>, </World/beauty>, </World/Peye>, </World/ids>, </World/wear>, </World/tint>, </World/albedo>,
            </World/diffuse>, </World/objects>, </World/materials>]
    }
    def RenderProduct "crop"
    {
        token productName = "crop/####.exr"
        rel camera = </World/other_cam>
        float4 dataWindowNDC = (0.25, 0.25, 0.75, 1.125)
        rel orderedVars = [</World/beauty>, </World/light>]
    }
    def RenderProduct "sharp"
    {
        token productName = "sharp.####.exr"
        bool disableDepthOfField = 1
        float pixelAspectRatio = 2
        rel orderedVars = </World/beauty>
    }
"""
VARS = {  # name: source, kind of the source, type
    "Z": ("cameraDepth", "raw", "float"),
    "beauty": ("Ci", "intrinsic", "color4f"),
    "light": ("color", "raw", "color3h"),
    "Peye": ("", "raw", "point3f"),
    "ids": ("primId", "raw", "int"),
    "wear": ("wear", "primvar", "float"),
    "tint": ("displayColor", "primvar", "color3f"),
    "albedo": ("albedo", "raw", "color3h"),
    "diffuse": ("C<RD>L", "lpe", "color3f"),
    "objects": ("cryptoObject", "raw", "color4f"),
    "materials": ("cryptoMaterial", "raw", "color4f"),
}
MATTE_CHANNELS = {f"{layer:02}.{channel}" for layer in range(3) for channel in "RGBA"}
CHANNELS = {
    "all": {
        "Z": ({"Z"}, np.float32),
        "beauty": (set("RGBA"), np.float32),
        "Peye": (set("XYZ"), np.float32),
        "ids": ({"id"}, np.uint32),
        "wear": ({"R"}, np.float32),
        "tint": (set("RGB"), np.float32),
        "albedo": (set("RGB"), np.float16),
        "cryptoObject": ({f"cryptoObject{end}" for end in MATTE_CHANNELS}, np.float32),
        "cryptoMaterial": ({f"cryptoMaterial{end}" for end in MATTE_CHANNELS}, np.float32),
    },
    "crop": {"beauty": (set("RGBA"), np.float32), "light": (set("RGB"), np.float16)},
    "sharp": {"beauty": (set("RGBA"), np.float32)},
}
WHOLE = (0, 0, 47, 31)
WINDOWS = {"all": WHOLE, "crop": (12, -4, 35, 23), "sharp": WHOLE}
PIXEL_ASPECTS = {"all": 1, "crop": 1, "sharp": 2}
CAMERAS = {"all": "/World/main_cam", "crop": "/World/other_cam", "sharp": "/World/main_cam"}
APERTURES = {"all": 2, "crop": 4, "sharp": None}


def render_var(name: str, source: str, kind: str, data: str) -> str:
    return f"""
    def RenderVar "{name}"
    {{
        uniform string sourceName = "{source}"
        uniform token sourceType = "{kind}"
        uniform token dataType = "{data}"
    }}
"""


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shot, before its products are recorded."""
    variables = "".join(render_var(name, *of) for name, of in VARS.items())
    path = tmp_path_factory.mktemp("products") / "shot.usda"
    write_shot(path, SQUARE, CARD, CAMERA, OTHER_CAMERA, SETTINGS, variables)
    path.write_text(path.read_text().replace("upAxis", 'renderSettingsPrimPath = "/World/settings"\n    upAxis'))
    return path


@pytest.fixture
def files(shot: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, Path]:
    """Files of the products, by name; recorded once."""
    out = shot.parent / "out"
    names = {"all": out / "all.0001.exr", "crop": out / "crop/0001.exr", "sharp": out / "sharp.0001.exr"}
    if not out.exists():
        ended = Command(capsys)("record", shot, out, "--products", "--json")
        assert ended.status == 0, ended.err
        found = json.loads(ended.out)
        assert [Path(entry["file"]) for entry in found["frames"]] == list(names.values())
        assert [finding["message"] for finding in found["findings"]] == [
            "var /World/diffuse is left out: light path expressions are not honoured"
        ]
    assert {file for file in out.rglob("*") if file.is_file()} == set(names.values())
    return names


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("product", CHANNELS)
def test_parts_channels_types_and_windows(files: dict[str, Path], reader: str, product: str) -> None:
    parts = READERS[reader](files[product])
    assert [part.name for part in parts] == list(CHANNELS[product])
    left, top, right, bottom = WINDOWS[product]
    for part in parts:
        names, kind = CHANNELS[product][part.name]
        assert set(part.channels) == names
        assert {pixels.dtype for pixels in part.channels.values()} == {np.dtype(kind)}, part.name
        assert {pixels.shape for pixels in part.channels.values()} == {(bottom - top + 1, right - left + 1)}
        assert part.data_window == WINDOWS[product]
        assert part.display_window == WHOLE


@pytest.mark.parametrize("product", CHANNELS)
def test_both_readers_read_the_same_samples(files: dict[str, Path], product: str) -> None:
    for one, other in zip(*(read(files[product]) for read in READERS.values()), strict=True):
        for name, pixels in one.channels.items():
            np.testing.assert_array_equal(pixels, other.channels[name], err_msg=f"{one.name}.{name}")


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("product", CHANNELS)
def test_the_header_has_the_camera_as_usd_has_it(files: dict[str, Path], shot: Path, reader: str, product: str) -> None:
    """The frustum is that of the display window, by usd-core's own."""
    parts = READERS[reader](files[product])
    stage = Usd.Stage.Open(str(shot))
    camera = UsdGeom.Camera(stage.GetPrimAtPath(CAMERAS[product])).GetCamera(1)
    camera.horizontalAperture = camera.verticalAperture * 48 * PIXEL_ASPECTS[product] / 32  # expandAperture
    to_clip = np.array(camera.frustum.ComputeViewMatrix()) @ np.array(camera.frustum.ComputeProjectionMatrix())
    points = np.array([[-0.8, -0.5, 1, 1], [0.1, 0.3, 1, 1], [1, 1, 0, 1], [0.3, -0.7, -4, 1]])
    clip = points @ to_clip
    expected = 0.5 + clip[:, :2] / clip[:, 3:] * [0.5, -0.5]
    for part in parts:
        seen = points @ part.header["worldToNDC"]
        np.testing.assert_allclose(seen[:, :2] / seen[:, 3:], expected, atol=1e-5)
        window = camera.frustum.GetWindow()
        np.testing.assert_allclose(part.header["screenWindowWidth"], window.GetSize()[0], rtol=1e-5)
        middle = (window.GetMin() + window.GetMax()) / 2
        np.testing.assert_allclose(part.header["screenWindowCenter"], middle, atol=1e-6)
        assert part.header["cameraLabel"] == CAMERAS[product]
        assert part.header["pixelAspectRatio"] == PIXEL_ASPECTS[product]
        assert part.header.get("aperture") == APERTURES[product]
        assert part.header["focus"] == 5
        assert part.header["imageCounter"] == 1
        assert part.header["pullfocus:rays"] == 16


def edges(part: ExrPart, channel: str) -> tuple[int, int, int, int]:
    """First and last column and row in which a channel is mostly filled, in pixels of the display window."""
    filled = part.channels[channel] > 0.5
    columns, rows = np.flatnonzero(filled.any(axis=0)), np.flatnonzero(filled.any(axis=1))
    left, top = part.data_window[:2]
    return left + int(columns[0]), left + int(columns[-1]), top + int(rows[0]), top + int(rows[-1])


@pytest.mark.parametrize("product", ["all", "sharp"])
def test_the_square_is_where_the_header_says(files: dict[str, Path], product: str) -> None:
    beauty = next(part for part in READERS["OpenEXR"](files[product]) if part.name == "beauty")
    corners = np.array([[-1, 1, 0, 1], [1, -1, 0, 1]]) @ beauty.header["worldToNDC"]
    (left, top), (right, bottom) = corners[:, :2] / corners[:, 3:] * [48, 32]
    expected = np.clip([left, right - 1, top, bottom - 1], 0, [47, 47, 31, 31])
    np.testing.assert_allclose(edges(beauty, "A"), expected, atol=1.0)


@pytest.mark.parametrize("reader", READERS)
def test_vars_hold_what_they_are_named_for(files: dict[str, Path], reader: str) -> None:
    parts = {part.name: part.channels for part in READERS[reader](files["all"])}
    card = parts["wear"]["R"] == 0.25
    assert card.sum() > 20
    assert (parts["wear"]["R"][~card] == 0).all()
    np.testing.assert_allclose(parts["Z"]["Z"][card], 4, rtol=1e-5)
    np.testing.assert_allclose(parts["Peye"]["Z"][card], -4, rtol=1e-5)
    for channel, value in zip("RGB", (0.1, 0.3, 0.9), strict=True):
        np.testing.assert_allclose(parts["tint"][channel][card], value, rtol=1e-6)
    assert len(set(parts["ids"]["id"][card].tolist())) == 1
    nothing = parts["Z"]["Z"] == 0
    assert nothing.any()
    assert (parts["ids"]["id"][nothing] == 0xFFFFFFFF).all()
    sure = parts["beauty"]["A"] == 1
    for channel in "RGB":  # unlit, the albedo is the light, but for the exposure
        share = parts["albedo"][channel][sure].astype(np.float64) / parts["beauty"][channel][sure]
        np.testing.assert_allclose(share, share.flat[0], rtol=2e-3)


@pytest.mark.parametrize("reader", READERS)
def test_mattes_decode(files: dict[str, Path], reader: str) -> None:
    """Ids by the names' hashes, and coverage that adds up to alpha."""
    mattes = read_cryptomattes(files["all"], READERS[reader])
    alpha = {part.name: part.channels for part in READERS[reader](files["all"])}["beauty"]["A"]
    names = {"cryptoObject": {"/World/Square", "/World/Card"}, "cryptoMaterial": {"default", "/World/Paint"}}
    assert set(mattes) == set(names)
    for name, matte in mattes.items():
        assert matte.manifest == {of: id_bits(of) for of in names[name]}
        np.testing.assert_allclose(matte.coverage.sum(axis=-1), alpha, atol=2e-6)
    np.testing.assert_array_equal(mattes["cryptoObject"].of("/World/Card"), mattes["cryptoMaterial"].of("/World/Paint"))
    blurred = mattes["cryptoObject"].of("/World/Card")
    assert ((blurred > 0.02) & (blurred < 0.98)).any()


def test_the_cropped_picture_is_that_of_the_whole_one(
    files: dict[str, Path], shot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where both show the same pixels of the display window, but for the rays that meet an edge or just miss it."""
    text = shot.read_text().replace("float4 dataWindowNDC = (0.25, 0.25, 0.75, 1.125)", "")
    (tmp_path / "whole.usda").write_text(text)
    assert Command(capsys)("record", tmp_path / "whole.usda", tmp_path / "out", "--products").status == 0
    crop, whole = (
        {part.name: part.channels for part in READERS["OpenEXR"](file)}["beauty"]
        for file in (files["crop"], tmp_path / "out/crop/0001.exr")
    )
    for channel in "RGBA":
        np.testing.assert_allclose(crop[channel][4:], whole[channel][:24, 12:36], atol=2.5 / 16)
        assert np.abs(crop[channel][4:] - whole[channel][:24, 12:36]).mean() < 0.004
