"""Movies of graded pictures, encoded by FFmpeg's libraries (PyAV).

    .mp4    H.264 by x264, 8 bits, 4:2:0, constant quality (CRF 16)
    .mov    Apple ProRes 422 HQ, 10 bits, 4:2:2
    .webm   VP9, 8 bits, 4:2:0, constant quality (CRF 20)

Pictures are converted to Y'CbCr with the matrix of BT.709 in limited range, and are tagged so. Width and height are even: a
picture of odd size repeats its last column or row. The same pictures give the same bytes on one machine.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from render.errors import SettingsError, one_line
from render.files import explain_write_errors, replace_whole, sync_file
from render.output.encode import cicp_of
from render.output.formats import MOVIES_BY_ENDING, MovieFormat, movie_format_of
from render.output.metadata import FrameMetadata, exact_frame_rate

if TYPE_CHECKING:  # it takes a while to load, and pictures do without it
    from av import VideoFrame
    from av.container import OutputContainer
    from av.video.stream import VideoStream

BT709, SRGB_TRANSFER = 1, 13
"""Code points of ITU-T H.273."""
_LIMITED, _FULL = 1, 2
"""Ranges of values as FFmpeg numbers them."""


@dataclass(frozen=True)
class MovieDescription:
    """Tags of a movie.

    Attributes:
        title: for people, such as shot and camera.
        comment: such as the lens.
        time_code: of the first picture, as ``HH:MM:SS:FF``; empty for none.
        primaries: of its colours (ITU-T H.273).
        transfer: of its values (ITU-T H.273).
    """

    title: str = ""
    comment: str = ""
    time_code: str = ""
    primaries: int = BT709
    transfer: int = BT709


@dataclass(frozen=True)
class _Encoding:
    """Encoder of a movie format, and its options."""

    codec: str
    pixels: str
    options: dict[str, str]


_ENCODINGS: dict[MovieFormat, _Encoding] = {
    "mp4": _Encoding("libx264", "yuv420p", {"crf": "16", "preset": "medium"}),
    "mov": _Encoding("prores_ks", "yuv422p10le", {"profile": "hq", "vendor": "apl0"}),
    "webm": _Encoding("libvpx-vp9", "yuv420p", {"crf": "20", "b": "0", "cpu-used": "4", "row-mt": "1"}),
}
_BITEXACT = {"fflags": "+bitexact"}  # no random numbers, and no version of FFmpeg
_CONTAINER_OPTIONS: dict[MovieFormat, dict[str, str]] = {
    "mp4": {**_BITEXACT, "movflags": "+faststart"},
    "mov": _BITEXACT,
    "webm": _BITEXACT,
}


def movie_rate(times: Sequence[float], time_codes_per_second: float) -> Fraction:
    """Return the pictures per second with which a movie lasts as long as the shot does between its pictures.

    Args:
        times: USD time codes of the pictures; the smallest step between two that follow each other counts.
        time_codes_per_second: of the stage.
    """
    steps = [abs(later - earlier) for earlier, later in pairwise(times)]
    step = min((step for step in steps if step > 0), default=1.0)
    numerator, denominator = exact_frame_rate(time_codes_per_second / step)
    return Fraction(max(numerator, 1), denominator)


def describe_movie(metadata: FrameMetadata, times: Sequence[float], rate: Fraction) -> MovieDescription:
    """Describe a movie by its first picture.

    Args:
        metadata: of that picture.
        times: USD time codes of the pictures.
        rate: pictures per second.
    """
    camera = metadata.camera
    lens = [] if camera.orthographic is not None else [f"{camera.focal_length_mm:.4g} mm"]
    lens += [f"f/{camera.f_stop:.3g}"] if camera.f_stop > 0 else []
    primaries, transfer = movie_colours(cicp_of(metadata.grade))
    return MovieDescription(
        title=" ".join(part for part in (metadata.stage, camera.path) if part),
        comment=" ".join(lens),
        time_code=time_code_of(times, rate),
        primaries=primaries,
        transfer=transfer,
    )


def movie_colours(cicp: Sequence[int] | None) -> tuple[int, int]:
    """Return the tags of a movie's primaries and transfer.

    Args:
        cicp: code points of its pictures (ITU-T H.273); None for those of BT.709.
    """
    if cicp is None:
        return BT709, BT709
    primaries, transfer = cicp[:2]
    # Players take BT.709 for how a movie of the sRGB display is to be shown; few know the tag of sRGB.
    return primaries, BT709 if transfer == SRGB_TRANSFER else transfer


MOST_COUNTED = 255
"""Pictures per second that a time code of the MOV format can count."""


def time_code_of(times: Sequence[float], rate: Fraction) -> str:
    """Return the time code of the first picture, without drop frames; empty where there is none.

    There is one where the pictures are each frame in order, and not too many a second.

    Args:
        times: USD time codes of the pictures.
        rate: pictures per second.
    """
    first = times[0]
    is_each_frame = all(later - earlier == 1 for earlier, later in pairwise(times))
    if not (first >= 0 and first % 1 == 0 and is_each_frame):  # the default time is not a number
        return ""
    if round(rate) > MOST_COUNTED:
        return ""
    seconds, frame = divmod(int(first), max(round(rate), 1))
    hours = seconds // 3600
    return f"{hours:02}:{seconds // 60 % 60:02}:{seconds % 60:02}:{frame:02}" if hours < 24 else ""


@contextmanager
def open_movie(path: str | Path, rate: Fraction) -> Iterator[MovieWriter]:
    """Open a movie, which is written beside its place and moved there at the end: no reader sees a partial one.

    Args:
        path: ends in ``.mp4``, ``.mov`` or ``.webm``. Its folder must exist; a file there is replaced.
        rate: pictures per second.

    Yields:
        A writer that takes its pictures.

    Raises:
        SettingsError: the name is not that of a movie, or no picture came.
        OutputError: the movie cannot be encoded or written; an existing file is unchanged.
    """
    movie_format = movie_format_of(path)
    if movie_format is None:
        raise SettingsError(f"a movie is one of {', '.join(MOVIES_BY_ENDING)}, got '{path}'", code="unknown_format")
    with replace_whole(path) as beside:
        writer = MovieWriter(beside, Path(path), movie_format, rate)
        try:
            yield writer
        except BaseException:
            writer.abandon()
            raise
        writer.finish()


class MovieWriter:
    """Takes the pictures of a movie in their order.

    Args:
        beside: name under which the movie is written.
        path: name that it will have.
        movie_format: container and encoder.
        rate: pictures per second.
    """

    def __init__(self, beside: Path, path: Path, movie_format: MovieFormat, rate: Fraction) -> None:
        self._beside, self._path, self._format, self._rate = beside, path, movie_format, rate
        self._open: tuple[OutputContainer, VideoStream] | None = None
        self._size = (0, 0)
        self._count = 0

    def add(self, picture: NDArray[np.uint8], description: MovieDescription) -> None:
        """Encode the next picture.

        Args:
            picture: ``(height, width, 3)`` levels of the graded picture, all of one size.
            description: of the movie; that of the first picture counts.

        Raises:
            SettingsError: the picture has another size than the first one.
            OutputError: the movie cannot be encoded or written.
        """
        height, width, _ = picture.shape
        if self._open is None:
            self._size = (width, height)
        elif (width, height) != self._size:
            expected = " x ".join(map(str, self._size))
            raise SettingsError(f"pictures of a movie have one size, {expected} px, got {width} x {height} px")
        with _explain_errors(self._path):
            if self._open is None:
                self._open = self._start(description)
            container, stream = self._open
            container.mux(stream.encode(self._video_frame(picture, stream)))
        self._count += 1

    def finish(self) -> None:
        """Write what the encoder still holds, and wait for the disk.

        Raises:
            SettingsError: there was no picture.
            OutputError: the movie cannot be encoded or written.
        """
        if self._open is None:
            raise SettingsError(f"a movie has one picture at least, {self._path} got none")
        container, stream = self._open
        with _explain_errors(self._path):
            container.mux(stream.encode(None))
            container.close()
            sync_file(self._beside)

    def abandon(self) -> None:
        """Close the file as it is."""
        if self._open is not None:
            with suppress(Exception):
                self._open[0].close()

    def _start(self, description: MovieDescription) -> tuple[OutputContainer, VideoStream]:
        """Open the container and its stream."""
        import av

        encoding = _ENCODINGS[self._format]
        container = av.open(
            str(self._beside), "w", format=self._format, container_options=_CONTAINER_OPTIONS[self._format]
        )
        container.metadata.update({"title": one_line(description.title), "comment": one_line(description.comment)})
        stream: Any = container.add_stream(encoding.codec, rate=self._rate, options=encoding.options)
        width, height = self._size
        stream.width, stream.height, stream.pix_fmt = width + width % 2, height + height % 2, encoding.pixels
        stream.color_range, stream.colorspace = _LIMITED, BT709
        stream.color_primaries, stream.color_trc = description.primaries, description.transfer
        if description.time_code:
            stream.metadata["timecode"] = description.time_code
        return container, stream

    def _video_frame(self, picture: NDArray[np.uint8], stream: VideoStream) -> VideoFrame:
        """Convert a picture to the pixels of the encoder."""
        import av
        from av.video.reformatter import Interpolation

        height, width, _ = picture.shape
        even = np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(even), format="rgb24").reformat(
            format=_ENCODINGS[self._format].pixels,
            src_colorspace=BT709,
            dst_colorspace=BT709,
            src_color_range=_FULL,
            dst_color_range=_LIMITED,
            dst_color_primaries=stream.color_primaries,  # ProRes has the tags of each frame
            dst_color_trc=stream.color_trc,
            interpolation=Interpolation.BICUBIC
            | Interpolation.ACCURATE_RND
            | Interpolation.FULL_CHR_H_INP
            | Interpolation.BITEXACT,
        )
        frame.pts, frame.time_base = self._count, 1 / self._rate
        return frame


@contextmanager
def _explain_errors(path: Path) -> Iterator[None]:
    """Raise errors of FFmpeg and of the disk as `OutputError`."""
    import av

    with explain_write_errors(path):
        try:
            yield
        except av.FFmpegError as error:
            raise OSError(error.errno, error.strerror) from error
