"""The options of `record` that say how strong a lens's flare is, in place of what the shot says."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

from render.errors import SettingsError
from render.shot import Shot


@dataclass(frozen=True)
class AskedFlare:
    """What is asked of a lens's flare for one run; None keeps the shot's.

    Attributes:
        ghosts: strength of its reflections.
        star: strength of the diffraction at its iris.
    """

    ghosts: float | None = None
    star: float | None = None

    def set_on(self, shot: Shot, camera: str | None) -> None:
        """Set them for this run alone.

        Args:
            shot: the shot.
            camera: prim path; None for a camera that frames the whole stage.

        Raises:
            InputError: there is no camera to set.
        """
        asked = {"flare_ghosts": self.ghosts, "flare_star": self.star}
        said = {name: factor for name, factor in asked.items() if factor is not None}
        if said:
            shot.exposure.set(camera, **said)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare them, for `asked_flare`."""
    group = parser.add_argument_group("flare of the lens, in place of what the shot says")
    for name, what in (
        ("--flare", "ghosts: what the surfaces of a lens with a prescription reflect of what is bright"),
        ("--star", "the star that diffraction at the iris draws around what is bright"),
    ):
        group.add_argument(
            name, nargs="?", type=float, const=1.0, metavar="FACTOR", help=f"{what}; 1 without a number, 0 for none"
        )


def asked_flare(arguments: argparse.Namespace) -> AskedFlare:
    """What the options ask for.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a factor is no number of 0 or more.
    """
    for name, factor in (("--flare", arguments.flare), ("--star", arguments.star)):
        if factor is not None and not 0 <= factor < math.inf:
            raise SettingsError(f"{name} takes a factor of 0 or more, got {factor:g}")
    return AskedFlare(arguments.flare, arguments.star)
