"""Resolution of layers: as requested, or as suits the rays and the size of the picture."""

from __future__ import annotations

import numpy as np
import pytest

from render.engines.shared.layer_scale import MOST_LINES, blurred_scale, texel_offset, traced_scale
from render.model.frame_settings import FrameSettings


@pytest.mark.parametrize(
    ("changes", "moments", "expected"),
    [
        ({"rays": 1}, 1, 2),
        ({"rays": 24}, 1, 3),
        ({"rays": 100}, 1, 4),
        ({"rays": 4, "noise": 0.01}, 1, 4),
        ({"rays": 100}, 16, 2),
        ({"rays": 100, "supersample": 1.5}, 16, 1.5),
        ({"rays": 100, "width": 1920, "height": 1080}, 1, 4),
        ({"rays": 100, "width": 3840, "height": 2160}, 1, 3),
        ({"rays": 100, "width": 7680, "height": 4320}, 1, 2),
    ],
)
def test_layers_are_as_fine_as_rays_and_size_allow(changes: dict[str, float], moments: int, expected: float) -> None:
    settings = FrameSettings(**changes)  # type: ignore[arg-type]
    assert traced_scale(settings, moments) == expected
    assert expected == 2 or settings.supersample > 0 or expected * min(settings.width, settings.height) <= MOST_LINES


def test_engines_that_blur_one_picture_have_two_pixels_unless_asked() -> None:
    assert blurred_scale(FrameSettings(rays=100)) == 2
    assert blurred_scale(FrameSettings(supersample=1)) == 1


def test_offsets_of_moments_fill_a_layer_pixel_evenly() -> None:
    """Sixteen moments have four offsets, far from each other and within half a pixel, and a single picture has none."""
    offsets = np.unique([texel_offset(FrameSettings(), (part, 16)) for part in range(16)], axis=0)
    assert offsets.shape == (4, 2)
    assert np.abs(offsets).max() <= 0.5
    apart = np.linalg.norm(offsets[:, None] - offsets, axis=-1)[~np.eye(4, dtype=bool)]
    assert apart.min() > 0.35
    assert texel_offset(FrameSettings(), (0, 1)) == (0.0, 0.0)
    assert texel_offset(FrameSettings(supersample=2), (3, 4)) == (0.0, 0.0)
