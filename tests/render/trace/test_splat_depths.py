"""Depths, ids and focus maps of Gaussian splats: those where their opacity passes one half."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.layers.splats import LOW_PASS_PX2, project_splats
from render.model.arrays import DoubleArray
from render.model.lens import Lens, SeidelErrors
from render.model.scene import Batch, Material
from render.model.splats import LEAST_OPACITY, SplatBatch
from render.optics.view import PinholeView
from tests.render.kits.splats import CAMERA, SIZE, captured_set, plain_cloud, scene_of

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(*SIZE, rays=1, shading="unlit", aovs=("color", "depth", "coc", "prim_id", "face_id", "Neye"))
VIEW = PinholeView.from_camera(CAMERA, *SIZE)
MIDDLE = SIZE[1] // 2, SIZE[0] // 2


def wall(depth_m: float, role: str = "seen") -> Batch:
    """A wall across the left half of the view."""
    quad = rectangle((-5.0, 0, -depth_m), (5.0, 0, 0), (0, 5.0, 0))
    return Batch(quad, Material(), np.eye(4)[None], camera_role=role)  # type: ignore[arg-type]


def brute_depths(batches: tuple[SplatBatch, ...]) -> DoubleArray:
    """Depths of all pixels, one splat after another."""
    splats = project_splats(batches, VIEW, LOW_PASS_PX2)
    y, x = np.mgrid[: SIZE[1], : SIZE[0]] + 0.5
    passing, depths = np.ones(SIZE[::-1]), np.full(SIZE[::-1], np.inf)
    for record in splats.records[::-1].astype(np.float64):
        across = (x - record[0]) / record[4]
        down = (y - record[1] - record[5] * across) / record[6]
        opacity = record[3] * np.exp(-(across**2 + down**2) / 2)
        before = passing
        passing = before * (1 - np.where(opacity < LEAST_OPACITY, 0, opacity))
        depths[(before > 0.5) & (passing <= 0.5)] = 1 / (record[2] + VIEW.base_w)
    return depths


def test_depths_are_where_opacity_passes_one_half(renderer: FrameRenderer) -> None:
    """As of splats one after another, in a captured set of more splats than runs of runs."""
    scene = scene_of(captured_set(3_000))
    depth = renderer.render(scene, CAMERA, SETTINGS).aovs["depth"]
    expected = brute_depths(scene.splats)
    assert 0.2 < np.isfinite(expected).mean() < 0.95
    close = np.isclose(depth, expected, rtol=1e-5)
    assert close.mean() > 0.999  # rounding decides where opacity is one half


def test_strips_of_a_large_picture_are_those_of_the_whole(
    renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = scene_of(captured_set(500))
    whole = renderer.render(scene, CAMERA, SETTINGS).aovs["depth"]
    monkeypatch.setattr("render.trace.splats.depths.STRIP_PX", 7 * SIZE[0] + 5)
    np.testing.assert_array_equal(renderer.render(scene, CAMERA, SETTINGS).aovs["depth"], whole)


def test_a_click_gives_the_same_depth(renderer: FrameRenderer) -> None:
    scene = scene_of(captured_set(3_000), batches=(wall(2.5),))
    depth = renderer.render(scene, CAMERA, SETTINGS).aovs["depth"]
    for x, y in ((20, 30), (30, 32), (48, 33), (60, 36), (80, 50), (90, 5)):
        picked = renderer.pick(scene, CAMERA, *SIZE, x + 0.5, y + 0.5)
        assert depth[y, x] == pytest.approx(np.inf if picked is None else picked.depth_m, rel=1e-4)


@pytest.mark.parametrize(("behind_m", "expected", "prim"), [(1.7, 1.7, 1), (2.5, 2.0, 2)])
def test_the_nearer_of_splats_and_surfaces_counts(
    renderer: FrameRenderer, behind_m: float, expected: float, prim: int
) -> None:
    depths, opacities = [1.5, 2.0, 3.0], [0.3, 0.4, 0.9]  # 0.7, 0.42 and 0.04 let through
    cloud = plain_cloud([[0, 0, -z] for z in depths], [[1, 1, 0.01]] * 3, [[1, 1, 1]] * 3, opacities)
    scene = scene_of(cloud, batches=(wall(behind_m),))
    scene = replace(scene, prim_paths=("/surface", "/cloud"), splats=(replace(scene.splats[0], prim_id=1),))
    aovs = renderer.render(scene, replace(CAMERA, f_stop=2.8, focus_distance_m=3.0), SETTINGS).aovs
    left, right = (MIDDLE[0], MIDDLE[1] - 4), (MIDDLE[0], MIDDLE[1] + 4)
    assert aovs["depth"][left] == pytest.approx(expected, rel=1e-4)
    assert aovs["depth"][right] == pytest.approx(2.0, rel=1e-4)
    assert (aovs["prim_id"][left], aovs["prim_id"][right]) == (prim, 2)
    assert aovs["face_id"][right] == -1
    assert not aovs["Neye"][right].any()
    radius = VIEW.fx * 0.050 / 2 / 2.8 * (1 / 3 - 1 / 2)
    assert aovs["coc"][right] == pytest.approx(radius, rel=1e-3)


def test_focus_maps_are_the_aovs(renderer: FrameRenderer) -> None:
    """Through a lens whose chief rays bend, too."""
    scene, camera = scene_of(captured_set(500)), replace(CAMERA, f_stop=2.8)
    barrel = Lens("seidel", seidel=SeidelErrors(w311=60.0, reference_f_stop=2.8, reference_height_mm=15.0))
    pictures = []
    for lens in (Lens(), barrel):
        aovs = renderer.render(scene, replace(camera, lens=lens), SETTINGS).aovs
        focus = renderer.map_focus(scene, replace(camera, lens=lens), SETTINGS)
        np.testing.assert_array_equal(focus.depth_m, aovs["depth"])
        np.testing.assert_array_equal(focus.coc_px, aovs["coc"])
        assert np.isfinite(focus.depth_m).any()
        pictures.append(focus.depth_m)
    assert not np.array_equal(*pictures)


def test_splats_count_before_holdouts_and_not_behind(renderer: FrameRenderer) -> None:
    for depth_m, expected in ((1.5, 1.5), (3.0, np.inf)):
        cloud = plain_cloud([[0, 0, -depth_m]], [[1, 1, 0.01]], [[1, 1, 1]], [0.9])
        aovs = renderer.render(scene_of(cloud, batches=(wall(2.0, "holdout"),)), CAMERA, SETTINGS).aovs
        assert aovs["depth"][MIDDLE[0], MIDDLE[1] - 4] == pytest.approx(expected, rel=1e-4)
