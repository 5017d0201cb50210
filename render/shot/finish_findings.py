"""What of a camera's film and grade cannot be made, found without a picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from render.errors import PullfocusError
from render.shot.finish import finish_of
from render.shot.shot import Shot
from render.stage import Finding
from usd_schemas.validation import Problem

_SQUARE = (64, 64)  # a picture's size, which no finish depends on


def finish_findings(shot: Shot, time: float, validation: Iterable[Problem]) -> Iterator[Finding]:
    """A finding for each camera whose pictures could not be finished at a time: what `record` would end with.

    Args:
        shot: the shot.
        time: USD time code.
        validation: what the validators found: a camera with a wrong ``film:*`` in it is told of already.

    Yields:
        Findings; a camera that cannot be read at all has none.
    """
    told = [problem.path for problem in validation if problem.severity == "error"]
    for path in shot.cameras():
        if any(own.startswith(f"{path}.film:") for own in told):
            continue
        try:
            camera = shot.camera_at(path, time, *_SQUARE)
        except PullfocusError:
            continue
        try:
            finish_of(shot.stage, camera, time)
        except PullfocusError as error:
            yield Finding(error.code, path, error.detail)
