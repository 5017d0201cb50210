"""`pullfocus record`: frames of a shot as files, with usdrecord's arguments where it has them."""

from __future__ import annotations

import argparse
import time as clock
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from pxr import Sdf

from render.cli import arguments as shared
from render.cli import (
    camera_options,
    contact_sheet_options,
    flare_options,
    grade_options,
    long_exposure_options,
    progressive_options,
)
from render.cli.camera_options import Viewed
from render.cli.report import FrameProgress, camel_case_keys, print_json, warn_of
from render.engines import all_engines, check_settings
from render.errors import SettingsError
from render.files import check_replaceable, check_writable
from render.film import GradeChoice
from render.film.stock import library_stock
from render.model.frame_settings import MAX_MOTION, MOTIONS, FrameSettings
from render.model.frame_spec import frame_file_names, parse_frames
from render.model.limits import MAX_WAVELENGTHS
from render.output import format_of, write_frame
from render.pictures.picture import make_picture
from render.pictures.picture_height import picture_height
from render.shot import Shot

PURPOSES = ("default", "render", "proxy", "guide")
COMPLEXITIES = ("low", "medium", "high", "veryhigh")
MOMENTS = 16
"""At which motion is looked at where somebody says how and not how often."""


def add_parser(commands: Any) -> None:
    """Declare the command's arguments."""
    parser = commands.add_parser("record", help="render frames of a shot to EXR, PNG or JPEG files")
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    parser.add_argument(
        "out",
        metavar="OUT",
        help="file to write: .exr (scene-linear), .png or .jpg (graded); a run of # in it is the frame number",
    )
    shared.add_camera(parser)
    shared.add_lens(parser)
    parser.add_argument(
        "--film",
        metavar="NAME",
        help="shoot it on this stock of the library (pullfocus films); what the shot says without it",
    )
    shared.add_frames(parser, "the shot's first frame")
    _add_scene_options(parser)
    _add_picture_options(parser)
    camera_options.add_arguments(parser)
    grade_options.add_arguments(parser)
    flare_options.add_arguments(parser)
    long_exposure_options.add_arguments(parser)
    contact_sheet_options.add_arguments(parser)
    progressive_options.add_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print on standard output what was written")


def _add_scene_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("what is drawn")
    group.add_argument(
        "--purposes", "-p", default="render", metavar="LIST", help="of render, proxy and guide; default is always drawn"
    )
    group.add_argument("--mask", metavar="PATHS", help="only these prims, with commas between, and what is in them")
    group.add_argument(
        "--complexity", "-c", default="low", choices=COMPLEXITIES, help="how finely round prims are divided"
    )


def _add_picture_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("how it is rendered")
    group.add_argument(
        "--imageWidth", "-w", type=int, default=960, metavar="PX", help="width; the film gate's shape gives the height"
    )
    group.add_argument(
        "--engine",
        default=FrameSettings.engine,
        metavar="NAME",
        help="; ".join(f"{engine.name} {engine.summary}" for engine in all_engines()),
    )
    with_rays = ", ".join(engine.name for engine in all_engines() if engine.has_rays)
    group.add_argument(
        "--rays", type=int, default=100, metavar="N", help=f"lens rays for each pixel, of the engines {with_rays}"
    )
    group.add_argument("--layers", type=int, default=4, metavar="N", help="depth layers at most")
    group.add_argument(
        "--supersample", type=float, default=2, metavar="N", help="layer pixels for each pixel, along each axis"
    )
    group.add_argument(
        "--wavelengths",
        type=int,
        default=3,
        metavar="N",
        help=f"of light, from 1 to {MAX_WAVELENGTHS}, for lenses with colour errors: 3 is one for each channel,"
        " more a smoother spectrum, 1 leaves colour errors out",
    )
    group.add_argument("--shading", default="lit", metavar="NAME", help="lit, or unlit for the base colour as radiance")
    group.add_argument(
        "--aov",
        default="color",
        metavar="LIST",
        help="parts of an EXR: color, depth, coc, defocus, focus_depth, albedo, prim_id, face_id",
    )
    group.add_argument(
        "--motion",
        type=int,
        metavar="N",
        help=f"moments of the shutter's opening to look at, from 1 to {MAX_MOTION}, over which the rays are spread;"
        f" 1, as without it, stops motion; with --motion-by {MOMENTS}",
    )
    group.add_argument(
        "--motion-by",
        choices=MOTIONS,
        help="moments: the scene is drawn anew at each, which is exact; velocities: drawn once and moved, many times faster",
    )
    group.add_argument("--seed", type=int, default=0, metavar="N", help="of the sampling pattern")


