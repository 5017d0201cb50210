"""Frame specifications mean what usdrecord means by them, and no two frames share a file."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from render.model.frame_spec import MAX_FRAMES, every_frame, frame_file_names, parse_frames


@pytest.mark.parametrize(
    ("spec", "frames"),
    [
        ("7", [7]),
        ("1:4", [1, 2, 3, 4]),
        ("4:1", [4, 3, 2, 1]),
        ("1,5:9x2", [1, 5, 7, 9]),
        ("1:2x0.25", [1, 1.25, 1.5, 1.75, 2]),
        ("-3:-1", [-3, -2, -1]),
        ("9:1x-4", [9, 5, 1]),
        ("0:1x0.1", pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1])),
        (" 1 , 3 ", [1, 3]),
    ],
)
def test_both_ends_of_a_range_are_included(spec: str, frames: list[float]) -> None:
    assert parse_frames(spec) == frames


@pytest.mark.parametrize(
    "spec",
    ["", ",", "1:", "1:5x", "one", "1:9x0", "1:5x-1", "nan", "1:inf", "1e4", "1;2", "1:3xnan", "1:9x", "x2", "9" * 400],
)
def test_what_is_no_frame_specification_is_refused(spec: str) -> None:
    with pytest.raises(SettingsError, match="frames"):
        parse_frames(spec)


@pytest.mark.parametrize("spec", ["1:1000000000", "0:1x0.0000001", "1:60000,100001:160000", "1:" + "9" * 300])
def test_a_billion_frames_are_refused_at_once(spec: str) -> None:
    with pytest.raises(SettingsError, match=f"more than the {MAX_FRAMES:,}"):
        parse_frames(spec)


@pytest.mark.parametrize(
    ("start", "end", "frames"),
    [(1, 3, [1, 2, 3]), (0, 0, [0]), (5, 1, [5]), (-1, 0.5, [-1, 0]), (0.5, 2.5, [0.5, 1.5, 2.5])],
)
def test_a_shot_has_every_frame_from_its_first_to_its_last(start: float, end: float, frames: list[float]) -> None:
    assert every_frame(start, end) == frames


@pytest.mark.parametrize("end", [1e9, float("inf")])
def test_a_shot_of_a_billion_frames_is_refused_at_once(end: float) -> None:
    with pytest.raises(SettingsError, match="more than"):
        every_frame(1, end)


def test_a_frame_named_twice_is_refused() -> None:
    with pytest.raises(SettingsError, match="more than once"):
        parse_frames("1:5,3")


@pytest.mark.parametrize(
    ("pattern", "frames", "names"),
    [
        ("shot.exr", [12], ["shot.exr"]),
        ("shot.####.exr", [1, 12, 123456], ["shot.0001.exr", "shot.0012.exr", "shot.123456.exr"]),
        ("####/shot.##.png", [7], ["0007/shot.07.png"]),
        ("shot.###.##.exr", [12.5], ["shot.012.50.exr"]),
        ("shot.####.exr", [-3], ["shot.-003.exr"]),
    ],
)
def test_the_frame_number_goes_where_the_hashes_are(pattern: str, frames: list[float], names: list[str]) -> None:
    assert frame_file_names(pattern, frames) == names


@pytest.mark.parametrize(("pattern", "frames"), [("shot.exr", [1, 2]), ("shot.####.exr", [1, 1.25])])
def test_two_frames_never_share_a_file(pattern: str, frames: list[float]) -> None:
    with pytest.raises(SettingsError, match="place for"):
        frame_file_names(pattern, frames)


@given(st.lists(st.integers(-10_000, 10_000), min_size=1, max_size=50, unique=True))
def test_every_frame_has_its_own_file_whatever_the_width(frames: list[int]) -> None:
    assert len(set(frame_file_names("shot.#.exr", frames))) == len(frames)
