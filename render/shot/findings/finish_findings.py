"""Findings of film and grade settings that no picture can be finished with, found without rendering."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from pxr import Usd

from render.errors import PullfocusError
from render.model.camera import Camera
from render.shot.film.finish import read_finish
from render.stage import Finding
from usd_schemas.keys import keys
from usd_schemas.validation import Problem
from usd_schemas.values import is_animated

_UNREADABLE = ("AuthoredTypes", "ValuesAllowed")
_MAX_KEYS = 50
"""Keys of a camera that are checked, evenly chosen where there are more."""


def finish_findings(
    stage: Usd.Stage,
    camera_at: Callable[[str, float], Camera],
    camera_paths: Sequence[str],
    time: float,
    validation: Iterable[Problem],
) -> Iterator[Finding]:
    """Find the cameras whose pictures cannot be finished: errors that `record` would end with.

    Args:
        stage: the shot.
        camera_at: a camera for a picture at a time, its focus solved.
        camera_paths: of its cameras.
        time: USD time code that is checked first; then the keys of film and grade.
        validation: problems from the validators; a camera with a problem in ``film:*``, or with an unreadable value, is skipped.

    Yields:
        One finding for a camera; a camera that cannot be read at all has none.
    """
    known = [(problem.rule, problem.path) for problem in validation if problem.severity == "error"]
    for path in camera_paths:
        film_prefix, camera_prefix = f"{path}.film:", f"{path}."
        if any(
            known_path.startswith(camera_prefix if rule in _UNREADABLE else film_prefix) for rule, known_path in known
        ):
            continue
        for at in _times(stage.GetPrimAtPath(path), time):
            finding = _finish_finding(stage, camera_at, path, at)
            if finding is not None:
                yield finding if at == time else replace(finding, message=f"{finding.message} (at time code {at:g})")
                break


def _times(prim: Usd.Prim, first: float) -> list[float]:
    """The time, and those of the keys of film and grade, thinned out where there are many."""
    keyed = {
        key.time
        for attribute in prim.GetPropertiesInNamespace("film")
        if isinstance(attribute, Usd.Attribute) and is_animated(attribute)
        for key in keys(attribute)
    }
    others = sorted(keyed - {first})
    return [first, *others[:: max(1, len(others) // _MAX_KEYS)]]


def _finish_finding(
    stage: Usd.Stage, camera_at: Callable[[str, float], Camera], path: str, time: float
) -> Finding | None:
    """The error of a camera's finish at a time; None where there is none, or the camera itself cannot be read."""
    try:
        camera = camera_at(path, time)
    except PullfocusError:
        return None
    try:
        read_finish(stage, camera, time)
    except PullfocusError as error:
        return Finding(error.code, path, error.detail)
    return None
