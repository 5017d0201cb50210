"""Options of `pullfocus record` that usdrecord has too, beside those of camera, frames and size."""

from __future__ import annotations

import argparse
from pathlib import Path

from render.errors import SettingsError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `check_arguments`."""
    group = parser.add_argument_group("stage")
    group.add_argument(
        "--sessionLayer", type=Path, metavar="FILE", help="layer that is put over the stage, below --edits"
    )
    group.add_argument(
        "--resolver",
        choices=("root", "inherit"),
        default="root",
        help="find assets from the folder of STAGE too, which is the default, or from the environment alone",
    )
    group.add_argument(
        "--renderSettingsPrimPath",
        "-rs",
        metavar="PATH",
        help="RenderSettings prim to use, with its purposes and resolution, in place of the one that the stage names",
    )
    group.add_argument(
        "--renderPassPrimPath",
        "-rp",
        metavar="PATH",
        help="RenderPass prim to use: its renderSource for settings, and its collections renderVisibility and prune",
    )
    group.add_argument(
        "--disableDrawMode", action="store_true", help="do not warn of draw modes: geometry is drawn in any case"
    )
    group.add_argument(
        "--disableCameraLight", action="store_true", help="leave a stage without lights dark: no light at the camera"
    )
    group.add_argument(
        "--enableDomeLightVisibility",
        action="store_true",
        default=True,
        dest="dome_visible",
        help="show the dome light behind everything, which is the default",
    )
    group.add_argument(
        "--disableDomeLightVisibility",
        action="store_false",
        dest="dome_visible",
        help="light by the dome without showing it, as usdrecord does by default",
    )


def check_arguments(arguments: argparse.Namespace) -> None:
    """Check that the options fit together.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: both a settings prim and a render pass are named.
    """
    if arguments.renderSettingsPrimPath is not None and arguments.renderPassPrimPath is not None:
        raise SettingsError("--renderPassPrimPath names its own settings: leave out --renderSettingsPrimPath")
