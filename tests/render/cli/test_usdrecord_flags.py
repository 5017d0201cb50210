"""Every flag of usdrecord, as its help spells it, has the effect there that it has in usdrecord or that the guide says."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
from numpy.typing import NDArray

from render.cli.parser import Parser
from render.cli.record import add_arguments
from render.gl.compat import software_device
from render.gl.no_gpu import NO_GPU, check_software
from render.stage.options import COMPLEXITIES, LIGHTS
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, Ended, write_shot

WIDTH = 24
USDRECORD_FLAGS = """--help -h --mask --purposes --sessionLayer --disableGpu --disableDrawMode --disableCameraLight --resolver
--camera -cam --defaultTime -d --frames -f --complexity -c --colorCorrectionMode -color --renderer -r --imageWidth -w
--enableDomeLightVisibility --renderPassPrimPath -rp --renderSettingsPrimPath -rs --traceToFile --traceFormat --memstats"""
DOME = '\n    def DomeLight "Sky"\n    {\n        color3f inputs:color = (0.5, 0.5, 0.5)\n    }\n'
LAMP = '\n    def DistantLight "Sun"\n    {\n        float inputs:intensity = 2\n    }\n'
SETTINGS = """
    def RenderSettings "Wide"
    {
        rel camera = </World/other_cam>
        uniform token[] includedPurposes = ["proxy"]
        uniform int2 resolution = (20, 6)
    }
    def RenderPass "Beauty" (prepend apiSchemas = ["CollectionAPI:prune"])
    {
        rel renderSource = </World/Wide>
        rel collection:prune:includes = </World/Square>
    }
