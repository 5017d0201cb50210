"""Facts burnt into the corners of pictures: their words, and that they change nothing else."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from render.drawing.burn_in import LINE_PX, draw_burn_in
from render.errors import SettingsError
from render.film.settings import FilmSettings
from render.film.stock import camera_stock
from render.model.burn_in import FACTS, BurnIn, Fact, read_facts
from render.model.camera import Camera
from render.model.lens import Lens
from render.output.burn_in import burnt_lines
from render.output.metadata import FrameMetadata

CAMERA = Camera(
    np.eye(4),
    focal_length_mm=58.04,
    f_stop=2.8,
    focus_distance_m=3.424,
    lens=Lens(name="Biotar 58/2"),
    path="/World/main_cam",
)
METADATA = FrameMetadata(CAMERA, time=1500, stage="tram.usda", film=None)
GREY = np.full((540, 960, 3), 0.5, np.float32)


def words(*facts: Fact, metadata: FrameMetadata = METADATA) -> list[str]:
    lines = burnt_lines(BurnIn(facts), metadata)
    return [line for corner in lines.values() for line in corner]


def test_each_corner_has_its_facts() -> None:
    burn_in = BurnIn(FACTS, revision="5a302e56c1d04f7b", day="2026-11-08")
    stock = camera_stock("velvia_50")
    filmed = replace(METADATA, film=FilmSettings("reversal", stock))
    assert burnt_lines(burn_in, filmed) == {
        "top_left": ("tram.usda", "main_cam"),
        "top_right": ("Biotar 58/2", "58 mm · f/2.8 · focus 3.42 m · focus 11′ 3″"),
        "bottom_left": ("Fuji Velvia 50", "rev 5a302e56 · 2026-11-08"),
        "bottom_right": ("frame 1500 · 00:01:02:12",),
    }


def test_time_codes_are_at_the_rate_of_movies() -> None:
    """A frame a time code, as movies have them, whatever rate the shot is to be played at."""
    assert words("timecode", metadata=replace(METADATA, frames_per_second=24, time_codes_per_second=48)) == [
        "00:00:31:12"
    ]


def test_a_long_name_is_shortened_to_the_room() -> None:
    long = replace(METADATA, camera=replace(CAMERA, lens=Lens(name="x" * 100_000)))
    shown, cut = (draw_burn_in(GREY, BurnIn(("lens",)), one) != GREY for one in (METADATA, long))
    assert cut.any(axis=(0, 2)).sum() > shown.any(axis=(0, 2)).sum()
    assert not cut[:, : GREY.shape[1] // 2].any()


def test_facts_that_there_are_not_are_left_out() -> None:
    timeless = replace(METADATA, time=math.nan, camera=replace(CAMERA, path=""))
    assert words("camera", "film", "frame", "timecode", "revision", metadata=timeless) == ["framing camera"]


@pytest.mark.parametrize(
    ("metadata", "said"),
    [
        (replace(METADATA, t_stop=3.1305), "T 3.13 · focus 11′ 3″"),
        (replace(METADATA, camera=replace(CAMERA, f_stop=0.0)), "pinhole · focus 11′ 3″"),
        (replace(METADATA, camera=replace(CAMERA, focus_distance_m=0.0)), "f/2.8 · focus ∞"),
        (replace(METADATA, camera=replace(CAMERA, focus_distance_m=0.6)), "f/2.8 · focus 1′ 11.6″"),
        (replace(METADATA, camera=replace(CAMERA, focus_distance_m=40.0)), "f/2.8 · focus 131′"),
    ],
)
def test_stops_and_feet_are_worded(metadata: FrameMetadata, said: str) -> None:
    assert words("stop", "focusFt", metadata=metadata) == [said]


def test_only_the_lines_of_the_facts_change() -> None:
    drawn = draw_burn_in(GREY, BurnIn(("lens", "stop", "frame", "timecode")), METADATA)
    changed = np.argwhere((drawn != GREY).any(axis=-1))
    upper, lower = changed[changed[:, 0] < 270], changed[changed[:, 0] >= 270]
    assert upper.min(axis=0)[0] == 0
    assert upper.max(axis=0).tolist() == [2 * LINE_PX - 1, 959]  # two lines, at the right edge
    assert lower.min(axis=0)[0] == 540 - LINE_PX
    assert lower.max(axis=0).tolist() == [539, 959]
    assert min(upper.min(axis=0)[1], lower.min(axis=0)[1]) > 0.52 * 960
    assert drawn.max() == pytest.approx(1, abs=0.01)  # white
    assert drawn.min() == pytest.approx(0.2, abs=0.01)  # on 60 % of black


def test_the_text_is_that_of_the_frame() -> None:
    burn_in = BurnIn(("shot", "frame"))
    at = {time: draw_burn_in(GREY, burn_in, replace(METADATA, time=time)) for time in (24, 25)}
    differ = np.argwhere((at[24] != at[25]).any(axis=-1))
    assert differ[:, 0].min() >= 540 - LINE_PX  # the shot's name is the same
    assert differ[:, 1].min() > 900  # so is all of the number but its last digit
    black = draw_burn_in(np.zeros_like(GREY), burn_in, METADATA)
    white = draw_burn_in(np.ones_like(GREY), burn_in, METADATA)
    text = black[..., :1] > 0.9
    np.testing.assert_allclose(white[np.broadcast_to(text, white.shape)], 1, atol=0.1)  # the same text on any picture


def test_long_names_leave_room_for_the_other_side() -> None:
    long = replace(METADATA, stage="a" * 400)
    drawn = draw_burn_in(GREY, BurnIn(("shot",)), long)
    assert np.argwhere((drawn != GREY).any(axis=-1))[:, 1].max() < 0.49 * 960
    tiny = np.full((6, 8, 3), 0.5, np.float32)
    assert draw_burn_in(tiny, BurnIn(FACTS), long).shape == tiny.shape


def test_unknown_facts_are_refused() -> None:
    with pytest.raises(SettingsError, match=r"no burn-in named 'tiemcode'.*timecode"):
        read_facts(("frame", "tiemcode"))
    assert read_facts(("timecode", "frame", "frame")) == ("frame", "timecode")
