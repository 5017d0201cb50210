"""A new engine is one class: it draws frames, the command line lists it, and its capabilities decide what is done around it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from render.engines import DrawRequest, Engine, check_settings, engine_class, engine_names, register, unregister
from render.errors import SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import spheres_over_checkerboard
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import Lens
from render.pictures.picture import apply_vignetting
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

GREEN = (0.0, 0.5, 0.0, 1.0)
SETTINGS = FrameSettings(12, 8, engine="toy", rays=2, supersample=1)


class Toy(Engine):
    """Paints the picture green, and remembers the f-numbers of its cameras."""

    name = "toy"
    summary = "paints everything green"
    has_rays = True
    is_sharp = True
    f_stops: list[float] = []  # noqa: RUF012 - the test reads it

    @classmethod
    def check_camera(cls, camera: Camera) -> None:
        if camera.lens.model == "seidel":
            raise SettingsError("engine toy can show no errors of a lens")

    def draw(self, request: DrawRequest) -> FloatArray:
        self.f_stops.append(request.camera.f_stop)
        return np.full((request.view.height, request.view.width, 4), GREEN, np.float32)


@pytest.fixture
def toy() -> Iterator[type[Toy]]:
    Toy.f_stops.clear()
    register(Toy)
    yield Toy
    unregister(Toy)


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


@pytest.mark.gl
def test_it_draws_frames_and_their_albedo(renderer: FrameRenderer, toy: type[Toy]) -> None:
    frame = renderer.render(*spheres_over_checkerboard(), replace(SETTINGS, aovs=("color", "albedo", "depth")))
    assert (frame.color == np.float32(GREEN)).all()
    assert (frame.aovs["albedo"] == np.float32(GREEN[:3])).all()
    assert np.isfinite(frame.aovs["depth"]).any()


@pytest.mark.gl
def test_a_sharp_engine_gets_a_closed_iris(renderer: FrameRenderer, toy: type[Toy]) -> None:
    scene, camera = spheres_over_checkerboard()
    assert camera.f_stop > 0
    renderer.render(scene, camera, SETTINGS)
    assert toy.f_stops == [0.0]


@pytest.mark.gl
def test_its_refusal_of_a_lens_comes_before_it_draws(renderer: FrameRenderer, toy: type[Toy]) -> None:
    scene, camera = spheres_over_checkerboard()
    with pytest.raises(SettingsError, match="toy can show no errors"):
        renderer.render(scene, replace(camera, lens=Lens("seidel")), SETTINGS)
    assert toy.f_stops == []


@pytest.mark.parametrize(("traces_lens", "light"), [(False, 0.25), (True, 0.5)])
def test_the_light_that_a_lens_takes_is_taken_once(
    traces_lens: bool, light: float, toy: type[Toy], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(toy, "traces_lens", traces_lens)
    _, camera = spheres_over_checkerboard()
    radiance = np.full((8, 12, 4), 0.5, np.float32)
    apply_vignetting(radiance, replace(camera, lens=Lens(transmittance=0.5)), SETTINGS)
    assert (radiance[..., :3] == light).all()


def test_motion_by_velocities_is_for_engines_that_take_it(toy: type[Toy], monkeypatch: pytest.MonkeyPatch) -> None:
    moving = replace(SETTINGS, motion=4, motion_by="velocities")
    with pytest.raises(SettingsError, match="the toy engine draws every moment by itself"):
        check_settings(moving)
    monkeypatch.setattr(toy, "takes_velocities", True)
    check_settings(moving)


@pytest.mark.gl
def test_record_draws_by_it(toy: type[Toy], pullfocus: Command, tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)
    assert pullfocus("record", shot, tmp_path / "f.exr", "--engine", "toy", *small()).status == 0
    pixels = OpenImageIO.ImageBuf(str(tmp_path / "f.exr"), 0, 0).get_pixels(OpenImageIO.FLOAT)
    np.testing.assert_allclose(pixels, np.broadcast_to(GREEN, pixels.shape))


def test_help_lists_it_with_its_summary_and_among_those_with_rays(toy: type[Toy], pullfocus: Command) -> None:
    text = " ".join(pullfocus("record", "--help").out.split())
    assert "toy paints everything green" in text
    assert "of the engines lens, accumulation, pinhole, toy" in text


def test_an_engine_that_was_taken_out_is_unknown(toy: type[Toy], pullfocus: Command, tmp_path: Path) -> None:
    unregister(Toy)
    shot = write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)
    ended = pullfocus("record", shot, tmp_path / "f.png", "--engine", "toy", *small())
    assert ended.status != 0
    assert f"engine must be one of {', '.join(engine_names())}, got 'toy'" in ended.err
    register(Toy)


def test_two_engines_of_one_name_are_refused(toy: type[Toy]) -> None:
    class Other(Toy):
        """A second engine of the same name."""

    with pytest.raises(ValueError, match="two engines of the name toy"):
        register(Other)
    assert engine_class(SETTINGS) is toy
