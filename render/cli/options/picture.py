"""Options of how a picture is rendered: engine, rays, layers, motion and what is measured."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

from render.cli.options import shared
from render.engines import all_engines, check_settings
from render.errors import SettingsError
from render.model.aovs import AOV_NAMES
from render.model.frame_settings import LEAST_NOISE, MAX_MOTION, MOST_NOISE, MOTIONS, FrameSettings
from render.model.limits import MAX_RAYS, MAX_WAVELENGTHS
from render.stage.own_settings import put_over

DEFAULT_WIDTH_PX = 960
DEFAULT_MOMENTS = 16
"""Shutter samples where --motion-by is given without --motion."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_given`."""
    group = parser.add_argument_group("rendering")
    group.add_argument(
        "--imageWidth",
        "-w",
        type=int,
        metavar="PX",
        help=f"width; the film gate's shape gives the height; without it {DEFAULT_WIDTH_PX}, or the resolution that"
        " --renderSettingsPrimPath gives",
    )
    group.add_argument(
        "--engine",
        metavar="NAME",
        help="; ".join(f"{engine.name} {engine.summary}" for engine in all_engines()),
    )
    with_rays = ", ".join(engine.name for engine in all_engines() if engine.has_rays)
    group.add_argument(
        "--rays",
        type=int,
        metavar="N",
        help=f"lens rays for each pixel, {FrameSettings.rays} by default, of the engines {with_rays}",
    )
    group.add_argument(
        "--noise",
        type=float,
        metavar="E",
        help="in place of --rays, of the engine lens: rays until the standard error of each 8x8 pixels is below this, from"
        f" {LEAST_NOISE} to {MOST_NOISE} in values of the encoded picture from 0 to 1, or at {MAX_RAYS} rays",
    )
    group.add_argument(
        "--no-adaptive", action="store_true", help="the same number of rays for every pixel, for exact comparisons"
    )
    group.add_argument(
        "--layers", type=int, metavar="N", help=f"depth layers at most, {FrameSettings.layers} by default"
    )
    group.add_argument(
        "--supersample",
        type=float,
        metavar="N",
        help="layer pixels for each pixel, along each axis; 0, the default, for as many as suit the engine and its rays",
    )
    group.add_argument(
        "--no-connections",
        action="store_true",
        help="leave small bright lights to the lens rays, for exact comparisons: their blurred images are noisy then",
    )
    group.add_argument(
        "--wavelengths",
        type=int,
        metavar="N",
        help=f"of light, from 1 to {MAX_WAVELENGTHS}, for lenses with colour errors: 3, the default, is one for each channel,"
        " more a smoother spectrum, 1 leaves colour errors out",
    )
    group.add_argument("--shading", metavar="NAME", help="lit, the default, or unlit for the base colour as radiance")
    group.add_argument(
        "--aov",
        default="color",
        metavar="LIST",
        help=f"parts of an EXR: {', '.join(AOV_NAMES)}",
    )
    group.add_argument(
        "--motion",
        type=int,
        metavar="N",
        help=f"shutter samples, from 1 to {MAX_MOTION}, over which the rays are spread; 1, the default, stops motion;"
        f" with --motion-by the default is {DEFAULT_MOMENTS}",
    )
    group.add_argument(
        "--motion-by",
        choices=MOTIONS,
        help="moments: render the scene at each sample, which is exact; velocities: render it once and move it, much faster",
    )
    group.add_argument("--seed", type=int, metavar="N", help="of the sampling pattern")


def read_given(arguments: argparse.Namespace) -> dict[str, Any]:
    """Fields of `FrameSettings` that the command line gives, except width and height.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: values are out of range or contradict each other.
    """
    names = ("engine", "rays", "noise", "layers", "supersample", "wavelengths", "shading", "motion_by", "seed")
    given = {name: getattr(arguments, name) for name in names if getattr(arguments, name) is not None}
    given |= {"adaptive": False} if arguments.no_adaptive else {}
    given |= {"connections": False} if arguments.no_connections else {}
    if arguments.motion == 1 and arguments.motion_by is not None and arguments.long_exposure is None:
        raise SettingsError("--motion-by has no effect with --motion 1, which stops motion: leave out one of them")
    given |= {"motion": arguments.motion} if arguments.motion is not None else {}
    given["aovs"] = shared.split_words(arguments.aov)
    make_settings(given, width=DEFAULT_WIDTH_PX if arguments.imageWidth is None else arguments.imageWidth, height=1)
    return given


def merge(authored: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Settings that a stage authors, and over them those of the command line. Motion that is asked for has samples."""
    settings = put_over(authored, given)
    if "motion_by" in given:
        settings.setdefault("motion", DEFAULT_MOMENTS)
    return settings


def make_settings(given: dict[str, Any], *, width: int, height: int) -> FrameSettings:
    """Settings of a picture.

    Args:
        given: fields that are not the default's.
        width: in pixels.
        height: in pixels.

    Raises:
        SettingsError: a value is out of range, or no engine can do this.
    """
    settings = FrameSettings(**{**given, "width": width, "height": height})
    check_settings(settings)
    return settings
