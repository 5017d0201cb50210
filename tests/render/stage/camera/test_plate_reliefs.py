"""Back plates with a depth image: each place stands at its own depth, and is blurred by it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from render.frame import FrameRenderer
from render.model.arrays import DoubleArray
from render.stage import StageReader
from tests.render.kits.plates import HEIGHT, WIDTH, corners_in_picture, picture, plated, write_image
from tests.render.kits.stages import only_batch, world_points


def relief_stage(tmp_path: Path, texels: object, unit: float = 1.0, **tweaks: object) -> Usd.Stage:
    """A red plate at 5 units with a depth image of one channel, rows from the top."""
    depth = write_image(tmp_path / "depth.exr", np.asarray(texels, np.float32)[..., None])
    image = write_image(tmp_path / "plain.exr", (0.8, 0.2, 0.1))
    return plated(image, unit, depth_image=depth, **tweaks)


@pytest.mark.parametrize("unit", [1.0, 0.01])
def test_depths_move_places_along_their_lines_of_sight(tmp_path: Path, unit: float) -> None:
    texels = np.array([[2.0, 3, 4], [8, 9, 12]])
    stage = relief_stage(
        tmp_path, texels, unit, depth_minOffset=1.0, depth_normalizingFactor=2.0, depth_cameraSpaceOffset=0.5
    )
    places, depths_m = corners_in_picture(stage)
    np.testing.assert_allclose(depths_m.reshape(2, 3), ((texels - 1) * 2 + 0.5) * unit, rtol=1e-6)
    expected = [(x * WIDTH / 2, y * HEIGHT) for y in (0, 1) for x in (0, 1, 2)]
    np.testing.assert_allclose(places, expected, atol=1e-3)


def test_depths_that_are_none_are_those_of_the_plate(tmp_path: Path) -> None:
    stage = relief_stage(tmp_path, [[0.0, -3, math.nan], [math.inf, 1e30, 3]])
    _, depths_m = corners_in_picture(stage)
    np.testing.assert_allclose(depths_m, [5, 5, 5, 5, 5, 3], rtol=1e-6)


@pytest.mark.gl
def test_a_relief_looks_flat_and_is_blurred_by_its_depths(renderer: FrameRenderer, tmp_path: Path) -> None:
    """The left half is in focus at 5 m, the right half at 20 m; both have stripes, of which the lens blurs the right ones."""
    texels = np.where(np.arange(256) < 128, 5.0, 20.0) * np.ones((144, 1))
    stage = relief_stage(tmp_path, texels)
    stripes = np.repeat((np.arange(320) // 8 % 2)[None, :, None], 4, axis=0) * np.ones(3)
    UsdGeom.BackPlateAPI(stage.GetPrimAtPath("/cam"), "sky").GetImageAttr().Set(
        write_image(tmp_path / "s.exr", stripes)
    )
    flat = Usd.Stage.Open(stage.Flatten())
    flat.GetPrimAtPath("/cam").GetAttribute("backPlate:sky:depth:image").Set("")
    sharp, plain = (picture(renderer, one)[..., 0] for one in (stage, flat))
    away = np.abs(np.arange(WIDTH) - WIDTH / 2) > 2
    np.testing.assert_allclose(sharp[:, away], plain[:, away], atol=0.02)
    assert sharp[45].max() > 0.9
    for one in (stage, flat):
        UsdGeom.Camera(one.GetPrimAtPath("/cam")).CreateFStopAttr(0.4)
    blurred = picture(renderer, stage, engine="lens", rays=256, supersample=2)[45, :, 0]
    radius_px = WIDTH * 50 / 36 * (0.05 / 0.8) * (1 / 5 - 1 / 20)

    def beyond(edge_px: float) -> DoubleArray:
        t = np.clip((np.arange(WIDTH) + 0.5 - edge_px) / radius_px, -1, 1)
        return np.asarray(0.5 + (np.arcsin(t) + t * np.sqrt(1 - t * t)) / np.pi)

    expected = sum(beyond(edge) - beyond(edge + 4) for edge in range(4, WIDTH, 8))  # stripes of four pixels
    assert radius_px > 2
    np.testing.assert_allclose(blurred[96:150], expected[96:150], atol=0.04)  # 256 rays, layers of half a pixel
    np.testing.assert_allclose(blurred[8:64], plain[45, 8:64], atol=0.02)


@pytest.mark.parametrize("fault", ["missing", "outside numbers", "orthographic"])
def test_a_depth_image_that_cannot_be_used_leaves_the_plate_flat(tmp_path: Path, fault: str) -> None:
    stage = relief_stage(tmp_path, [[2.0, 3], [4, 5]])
    camera = stage.GetPrimAtPath("/cam")
    if fault == "missing":
        camera.GetAttribute("backPlate:sky:depth:image").Set("nowhere.exr")
    elif fault == "orthographic":
        UsdGeom.Camera(camera).CreateProjectionAttr("orthographic")
    else:
        camera.GetAttribute("backPlate:sky:depth:normalizingFactor").Set(math.nan)
    reader = StageReader(stage)
    np.testing.assert_allclose(world_points(only_batch(reader.read(0)))[:, 2], -5)
    (finding,) = reader.findings
    assert finding.path == "/cam.backPlate:sky:depth:image"
    assert finding.message.endswith("it is flat")


def test_a_relief_stays_the_same_object_and_follows_a_change(tmp_path: Path) -> None:
    stage = relief_stage(tmp_path, [[2.0, 3], [4, 5]])
    reader = StageReader(stage)
    first = only_batch(reader.read(0))
    assert only_batch(reader.read(1)) is first
    stage.GetPrimAtPath("/cam").GetAttribute("backPlate:sky:depth:cameraSpaceOffset").Set(1.0)
    moved = only_batch(reader.read(1))
    np.testing.assert_allclose(world_points(moved)[:, 2], [-3, -4, -5, -6], rtol=1e-6)
    stage.GetPrimAtPath("/cam").GetAttribute("backPlate:sky:depth:image").Set("")
    np.testing.assert_allclose(world_points(only_batch(reader.read(1)))[:, 2], -5)
