"""Ranges of frames: the grammar of Open Job Description, and its refusals."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import SettingsError
from service.jobs.frame_ranges import MAX_FRAMES, format_frames, parse_frames


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        ("7", [7]),
        ("1-4", [1, 2, 3, 4]),
        ("1-10:3", [1, 4, 7, 10]),
        ("1-10:2,15", [1, 3, 5, 7, 9, 15]),
        ("15,1-3", [1, 2, 3, 15]),
        ("-3--1", [-3, -2, -1]),
        ("-2-1", [-2, -1, 0, 1]),
        ("9-1:-4", [1, 5, 9]),
        (" 1 - 3 : 2 , 8 ", [1, 3, 8]),
        ("5-5", [5]),
    ],
)
def test_frames_of_a_range(text, frames):
    assert parse_frames(text) == frames


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "like 1-10:2,15"),
        ("1,,2", "like 1-10:2,15"),
        ("1-", "like 1-10:2,15"),
        ("1.5", "like 1-10:2,15"),
        ("١-٣", "like 1-10:2,15"),
        ("1-10:0", "does not lead from"),
        ("10-1", "does not lead from"),
        ("1-10:-1", "does not lead from"),
        ("1-5,3", "frame 3 comes twice"),
        (f"1-{MAX_FRAMES + 1}", "10,000 frames at most, got 10,001"),
        ("0-9999999999", "lie between"),
        ("1-999999999,-999999999-0", "frames at most"),
    ],
)
def test_what_is_no_range_is_refused(text, said):
    with pytest.raises(SettingsError, match=said) as refused:
        parse_frames(text)
    assert refused.value.path == "frames"


@given(st.sets(st.integers(-500, 500), min_size=1))
def test_a_range_that_is_written_reads_the_same(frames):
    assert parse_frames(format_frames(sorted(frames))) == sorted(frames)


def test_a_range_is_written_short():
    assert format_frames([1, 2, 3, 7, 9, 10]) == "1-3,7,9-10"
    assert format_frames([1, 3, 5, 7, 8, 20, 40]) == "1-7:2,8,20,40"
