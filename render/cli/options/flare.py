"""Options of `pullfocus record` for the strength of lens flare, in place of the shot's."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

from render.errors import SettingsError
from render.shot import Shot


@dataclass(frozen=True)
class FlareOptions:
    """Strength of lens flare in one run; None keeps the shot's.

    Attributes:
        ghosts: strength of its reflections.
        star: strength of the diffraction at its iris.
    """

    ghosts: float | None = None
    star: float | None = None

    def set_on(self, shot: Shot, camera_path: str | None) -> None:
        """Set them for this run alone.

        Args:
            shot: the shot.
            camera_path: prim path; None for a camera that frames the whole stage.

        Raises:
            InputError: there is no camera to set.
        """
        factors = {"flare_ghosts": self.ghosts, "flare_star": self.star}
        given = {name: factor for name, factor in factors.items() if factor is not None}
        if given:
            shot.exposure.set(camera_path, **given)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_flare_options`."""
    group = parser.add_argument_group("lens flare, in place of the shot's")
    for name, what in (
        ("--flare", "ghosts: reflections of bright things between the surfaces of a lens with a prescription"),
        ("--star", "stars around bright things, from diffraction at the iris"),
    ):
        group.add_argument(
            name, nargs="?", type=float, const=1.0, metavar="FACTOR", help=f"{what}; 1 without a number, 0 for none"
        )


def read_flare_options(arguments: argparse.Namespace) -> FlareOptions:
    """Read the options.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a factor is no number of 0 or more.
    """
    for name, factor in (("--flare", arguments.flare), ("--star", arguments.star)):
        if factor is not None and not 0 <= factor < math.inf:
            raise SettingsError(f"{name} takes a factor of 0 or more, got {factor:g}")
    return FlareOptions(arguments.flare, arguments.star)
