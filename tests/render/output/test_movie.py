"""Movies: read back by FFmpeg's decoder."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest

from render.errors import OutputError, SettingsError
from render.film import Grade
from render.model.camera import Camera
from render.output import FrameMetadata
from render.output.movie import MovieDescription, describe_movie, movie_rate, open_movie, time_code_of

RATE, PLAIN = Fraction(24), MovieDescription()
ENDINGS = ("mp4", "mov", "webm")
CODECS = {"mp4": ("h264", "yuv420p"), "mov": ("prores", "yuv422p10le"), "webm": ("vp9", "yuv420p")}
COLOURS = ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255), (0, 0, 0), (128, 128, 128), (200, 80, 30))
METADATA = FrameMetadata(
    Camera(np.eye(4), focal_length_mm=35, f_stop=2.8, focus_distance_m=3.2, path="/cam"), time=40, stage="shot.usda"
)


def write(path: Path, pictures: Any, description: MovieDescription = PLAIN, rate: Fraction = RATE) -> None:
    with open_movie(path, rate) as movie:
        for picture in pictures:
            movie.add(picture, description)


def plain(colour: Any, width: int = 64, height: int = 48) -> np.ndarray:
    return np.full((height, width, 3), colour, np.uint8)


def mean_colour(frame: av.VideoFrame) -> np.ndarray:
    """The mean colour by the definition of BT.709 (ITU-R BT.709-6, 3.2 to 3.5), from the mean of each plane."""
    bits = frame.format.components[0].bits
    planes = [np.frombuffer(plane, np.uint8 if bits == 8 else np.uint16) for plane in frame.planes]
    widths = [plane.line_size // (1 if bits == 8 else 2) for plane in frame.planes]
    means = [
        samples.reshape(-1, width)[: plane.height, : plane.width].mean() / 2 ** (bits - 8)
        for samples, width, plane in zip(planes, widths, frame.planes, strict=True)
    ]
    y, blue, red = (means[0] - 16) / 219, (means[1] - 128) / 224, (means[2] - 128) / 224
    r, b = y + 1.5748 * red, y + 1.8556 * blue
    return 255 * np.array([r, (y - 0.2126 * r - 0.0722 * b) / 0.7152, b])


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_movie_holds_every_picture_with_its_size_and_rate(ending: str, tmp_path: Path) -> None:
    path, rate = tmp_path / f"a.{ending}", Fraction(24000, 1001)
    write(path, [plain(colour) for colour in COLOURS], rate=rate)

    with av.open(str(path)) as movie:
        stream = movie.streams.video[0]
        frames = list(movie.decode(stream))
        assert (stream.codec.name, frames[0].format.name) == CODECS[ending]
        assert (len(frames), stream.width, stream.height) == (len(COLOURS), 64, 48)
        # WebM counts whole milliseconds, so that its rate is an estimate.
        assert float(stream.average_rate) == pytest.approx(float(rate), rel=1e-9 if ending != "webm" else 1e-3)


@pytest.mark.parametrize("ending", ENDINGS)
def test_decoded_colours_are_those_of_the_pictures(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{ending}"
    write(path, [plain(colour) for colour in COLOURS])
    with av.open(str(path)) as movie:
        means = [mean_colour(frame) for frame in movie.decode(video=0)]
    # Half a level of limited-range chroma is 0.5 * 1.86 * 255 / 224 = 1.06 levels of blue; coding adds to it.
    np.testing.assert_allclose(means, COLOURS, atol=2)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_movie_is_tagged_as_limited_bt709(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{ending}"
    write(path, [plain((9, 99, 199))], MovieDescription(title="night tram", comment="35 mm f/2.8"))
    with av.open(str(path)) as movie:
        frame = next(movie.decode(video=0))
        # ITU-T H.273: 1 is BT.709 for primaries, transfer and matrix; FFmpeg's 1 is the limited range.
        tags = (frame.color_primaries, frame.color_trc, frame.colorspace, frame.color_range)
        assert tags == (1, 1, 1, 1)
        told = {name.lower(): value for name, value in movie.metadata.items()}
    assert (told["title"], told["comment"]) == ("night tram", "35 mm f/2.8")


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_title_of_any_characters_is_one_line(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{ending}"
    write(path, [plain(0)], MovieDescription(title="Straßenbahn\nnull\0 \udcff"))
    with av.open(str(path)) as movie:
        assert movie.metadata["title"] == r"Straßenbahn\nnull\x00 \udcff"


@pytest.mark.parametrize("ending", ["mp4", "mov"])
def test_a_movie_starts_at_its_time_code(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{ending}"
    write(path, [plain(0), plain(9)], describe_movie(METADATA, [40, 41], RATE))
    with av.open(str(path)) as movie:
        assert movie.streams.video[0].metadata["timecode"] == "00:00:01:16"


@pytest.mark.parametrize("ending", ENDINGS)
def test_odd_sizes_repeat_the_last_column_and_row(ending: str, tmp_path: Path) -> None:
    picture = plain(60, 31, 17)
    picture[-1], picture[:, -1] = 180, 180
    path = tmp_path / f"a.{ending}"
    write(path, [picture])
    with av.open(str(path)) as movie:
        luma = next(movie.decode(video=0)).reformat(format="gray").to_ndarray().astype(float)
    assert luma.shape == (18, 32)
    np.testing.assert_allclose(luma[16:], np.mean(luma[16:]), atol=6)
    np.testing.assert_allclose(luma[:, 30:], np.mean(luma[:, 30:]), atol=6)


@pytest.mark.parametrize("ending", ENDINGS)
def test_the_same_pictures_give_the_same_bytes(ending: str, tmp_path: Path) -> None:
    pictures = np.random.default_rng(0).integers(0, 256, (3, 48, 64, 3), np.uint8)
    for name in ("one", "two"):
        write(tmp_path / f"{name}.{ending}", pictures)
    assert (tmp_path / f"one.{ending}").read_bytes() == (tmp_path / f"two.{ending}").read_bytes()


def test_a_movie_that_fails_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.mp4"
    path.write_bytes(b"old")
    with pytest.raises(ZeroDivisionError):
        write(path, (plain(1 // number) for number in (1, 0)))
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.mp4"]


@contextmanager
def most_bytes(count: int) -> Iterator[None]:
    """Let no file of this process grow larger, as on a disk that is full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (count, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_full_disk_leaves_nothing(ending: str, tmp_path: Path) -> None:
    pictures = np.random.default_rng(0).integers(0, 256, (9, 96, 128, 3), np.uint8)
    with most_bytes(4096), pytest.raises(OutputError, match="the disk is full") as raised:
        write(tmp_path / f"a.{ending}", pictures)
    assert raised.value.code == "disk_full"
    assert os.listdir(tmp_path) == []


def test_pictures_of_a_movie_have_one_size(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="one size, 64 x 48 px, got 48 x 64 px"):
        write(tmp_path / "a.mp4", [plain(0), plain(0, 48, 64)])
    with pytest.raises(SettingsError, match="one picture at least"):
        write(tmp_path / "a.mp4", [])
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["a.png", "a.avi"])
def test_other_names_are_no_movies(name: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"\.mp4, \.mov, \.webm"):
        write(tmp_path / name, [plain(0)])


