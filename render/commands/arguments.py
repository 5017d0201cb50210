"""Arguments that several commands share, and what they mean."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from render.commands.report import say
from render.errors import SettingsError
from render.shot import Shot


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


def add_frames(parser: argparse.ArgumentParser, without: str) -> None:
    """Add --frames, for `parse_frames`.

    Args:
        parser: to add it to.
        without: which frames are taken when it is not given.
    """
    parser.add_argument(
        "--frames", "-f", metavar="SPEC", help=f"such as 1:48 or 1,5:9x2, ends included; without it {without}"
    )


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