"""
OTHER_CAMERA = CAMERA.replace("main_cam", "other_cam")
PROXY = SQUARE.replace("Square", "Proxy").replace(
    "int[] faceVertexCounts", 'uniform token purpose = "proxy"\n        int[] faceVertexCounts'
)


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


def record(pullfocus: Command, shot: Path, *flags: object, name: str = "f.exr") -> tuple[Ended, NDArray[np.float32]]:
    """Record one small sharp picture: what was said, and the pixels ``(height, width, channels)``."""
    out = shot.parent / name
    size = () if {"-w", "--imageWidth"} & set(flags) else ("-w", WIDTH)
    ended = pullfocus("record", shot, out, "--engine", "pinhole", *size, *flags)
    assert ended.status == 0, ended.err
    return ended, np.asarray(OpenImageIO.ImageBuf(str(out)).get_pixels(OpenImageIO.FLOAT))


def middle(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """The pixel in the middle."""
    return picture[picture.shape[0] // 2, picture.shape[1] // 2]


def test_mask_takes_commas_and_spaces(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA, '\n    def Xform "Empty" {}\n')
    for mask, alpha in (("/World/Empty", 0), ("/World/Empty,/World/Square", 1), ("/World/Empty /World/Square", 1)):
        _, picture = record(pullfocus, shot, "--mask", mask)
        assert middle(picture)[3] == pytest.approx(alpha, abs=1e-3)


@pytest.mark.parametrize("flag", ["--purposes", "-p"])
def test_purposes_takes_commas_and_spaces(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", PROXY, CAMERA)
    for purposes, alpha in (("render", 0), ("default,proxy", 1), ("guide proxy", 1)):
        _, picture = record(pullfocus, shot, flag, purposes)
        assert middle(picture)[3] == pytest.approx(alpha, abs=1e-3)


def test_session_layer(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    session = tmp_path / "session.usda"
    session.write_text('#usda 1.0\nover "World"\n{\n    over "Square" (active = false) {}\n}\n')
    _, picture = record(pullfocus, shot, "--sessionLayer", session)
    assert middle(picture)[3] == 0
    ended = pullfocus("record", shot, tmp_path / "g.exr", "--sessionLayer", tmp_path / "gone.usda")
    assert ended.status == 1
    assert "gone.usda" in ended.err


@pytest.mark.parametrize(("resolver", "alpha"), [("root", 1), ("inherit", 0)])
def test_resolver(resolver: str, alpha: float, pullfocus: Command, tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    write_shot(tmp_path / "square.usda", SQUARE)
    (tmp_path / "sub" / "b.usda").write_text('#usda 1.0\ndef "B" (references = @square.usda@</World/Square>) {}\n')
    chain = '\n    def "Chain" (references = @./sub/b.usda@</B>) {}\n'
    _, picture = record(pullfocus, write_shot(tmp_path / "a.usda", chain, CAMERA), "--resolver", resolver)
    assert middle(picture)[3] == alpha


def test_disable_draw_mode(pullfocus: Command, tmp_path: Path) -> None:
    bounds = SQUARE.replace('"Square"', '"Square" (prepend apiSchemas = ["GeomModelAPI"]; kind = "component")').replace(
        "int[] faceVertexCounts", 'uniform token model:drawMode = "bounds"\n        int[] faceVertexCounts'
    )
    shot = write_shot(tmp_path / "a.usda", bounds, CAMERA)
    shot.write_text(shot.read_text().replace('def Xform "World"', 'def Xform "World" (kind = "assembly")'))
    assert middle(record(pullfocus, shot)[1])[3] == pytest.approx(0, abs=1e-3)
    assert middle(record(pullfocus, shot, "--disableDrawMode")[1])[3] == pytest.approx(1, abs=1e-3)


def test_disable_camera_light(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    assert middle(record(pullfocus, shot)[1])[0] > 0.1
    assert middle(record(pullfocus, shot, "--disableCameraLight")[1]) == pytest.approx([0, 0, 0, 1], abs=1e-3)
    lit = write_shot(tmp_path / "lit.usda", SQUARE, CAMERA, LAMP)
    assert (record(pullfocus, lit)[1] == record(pullfocus, lit, "--disableCameraLight")[1]).all()


def test_lights(pullfocus: Command, tmp_path: Path) -> None:
    lamp = LAMP.replace("float inputs:intensity", "float inputs:angle = 0\n        float inputs:intensity")
    shot, lit = write_shot(tmp_path / "a.usda", SQUARE, CAMERA), write_shot(tmp_path / "b.usda", SQUARE, CAMERA, lamp)
    red = {lights: middle(record(pullfocus, lit, "--lights", lights)[1])[0] for lights in LIGHTS}
    dark = {lights: middle(record(pullfocus, shot, "--lights", lights)[1])[0] for lights in LIGHTS}
    assert dark["stage"] == 0
    assert dark["auto"] == dark["camera"] == dark["both"] == red["camera"] > 0.1
    assert red["auto"] == red["stage"] > 0.1
    assert red["both"] == pytest.approx(red["camera"] + red["stage"], rel=0.01)


def test_dome_light_visibility(pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA, DOME)
    shown, hidden = record(pullfocus, shot)[1], record(pullfocus, shot, "--disableDomeLightVisibility")[1]
    assert shown[0, 0, :3] == pytest.approx([0.5, 0.5, 0.5], abs=1e-2)
    assert hidden[0, 0] == pytest.approx([0, 0, 0, 0])
    assert middle(hidden) == pytest.approx(middle(shown))
    both = ("--disableDomeLightVisibility", "--enableDomeLightVisibility")
    assert (record(pullfocus, shot, *both)[1] == shown).all()


@pytest.mark.parametrize("flag", ["--renderSettingsPrimPath", "-rs"])
def test_render_settings_prim_path(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", PROXY, CAMERA, OTHER_CAMERA, SETTINGS)
    ended, picture = record(pullfocus, shot, flag, "/World/Wide")
    assert ended.err.startswith("camera: /World/other_cam (the render settings /World/Wide name it)")
    assert picture.shape[1] == WIDTH
    assert middle(picture)[3] == 1
    assert pullfocus("record", shot, tmp_path / "g.exr", "--engine", "pinhole", flag, "/World/Wide").status == 0
    assert np.asarray(OpenImageIO.ImageBuf(str(tmp_path / "g.exr")).get_pixels()).shape[:2] == (6, 20)
    refused = pullfocus("record", shot, tmp_path / "h.exr", flag, "/World/Square")
    assert refused.status == 2
    assert "no RenderSettings prim at '/World/Square'; the stage has: /World/Wide" in refused.err


@pytest.mark.parametrize("flag", ["--renderPassPrimPath", "-rp"])
def test_render_pass_prim_path(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA, OTHER_CAMERA, SETTINGS)
    ended, picture = record(pullfocus, shot, flag, "/World/Beauty")
    assert ended.err.startswith("camera: /World/other_cam (")
    assert middle(picture)[3] == 0
    both = pullfocus("record", shot, tmp_path / "g.exr", flag, "/World/Beauty", "-rs", "/World/Wide")
    assert both.status == 2
    assert "leave out --renderSettingsPrimPath" in both.err


@pytest.mark.parametrize(("engine", "alpha"), [("pinhole", 0), ("flag", 1)])
def test_engines_without_alpha_say_so_of_holdouts(
    engine: str, alpha: float, pullfocus: Command, tmp_path: Path
) -> None:
    held = SETTINGS.replace("prune", "matte")
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA, OTHER_CAMERA, held)
    ended = pullfocus("record", shot, tmp_path / "f.exr", "-rp", "/World/Beauty", "--engine", engine)
    assert ended.status == 0
    picture = np.asarray(OpenImageIO.ImageBuf(str(tmp_path / "f.exr")).get_pixels())
    assert middle(picture) == pytest.approx([0, 0, 0, alpha])
    message = "holdouts of the render pass are black with alpha 1, since the engine flag has no alpha"
    assert (message in ended.err) == (engine == "flag")


MOVED = SQUARE.replace(
    "color3f[] primvars",
    """double3 xformOp:translate = (0, 0, 1)
        double3 xformOp:translate.timeSamples = {1: (0, 0, -1), 9: (0, 0, -3)}
        uniform token[] xformOpOrder = ["xformOp:translate"]
        color3f[] primvars""",
)
FOCUSED = CAMERA.replace(
    'Camera "main_cam"', 'Camera "main_cam" (prepend apiSchemas = ["FocusAPI", "FocusPointAPI:it"])'
).replace(
    "{",
    """{
        uniform token focus:mode = "points"
        float focus:smoothing = 0.5
        rel focusPoint:it:target = </World/Square>""",
)


@pytest.mark.parametrize("flag", ["--defaultTime", "-d"])
def test_default_time(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    """Depth and focus are those of the default values, 4 m before the camera; at the first frame it is 6 m."""
    shot = write_shot(tmp_path / "a.usda", MOVED, FOCUSED)
    for time, depth_m in ((("--frames", 1), 6), ((flag,), 4)):
        record(pullfocus, shot, *time, "--aov", "color,depth")
        header = OpenImageIO.ImageBuf(str(tmp_path / "f.exr"), 0, 0).spec()
        assert header.getattribute("focus") == pytest.approx(depth_m, rel=1e-4)
        assert (header.getattribute("pullfocus:timeCode") is None) == (flag in time)
        depths = np.asarray(OpenImageIO.ImageBuf(str(tmp_path / "f.exr"), 1, 0).get_pixels())
        assert middle(depths)[0] == pytest.approx(depth_m, rel=1e-4)


@pytest.mark.parametrize("options", [("--film", "portra_400"), ("--meter", "spot"), ("--motion", 3), ("--json",)])
def test_default_time_goes_with_everything_of_one_picture(
    options: tuple[object, ...], pullfocus: Command, tmp_path: Path
) -> None:
    shot = write_shot(tmp_path / "a.usda", MOVED, FOCUSED)
    ended, picture = record(pullfocus, shot, "-d", *options, name="f.png")
    assert middle(picture)[0] > 0.1
    if options == ("--json",):
        assert json.loads(ended.out)["frames"][0]["time"] is None


@pytest.mark.parametrize(
    ("out", "options", "words"),
    [
        ("f.#.png", (), "no frame number for the #"),
        ("f.png", ("--frames", "1"), "not allowed with argument"),
        ("f.png", ("--long-exposure", "1:4"), "leave out --long-exposure"),
        ("f.png", ("--contact-sheet", "stop=2,4"), "leave out --long-exposure and --contact-sheet"),
    ],
)
def test_default_time_is_one_picture(
    out: str, options: tuple[str, ...], words: str, pullfocus: Command, tmp_path: Path
) -> None:
    ended = pullfocus("record", write_shot(tmp_path / "a.usda", SQUARE, CAMERA), tmp_path / out, "-d", *options)
    assert ended.status == 2
    assert words in ended.err


@pytest.mark.parametrize("flag", ["--camera", "-cam"])
@pytest.mark.parametrize("name", ["/World/other_cam", "World/other_cam", "other_cam"])
def test_camera(flag: str, name: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA, OTHER_CAMERA.replace("0, 0, 5", "0, 0, 9"))
    record(pullfocus, shot, flag, name, "--aov", "color,depth")
    depths = np.asarray(OpenImageIO.ImageBuf(str(tmp_path / "f.exr"), 1, 0).get_pixels())
    assert middle(depths)[0] == pytest.approx(9, rel=1e-4)


@pytest.mark.parametrize("flag", ["--frames", "-f"])
def test_frames(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    ended = pullfocus("record", shot, tmp_path / "f.##.#.png", "--engine", "pinhole", "-w", WIDTH, flag, "2:1x-0.5")
    assert ended.status == 0
    assert sorted(file.name for file in tmp_path.glob("f.*")) == [f"f.{time}.png" for time in ("01.0", "01.5", "02.0")]


@pytest.mark.parametrize("flag", ["--imageWidth", "-w"])
def test_image_width(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    assert record(pullfocus, shot, flag, 40)[1].shape[:2] == (26, 40)


@pytest.mark.parametrize("flag", ["--complexity", "-c"])
def test_complexity(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    """A square of the default scheme, Catmull-Clark, with round corners: polygons of more and more corners in a round shape."""
    square = SQUARE.replace(
        "int[] faceVertexCounts", 'token interpolateBoundary = "edgeOnly"\n        int[] faceVertexCounts'
    )
    shot = write_shot(tmp_path / "a.usda", square, CAMERA)
    areas = {name: float(record(pullfocus, shot, flag, name)[1][..., 0].mean()) for name in COMPLEXITIES}
    assert areas["low"] > areas["veryhigh"] > areas["high"] > areas["medium"]
    assert areas["auto"] == float(record(pullfocus, shot)[1][..., 0].mean())
    assert pullfocus("record", shot, tmp_path / "f.png", flag, "1.2").status == 2


@pytest.mark.parametrize("flag", ["--colorCorrectionMode", "-color"])
def test_color_correction_mode(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    """The square's colour as it is, as sRGB encodes it (IEC 61966-2-1), and as the default view of the configuration shows it."""
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    unlit = ("--shading", "unlit")
    linear = np.array([0.8, 0.2, 0.1])
    expected = {"disabled": linear, "sRGB": 1.055 * linear ** (1 / 2.4) - 0.055}
    for mode, color in expected.items():
        _, picture = record(pullfocus, shot, flag, mode, *unlit, name="f.png")
        assert middle(picture) == pytest.approx(color, abs=1.1 / 255)
    _, viewed = record(pullfocus, shot, flag, "openColorIO", *unlit, name="f.png")
    assert (viewed == record(pullfocus, shot, *unlit, name="f.png")[1]).all()
    assert middle(viewed) != pytest.approx(expected["sRGB"], abs=0.02)


def test_color_correction_leaves_out_film_and_grade(pullfocus: Command, tmp_path: Path) -> None:
    camera = CAMERA.replace('"main_cam"', '"main_cam" (prepend apiSchemas = ["FilmAPI"])').replace(
        "{", '{\n        uniform token film:process = "monochrome"', 1
    )
    shot = write_shot(tmp_path / "a.usda", SQUARE, camera)
    red, green, _ = middle(record(pullfocus, shot, "-color", "sRGB", name="f.png")[1])
    assert red > 1.5 * green
    refused = pullfocus("record", shot, tmp_path / "g.png", "-color", "sRGB", "--film", "portra_400", "--look", "x")
    assert refused.status == 2
    assert "leave out --film, --look" in refused.err
    ended, _ = record(pullfocus, shot, "-color", "sRGB")
    assert "an EXR file stays scene-linear: --colorCorrectionMode is not applied" in ended.err
    header = OpenImageIO.ImageBuf(str(tmp_path / "f.exr")).spec()
    assert header.getattribute("pullfocus:pictureSpace") == "srgb_texture"


@pytest.mark.parametrize("flag", ["--renderer", "-r"])
def test_renderer(flag: str, pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    assert "renderer: Pullfocus, in place of Storm" in record(pullfocus, shot, flag, "Storm")[0].err
    assert "renderer:" not in record(pullfocus, shot, flag, "Pullfocus")[0].err


@pytest.mark.skipif(software_device() is None, reason="EGL has no software rasteriser")
def test_disable_gpu(pullfocus: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The software rasteriser draws, and a context with another device, which is made up here, is refused."""
    shot = write_shot(tmp_path / "a.usda", SQUARE, CAMERA)
    asked = []

    def find_device() -> object:
        asked.append(software_device())
        return asked[0]

    monkeypatch.setattr("render.gl.context.software_device", find_device)
    record(pullfocus, shot)
    assert asked == []
    record(pullfocus, shot, "--disableGpu")
    assert len(asked) == 1
    assert asked[0] is not None
    assert NO_GPU not in os.environ
    monkeypatch.setattr("render.gl.context.check_software", lambda *_: check_software("Fast GPU", is_software=False))
    assert pullfocus("record", shot, tmp_path / "g.png", "-w", WIDTH).status == 0
    refused = pullfocus("record", shot, tmp_path / "h.png", "--disableGpu", "-w", WIDTH)
    assert refused.status == 1
    assert "OpenGL has none but Fast GPU" in refused.err


@pytest.mark.parametrize("format", ["chrome", "trace"])
def test_trace_to_file(format: str, pullfocus: Command, tmp_path: Path) -> None:
    shot, trace = write_shot(tmp_path / "a.usda", SQUARE, CAMERA), tmp_path / "trace.txt"
    record(pullfocus, shot, "--traceToFile", trace, "--traceFormat", format)
    if format == "chrome":
        assert json.loads(trace.read_text())["traceEvents"]
    else:
        assert "UsdStage::Open" in trace.read_text()
    before = shot.read_text()
    assert pullfocus("record", shot, tmp_path / "f.png", "--traceToFile", shot).status == 2
    assert shot.read_text() == before


def test_memstats(pullfocus: Command, tmp_path: Path) -> None:
    said = record(pullfocus, write_shot(tmp_path / "a.usda", SQUARE, CAMERA), "--memstats")[0].err
    (line,) = [line for line in said.splitlines() if line.startswith("memory: ")]
    assert float(line.split()[1].replace(",", "")) > 50


def test_every_flag_of_usdrecord_is_there() -> None:
    """The flags of usdrecord's help in OpenUSD 26 (``usdrecord.py`` and ``UsdAppUtils``)."""
    parser = Parser()
    add_arguments(parser)
    known = {word for action in parser._actions for word in action.option_strings}
    assert set(USDRECORD_FLAGS.split()) <= known
