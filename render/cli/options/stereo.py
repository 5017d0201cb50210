"""Option of `pullfocus record` that records both eyes of a stereo rig: its cameras, and the names of its files."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

from render.cli.console import print_message
from render.cli.options import shared
from render.errors import SettingsError
from render.model.frame_spec import frame_file_names
from render.output import format_of
from render.shot import Shot
from render.stage import EYES, Eye, Finding, StereoPair, pair_of

_PLACE = re.compile("%[Vv]")
_NUMBER = re.compile("[._-]?#")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the option, for `choose_pair`."""
    parser.add_argument(
        "--stereo",
        action="store_true",
        help="record both eyes: the cameras with stereoRole left and right that belong together, of which --camera may name"
        " either, or one beside them; an EXR holds both views; %%V in OUT is left or right, %%v is l or r, for a file each",
    )


def check_arguments(arguments: argparse.Namespace) -> None:
    """Check that no other way of recording is asked for as well.

    Args:
        arguments: of `pullfocus record`.

    Raises:
        SettingsError: there is one.
    """
    ways = {"--contact-sheet": arguments.contact_sheet, "--long-exposure": arguments.long_exposure}
    given = [
        name for name, value in {**ways, "--progressive": arguments.progressive or None}.items() if value is not None
    ]
    if arguments.stereo and given:
        raise SettingsError(f"--stereo records single pictures of two cameras: leave out {', '.join(given)}")


def choose_pair(shot: Shot, typed: str | None) -> StereoPair:
    """Choose the pair of cameras, and let each have the settings that the other alone has.

    Args:
        shot: the shot.
        typed: value of --camera; None where it is not given.

    Raises:
        SettingsError: there is no pair, or none to prefer.
    """
    pairs = shot.stereo_pairs()
    if not pairs:
        raise SettingsError(
            f"--stereo needs two cameras with stereoRole left and right, and {shot.path.name} has no pair"
        )
    named = shared.choose_camera(shot, typed) if typed is not None else shot.default_camera().path
    pair = pair_of(pairs, named) if named is not None else None
    if pair is None and (typed is not None or len(pairs) > 1):
        known = ", ".join(f"{pair.left} and {pair.right}" for pair in pairs)
        what = (
            f"{typed} belongs to no pair of cameras" if typed is not None else "--camera must name a camera of the pair"
        )
        raise SettingsError(f"{what}, the pairs are: {known}")
    pair = pair or pairs[0]
    print_message(f"stereo: left {pair.left}, right {pair.right}")
    share_settings(shot, pair)
    return pair


def pair_with(shot: Shot, camera_path: str | None) -> StereoPair | None:
    """The pair that a camera is an eye of, each eye with the settings that the other alone has; None for another camera.

    Args:
        shot: the shot.
        camera_path: prim path; None for a camera that frames the whole stage.
    """
    pair = next((pair for pair in shot.stereo_pairs() if camera_path in (pair.left, pair.right)), None)
    if pair is not None:
        share_settings(shot, pair)
    return pair


def share_settings(shot: Shot, pair: StereoPair) -> None:
    """Let each camera have the settings that the other alone has; one that cannot be edited is a finding."""
    for path in shot.camera.share_settings(pair.left, pair.right):
        message = f"{path} lies in an instance, which USD lets nobody edit: it does not share settings of the other eye"
        shot.note_asked([Finding("stereo_not_shared", path, message)])


def view_files(out: str, frames: Sequence[float]) -> list[dict[Eye, Path]]:
    """Files of each frame by eye, the same one for both eyes where it holds both.

    Args:
        out: OUT as it is typed.
        frames: USD time codes.

    Raises:
        SettingsError: two pictures would be written to one file.
    """
    names = {eye: frame_file_names(view_pattern(out, eye), frames) for eye in EYES}
    return [{eye: Path(names[eye][number]) for eye in EYES} for number in range(len(frames))]


def view_pattern(out: str, eye: Eye) -> str:
    """Name of an eye's files, with ``#`` for the frame number. Without a place for the eye's name it stands before the
    frame number, or before the ending where there is none; an EXR needs no name for it.

    Args:
        out: OUT as it is typed.
        eye: the eye.
    """
    if _PLACE.search(out):
        return out.replace("%V", eye).replace("%v", eye[0])
    if format_of(out) == "exr":
        return out
    path = Path(out)
    number = _NUMBER.search(path.name)
    at = number.start() if number else len(path.stem)
    before, after = path.name[:at], path.name[at:]
    dotted = f"{before}." if before else ""
    return str(path.with_name(f"{dotted}{eye}{'' if after[:1] in '._-' else '.'}{after}"))
