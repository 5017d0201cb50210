"""Arguments that several commands share, and functions that read them."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from render.cli.console import print_findings, print_message
from render.errors import InputError, NotFoundError, PullfocusError, SettingsError
from render.optics.lens_files import UNKNOWN_GLASS
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from render.shot import Shot
from render.shot.lens.lens_alone import FULL_FRAME_MM
from render.shot.lens.lens_choice import LensChoice, choose_lens
from render.stage import StageOptions
from render.stage.options import DEFAULT_OPTIONS


def add_stage(parser: argparse.ArgumentParser) -> None:
    """Add STAGE, --edits and --unloaded, for `open_shot`."""
    parser.add_argument("stage", metavar="STAGE", help="the shot: a .usda, .usdc, .usd or .usdz file")
    parser.add_argument(
        "--edits", metavar="LAYER", type=Path, help="put a layer of edits over the shot, as the page downloads them"
    )
    parser.add_argument("--unloaded", action="store_true", help="do not load payloads; a warning counts them")


def open_shot(arguments: argparse.Namespace, options: StageOptions = DEFAULT_OPTIONS) -> Shot:
    """Open the shot that the arguments of `add_stage` name.

    Args:
        arguments: of the command line.
        options: how the stage is opened and read otherwise.

    Raises:
        PullfocusError: as `Shot.open` does.
    """
    return Shot.open(arguments.stage, edits=arguments.edits, options=replace(options, unloaded=arguments.unloaded))


def camera_path(typed: str | None) -> str | None:
    """Path of a camera that is typed as one, with or without the first slash; None for its name alone."""
    return f"/{typed.lstrip('/')}" if typed is not None and "/" in typed else None


@contextmanager
def printed_findings(shot: Shot, stage: str) -> Iterator[None]:
    """Print the findings of a shot at the end of the block, also where it fails: a missing file may be the reason.

    Args:
        shot: the shot.
        stage: as the user typed it.
    """
    try:
        yield
    except PullfocusError:
        print_findings(shot.findings(), stage)
        raise
    print_findings(shot.findings(), stage)


def add_camera(parser: argparse.ArgumentParser) -> None:
    """Add --camera, for `choose_camera`."""
    parser.add_argument(
        "--camera",
        "-cam",
        metavar="PATH|NAME",
        help="camera prim, or its name alone; without it the one that the stage's render settings name, else main_cam, else"
        " the only one",
    )


def choose_camera(shot: Shot, typed: str | None) -> str | None:
    """Choose the camera; one that the user did not name by its path is printed.

    Args:
        shot: the shot.
        typed: value of --camera; None where it is not given.

    Returns:
        Prim path, or None for a camera that frames the whole stage.
    """
    if typed is not None:
        return _camera_called(shot, typed)
    choice = shot.default_camera()
    print_message(f"camera: {choice.path or 'none of the stage'} ({choice.reason})")
    return choice.path


def _camera_called(shot: Shot, typed: str) -> str:
    """Path of the camera that is typed: by its path, with or without the first slash, or by its name alone, as in usdrecord."""
    path = camera_path(typed)
    if path is not None:
        return path
    found = [path for path in shot.cameras() if path.rpartition("/")[2] == typed]
    if not found:
        return typed
    rest = f", the first of {len(found)}" if len(found) > 1 else ""
    print_message(f"camera: {found[0]} (it is called {typed}{rest})")
    return found[0]


def add_lens(parser: argparse.ArgumentParser) -> None:
    """Add --lens, for `read_lens`."""
    parser.add_argument(
        "--lens",
        metavar="NAME|FILE",
        help="mount a lens: one of the library (pullfocus lenses), or a .dat, .zmx, .seq, Optical Bench .txt, .roa, .json or"
        " data sheet .lens file; it sets the camera's focal length, and its f-number where that is wider than the lens opens",
    )
    add_unknown_glass(parser)


def add_unknown_glass(parser: argparse.ArgumentParser) -> None:
    """Add --allow-unknown-glass, for commands that read lens files."""
    parser.add_argument(
        "--allow-unknown-glass",
        action="store_true",
        help="take a lens file's glass that is in no catalogue by the index and the Abbe number beside its name",
    )


@contextmanager
def glass_advice() -> Iterator[None]:
    """Add the option that allows unknown glass to the error of one."""
    try:
        yield
    except InputError as error:
        if error.code != UNKNOWN_GLASS:
            raise
        advice = "--allow-unknown-glass takes it by index and Abbe number, where the file has them beside its name"
        detail = error.detail if error.detail.endswith("?") else f"{error.detail};"
        raise InputError(f"{detail} {advice}", code=error.code, path=error.path) from error


def read_lens(arguments: argparse.Namespace) -> LensChoice | None:
    """Read the lens that --lens names.

    Args:
        arguments: as `add_lens` declares them.

    Raises:
        SettingsError: the library has no such lens; the message has the nearest names.
        InputError: the file has no usable lens.
    """
    if arguments.lens is None:
        return None
    try:
        with glass_advice():
            return choose_lens(arguments.lens, arguments.allow_unknown_glass)
    except NotFoundError as error:
        raise SettingsError(f"--lens: {error.detail}", code=error.code, path=error.path) from error


def mount_lens(shot: Shot, camera_path: str | None, lens: LensChoice | None) -> None:
    """Mount a lens for this run alone, and print what that changed.

    Args:
        shot: the shot.
        camera_path: prim path; None for a camera that frames the whole stage.
        lens: None keeps the camera's own.

    Raises:
        InputError: there is no camera to mount it on.
    """
    if lens is None:
        return
    mounted = shot.camera.mount_lens(camera_path, lens)
    changes = [f"focal length {mounted.focal_length_mm:g} mm"] if mounted.focal_length_mm is not None else []
    changes += [f"f-number raised to f/{mounted.f_stop:g}"] if mounted.f_stop is not None else []
    print_message(f"lens: {lens.name} ({', '.join(changes) or 'the camera as it is set'})")
    for note in lens.notes:
        print_message(f"lens: {note}")


def read_gate(typed: str | None) -> tuple[float, float]:
    """Read a film gate in mm, such as 24.89x18.66; None is full frame.

    Raises:
        SettingsError: it is none.
    """
    if typed is None:
        return FULL_FRAME_MM
    try:
        width, height = (float(number) for number in re.split("[x×]", typed.lower()))
    except ValueError:
        raise SettingsError(f"--gate takes width x height in mm, such as 24.89x18.66, got {typed}") from None
    return width, height


def add_frames(parser: argparse._ActionsContainer, without: str) -> None:
    """Add --frames, for `parse_frames`.

    Args:
        parser: the parser.
        without: frames that are used where the option is not given, in words.
    """
    parser.add_argument(
        "--frames", "-f", metavar="SPEC", help=f"such as 1:48 or 1,5:9x2, ends included; without it {without}"
    )


def read_place(option: str, typed: str) -> tuple[float, float]:
    """Read a position in the picture: 0,0 is its top left corner and 1,1 the bottom right one.

    Args:
        option: the option, for the message.
        typed: its value.

    Raises:
        SettingsError: it is no position in the picture.
    """
    try:
        x, y = map(float, split_words(typed))
    except ValueError:
        x = y = math.nan
    if not (0 <= x <= 1 and 0 <= y <= 1):
        raise SettingsError(f"{option} takes a place in the picture such as 0.5,0.5, got {typed!r}")
    return x, y


def check_number(option: str, value: float | None, low: float, high: float, unit: str) -> float | None:
    """Check the range of an option's number.

    Args:
        option: the option, for the message.
        value: its value; None where it is not given.
        low: least value.
        high: largest value.
        unit: in words that follow "takes".

    Raises:
        SettingsError: it is out of range.
    """
    if value is not None and not low <= value <= high:
        raise SettingsError(f"{option} takes {unit} from {low:g} to {high:g}, got {value:g}")
    return value


def check_compensation(value: float | None) -> float | None:
    """Check the stops of --compensation, which every command takes alike.

    Raises:
        SettingsError: they are out of range.
    """
    most = MAX_COMPENSATION_STOPS
    return check_number("--compensation", value, -most, most, "stops")


def read_words(option: str, typed: str, known: Sequence[str]) -> tuple[str, ...]:
    """Read a comma-separated list of known words.

    Args:
        option: the option, for the message.
        typed: its value.
        known: the words that are allowed.

    Raises:
        SettingsError: a word is not known, or there is none.
    """
    words = split_words(typed)
    unknown = [word for word in words if word not in known]
    if unknown or not words:
        raise SettingsError(f"{option} takes words of {', '.join(known)}, got {', '.join(unknown) or 'none'}")
    return words


def split_words(text: str) -> tuple[str, ...]:
    """Split a list with commas or spaces between its words."""
    return tuple(text.replace(",", " ").split())
