"""Limits on the prims that are walked and drawn: files of a kilobyte can ask for more than time or memory allow."""

from __future__ import annotations

from render.errors import StageError

# Prims met below instances, native ones and those of point instancers: a few seconds' walk.
MAX_INSTANCED_PRIMS = 200_000
# Places of one surface below point instancers, nested ones multiplied out: about 350 MB of poses.
MAX_PLACES = 2_000_000


# Triangles of all instances at a time: a hundred seconds on two cores.
MAX_DRAWN_TRIANGLES = 200_000_000


class PlaceError(StageError):
    """Surface or light that has no place that can be used, or too many of them; the path is that of the prim at fault."""


class PrimCount:
    """Counts the prims of a walk that lie below instances."""

    def __init__(self) -> None:
        self._count = 0

    def add(self, path: object) -> None:
        """Count one more.

        Raises:
            StageError: there are too many; code ``too_many_prims``.
        """
        self._count += 1
        if self._count > MAX_INSTANCED_PRIMS:
            raise StageError(
                f"the stage has more than {MAX_INSTANCED_PRIMS:,} prims in instances, at {path} among others: "
                "expected fewer instances within instances",
                code="too_many_prims",
                path=str(path),
            )


def check_places(count: int, instancer: object) -> None:
    """Raise `PlaceError`, code ``too_many_instances``, where an instancer multiplies a surface beyond `MAX_PLACES`."""
    if count > MAX_PLACES:
        raise PlaceError(
            f"instancer {instancer} has {count:,} instances with those it is nested in: expected up to {MAX_PLACES:,}",
            code="too_many_instances",
            path=str(instancer),
        )