@pytest.mark.parametrize(
    ("times", "time_codes_per_second", "rate"),
    [
        ([1, 2, 3], 24, 24),
        ([1, 5, 9], 24, 6),
        ([9, 8, 7], 25, 25),
        ([1, 5, 7, 9], 24, 12),
        ([40], 30, 30),
        ([1, 1.5, 2], 24, 48),
        ([1, 2], 23.976, Fraction(24000, 1001)),
        ([float("nan")], 24, 24),
    ],
)
def test_a_movie_plays_as_fast_as_the_shot(times: list[float], time_codes_per_second: float, rate: Fraction) -> None:
    assert movie_rate(times, time_codes_per_second) == rate


@pytest.mark.parametrize(
    ("times", "rate", "time_code"),
    [
        ([86401, 86402], 24, "01:00:00:01"),
        ([1, 5], 6, ""),  # its pictures are not each frame of the shot
        ([24, 25], Fraction(24000, 1001), "00:00:01:00"),
        ([-3, -2], 24, ""),
        ([1.5, 2.5], 24, ""),
        ([float("nan")], 24, ""),
        ([24 * 86400], 24, ""),  # a day has no such time
        ([1, 2], 255, "00:00:00:01"),
        ([1, 2], 256, ""),  # the MOV format counts no more
    ],
)
def test_time_codes_count_frames_of_the_shot(times: list[float], rate: Fraction, time_code: str) -> None:
    assert time_code_of(times, Fraction(rate)) == time_code


def test_a_movie_is_described_by_shot_lens_and_display() -> None:
    assert describe_movie(METADATA, [40], RATE) == MovieDescription("shot.usda /cam", "35 mm f/2.8", "00:00:01:16")
    wide = FrameMetadata(METADATA.camera, grade=Grade(display="Display P3 - Display"))
    assert describe_movie(wide, [40], RATE).primaries == 12  # P3 D65 (ITU-T H.273)
