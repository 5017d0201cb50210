"""`pullfocus bench`: what the engines cost and how near they come to the truth, measured here and now."""

from __future__ import annotations

import argparse
from typing import Any

from render.bench.film_plan import add_arguments as add_film_arguments
from render.bench.focus_plan import add_arguments as add_focus_arguments
from render.bench.importance_plan import add_arguments as add_importance_arguments
from render.bench.live_plan import add_arguments as add_live_arguments
from render.bench.motion_plan import add_arguments as add_motion_arguments
from render.bench.plan import add_arguments
from render.bench.postblur_plan import add_arguments as add_postblur_arguments
from render.bench.soak_plan import add_arguments as add_soak_arguments


def add_parser(commands: Any) -> None:
    """Declare the command's arguments."""
    parser = commands.add_parser("bench", help="measure the engines on this machine against their references")
    benches = parser.add_subparsers(title="benches", metavar="BENCH", required=True)
    lens = benches.add_parser(
        "lens", help="the lens engine: three scenes, and sweeps over rays, layers, aperture, surfaces"
    )
    lens.set_defaults(run=run_lens)
    add_arguments(lens)
    focus = benches.add_parser("focus", help="focusing: the solvers, and what a surface that is no plane costs")
    focus.set_defaults(run=run_focus)
    add_focus_arguments(focus)
    film = benches.add_parser(
        "film", help="film and grade: on the device and on the processor, beside the frame itself"
    )
    film.set_defaults(run=run_film)
    add_film_arguments(film)
    motion = benches.add_parser(
        "motion", help="motion: sixteen moments by velocities and by peeling each, beside the still frame"
    )
    motion.set_defaults(run=run_motion)
    add_motion_arguments(motion)
    live = benches.add_parser(
        "live", help="live work: from a change to the first picture and to the last, of five kinds of drags"
    )
    live.set_defaults(run=run_live)
    add_live_arguments(live)
    soak = benches.add_parser(
        "soak", help="thousands of random edits of a small shot: no drift, no error, no growth of memory"
    )
    soak.set_defaults(run=run_soak)
    add_soak_arguments(soak)
    postblur = benches.add_parser(
        "postblur",
        help="blurs of one picture: FLAG and the naive gather as the blur grows, and every engine's likeness",
    )
    postblur.set_defaults(run=run_postblur)
    add_postblur_arguments(postblur)
    importance = benches.add_parser(
        "importance", help="importance ordering: Fearing's experiments, beside the linear method"
    )
    importance.set_defaults(run=run_importance)
    add_importance_arguments(importance)


def run_importance(arguments: argparse.Namespace) -> None:
    """Measure importance ordering, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: a file cannot be written.
    """
    from render.bench.importance import run  # brings OpenGL with it

    run(arguments)


def run_lens(arguments: argparse.Namespace) -> None:
    """Measure the lens engine, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: the JSON cannot be written.
    """
    from render.bench.lens import run  # brings OpenGL with it

    run(arguments)


def run_focus(arguments: argparse.Namespace) -> None:
    """Measure focusing, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        GraphicsError: there is no device to draw on.
        OutputError: the JSON cannot be written.
    """
    from render.bench.focus import run  # brings OpenGL with it

    run(arguments)


def run_film(arguments: argparse.Namespace) -> None:
    """Measure film and grade, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the picture is too small or too large.
        GraphicsError: there is no device to draw on.
        OutputError: the JSON cannot be written.
    """
    from render.bench.film import run  # brings OpenGL with it

    run(arguments)


def run_motion(arguments: argparse.Namespace) -> None:
    """Measure motion, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the picture is too small or too large.
        GraphicsError: there is no device to draw on.
        OutputError: the JSON cannot be written.
    """
    from render.bench.motion import run  # brings OpenGL with it

    run(arguments)


def run_live(arguments: argparse.Namespace) -> None:
    """Measure live work, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the picture is too small or too large.
        GraphicsError: there is no device to draw on.
        OutputError: the JSON cannot be written.
    """
    from render.bench.live import run  # brings OpenGL with it

    run(arguments)


def run_soak(arguments: argparse.Namespace) -> None:
    """Edit a shot thousands of times, and print and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: no edits are asked for.
        GraphicsError: there is no device to draw on.
        OutputError: the JSON cannot be written.
    """
    from render.bench.soak import run  # brings OpenGL with it

    run(arguments)


def run_postblur(arguments: argparse.Namespace) -> None:
    """Measure the blurs of one picture, and print, draw and write what was found.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the drawing is to be of a kind that there is none of.
        GraphicsError: there is no device to draw on.
        OutputError: a file cannot be written.
    """
    from render.bench.postblur import run  # brings OpenGL with it

    run(arguments)
