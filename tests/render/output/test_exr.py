"""EXR files: light, measurements, and the camera under OpenEXR's names."""

from __future__ import annotations

import dataclasses
import json
import math
import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import OpenImageIO
import pytest

from render.errors import SettingsError
from render.film import Cdl, Grade, film_settings
from render.model.camera import Camera
from render.optics.view import PinholeView
from render.output import FrameMetadata, encode
from render.output.exr import encode_exr
from render.output.layout import FileLayout, FilePart
from render.output.metadata import exact_frame_rate
from usd_schemas import FilmData

WIDTH, HEIGHT = 32, 18
POSE = np.array([[0.0, 0, 1, 4], [0, 1, 0, 1.5], [-1, 0, 0, -2], [0, 0, 0, 1]])
CAMERA = Camera(
    POSE,
    focal_length_mm=35,
    horizontal_aperture_mm=36,
    vertical_aperture_mm=20.25,
    horizontal_offset_mm=3,
    vertical_offset_mm=-1,
    f_stop=2,
    focus_distance_m=3.25,
    near_m=0.1,
    far_m=100,
    exposure_scale=0.5,
    shutter_open=-0.25,
    shutter_close=0.25,
    path="/World/main_cam",
)
METADATA = FrameMetadata(
    CAMERA,
    time=12.5,
    frames_per_second=24000 / 1001,
    settings={"engine": "lens", "rays": 64, "aovs": ("color", "depth")},
    stage="shot.usda",
    prim_paths=("/World/ground", "/World/hero", "/World/never_seen"),
    exposure_time_s=1 / 48,
    iso=800,
)


def make_frame() -> Any:
    rng = np.random.default_rng(3)
    color = rng.uniform(0, 2, (HEIGHT, WIDTH, 4)).astype(np.float32)
    color[..., 3] /= 2
    depth = rng.uniform(1, 50, (HEIGHT, WIDTH)).astype(np.float32)
    depth[0] = np.inf
    prims = rng.integers(1, 3, (HEIGHT, WIDTH)).astype(np.uint32)
    faces = rng.integers(0, 20_000_000, (HEIGHT, WIDTH)).astype(np.int32)
    prims[0], faces[0] = 0, -1
    coc = rng.normal(0, 5, (HEIGHT, WIDTH)).astype(np.float32)
    return SimpleNamespace(color=color, aovs={"face_id": faces, "coc": coc, "depth": depth, "prim_id": prims})


def exr(frame: Any, metadata: FrameMetadata = METADATA) -> bytes:
    return encode("exr", frame, np.zeros((*frame.color.shape[:2], 3), np.float32), metadata)


def raw_headers(content: bytes) -> list[dict[str, tuple[str, bytes]]]:
    """Type and bytes of every attribute of every part, straight from the file (OpenEXR file layout, "Header")."""
    multi_part = struct.unpack("<I", content[4:8])[0] & 0x1000
    headers, at = [], 8

    def word() -> str:
        nonlocal at
        end = content.index(b"\0", at)
        start, at = at, end + 1
        return content[start:end].decode()

    while True:
        header = {}
        while name := word():
            kind = word()
            (size,) = struct.unpack("<i", content[at : at + 4])
            header[name] = (kind, content[at + 4 : at + 4 + size])
            at += 4 + size
        if header:
            headers.append(header)
        if not header or not multi_part:
            return headers


def part(content: bytes, name: str, path: Path) -> np.ndarray:
    path.write_bytes(content)
    for index in range(OpenImageIO.ImageBuf(str(path)).nsubimages):
        image = OpenImageIO.ImageBuf(str(path), index, 0)
        if image.spec()["oiio:subimagename"] == name:
            return image.get_pixels(image.spec().format)
    raise AssertionError(f"no part {name}")


def matrix(header: dict[str, tuple[str, bytes]], name: str) -> np.ndarray:
    kind, content = header[name]
    assert kind == "m44f"
    return np.frombuffer(content, "<f4").reshape(4, 4).astype(np.float64)


