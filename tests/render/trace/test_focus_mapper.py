"""Focus maps: the AOVs of the picture, without the picture, and without drawing where only the focus changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import spheres_over_checkerboard
from render.layers.peel import Peeler
from render.model.camera import Camera
from render.model.lens import Lens, SeidelErrors
from tests.render.kits.lenses import PLANAR

SETTINGS = FrameSettings(96, 72, rays=1, aovs=("color", "depth", "coc"))
SCENE, CAMERA = spheres_over_checkerboard()
BARREL = SeidelErrors(w220=-20.0, w311=40.0, reference_f_stop=2.8, reference_height_mm=15.0)
LENSES = {
    "thin": Lens(),
    "seidel": Lens("seidel", seidel=BARREL),
    "prescription": Lens("prescription", prescription=PLANAR.prescription),
}


def through(lens: Lens, **values: float) -> Camera:
    return replace(CAMERA, focal_length_mm=50.0, f_stop=4.0, focus_distance_m=3.0, lens=lens, **values)  # type: ignore[arg-type]


@pytest.fixture
def draws(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[int, int]]]:
    """Sizes of the surfaces that are drawn."""
    sizes: list[tuple[int, int]] = []
    plain = Peeler.draw_surfaces

    def counted(peeler: Peeler, view: object) -> object:
        sizes.append(view.size)  # type: ignore[attr-defined]
        return plain(peeler, view)  # type: ignore[arg-type]

    monkeypatch.setattr(Peeler, "draw_surfaces", counted)
    return iter([sizes]).__next__()


@pytest.mark.parametrize("lens", LENSES)
def test_it_is_the_aovs_of_the_picture(renderer: FrameRenderer, lens: str) -> None:
    for camera in (through(LENSES[lens]), replace(through(LENSES[lens]), focus_distance_m=4.5, f_stop=2.8)):
        aovs = renderer.render(SCENE, camera, SETTINGS).aovs
        focus = renderer.map_focus(SCENE, camera, SETTINGS)
        np.testing.assert_array_equal(focus.coc_px, aovs["coc"])
        np.testing.assert_array_equal(focus.depth_m, aovs["depth"])
        assert focus.film_mm_per_px == camera.horizontal_aperture_mm / 96
        assert np.ptp(focus.coc_px) > 0.2


def test_it_is_all_sharp_where_the_engine_is(renderer: FrameRenderer) -> None:
    assert not renderer.map_focus(SCENE, through(Lens()), replace(SETTINGS, engine="pinhole")).coc_px.any()


def test_focus_and_stop_leave_the_surfaces(renderer: FrameRenderer, draws: list[tuple[int, int]]) -> None:
    scene = replace(SCENE)  # of which no depths are kept
    first = renderer.map_focus(scene, through(Lens()), SETTINGS)
    for change in ({"focus_distance_m": 5.0}, {"f_stop": 1.4}):
        changed = renderer.map_focus(scene, replace(through(Lens()), **change), SETTINGS)  # type: ignore[arg-type]
        assert not np.array_equal(changed.coc_px, first.coc_px)
    renderer.map_focus(scene, through(Lens()), SETTINGS, size=(48, 36), is_preview=True)
    renderer.map_focus(scene, through(Lens()), SETTINGS)
    assert draws == [(96, 72), (48, 36)]


def test_another_view_or_scene_is_drawn(renderer: FrameRenderer, draws: list[tuple[int, int]]) -> None:
    scene = replace(SCENE)
    renderer.map_focus(scene, through(Lens()), SETTINGS)
    near = renderer.map_focus(scene, replace(through(Lens()), focal_length_mm=80.0), SETTINGS)
    emptied = renderer.map_focus(replace(SCENE, batches=()), replace(through(Lens()), focal_length_mm=80.0), SETTINGS)
    assert len(draws) == 3
    assert np.isfinite(near.depth_m).any()
    assert np.isinf(emptied.depth_m).all()
