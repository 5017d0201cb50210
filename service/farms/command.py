"""`pullfocus export-openjd`: write a template of Open Job Description, by which a farm records a shot.

The options are those of `pullfocus record`. They are checked against the shot before anything is written, and a file that they
name becomes a parameter of the job.
"""

from __future__ import annotations

import argparse
import json
import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from render.cli import record
from render.cli.console import print_message
from render.cli.options import scene, shared, stereo
from render.cli.parser import Parser
from render.cli.recording.products import product_files
from render.engines import engine_class
from render.errors import SettingsError
from render.files import check_writable, write_atomic
from render.model.frame_settings import FrameSettings
from render.model.frame_spec import every_frame, frame_file_names
from render.optics.lens_files import is_data_sheet
from render.output import format_of
from render.shot import Shot
from render.shot.film.finish import read_finish
from render.shot.lens.lens_choice import is_lens_file
from render.stage.opening import quiet_diagnostics
from service.jobs.openjd import (
    FarmJob,
    PathParameter,
    check_literal,
    make_template,
    refer,
    required_parameters,
)

_OWN = ("help", "task_timeout", "frames")
"""Options that the template has in another form, or not."""
_OTHER_WAYS = {
    "defaultTime": "--defaultTime has no frames",
    "long_exposure": "--long-exposure is one picture of many frames",
    "contact_sheet": "--contact-sheet is one picture",
    "traceToFile": "--traceToFile is one file, which each task would write",
}
_MAX_TIMEOUT_S = 30 * 86_400


@dataclass(frozen=True)
class _Named:
    """A file that an option names.

    Attributes:
        parameter: for the file.
        rest: text that follows the file's name, such as the id of a colour correction.
    """

    parameter: PathParameter
    rest: str = ""


def export_openjd(arguments: Sequence[str]) -> int:
    """Write the template.

    Args:
        arguments: as typed after ``pullfocus export-openjd``.

    Returns:
        The exit status.

    Raises:
        SettingsError: an option is wrong, or makes no sense for a farm; a name cannot stand in a template.
        InputError: the shot, its camera, or a file that an option names cannot be used.
        OutputError: the template cannot be written.
    """
    parser = _parser()
    typed = parser.parse_args(arguments)
    template = _absolute(typed.template)
    if template.suffix != ".json":
        raise SettingsError(f"a template is a .json file, got {typed.template}", code="unknown_format")
    if typed.out is None:
        renders = template.parent / "renders"
        typed.out = os.fspath(renders if typed.products else renders / f"{Path(typed.stage).stem}.####.exr")
    check_writable(template)
    with quiet_diagnostics():
        job = _make_job(parser, typed, template)
    content = json.dumps(make_template(job, template.parent), indent=2, ensure_ascii=False)
    write_atomic(template, f"{content}\n".encode())
    tasks = "1 task" if len(job.frames) == 1 else f"{len(job.frames):,} tasks"
    print_message(f"{typed.template}: {tasks}")
    required = required_parameters(job, template.parent)
    if required:
        given = " ".join(f"-p {shlex.quote(f'{parameter.name}={parameter.path}')}" for parameter in required)
        print_message(f"not in the folder of the template, so to be given at submission: {given}")
    return 0


def _parser() -> Parser:
    parser = Parser(
        prog="pullfocus export-openjd",
        description="Write a template of Open Job Description, by which a farm records a shot: a task for each frame. It takes"
        " the options of `pullfocus record`.",
    )
    shared.add_stage(parser)
    parser.add_argument("template", metavar="TEMPLATE", help="the template to write, a .json file")
    parser.add_argument(
        "out",
        metavar="OUT",
        nargs="?",
        help="pictures that the farm writes, as for record: .exr, .png or .jpg, with a run of # for the frame number; with"
        " --products a folder; without it renders/NAME.####.exr beside the template",
    )
    parser.add_argument(
        "--task-timeout",
        metavar="S",
        type=int,
        default=FarmJob.timeout_s,
        help="seconds after which a farm gives up a frame (default: %(default)s)",
    )
    record.add_options(parser)
    return parser


def _make_job(parser: Parser, typed: argparse.Namespace, template: Path) -> FarmJob:
    """Check the arguments and the shot, and collect what the template holds."""
    for name, reason in _OTHER_WAYS.items():
        if getattr(typed, name):
            raise SettingsError(f"{reason}, and a farm has a task for each frame: leave it out")
    shared.check_number("--task-timeout", typed.task_timeout, 1, _MAX_TIMEOUT_S, "seconds")
    out = _absolute(typed.out)
    _check_out(typed, out)
    options = record.read_options(typed)
    shot = scene.open_shot(typed)
    shot.check_not_own(template)
    frames = _whole_frames(options.frames or every_frame(shot.frame_range.start, shot.frame_range.end))
    settings = None
    if typed.products:
        _check_products(typed, shot, out, frames)
    else:
        _check_names(typed, frames)
        settings = _settings(typed, shot, options, frames)
    named = _named_files(typed)
    changeable = _changeable(typed, options, settings)
    return FarmJob(
        name=Path(typed.stage).stem,
        shot=_absolute(typed.stage),
        folder=out if typed.products else out.parent,
        image_name=None if typed.products else out.name,
        frames=frames,
        options=_options(parser, typed, named, changeable),
        files=[each.parameter for each in named.values()],
        width_px=changeable.get("imageWidth"),
        rays=changeable.get("rays"),
        timeout_s=typed.task_timeout,
    )


