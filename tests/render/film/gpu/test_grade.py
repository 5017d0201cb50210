"""The picture that the device develops is the one that the processor develops for files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import pytest

from render.errors import SettingsError
from render.film import Cdl, Grade, develop, list_displays, project
from render.film.gpu.grade import DisplayPass
from render.frame import FrameRenderer
from render.model.arrays import FloatArray
from tests.render.kits.colours import OWN_CONFIG, chart

pytestmark = pytest.mark.gl

ACES_2 = "ocio://studio-config-v5.0.0_aces-v2.1_ocio-v2.6"
ACES_1 = "ocio://studio-config-v2.1.0_aces-v1.3_ocio-v2.3"
GRADES = [
    Grade(),
    Grade(display="Rec.1886 Rec.709 - Display"),
    Grade(display="Gamma 2.6 P3-D65 - Display"),
    Grade(display="Rec.2100-PQ - Display", view="ACES 2.0 - HDR 1000 nits (Rec.2020)"),
    Grade(view="Un-tone-mapped"),
    Grade(view="Raw"),
    Grade(ACES_1, view="ACES 1.0 - SDR Video"),
    Grade(look="ACES 1.3 Reference Gamut Compression"),
    Grade(cdl=Cdl((1.1, 0.95, 0.9), (0.02, 0.0, -0.01), (1.0, 1.05, 1.1), 0.8)),
]


@pytest.fixture
def display_pass(renderer: FrameRenderer) -> Iterator[DisplayPass]:
    made = DisplayPass(renderer.graphics.ctx)
    yield made
    made.release()


@pytest.mark.parametrize(
    "grade", GRADES, ids=lambda g: f"{g.display_name}, {g.view_name}, {g.look}, {g.cdl.saturation}"
)
def test_the_device_agrees_with_the_processor(display_pass: DisplayPass, grade: Grade) -> None:
    shown = display_pass.develop(chart(), 1.25, grade)

    assert shown.dtype == np.float32
    assert shown.shape == chart().shape
    assert np.abs(shown - develop(chart(), 1.25, grade)).max() < 1 / 255
    assert np.ptp(shown) > 0.7, "the chart has dark and light; 1000 cd/m² are 0.75 in PQ"


def written_tables(folder: Path, interpolation: str) -> Grade:
    """A look of two tables: a curve, and a cube that is different along each of its axes."""
    curve = np.linspace(0, 1, 64) ** np.array([[0.8], [1.0], [1.3]])
    (folder / "curve.cube").write_text("LUT_1D_SIZE 64\n" + "".join(f"{r} {g} {b}\n" for r, g, b in curve.T))
    blue, green, red = np.meshgrid(*[np.linspace(0, 1, 9)] * 3, indexing="ij")
    cube = np.stack([red**1.5, 0.7 * green + 0.3 * red * blue, np.sqrt(blue)], axis=-1).reshape(-1, 3)
    (folder / "cube.cube").write_text("LUT_3D_SIZE 9\n" + "".join(f"{r} {g} {b}\n" for r, g, b in cube))
    steps = ", ".join(
        f"!<FileTransform> {{src: {name}.cube, interpolation: {interpolation}}}" for name in ("curve", "cube")
    )
    look = f"name: Show, process_space: Studio Linear, transform: !<GroupTransform> {{children: [{steps}]}}"
    file = folder / "own.ocio"
    file.write_text(f"{OWN_CONFIG}\nlooks: [!<Look> {{{look}}}]\n")
    return Grade(str(file), look="Show")


@pytest.mark.parametrize("interpolation", ["linear", "tetrahedral"])
def test_tables_are_looked_up_alike(display_pass: DisplayPass, interpolation: str, tmp_path: Path) -> None:
    grade = written_tables(tmp_path, interpolation)
    light = np.random.default_rng(5).uniform(-0.1, 1.2, (40, 30, 3)).astype(np.float32)

    shown = display_pass.develop(light, 1.0, grade)

    assert np.abs(shown - develop(light, 1.0, grade)).max() < 1 / 255
    assert np.abs(shown - np.clip(light, 0, 1)).max() > 0.2


def test_a_print_is_projected_alike(display_pass: DisplayPass) -> None:
    light = np.random.default_rng(6).uniform(0, 1.1, (16, 16, 3)).astype(np.float32)
    grade = Grade(display="Display P3 - Display", cdl=Cdl(saturation=0.7))

    shown = display_pass.develop(light, 1.0, grade, "lin_rec709")

    assert np.abs(shown - project(light, grade, "lin_rec709")).max() < 1 / 255


def test_broken_light_does_not_break_the_picture(display_pass: DisplayPass) -> None:
    light = np.array([[[np.nan] * 3, [np.inf] * 3, [1e30] * 3, [-np.inf, 0.5, np.nan]]], np.float32)

    shown = display_pass.develop(light, 1.0, Grade())

    np.testing.assert_allclose(shown, develop(light, 1.0, Grade()), atol=1 / 255)


def test_coverage_is_left_out(display_pass: DisplayPass) -> None:
    light = np.concatenate([chart(), np.full((*chart().shape[:2], 1), 0.5, np.float32)], axis=2)

    np.testing.assert_array_equal(
        display_pass.develop(light, 1.0, Grade()), display_pass.develop(chart(), 1.0, Grade())
    )


def test_textures_stay_on_the_device_and_may_be_of_bytes(display_pass: DisplayPass, renderer: FrameRenderer) -> None:
    ctx, light = renderer.graphics.ctx, chart()
    height, width = light.shape[:2]
    source = ctx.texture((width, height), 3, light.tobytes(), dtype="f4")
    target = ctx.texture((width, height), 4)

    display_pass.run(source, target, 1.0, Grade())
    shown: FloatArray = np.frombuffer(target.read(), np.uint8).reshape(height, width, 4)[..., :3] / np.float32(255)
    source.release()
    target.release()

    # 0.5 of a step is the nearest byte; OpenGL leaves the rounding to the device, and NVIDIA's stay within 0.6
    assert np.abs(shown - develop(light, 1.0, Grade())).max() <= 0.6 / 255 + 1e-4


def test_more_grades_than_are_kept_do_each_their_own(display_pass: DisplayPass) -> None:
    views = list_displays()["sRGB - Display"][:3]
    grades = [
        Grade(display=name, view=view) for name in list_displays() for view in views if view in list_displays()[name]
    ]
    colour = np.array([[[0.6, 0.2, 0.1]]], np.float32)
    assert len(grades) > 10

    for grade in [*grades[:10], *grades[:2]]:
        np.testing.assert_allclose(
            display_pass.develop(colour, 1.0, grade), develop(colour, 1.0, grade), atol=1 / 255, err_msg=str(grade)
        )


def test_a_cdl_that_moves_in_each_frame_is_compiled_once(renderer: FrameRenderer) -> None:
    counted = CountingContext(renderer.graphics.ctx)
    display_pass = DisplayPass(counted)  # type: ignore[arg-type]
    light = np.random.default_rng(7).uniform(-0.1, 2, (16, 16, 3)).astype(np.float32)

    for step in range(1, 6):
        cdl = Cdl((1 + step / 10, 1, 1), (0, -step / 50, 0), (1, 1, 1 + step / 5), 1 - step / 10)
        shown = display_pass.develop(light, 1.0, Grade(cdl=cdl))
        assert np.abs(shown - develop(light, 1.0, Grade(cdl=cdl))).max() < 1 / 255
    display_pass.release()

    assert counted.compiled == 1


class CountingContext:
    """A context that counts what it compiles."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self.compiled = 0

    def compute_shader(self, source: str) -> moderngl.ComputeShader:
        self.compiled += 1
        return self._ctx.compute_shader(source)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ctx, name)


def test_impossible_light_is_refused(display_pass: DisplayPass) -> None:
    with pytest.raises(SettingsError, match=r"light must be \(height, width, 3\)"):
        display_pass.develop(np.zeros((4, 4), np.float32), 1.0, Grade())
    with pytest.raises(SettingsError, match="exposure scale must be a finite number from 0 up"):
        display_pass.develop(chart(), float("nan"), Grade())