def test_parts_come_in_a_fixed_order_with_their_types(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(exr(make_frame()))
    file = OpenImageIO.ImageInput.open(str(tmp_path / "a.exr"))

    parts = []
    while file.seek_subimage(len(parts), 0):
        spec = file.spec()
        parts.append((spec["oiio:subimagename"], spec.channelnames, str(spec.format)))

    assert parts == [
        ("rgba", ("R", "G", "B", "A"), "half"),
        ("depth", ("Z",), "float"),
        ("coc", ("radius",), "float"),
        ("prim_id", ("id",), "uint"),
        ("face_id", ("id",), "uint"),
    ]


def test_light_is_exposed_and_not_graded(tmp_path: Path) -> None:
    frame = make_frame()

    pixels = part(exr(frame), "rgba", tmp_path / "a.exr")

    # A half float keeps 11 significant bits.
    np.testing.assert_allclose(pixels[..., :3], frame.color[..., :3] * 0.5, rtol=2**-11, atol=1e-7)
    np.testing.assert_allclose(pixels[..., 3], frame.color[..., 3], rtol=2**-11, atol=1e-7)


def test_measurements_come_back_bit_for_bit(tmp_path: Path) -> None:
    frame = make_frame()
    content = exr(frame)

    for name in ("depth", "coc"):
        np.testing.assert_array_equal(part(content, name, tmp_path / "a.exr").squeeze(), frame.aovs[name])
    for name, nothing in (("prim_id", 0), ("face_id", 0xFFFFFFFF)):
        ids = part(content, name, tmp_path / "a.exr").squeeze()
        np.testing.assert_array_equal(ids[1:], frame.aovs[name][1:])
        assert (ids[0] == nothing).all(), "nothing is there"


def test_a_frame_without_measurements_has_one_part() -> None:
    frame = make_frame()
    frame.aovs = {}

    assert len(raw_headers(exr(frame))) == 1


def test_light_that_a_half_float_cannot_hold_stays_a_number(tmp_path: Path) -> None:
    frame = make_frame()
    frame.color[0, :4] = [[np.nan, 0, 0, np.nan], [np.inf, 0, 0, 2], [1e9, 0, 0, 0.5], [-np.inf, 0, 0, -1]]

    pixels = part(exr(frame), "rgba", tmp_path / "a.exr")

    np.testing.assert_array_equal(pixels[0, :4, 0].astype(np.float32), [0, 65504, 65504, -65504])
    np.testing.assert_array_equal(pixels[0, :4, 3].astype(np.float32), [0, 1, 0.5, 0])


def test_the_working_space_is_named() -> None:
    rgba, depth, *_ = raw_headers(exr(make_frame()))

    kind, primaries = rgba["chromaticities"]
    assert kind == "chromaticities"
    # AP1 and the ACES white point (SMPTE ST 2065-1, Academy S-2014-004).
    np.testing.assert_allclose(
        np.frombuffer(primaries, "<f4"), [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767], atol=1e-6
    )
    assert rgba["colorInteropID"] == ("string", b"lin_ap1_scene")
    assert depth["colorInteropID"] == ("string", b"data")
    assert "chromaticities" not in depth


def test_colours_are_written_in_a_linear_space_that_is_named(tmp_path: Path) -> None:
    """Parts in any order: OpenEXR wants the primaries in the first one too."""
    frame = make_frame()
    frame.color[0, 0] = [1e9, 0, 0, 1]
    frame.aovs["albedo"] = frame.color[..., :3] / 2
    metadata = dataclasses.replace(METADATA, color_space="lin_rec709_scene")
    parts = (FilePart("z", "depth"), FilePart("c", "color", "float"), FilePart("a", "albedo", "float"))
    content = encode_exr(frame.color, frame.aovs, metadata, FileLayout(parts))

    depth, colour, albedo = raw_headers(content)
    for header in (depth, colour, albedo):  # Rec. ITU-R BT.709-6, item 1.3 and 1.4
        primaries = np.frombuffer(header["chromaticities"][1], "<f4")
        np.testing.assert_allclose(primaries, [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329], atol=1e-6)
    assert depth["colorInteropID"] == ("string", b"data")
    assert colour["colorInteropID"] == albedo["colorInteropID"] == ("string", b"lin_rec709_scene")
    # AP1 to Rec. 709 with Bradford adaptation to D65 (ACES, CG configuration 2020)
    to_rec709 = [[1.70505, -0.62179, -0.08326], [-0.13026, 1.1408, -0.01055], [-0.024, -0.12897, 1.15297]]
    light = frame.color[..., :3].astype(np.float64) @ np.transpose(to_rec709)
    written = part(content, "c", tmp_path / "a.exr")
    assert written[0, 0, 0] == 65504
    np.testing.assert_allclose(written[1:, :, :3], light[1:] * 0.5, rtol=1e-4, atol=2e-5)
    np.testing.assert_array_equal(written[..., 3], frame.color[..., 3])
    np.testing.assert_allclose(part(content, "a", tmp_path / "a.exr")[1:], light[1:] / 2, rtol=1e-4, atol=2e-5)
    np.testing.assert_array_equal(part(content, "z", tmp_path / "a.exr")[..., 0], frame.aovs["depth"])


def test_every_part_carries_the_camera_under_openexrs_names() -> None:
    expected = {
        "focus": 3.25,
        "aperture": 2,
        "nominalFocalLength": 35,
        "effectiveFocalLength": 35,
        "pinholeFocalLength": 35,
        "expTime": 1 / 48,
        "isoSpeed": 800,
        "shutterAngle": 180,
        "pullfocus:exposureScale": 0.5,
        "pullfocus:timeCode": 12.5,
    }
    for header in raw_headers(exr(make_frame())):
        for name, value in expected.items():
            assert header[name][0] == "float", name
            assert struct.unpack("<f", header[name][1])[0] == pytest.approx(value), name
        assert header["sensorOverallDimensions"] == ("v2f", struct.pack("<2f", 36, 20.25))
        assert header["sensorCenterOffset"] == ("v2f", struct.pack("<2f", 3000, 1000))
        assert header["framesPerSecond"] == ("rational", struct.pack("<iI", 24000, 1001))
        assert header["imageCounter"] == ("int", struct.pack("<i", 12))
        assert header["cameraLabel"] == ("string", b"/World/main_cam")
        assert header["pullfocus:engine"] == ("string", b"lens")
        assert header["pullfocus:rays"] == ("int", struct.pack("<i", 64))
        assert header["pullfocus:aovs"] == ("string", b"color,depth")
        assert "capDate" not in header


def test_the_matrices_put_a_point_where_the_renderer_does() -> None:
    header = raw_headers(exr(make_frame()))[0]
    point = np.array([-3.0, 2.0, -2.5])
    pixel, depth = PinholeView.from_camera(CAMERA, WIDTH, HEIGHT).project(point[None])

    x, y, z, w = np.append(point, 1) @ matrix(header, "worldToNDC")
    _, _, camera_z, _ = np.append(point, 1) @ matrix(header, "worldToCamera")

    np.testing.assert_allclose([x / w * WIDTH, y / w * HEIGHT], pixel[0], rtol=1e-5)
    assert 0 < z / w < 1
    assert camera_z == pytest.approx(depth[0], rel=1e-6), "OpenEXR's camera looks along +z"


def test_openexrs_camera_has_x_to_the_right_and_y_up() -> None:
    header = raw_headers(exr(make_frame()))[0]
    ray_origin, right_of_axis = PinholeView.from_camera(CAMERA, WIDTH, HEIGHT).ray(WIDTH, HEIGHT / 2)
    _, above_axis = PinholeView.from_camera(CAMERA, WIDTH, HEIGHT).ray(WIDTH / 2, 0)
    world_to_camera = matrix(header, "worldToCamera")

    assert (np.append(ray_origin + right_of_axis, 1) @ world_to_camera)[0] > 0
    assert (np.append(ray_origin + above_axis, 1) @ world_to_camera)[1] > 0


def test_the_screen_window_is_the_frame_at_distance_one() -> None:
    header = raw_headers(exr(make_frame()))[0]
    origin, to_top_left = PinholeView.from_camera(CAMERA, WIDTH, HEIGHT).ray(0, 0)
    left, top, distance, _ = np.append(origin + to_top_left, 1) @ matrix(header, "worldToCamera")

    (width,) = struct.unpack("<f", header["screenWindowWidth"][1])
    centre_x, centre_y = struct.unpack("<2f", header["screenWindowCenter"][1])

    assert distance == pytest.approx(1, rel=1e-5)
    assert centre_x - width / 2 == pytest.approx(left, rel=1e-5)
    assert centre_y + width / 2 * HEIGHT / WIDTH == pytest.approx(top, rel=1e-5)


def test_breathing_moves_the_pinhole_and_not_the_lens() -> None:
    breathing = dataclasses.replace(METADATA, camera=dataclasses.replace(CAMERA, breathing=True, focus_distance_m=0.7))

    header = raw_headers(exr(make_frame(), breathing))[0]

    image_distance_mm = 1 / (1 / 35 - 1 / 700)
    assert struct.unpack("<f", header["pinholeFocalLength"][1])[0] == pytest.approx(image_distance_mm)
    assert struct.unpack("<f", header["effectiveFocalLength"][1])[0] == pytest.approx(35)


def test_a_pinhole_at_infinity_has_no_f_number() -> None:
    pinhole = Camera(np.eye(4), f_stop=0, focus_distance_m=0, far_m=math.inf)

    header = raw_headers(exr(make_frame(), FrameMetadata(pinhole)))[0]

    assert "aperture" not in header
    assert header["focus"] == ("float", struct.pack("<f", math.inf))
    assert not {"expTime", "isoSpeed", "shutterAngle", "cameraLabel"} & set(header)
    assert np.isfinite(matrix(header, "worldToNDC")).all()


def test_ids_can_be_looked_up() -> None:
    header = raw_headers(exr(make_frame()))[3]

    paths = json.loads(header["pullfocus:primPaths"][1])

    assert paths == {"1": "/World/ground", "2": "/World/hero"}, "only what is in the picture"


@pytest.mark.parametrize(
    ("rate", "expected"),
    [
        (24.0, (24, 1)),
        (23.976, (24000, 1001)),
        (29.97, (30000, 1001)),
        (59.94005994, (60000, 1001)),
        (12.5, (25, 2)),
        (25.0, (25, 1)),
        (0.1, (1, 10)),
    ],
)
def test_frame_rates_are_exact(rate: float, expected: tuple[int, int]) -> None:
    assert exact_frame_rate(rate) == expected


@pytest.mark.parametrize(
    ("aovs", "message"),
    [
        ({"velocity": np.zeros((HEIGHT, WIDTH))}, "aov must be one of color, depth, coc.*, got 'velocity'"),
        ({"depth": np.zeros((3, 3))}, r"AOV 'depth' must be \(18, 32\) like the picture, got \(3, 3\)"),
    ],
)
def test_a_measurement_that_has_no_place_is_refused(aovs: dict[str, np.ndarray], message: str) -> None:
    frame = make_frame()
    frame.aovs = aovs

    with pytest.raises(SettingsError, match=message):
        exr(frame)


def test_the_header_says_how_the_light_is_to_be_shown() -> None:
    look = "ACES 1.3 Reference Gamut Compression"
    grade = Grade(
        display="Display P3 - Display", look=look, cdl=Cdl((1.1, 1, 0.9), (0, 0.25, 0), (1, 1, 2), saturation=0.5)
    )
    film = film_settings(FilmData(push=1.0), name="5219")

    rgba, *_ = raw_headers(exr(make_frame(), dataclasses.replace(METADATA, grade=grade, film=film)))
    plain, *_ = raw_headers(exr(make_frame()))

    said = {name: rgba[f"pullfocus:{name}"][1] for name in ("display", "view", "look", "filmStock", "filmPrint")}
    assert said == {
        "display": b"Display P3 - Display",
        "view": grade.view_name.encode(),
        "look": look.encode(),
        "filmStock": b"vision3_500t_5219",
        "filmPrint": b"vision_2383",
    }
    numbers = b"".join(rgba[f"pullfocus:{name}"][1] for name in ("cdlSlope", "cdlOffset", "cdlPower", "cdlSaturation"))
    np.testing.assert_allclose(np.frombuffer(numbers, "<f4"), [1.1, 1, 0.9, 0, 0.25, 0, 1, 1, 2, 0.5], rtol=1e-6)
    assert np.frombuffer(rgba["pullfocus:filmPush"][1], "<f4") == 1
    assert not {"pullfocus:look", "pullfocus:cdlSlope", "pullfocus:filmProcess"} & set(plain)