def _check_out(typed: argparse.Namespace, out: Path) -> None:
    """Check the pattern of file names: each task sees one frame, and cannot know that the next one has the same name."""
    folder = os.fspath(out if typed.products else out.parent)
    if "#" in folder or (typed.stereo and "%v" in folder.lower()):
        raise SettingsError(f"the folder of the pictures may hold no place for a frame number or an eye, got {folder}")
    if typed.products:
        return
    format_of(out.name)
    if "#" not in out.name:
        raise SettingsError(
            f"the frames of a farm need a place for the frame number in {typed.out!r}, such as shot.####.exr"
        )


def _whole_frames(times: Sequence[float]) -> list[int]:
    fraction = next((time for time in times if not time.is_integer()), None)
    if fraction is not None:
        raise SettingsError(f"the tasks of Open Job Description are whole frames, got {fraction:g}: choose by --frames")
    return [int(time) for time in times]


def _check_names(typed: argparse.Namespace, frames: Sequence[float]) -> None:
    if typed.stereo:
        stereo.view_files(typed.out, frames)
    else:
        frame_file_names(typed.out, frames)


def _check_products(typed: argparse.Namespace, shot: Shot, folder: Path, frames: Sequence[float]) -> None:
    """Check that all products can be named, for all frames."""
    for product in shot.products():
        product_files(product, folder, frames, is_stereo=typed.stereo)
        shared.choose_camera(shot, product.camera_path)


def _settings(
    typed: argparse.Namespace, shot: Shot, options: record.RecordOptions, frames: Sequence[float]
) -> FrameSettings:
    """Settings of the pictures, once the camera is set and checked."""
    with shared.printed_findings(shot, typed.stage):
        if typed.stereo:
            camera_path: str | None = stereo.choose_pair(shot, typed.camera).left
        else:
            camera_path = shared.choose_camera(shot, typed.camera)
        job = record.make_job(shot, camera_path, options, frames[0])
        camera = shot.camera_at(job.camera_path, frames[0], job.settings.width, job.settings.height)
        read_finish(shot.stage, camera, frames[0], stock=job.stock, choice=job.grade)
    return job.settings


def _changeable(
    typed: argparse.Namespace, options: record.RecordOptions, settings: FrameSettings | None
) -> Mapping[str, int]:
    """Values that may be changed at submission, by the name of the option: none where the stage or a noise level gives them."""
    if settings is None:
        return {}
    width = {} if options.takes_resolution else {"imageWidth": settings.width}
    has_rays = engine_class(settings).has_rays and settings.noise == 0
    return width | ({"rays": settings.rays} if has_rays else {})


def _named_files(typed: argparse.Namespace) -> dict[str, _Named]:
    """Files that the options name, by the attribute of the option."""
    names: dict[str, tuple[str, str, str]] = {}
    if typed.edits is not None:
        names["edits"] = ("EditLayer", "Layer of edits over the shot.", typed.edits)
    if typed.sessionLayer is not None:
        names["sessionLayer"] = ("SessionLayer", "Layer that is put over the stage.", typed.sessionLayer)
    if typed.lens is not None and (is_lens_file(typed.lens) or is_data_sheet(typed.lens)):
        names["lens"] = ("LensFile", "Lens to mount.", typed.lens)
    if typed.ocio_config is not None and not typed.ocio_config.startswith("ocio://"):
        names["ocio_config"] = ("OcioConfig", "OpenColorIO configuration.", typed.ocio_config)
    named = {
        option: _Named(PathParameter(name, _absolute(path), "IN", about))
        for option, (name, about, path) in names.items()
    }
    if typed.cdl is not None:
        path, mark, correction = typed.cdl.rpartition("#") if "#" in typed.cdl else (typed.cdl, "", "")
        if Path(path).is_file():
            parameter = PathParameter("CdlFile", _absolute(path), "IN", "Colour correction.")
            named["cdl"] = _Named(parameter, f"{mark}{correction}")
    return named


def _options(
    parser: Parser, typed: argparse.Namespace, named: Mapping[str, _Named], changeable: Mapping[str, int]
) -> list[str]:
    """Options of `record` as format strings, each in one word, so that a value may begin with a hyphen."""
    words = []
    for action in parser._actions:
        value = getattr(typed, action.dest, None)
        if not action.option_strings or action.dest in _OWN or action.dest in changeable or value == action.default:
            continue
        option = next(name for name in action.option_strings if name.startswith("--"))
        if action.dest in named:
            file = named[action.dest]
            words.append(f"{option}={refer(file.parameter.name)}{check_literal(option, file.rest)}")
        elif action.nargs == 0:
            words += [option] if value == action.const else []
        else:
            words.append(f"{option}={check_literal(option, str(value))}")
    return words


def _absolute(path: str | os.PathLike[str]) -> Path:
    """Absolute path without ``..``; links are kept, since a farm may have them elsewhere."""
    return Path(os.path.abspath(path))
