"""Templates of Open Job Description: a shot that a farm renders by `pullfocus record`, one task for each frame.

A template is a job of one step, with the frames as its task parameter (Template Schemas, revision 2023-09). Names of files are
values of job parameters, which a farm takes as they are and maps to the folders of its workers. All other text is a format
string, which has no escape for its double braces.
"""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from render.errors import SettingsError
from render.model.limits import MAX_PICTURE_SIDE_PX, MAX_RAYS
from service.jobs.frame_ranges import format_frames

SPECIFICATION = "jobtemplate-2023-09"
STEP = "Render"
MAX_PATH_CHARACTERS = 1024
"""Length of a parameter's value."""
LEAST_PROCESSORS = 2
"""Processors of a worker: a frame takes all that there are."""
_MAX_NAME_CHARACTERS = 128
_BRACES = ("{{", "}}")
_NO_TEXT = {"Cc": "a control character", "Cs": "bytes that are no UTF-8"}


@dataclass(frozen=True)
class PathParameter:
    """A file or folder that a task reads or writes.

    Attributes:
        name: of the job parameter.
        path: absolute.
        flow: IN is read, OUT is written.
        about: the parameter's description.
        is_folder: whether it is a folder.
    """

    name: str
    path: Path
    flow: Literal["IN", "OUT"]
    about: str
    is_folder: bool = False


@dataclass(frozen=True)
class FarmJob:
    """A shot to be rendered by a farm.

    Attributes:
        name: of the job.
        shot: the USD file, absolute.
        folder: that pictures are written to, absolute.
        image_name: file name of a picture with ``#`` for the frame number; None where the shot names the files below the folder.
        frames: whole USD time codes.
        options: further arguments of `pullfocus record`: format strings, in which `refer` names the files.
        files: other files that the options refer to.
        width_px: of the pictures; None for a width that is not to be changed at submission.
        rays: for each pixel; None for a number that is not to be changed at submission.
        timeout_s: time for a frame, s.
    """

    name: str
    shot: Path
    folder: Path
    image_name: str | None
    frames: Sequence[int]
    options: Sequence[str] = ()
    files: Sequence[PathParameter] = ()
    width_px: int | None = None
    rays: int | None = None
    timeout_s: int = 21_600


def refer(parameter: str) -> str:
    """Return the format string for the value of a job parameter."""
    return f"{{{{Param.{parameter}}}}}"


def check_text(what: str, text: str) -> str:
    """Return a text that a template can hold in a parameter's value.

    Args:
        what: the text is, for the message.
        text: the text.

    Raises:
        SettingsError: it has control characters, or no UTF-8 form.
    """
    bad = next((kind for kind in map(unicodedata.category, text) if kind in _NO_TEXT), None)
    if bad is not None:
        raise SettingsError(
            f"{what} has {_NO_TEXT[bad]}, which no template can hold: {text!a}", code="bad_template_text"
        )
    return text


def check_literal(what: str, text: str) -> str:
    """Return a text that a template can hold where format strings stand.

    Args:
        what: the text is, for the message.
        text: the text.

    Raises:
        SettingsError: as for `check_text`, or it has double braces.
    """
    braces = next((braces for braces in _BRACES if braces in text), None)
    if braces is not None:
        raise SettingsError(
            f"{what} has {braces}, which begins or ends a variable of Open Job Description and has no escape: {text!r}",
            code="bad_template_text",
        )
    return check_text(what, text)


def make_template(job: FarmJob, template_folder: Path) -> dict[str, Any]:
    """Make the template of a job.

    Args:
        job: the job.
        template_folder: absolute folder that the template will lie in. What lies in it has relative paths, as the specification
            wants; other paths have no default and are given at submission.

    Returns:
        Plain data, to be written as JSON.

    Raises:
        SettingsError: a name cannot stand in a template.
    """
    paths = _path_parameters(job)
    parameters = [_path_definition(path, template_folder) for path in paths]
    outputs = [refer("OutputFolder")]
    if job.image_name is not None:
        about = "File name of a picture, with # for the frame number: .exr, .png or .jpg."
        value = check_text("the name of the pictures", job.image_name)
        parameters.append(
            {"name": "ImageName", "type": "STRING", "description": about, "minLength": 1, "default": value}
        )
        outputs.append(refer("ImageName"))
    arguments = ["record", refer("Shot"), "/".join(outputs), *job.options]
    for option, name, value_of, most, about in (
        ("--imageWidth", "Width", job.width_px, MAX_PICTURE_SIDE_PX, "Width of a picture in pixels."),
        ("--rays", "Rays", job.rays, MAX_RAYS, "Lens rays for each pixel."),
    ):
        if value_of is not None:
            parameters.append(_number_definition(name, value_of, most, about))
            arguments.append(f"{option}={refer(name)}")
    arguments.append("--frames={{Task.Param.Frame}}")
    return {
        "specificationVersion": SPECIFICATION,
        "name": check_literal("the name of the job", job.name)[:_MAX_NAME_CHARACTERS],
        "parameterDefinitions": parameters,
        "steps": [_step(arguments, job)],
    }


def required_parameters(job: FarmJob, template_folder: Path) -> list[PathParameter]:
    """List the files and folders outside the template's folder, whose parameters have no default."""
    return [path for path in _path_parameters(job) if not path.path.is_relative_to(template_folder)]


def _path_parameters(job: FarmJob) -> list[PathParameter]:
    return [
        PathParameter("Shot", job.shot, "IN", "The shot, a USD file."),
        PathParameter("ShotFolder", job.shot.parent, "IN", "Folder with all files of the shot.", is_folder=True),
        *job.files,
        PathParameter("OutputFolder", job.folder, "OUT", "Folder that pictures are written to.", is_folder=True),
    ]


def _path_definition(path: PathParameter, template_folder: Path) -> dict[str, Any]:
    definition: dict[str, Any] = {
        "name": path.name,
        "type": "PATH",
        "description": path.about,
        "objectType": "DIRECTORY" if path.is_folder else "FILE",
        "dataFlow": path.flow,
    }
    value = check_text(f"the path of {path.name}", os.fspath(path.path))
    if len(value) > MAX_PATH_CHARACTERS:
        raise SettingsError(
            f"the path of {path.name} may have {MAX_PATH_CHARACTERS} characters in a template, got {len(value)}",
            code="bad_template_text",
        )
    if path.path.is_relative_to(template_folder):
        definition["default"] = path.path.relative_to(template_folder).as_posix()
    return definition


def _number_definition(name: str, default: int, most: int, about: str) -> dict[str, Any]:
    return {
        "name": name,
        "type": "INT",
        "description": about,
        "minValue": 1,
        "maxValue": most,
        "default": default,
    }


def _step(arguments: Sequence[str], job: FarmJob) -> dict[str, Any]:
    """Make the step. Its environment makes the folder of the pictures, which `pullfocus record` does not."""
    make_folder = {"command": "mkdir", "args": ["-p", refer("OutputFolder")]}
    run = {"command": "pullfocus", "args": list(arguments), "timeout": job.timeout_s}
    frames = {"name": "Frame", "type": "INT", "range": format_frames(sorted(job.frames))}
    return {
        "name": STEP,
        "parameterSpace": {"taskParameterDefinitions": [frames]},
        "hostRequirements": {
            "amounts": [{"name": "amount.worker.vcpu", "min": LEAST_PROCESSORS}],
            "attributes": [{"name": "attr.worker.os.family", "anyOf": ["linux"]}],
        },
        "stepEnvironments": [{"name": "OutputFolder", "script": {"actions": {"onEnter": make_folder}}}],
        "script": {"actions": {"onRun": run}},
    }
