"""Converged pictures go on where they were left, keep to their subject, and know their noise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.converged import VIEWS_PER_PART, accumulate_converged, trace_converged
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import posts_before_wall

VIEWS = 2 * VIEWS_PER_PART
SETTINGS = FrameSettings(48, 36, rays=VIEWS, shading="unlit")


def say(line: str) -> None:
    """Keep quiet."""


@pytest.mark.gl
def test_a_picture_that_was_left_goes_on_as_if_it_had_not_been(tmp_path: Path) -> None:
    scene, camera = posts_before_wall()
    parts = []
    with FrameRenderer() as renderer:
        whole = accumulate_converged(renderer, scene, camera, SETTINGS, tmp_path / "whole.npz", say=say)
        few = replace(SETTINGS, rays=VIEWS_PER_PART)
        half = accumulate_converged(renderer, scene, camera, few, tmp_path / "left.npz", say=parts.append)
        rest = accumulate_converged(renderer, scene, camera, SETTINGS, tmp_path / "left.npz", say=parts.append)
        kept = accumulate_converged(renderer, scene, camera, SETTINGS, tmp_path / "left.npz", say=parts.append)
        lens = renderer.render(scene, camera, replace(SETTINGS, rays=1024, supersample=4)).color

    assert (half.count, rest.count, kept.count) == (VIEWS_PER_PART, VIEWS, VIEWS)
    assert len(parts) == 2  # the last call draws nothing
    assert (rest.picture == whole.picture).all()
    assert (kept.sums == whole.sums).all()
    assert np.isnan(half.halves_psnr_db)
    noise_db = whole.halves_psnr_db + 6
    assert 30 < noise_db < 60
    assert psnr_db(whole.picture, lens) > 30


@pytest.mark.gl
def test_a_picture_of_another_camera_is_replaced(tmp_path: Path) -> None:
    scene, camera = posts_before_wall()
    few = replace(SETTINGS, rays=2)
    with FrameRenderer() as renderer:
        accumulate_converged(renderer, scene, camera, few, tmp_path / "a.npz", say=say)
        said: list[str] = []
        nearer = replace(camera, focus_distance_m=1.5)
        made = accumulate_converged(renderer, scene, nearer, few, tmp_path / "a.npz", say=said.append)
        (tmp_path / "a.npz").write_bytes(b"damaged")
        again = accumulate_converged(renderer, scene, nearer, few, tmp_path / "a.npz", say=said.append)
    assert len(said) == 2
    assert (again.picture == made.picture).all()


def test_rays_one_by_one_converge_to_the_same_picture(tmp_path: Path) -> None:
    scene, camera = posts_before_wall()
    settings = FrameSettings(16, 12, rays=8, shading="unlit")
    made = trace_converged(scene, camera, settings, tmp_path / "rays.npz", say=say)
    other = trace_converged(scene, camera, replace(settings, seed=7), tmp_path / "others.npz", say=say)
    assert made.count == 8
    assert made.picture.shape == (12, 16, 4)
    assert 18 < psnr_db(made.picture, other.picture) < 60
