"""What of a camera's film and grade cannot be made, found without a picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from pxr import Usd

from render.errors import PullfocusError
from render.model.camera import Camera
from render.shot.film.finish import finish_of
from render.stage import Finding
from usd_schemas.keys import keys
from usd_schemas.validation import Problem
from usd_schemas.values import is_animated

_UNREADABLE = ("AuthoredTypes", "ValuesAllowed")
_KEYS_LOOKED_AT = 50  # of a camera, or a few more


def finish_findings(
    stage: Usd.Stage,
    camera_at: Callable[[str, float], Camera],
    camera_paths: Sequence[str],
    time: float,
    validation: Iterable[Problem],
) -> Iterator[Finding]:
    """A finding for each camera whose pictures could not be finished: what `record` would end with.

    Args:
        stage: the shot.
        camera_at: a camera for a picture at a time, its focus solved.
        camera_paths: of its cameras.
        time: USD time code that is looked at first; then those of the keys of film and grade.
        validation: what the validators found: a camera with a wrong ``film:*`` or a value that cannot be read in it is told of
            already.

    Yields:
        Findings; a camera that cannot be read at all has none.
    """
    told = [(problem.rule, problem.path) for problem in validation if problem.severity == "error"]
    for path in camera_paths:
        of_film, of_camera = f"{path}.film:", f"{path}."
        if any(own.startswith(of_camera if rule in _UNREADABLE else of_film) for rule, own in told):
            continue
        for when in _times(stage.GetPrimAtPath(path), time):
            found = _unfinished(stage, camera_at, path, when)
            if found is not None:
                yield found if when == time else replace(found, message=f"{found.message} (at time code {when:g})")
                break


def _times(prim: Usd.Prim, first: float) -> list[float]:
    """The time, and those at which film or grade have keys; some of them where they are many."""
    keyed = {
        key.time
        for attribute in prim.GetPropertiesInNamespace("film")
        if isinstance(attribute, Usd.Attribute) and is_animated(attribute)
        for key in keys(attribute)
    }
    others = sorted(keyed - {first})
    return [first, *others[:: max(1, len(others) // _KEYS_LOOKED_AT)]]


def _unfinished(stage: Usd.Stage, camera_at: Callable[[str, float], Camera], path: str, time: float) -> Finding | None:
    """What is wrong with a camera's finish at a time; nothing where the camera itself cannot be read."""
    try:
        camera = camera_at(path, time)
    except PullfocusError:
        return None
    try:
        finish_of(stage, camera, time)
    except PullfocusError as error:
        return Finding(error.code, path, error.detail)
    return None
