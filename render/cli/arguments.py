"""Arguments that several commands share, and what they mean."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from render.cli.report import say
from render.errors import NotFoundError, SettingsError
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from render.shot import Shot
from render.shot.lens.lens_choice import LensChoice, choose_lens


def add_stage(parser: argparse.ArgumentParser) -> None:
    """Add STAGE and --edits, which `Shot.open` takes."""
    parser.add_argument("stage", metavar="STAGE", help="the shot: a .usda, .usdc, .usd or .usdz file")
    parser.add_argument(
        "--edits", metavar="LAYER", type=Path, help="put a layer of edits over the shot, as the page downloads them"
    )


def add_camera(parser: argparse.ArgumentParser) -> None:
    """Add --camera, for `choose_camera`."""
    parser.add_argument(
        "--camera",
        "-cam",
        metavar="PATH",
        help="camera prim; without it the one that the stage's render settings name, else main_cam, else the only one",
    )


def choose_camera(shot: Shot, asked: str | None) -> str | None:
    """The camera to look through, said aloud when the user did not name it.

    Args:
        shot: the shot.
        asked: what the user typed, if anything.

    Returns:
        Prim path, or None for a camera that frames the whole stage.
    """
    if asked is not None:
        return asked
    choice = shot.default_camera()
    say(f"camera: {choice.path or 'none of the stage'} ({choice.reason})")
    return choice.path


def add_lens(parser: argparse.ArgumentParser) -> None:
    """Add --lens, for `asked_lens`."""
    parser.add_argument(
        "--lens",
        metavar="NAME|FILE",
        help="mount a lens: one of the library (pullfocus lenses), or a .dat, .zmx, .seq, Optical Bench .txt or data sheet"
        " .lens file; it sets the camera's focal length, and its f-number where that is wider than the lens opens",
    )


def asked_lens(asked: str | None) -> LensChoice | None:
    """The lens that --lens names, if it names one.

    Args:
        asked: what the user typed, if anything.

    Raises:
        SettingsError: the library has no such lens; the message has the nearest names.
        InputError: the file is no lens.
    """
    try:
        return None if asked is None else choose_lens(asked)
    except NotFoundError as error:
        raise SettingsError(f"--lens: {error.detail}", code=error.code, path=error.path) from error


def mount(shot: Shot, camera: str | None, lens: LensChoice | None) -> None:
    """Mount a lens for this run alone, and say what that changed.

    Args:
        shot: the shot.
        camera: prim path; None for a camera that frames the whole stage.
        lens: None leaves the camera its own.

    Raises:
        InputError: there is no camera to mount it on.
    """
    if lens is None:
        return
    mounted = shot.camera.mount_lens(camera, lens)
    changes = [f"focal length {mounted.focal_length_mm:g} mm"] if mounted.focal_length_mm is not None else []
    changes += [f"f-number raised to f/{mounted.f_stop:g}"] if mounted.f_stop is not None else []
    say(f"lens: {lens.name} ({', '.join(changes) or 'the camera as it is set'})")
    for note in lens.notes:
        say(f"lens: {note}")


def add_frames(parser: argparse.ArgumentParser, without: str) -> None:
    """Add --frames, for `parse_frames`.

    Args:
        parser: to add it to.
        without: which frames are taken when it is not given.
    """
    parser.add_argument(
        "--frames", "-f", metavar="SPEC", help=f"such as 1:48 or 1,5:9x2, ends included; without it {without}"
    )


def place(option: str, typed: str) -> tuple[float, float]:
    """A place in the picture: 0,0 is its top left corner and 1,1 the bottom right one.

    Args:
        option: where it was typed, for the message.
        typed: what the user typed.

    Raises:
        SettingsError: it is none.
    """
    try:
        x, y = map(float, split_words(typed))
    except ValueError:
        x = y = math.nan
    if not (0 <= x <= 1 and 0 <= y <= 1):
        raise SettingsError(f"{option} takes a place in the picture such as 0.5,0.5, got {typed!r}")
    return x, y


def number_within(option: str, value: float | None, low: float, high: float, what: str) -> float | None:
    """A number that an option takes.

    Args:
        option: where it was typed, for the message.
        value: as it was typed; None where it was not.
        low: the least that makes sense.
        high: the most.
        what: it is, in words that follow "takes".

    Raises:
        SettingsError: it is no such number.
    """
    if value is not None and not low <= value <= high:
        raise SettingsError(f"{option} takes {what} from {low:g} to {high:g}, got {value:g}")
    return value


def compensation(value: float | None) -> float | None:
    """The stops of --compensation, which mean the same for every command.

    Raises:
        SettingsError: they are none that an exposure can have.
    """
    most = MAX_COMPENSATION_STOPS
    return number_within("--compensation", value, -most, most, "stops")


def known_words(text: str, known: Sequence[str], option: str) -> tuple[str, ...]:
    """The words of a list with commas.

    Args:
        text: as typed.
        known: the words that there are.
        option: where it was typed, for the message.

    Raises:
        SettingsError: one is not known, or there is none.
    """
    got = split_words(text)
    unknown = [word for word in got if word not in known]
    if unknown or not got:
        raise SettingsError(f"{option} takes words of {', '.join(known)}, got {', '.join(unknown) or 'none'}")
    return got


def split_words(text: str) -> tuple[str, ...]:
    """The parts of a list with commas."""
    return tuple(word.strip() for word in text.split(",") if word.strip())
