"""Options of `pullfocus record` that say which prims are drawn and how they are read, and the opening of its shot."""

from __future__ import annotations

import argparse

from pxr import Sdf

from render.cli.options import shared
from render.errors import SettingsError
from render.shot import Shot
from render.stage.options import COMPLEXITIES, LIGHTS, PURPOSES, StageOptions

CULLS = ("nothing", "backfaces")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `open_shot`."""
    group = parser.add_argument_group("scene")
    group.add_argument(
        "--purposes",
        "-p",
        metavar="LIST",
        help="of render, proxy and guide; default is always drawn; without it render, or those of --renderSettingsPrimPath",
    )
    group.add_argument(
        "--mask", metavar="PATHS", help="only these prims, with commas or spaces between, and what is in them"
    )
    group.add_argument(
        "--complexity",
        "-c",
        default=COMPLEXITIES[0],
        choices=COMPLEXITIES,
        help="how finely subdivision surfaces are refined; auto follows their size on screen",
    )
    group.add_argument(
        "--cull",
        default=CULLS[0],
        choices=CULLS,
        help="backfaces: draw only the outsides of what is not doubleSided; both sides are drawn without it",
    )
    group.add_argument(
        "--lights",
        default=LIGHTS[0],
        choices=LIGHTS,
        help="light by the stage's lights, by one at the camera, or by both as usdrecord does; auto: by the camera's where the "
        "stage has none",
    )


def open_shot(arguments: argparse.Namespace) -> Shot:
    """Open the shot as the options say.

    Args:
        arguments: those of `record`.

    Raises:
        PullfocusError: as `Shot.open` does.
        SettingsError: the shot does not hold what --mask names.
    """
    purposes = None
    if arguments.purposes is not None:
        words = shared.read_words("--purposes", arguments.purposes, PURPOSES)
        purposes = tuple(dict.fromkeys(("default", *words)))
    mask = _read_mask(arguments.mask)
    options = StageOptions(
        purposes=purposes,
        mask=mask,
        camera=shared.camera_path(arguments.camera),
        all_cameras=arguments.stereo,
        complexity=arguments.complexity,
        cull_backfaces=arguments.cull == "backfaces",
        lit_by=arguments.lights,
        dome_visible=arguments.dome_visible,
        draw_modes=not arguments.disableDrawMode,
        session_layer=arguments.sessionLayer,
        resolver=arguments.resolver,
        settings_prim=arguments.renderSettingsPrimPath,
        render_pass=arguments.renderPassPrimPath,
    )
    shot = shared.open_shot(arguments, options)
    missing = [path for path in mask or () if not shot.stage.GetPrimAtPath(path)]
    if missing:
        raise SettingsError(f"--mask names what {arguments.stage} does not hold: {', '.join(missing)}")
    return shot


def _read_mask(typed: str | None) -> tuple[str, ...] | None:
    """Read the prim paths of --mask.

    Raises:
        SettingsError: there is none, or one is no absolute prim path.
    """
    if typed is None:
        return None
    paths = shared.split_words(typed)
    wrong = [path for path in paths if not _is_prim_path(path)]
    if wrong or not paths:
        raise SettingsError(f"--mask takes absolute prim paths, got {', '.join(wrong) or 'none'}")
    return paths


def _is_prim_path(text: str) -> bool:
    path = Sdf.Path(text) if Sdf.Path.IsValidPathString(text) else Sdf.Path()
    return bool(path.IsAbsolutePath() and path.IsAbsoluteRootOrPrimPath())
