"""One refractive index for each channel, in place of dispersion (Lee, Eisemann & Seidel 2010, section 5.3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import CameraError
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.camera import Camera
from render.model.lens import Lens
from render.model.scene import Batch, Dome, Material, Scene
from render.optics.glass import CHANNELS_NM, refractive_index
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import first_order
from render.stage.camera.lenses import make_lens
from tests.render.kits.lenses import DOUBLE_GAUSS
from usd_schemas import LensData
from usd_schemas.settings import Prescription as PrescriptionData

SINGLET = PrescriptionData(radius=(50.0, -50.0), thickness=(2.0, 0.0), index=(1.5168, 1.0), abbe=(64.17, 0.0))
F_PX = 50 / 12.8 * 128
HALF_SLOPE = 0.004


def singlet(*indices: float) -> Lens:
    data = LensData(model="spherical", prescription=SINGLET, channel_index=(indices[0], indices[1], indices[2]))
    return make_lens(replace(data, f_stop_range=(4.0, 0.0)), "/cam")


def indices_of(lens: Lens, surface: int = 0) -> list[float]:
    assert lens.prescription is not None
    return [refractive_index(lens.prescription.surfaces[surface].glass, nm) for nm in CHANNELS_NM]


def spreads_px(renderer: FrameRenderer, lens: Lens) -> list[float]:
    """Standard deviation of each channel's light of a glowing square, which has one of its own."""
    glow = Material(name="glow", base_color=(0, 0, 0), emissive=(3000.0, 3000.0, 3000.0))
    half_m = HALF_SLOPE * 4
    square = rectangle((0, 0, -4.0), (half_m, 0, 0), (0, half_m, 0))
    scene = Scene((Batch(square, glow, np.eye(4)[None], double_sided=True),), (), Dome((0, 0, 0), np.eye(4)), ("/p",))
    camera = Camera(np.eye(4), 50.0, 12.8, 9.6, f_stop=8.0, focus_distance_m=4.0, near_m=0.1, lens=lens)
    picture = renderer.render(scene, camera, FrameSettings(128, 96, rays=256)).color
    x = np.arange(128) + 0.5
    found = []
    for channel in range(3):
        light = picture[..., channel].astype(np.float64).sum(axis=0)
        mean = (x * light).sum() / light.sum()
        variance = ((x - mean) ** 2 * light).sum() / light.sum() - (F_PX * HALF_SLOPE) ** 2 / 3
        found.append(float(np.sqrt(max(variance, 0.0))))
    return found


def test_a_single_glass_has_the_indices_that_are_drawn() -> None:
    assert indices_of(singlet(1.50, 1.52, 1.56)) == pytest.approx([1.50, 1.52, 1.56])
    between = refractive_index(singlet(1.50, 1.52, 1.56).prescription.surfaces[0].glass, 580.0)  # type: ignore[union-attr]
    assert between == pytest.approx(1.51)
    plain = make_lens(LensData(model="spherical", prescription=SINGLET), "/cam")
    assert indices_of(plain) != pytest.approx([1.50, 1.52, 1.56], abs=1e-3)


def test_all_glasses_of_a_lens_bend_a_colour_by_the_same_factor() -> None:
    """So the focal lengths of the colours are as 1 / (N - 1), but for the thickness of the elements."""
    rows = DOUBLE_GAUSS.prescription.surfaces
    data = PrescriptionData(
        radius=tuple(s.radius_mm for s in rows),
        thickness=tuple(s.thickness_mm for s in rows),
        index=tuple(s.glass.index for s in rows),
        abbe=tuple(60.0 if s.glass.index > 1 else 0.0 for s in rows),
        clear_diameter=tuple(2 * s.semi_diameter_mm for s in rows),
        stop_surface=next(i for i, s in enumerate(rows) if s.is_stop),
    )
    first = rows[0].glass.index
    drawn = (first - 0.02, first, first + 0.03)
    lens = make_lens(LensData(model="prescription", prescription=data, channel_index=drawn), "/cam")
    assert lens.prescription is not None
    for surface in lens.prescription.surfaces:
        own = [refractive_index(surface.glass, nm) - 1 for nm in CHANNELS_NM]
        if surface.glass.index != 1:
            assert np.array(own) / own[1] == pytest.approx((np.array(drawn) - 1) / (first - 1))
    whole = complete_prescription(lens.prescription)
    assert whole.surfaces[-1].thickness_mm > 0
    assert first_order(whole).focal_length_mm > 0


def test_equal_indices_draw_no_fringes(renderer: FrameRenderer) -> None:
    red, green, blue = spreads_px(renderer, singlet(1.5, 1.5, 1.5))
    assert (red, blue) == pytest.approx((green, green), abs=0.02)


def test_each_channel_is_out_of_focus_by_its_index(renderer: FrameRenderer) -> None:
    """The square is in focus at the d line; a channel of more power focuses nearer by ``(N - N_d) / (N_d - 1) / f``."""
    lens = singlet(1.46, 1.52, 1.60)
    assert lens.prescription is not None
    at_d = lens.prescription.surfaces[0].glass.index
    radius_m = 0.05 / 16
    expected = [F_PX * radius_m / 2 * abs(n - at_d) / (at_d - 1) / 0.05 for n in (1.46, 1.52, 1.60)]
    assert spreads_px(renderer, lens) == pytest.approx(expected, rel=0.06, abs=0.15)


@pytest.mark.parametrize("indices", [(1.0, 1.5, 1.5), (1.5, 0.0, 1.5), (1.5, 1.5, 11.0), (-1.5, 1.5, 1.5)])
def test_indices_that_no_glass_has_are_refused(indices: tuple[float, float, float]) -> None:
    with pytest.raises(CameraError, match=r"lens:expressive:channelIndex .* three numbers above 1"):
        singlet(*indices)
