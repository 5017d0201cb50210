"""Plan of the scale bench, and its arguments. Imports neither OpenGL nor USD, so that the command line starts at once."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace

from render.errors import SettingsError


@dataclass(frozen=True)
class SceneSize:
    """Size of a generated stage and of its picture.

    Attributes:
        triangles: triangles of all meshes together.
        prims: meshes, all of one size.
        instances: point instances of one small prototype.
        natives: native instances of one small prim.
        movers: small meshes that move, each by itself.
        lights: sphere lights that cast shadows.
        width: picture width in pixels; pictures are 16:9.
    """

    triangles: int = 100_000
    prims: int = 100
    instances: int = 0
    natives: int = 0
    movers: int = 0
    lights: int = 4
    width: int = 480


BASE = SceneSize()
PRIMS_BASE = replace(BASE, triangles=400_000)
"""Base of the axis of prims: with 100,000 of them, each has four triangles."""
AXES: dict[str, tuple[SceneSize, tuple[int, ...]]] = {
    "triangles": (BASE, (100_000, 300_000, 1_000_000, 3_000_000, 10_000_000, 20_000_000)),
    "prims": (PRIMS_BASE, (100, 1_000, 10_000, 100_000)),
    "instances": (BASE, (1_000, 10_000, 100_000, 1_000_000)),
    "natives": (BASE, (100, 1_000, 10_000, 100_000)),
    "movers": (BASE, (100, 1_000, 10_000)),
    "lights": (BASE, (1, 4, 16, 64, 250, 500)),
    "width": (BASE, (480, 960, 1920, 3840, 7680)),
}
"""For each axis: the size that the others keep, and the values along it."""
QUICK_BASE = SceneSize(triangles=4_000, prims=10, lights=1, width=96)
QUICK_AXES: dict[str, tuple[SceneSize, tuple[int, ...]]] = {
    "triangles": (QUICK_BASE, (4_000, 16_000)),
    "prims": (QUICK_BASE, (10, 40)),
    "instances": (QUICK_BASE, (100, 1_000)),
    "natives": (QUICK_BASE, (10, 100)),
    "movers": (QUICK_BASE, (10, 40)),
    "lights": (QUICK_BASE, (1, 4)),
    "width": (QUICK_BASE, (96, 192)),
}
TIMEOUT_S, MEMORY_GB = 600.0, 8.0


@dataclass(frozen=True)
class ScalePlan:
    """Plan of the bench.

    Attributes:
        axes: base and values of each axis that is measured.
        timeout_s: longest time of a case, seconds.
        memory_gb: most resident memory of a case, 10⁹ bytes.
    """

    axes: dict[str, tuple[SceneSize, tuple[int, ...]]]
    timeout_s: float
    memory_gb: float

    def cases(self) -> Iterator[tuple[str, int, SceneSize]]:
        """Axis, value and size of each case, in order."""
        for axis, (base, values) in self.axes.items():
            for value in values:
                yield axis, value, replace(base, **{axis: value})


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the tables"
    )
    parser.add_argument("--quick", action="store_true", help="small stages and pictures: does it all work")
    parser.add_argument("--axis", action="append", choices=tuple(AXES), help="measure this axis only; may be repeated")
    parser.add_argument("--most", type=int, metavar="N", help="leave out larger values of the axes")
    parser.add_argument(
        "--timeout", type=float, default=TIMEOUT_S, metavar="S", help="end a case after so many seconds (%(default)g)"
    )
    parser.add_argument(
        "--memory", type=float, default=MEMORY_GB, metavar="GB", help="end a case that takes more memory (%(default)g)"
    )


def plan_from_arguments(arguments: argparse.Namespace) -> ScalePlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: a limit is not positive, or leaves no case.
    """
    for name in ("timeout", "memory"):
        if not getattr(arguments, name) > 0:
            raise SettingsError(f"--{name} must be more than 0, got {getattr(arguments, name):g}")
    axes = {
        axis: (base, tuple(value for value in values if arguments.most is None or value <= arguments.most))
        for axis, (base, values) in (QUICK_AXES if arguments.quick else AXES).items()
        if arguments.axis is None or axis in arguments.axis
    }
    axes = {axis: (base, values) for axis, (base, values) in axes.items() if values}
    if not axes:
        raise SettingsError(f"--most {arguments.most} leaves no case to measure")
    return ScalePlan(axes, arguments.timeout, arguments.memory)
