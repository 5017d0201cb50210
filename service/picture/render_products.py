"""Functions of the picture process that make movies and contact sheets of the stored frames of a render."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from render.files import write_atomic
from render.output.movie import MovieDescription, movie_colours, movie_rate, open_movie, time_code_of
from render.output.stills import read_still, shrink_picture
from service.picture.state import PictureWorkerState, picture_function

Frames = Sequence[tuple[int, Path]]
"""Frames in rising order, and their graded pictures."""


@picture_function
def write_movie(state: PictureWorkerState, title: str, frames: Frames, time_codes_per_second: float, out: Path) -> None:
    """Encode a movie.

    Args:
        state: the worker's state.
        title: of the movie.
        frames: at least one.
        time_codes_per_second: of the shot.
        out: movie to write; its ending chooses the format.

    Raises:
        InputError: a picture cannot be read.
        OutputError: the movie cannot be written.
    """
    times = [frame for frame, _ in frames]
    rate = movie_rate(times, time_codes_per_second)
    time_code = time_code_of(times, rate)
    with open_movie(out, rate) as movie:
        for _, path in frames:
            still = read_still(path)
            primaries, transfer = movie_colours(still.cicp)
            movie.add(still.pixels, MovieDescription(title, "", time_code, primaries, transfer))


@picture_function
def write_contact_sheet(state: PictureWorkerState, title: str, frames: Frames, out: Path) -> None:
    """Draw a contact sheet.

    Args:
        state: the worker's state.
        title: head line.
        frames: at least one.
        out: PNG to write.

    Raises:
        InputError: a picture cannot be read.
        OutputError: the sheet cannot be written.
    """
    from render.drawing.frame_sheet import choose_frames, draw_frame_sheet  # matplotlib takes a second

    paths = dict(frames)
    pictures = [(frame, shrink_picture(read_still(paths[frame]).pixels)) for frame in choose_frames(list(paths))]
    write_atomic(out, draw_frame_sheet(title, pictures, len(paths)))
