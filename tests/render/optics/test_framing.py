"""Gates, the fields of view they have, and the frames within them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.model.camera import Camera
from render.optics.framing import FULL_FRAME_MM, Gate, field_of_view, framing_guide, framing_guides
from render.optics.view import PinholeView

SIDES = st.floats(1, 200)
GATES = st.builds(Gate, SIDES, SIDES, st.floats(1, 2), st.just((4000, 3000)))


def test_a_normal_lens_on_full_frame() -> None:
    view = field_of_view(Gate(*FULL_FRAME_MM), 50)
    found = (view.horizontal_rad, view.vertical_rad, view.diagonal_rad)
    assert np.degrees(found) == pytest.approx((39.6, 27.0, 46.8), abs=0.05)
    assert Gate(*FULL_FRAME_MM).crop_factor == Gate(*FULL_FRAME_MM).horizontal_crop_factor == 1


@given(GATES, st.floats(4, 1000))
def test_the_field_of_view_is_the_renderer_s(gate: Gate, lens_mm: float) -> None:
    """Directions through the edges of the picture, for apertures as the picture is stretched back."""
    camera = Camera(np.eye(4), lens_mm, gate.width_mm * gate.squeeze, gate.height_mm)
    view, field = PinholeView.from_camera(camera, 400, 300), field_of_view(gate, lens_mm)
    for angle, left, right in (
        (field.horizontal_rad, (0, 150), (400, 150)),
        (field.vertical_rad, (200, 0), (200, 300)),
        (field.diagonal_rad, (0, 0), (400, 300)),
    ):
        a, b = (view.ray(*at)[1] for at in (left, right))
        assert math.acos(a @ b / (np.linalg.norm(a) * np.linalg.norm(b))) == pytest.approx(angle, abs=1e-6)


@given(GATES, st.floats(4, 1000))
def test_the_crop_factor_keeps_the_field_of_view_on_full_frame(gate: Gate, lens_mm: float) -> None:
    full, own = Gate(*FULL_FRAME_MM), field_of_view(gate, lens_mm)
    assert field_of_view(full, lens_mm * gate.crop_factor).diagonal_rad == pytest.approx(own.diagonal_rad)
    assert field_of_view(full, lens_mm * gate.horizontal_crop_factor).horizontal_rad == pytest.approx(
        own.horizontal_rad
    )


@given(GATES)
def test_guides_fill_the_gate_and_have_their_shape(gate: Gate) -> None:
    for guide in framing_guides(gate):
        assert max(guide.width_share, guide.height_share) == 1
        assert guide.width_mm * gate.squeeze / guide.height_mm == pytest.approx(guide.aspect)
        assert guide.width_mm <= gate.width_mm
        assert guide.height_mm <= gate.height_mm
        assert guide.resolution == (round(4000 * guide.width_share), round(3000 * guide.height_share))


def test_scope_on_super_35_and_on_an_anamorphic_gate() -> None:
    super35 = framing_guide(Gate(24.89, 18.67), 2.39)
    assert (super35.name, super35.width_mm, super35.height_mm) == ("2.39:1", 24.89, pytest.approx(10.41, abs=0.01))
    # nearly all of the frame is used, which is what anamorphic lenses are for
    anamorphic = framing_guide(Gate(22.0, 18.59, 2.0), 2.39)
    assert anamorphic.width_share * anamorphic.height_share == pytest.approx(0.99, abs=0.01)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Gate(0, 24), "width of a gate must be a positive number, got 0"),
        (lambda: Gate(36, 24, math.inf), "squeeze of a gate must be a positive number, got inf"),
        (lambda: field_of_view(Gate(36, 24), -35), "focal length must be a positive number of mm, got -35"),
        (lambda: framing_guide(Gate(36, 24), math.nan), "aspect ratio of a frame must be a positive number, got nan"),
    ],
)
def test_impossible_gates_are_refused(make: object, words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        make()  # type: ignore[operator]
