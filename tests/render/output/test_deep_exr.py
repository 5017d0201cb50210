"""Deep EXR files, read by OpenEXR and flattened by OpenImageIO."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO
import pytest

from render.colour import from_working
from render.model.camera import Camera, Orthographic
from render.model.deep import layer_samples
from render.model.framing import Framing, Window
from render.output import FrameMetadata, encode, write_views
from render.output.layout import FileLayout, FilePart

WIDTH, HEIGHT = 7, 5
CAMERA = Camera(np.eye(4), f_stop=2, focus_distance_m=3, far_m=50.0, exposure_scale=0.5, path="/cam")
METADATA = FrameMetadata(CAMERA, metres_per_unit=0.01)
LAYOUT = FileLayout((FilePart("beauty", "color"),), Framing(window=Window(2, -1, 20, 10)), is_deep=True)


def make_frame() -> Any:
    """Up to four surfaces in each pixel, none in the first, before a background that shows in the first rows."""
    rng = np.random.default_rng(8)
    pixels = np.repeat(np.arange(1, WIDTH * HEIGHT), rng.integers(1, 5, WIDTH * HEIGHT - 1))
    coverage = rng.uniform(0.05, 0.25, len(pixels))
    light = rng.uniform(0, 4, (len(pixels), 3)) * coverage[:, None]
    w = rng.uniform(0.1, 2, len(pixels))
    color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    for pixel, own, share in zip(pixels, light, coverage, strict=True):
        color.reshape(-1, 4)[pixel] += [*own, share]
    color[1:3, :, :3] += 0.25
    deep = layer_samples(pixels, np.column_stack([coverage, light, w * coverage]), color)
    return SimpleNamespace(color=color, aovs={}, deep=deep)


def write(file: Path, frame: Any, metadata: FrameMetadata = METADATA) -> Path:
    file.write_bytes(encode("exr", frame, np.zeros((HEIGHT, WIDTH, 3), np.float32), metadata, LAYOUT))
    return file


def test_openexr_reads_the_samples_as_they_were_made(tmp_path: Path) -> None:
    frame = make_frame()
    (part,) = OpenEXR.File(str(write(tmp_path / "a.exr", frame)), separate_channels=True).parts
    assert part.type() == OpenEXR.deepscanline
    assert part.name() == "beauty"
    assert set(part.channels) == set("RGBAZ")
    assert [tuple(corner.tolist()) for corner in part.header["dataWindow"]] == [(2, -1), (8, 3)]
    assert [tuple(corner.tolist()) for corner in part.header["displayWindow"]] == [(0, 0), (19, 9)]
    assert part.header["cameraLabel"] == "/cam"
    assert part.header["colorInteropID"] == "lin_ap1_scene"
    samples = {name: part.channels[name].pixels.reshape(-1) for name in "RGBAZ"}
    own = frame.deep
    for pixel in range(WIDTH * HEIGHT):
        here = own.pixels == pixel
        if not here.any():
            assert all(samples[name][pixel] is None or not len(samples[name][pixel]) for name in samples)
            continue
        for c, name in enumerate("RGB"):
            np.testing.assert_array_equal(samples[name][pixel], own.light[here, c] * np.float32(0.5))
        np.testing.assert_array_equal(samples["A"][pixel], own.light[here, 3])
        depths_m = np.where(np.isinf(own.depths_m[here]), 50, own.depths_m[here])
        np.testing.assert_allclose(samples["Z"][pixel], depths_m * 100, rtol=1e-6)
        assert samples["Z"][pixel].dtype == np.float32


@pytest.mark.parametrize("space", ["", "lin_rec709_scene"])
def test_openimageio_flattens_them_to_the_flat_picture(space: str, tmp_path: Path) -> None:
    frame = make_frame()
    metadata = replace(METADATA, color_space=space)
    deep = OpenImageIO.ImageBuf(str(write(tmp_path / "a.exr", frame, metadata)))
    assert deep.deep
    flat = OpenImageIO.ImageBufAlgo.flatten(deep).get_pixels()
    expected = frame.color * [0.5, 0.5, 0.5, 1]
    if space:
        expected = from_working(expected.astype(np.float32), space)
    np.testing.assert_allclose(flat[..., :4], expected, atol=2e-6)


def test_the_same_frame_gives_the_same_bytes(tmp_path: Path) -> None:
    one, other = (write(tmp_path / name, make_frame()).read_bytes() for name in ("a.exr", "b.exr"))
    assert one == other


def test_both_eyes_go_into_one_file(tmp_path: Path) -> None:
    frame = make_frame()
    views = [(frame, replace(METADATA, view=eye)) for eye in ("left", "right")]
    write_views(tmp_path / "a.exr", views, LAYOUT)
    parts = OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True).parts
    assert [(part.name(), part.header["view"], part.type()) for part in parts] == [
        (f"beauty.{eye}", eye, OpenEXR.deepscanline) for eye in ("left", "right")
    ]
    for number in range(2):
        flat = OpenImageIO.ImageBufAlgo.flatten(OpenImageIO.ImageBuf(str(tmp_path / "a.exr"), number, 0)).get_pixels()
        np.testing.assert_allclose(flat[..., :3], frame.color[..., :3] * 0.5, atol=2e-6)


def test_depths_of_an_orthographic_camera_count_from_its_origin(tmp_path: Path) -> None:
    far = replace(CAMERA, orthographic=Orthographic(set_back_m=20.0, focal_length_mm=35.0), far_m=70.0)
    assert far.set_back_m == 20
    write(tmp_path / "a.exr", make_frame(), replace(METADATA, camera=far))
    (part,) = OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True).parts
    depths = np.concatenate([own for own in part.channels["Z"].pixels.reshape(-1) if own is not None])
    assert depths.max() == pytest.approx(5000), "the background, 50 m before the origin"
    own = make_frame().deep.depths_m
    np.testing.assert_allclose(sorted(depths)[:9], sorted((own[np.isfinite(own)] - 20) * 100)[:9], rtol=1e-5)
