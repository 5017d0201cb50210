"""Contact sheets of stored frames: which frames are on them, and where."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from render.drawing.frame_sheet import MOST_PICTURES, choose_frames, draw_frame_sheet
from render.errors import InputError
from render.output.stills import read_still, shrink_picture


def plain(level: int | tuple[int, int, int], width: int = 64, height: int = 36) -> np.ndarray:
    return np.full((height, width, 3), level, np.uint8)


def sheet_of(pictures: list[tuple[int, np.ndarray]], folder: Path, title: str = "night tram") -> np.ndarray:
    path = folder / "sheet.png"
    path.write_bytes(draw_frame_sheet(title, pictures, len(pictures)))
    return np.asarray(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8))[..., :3]


def test_a_short_render_is_on_the_sheet_whole() -> None:
    assert choose_frames([3, 5, 9]) == [3, 5, 9]


@pytest.mark.parametrize("count", [MOST_PICTURES + 1, 1000, 10_000])
def test_of_a_long_render_frames_at_even_distances_are_chosen(count: int) -> None:
    chosen = choose_frames(range(1, count + 1))
    assert (len(set(chosen)), chosen[0], chosen[-1]) == (MOST_PICTURES, 1, count)
    steps = np.diff(chosen)
    assert steps.min() >= 1
    assert steps.max() - steps.min() <= 1


def test_pictures_stand_row_after_row_pixel_for_pixel(tmp_path: Path) -> None:
    levels = list(range(60, 60 + 10 * 8, 10))
    sheet = sheet_of([(frame, plain((level, 0, 200))) for frame, level in enumerate(levels, start=1)], tmp_path)
    places = []
    for level in levels:
        rows, columns = np.nonzero((sheet == (level, 0, 200)).all(axis=2))  # no colour of the text
        corner = (rows.min(), columns.min())
        places.append(corner)
        assert (sheet[corner[0] : corner[0] + 36, corner[1] : corner[1] + 64] == (level, 0, 200)).all()
    assert places == sorted(places)
    assert len({row for row, _ in places}) > 1


def test_each_picture_has_its_number(tmp_path: Path) -> None:
    one, other = (sheet_of([(frame, plain(100))], tmp_path) for frame in (7, 8888))
    rows, _ = np.nonzero((one != other).any(axis=2))
    picture_rows, _ = np.nonzero((one == 100).all(axis=2))
    assert rows.min() > picture_rows.max()


def test_large_pictures_are_reduced_in_their_shape() -> None:
    y = np.linspace(0, 255, 540).astype(np.uint8)
    small = shrink_picture(np.broadcast_to(y[:, None, None], (540, 960, 3)))
    assert small.shape == (135, 240, 3)
    np.testing.assert_allclose(small[67].mean(), 127, atol=2)
    assert shrink_picture(plain(9)).shape == (36, 64, 3)


def test_a_long_title_and_one_pixel_fit(tmp_path: Path) -> None:
    sheet = sheet_of([(1, plain(100, 1, 1))], tmp_path, "x\n" * 250)
    assert sheet.shape[1] < 200


@pytest.mark.parametrize("content", [b"", b"junk", b"\x89PNG\r\n\x1a\n"])
def test_a_damaged_still_is_one_clear_error(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "1.1.png"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"1\.1\.png cannot be read"):
        read_still(path)