def run(arguments: argparse.Namespace) -> None:
    """Render the frames and write them.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the arguments are out of range or do not fit together.
        InputError: the shot or its camera cannot be used.
        GraphicsError: no OpenGL context.
        OutputError: a file cannot be written; those before it are whole.
    """
    progressive_options.check(arguments)
    axes = contact_sheet_options.asked_axes(arguments)
    if axes is None:
        _check_output(arguments)
    asked = None if arguments.frames is None else parse_frames(arguments.frames)
    settings = _settings(arguments)
    if arguments.film is not None:
        library_stock(arguments.film)
    grade = grade_options.asked_grade(arguments)
    body = camera_options.asked_camera(arguments)
    flare = flare_options.asked_flare(arguments)
    long = long_exposure_options.asked_long_exposure(arguments)
    lens = shared.asked_lens(arguments.lens)
    shot = _open(arguments)
    frames = asked or [shot.frame_range.start if long is None else long.begin]
    files = [Path(name) for name in frame_file_names(arguments.out, frames)]
    _check_files(files)
    for file in files:
        shot.check_not_own(file)
    grade_options.warn_of_unseen(arguments)
    camera = shared.choose_camera(shot, arguments.camera)
    shared.mount(shot, camera, lens)
    body.set_on(shot, camera)
    flare.set_on(shot, camera)
    settings = replace(settings, height=picture_height(shot, camera, frames[0], settings.width))
    if axes is not None:
        written = contact_sheet_options.record_contact_sheet(
            shot, camera, axes, frames[0], files[0], settings, arguments.film, grade, body.viewed
        )
    elif long is not None:
        written = long_exposure_options.record_long_exposure(
            shot, camera, long, files[0], settings, arguments.film, grade, body.viewed
        )
    else:
        plan = list(zip(frames, files, strict=True))
        record = progressive_options.record_progressively if arguments.progressive else _record
        written = record(shot, camera, plan, settings, arguments.film, grade, body.viewed)
    warn_of(shot.findings(), arguments.stage)
    if arguments.json:
        print_json(
            {
                "stage": arguments.stage,
                "camera": camera,
                "settings": camel_case_keys(asdict(settings)),
                "frames": written,
                "findings": [asdict(finding) for finding in shot.findings()],
            }
        )


def _check_output(arguments: argparse.Namespace) -> None:
    if format_of(arguments.out) != "exr" and shared.split_words(arguments.aov) != ("color",):
        raise SettingsError(f"--aov {arguments.aov} needs an EXR file to hold it, got {arguments.out}")


def _check_files(files: Sequence[Path]) -> None:
    """Before anything is rendered: an hour's work would fail when it is to be written."""
    for file in {file.parent: file for file in files}.values():
        check_writable(file)
    for file in files:
        check_replaceable(file)


def _open(arguments: argparse.Namespace) -> Shot:
    purposes = shared.known_words(arguments.purposes, PURPOSES, "--purposes")
    mask = _mask(arguments.mask)
    shot = Shot.open(
        arguments.stage,
        purposes=tuple(dict.fromkeys(("default", *purposes))),
        mask=mask,
        complexity=arguments.complexity,
        edits=arguments.edits,
    )
    missing = [path for path in mask or () if not shot.stage.GetPrimAtPath(path)]
    if missing:
        raise SettingsError(f"--mask names what {arguments.stage} does not hold: {', '.join(missing)}")
    return shot


def _mask(typed: str | None) -> tuple[str, ...] | None:
    """The prim paths of --mask.

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


def _settings(arguments: argparse.Namespace) -> FrameSettings:
    """All but the height, which the camera's film gate decides."""
    settings = FrameSettings(
        width=arguments.imageWidth,
        height=1,
        engine=arguments.engine,
        rays=arguments.rays,
        layers=arguments.layers,
        supersample=arguments.supersample,
        wavelengths=arguments.wavelengths,
        shading=arguments.shading,
        motion=_moments(arguments),
        motion_by=arguments.motion_by or MOTIONS[0],
        seed=arguments.seed,
        aovs=shared.split_words(arguments.aov),
    )
    check_settings(settings)
    return settings


def _moments(arguments: argparse.Namespace) -> int:
    """How often motion is looked at; a long exposure without --motion finds out itself."""
    if arguments.motion is None:
        return 1 if arguments.motion_by is None or arguments.long_exposure is not None else MOMENTS
    if arguments.motion == 1 and arguments.motion_by is not None and arguments.long_exposure is None:
        raise SettingsError("--motion-by is how motion is looked at, which --motion 1 stops: leave out one of them")
    return int(arguments.motion)


def _record(
    shot: Shot,
    camera: str | None,
    plan: Sequence[tuple[float, Path]],
    settings: FrameSettings,
    stock: str | None,
    grade: GradeChoice | None,
    viewed: Viewed,
) -> list[dict[str, Any]]:
    """Render and write each frame of the plan; what was written, for --json."""
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: not before the shot is found good

    written = []
    with FrameRenderer() as renderer, FrameProgress(len(plan)) as progress:
        for time, file in plan:
            began = clock.perf_counter()
            progress.begin(file.name)
            picture = make_picture(
                renderer, shot, camera, time, settings, on_progress=progress.within, stock=stock, choice=grade
            )
            write_frame(file, picture.frame, viewed(picture.graded, picture.camera), picture.metadata)
            seconds = clock.perf_counter() - began
            progress.finish(str(file), seconds)
            written.append({"time": time, "file": str(file), "seconds": round(seconds, 3)})
    return written
