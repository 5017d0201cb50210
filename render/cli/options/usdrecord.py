"""Options of `pullfocus record` that usdrecord has too, beside those of camera, frames and size."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

from pxr import Trace

from render.cli.console import print_message
from render.errors import SettingsError
from render.files import check_writable
from render.gl.no_gpu import NO_GPU


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
        help="RenderPass prim to use: its renderSource for settings, and its collections",
    )
    group.add_argument(
        "--renderer",
        "-r",
        metavar="NAME",
        help="renderer of Hydra, for scripts; Pullfocus says that it draws in its place",
    )
    group.add_argument(
        "--disableGpu",
        action="store_true",
        help="draw with Mesa's software rasteriser; an error where OpenGL has a GPU only",
    )
    group.add_argument(
        "--products",
        action="store_true",
        help="write every product of the RenderSettings prim, with its own camera, size and vars, below the folder OUT",
    )
    group.add_argument(
        "--disableDrawMode", action="store_true", help="do not warn of draw modes: geometry is drawn in any case"
    )
    group.add_argument(
        "--disableCameraLight",
        action="store_const",
        const="stage",
        default=argparse.SUPPRESS,
        dest="lights",
        help="leave a stage without lights dark: --lights stage",
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

    group = parser.add_argument_group("measurements")
    group.add_argument("--traceToFile", type=Path, metavar="FILE", help="write USD's own trace of the run")
    group.add_argument(
        "--traceFormat",
        choices=("chrome", "trace"),
        default="chrome",
        help="of the trace: for Chrome, or a text report",
    )
    group.add_argument("--memstats", action="store_true", help="print the most memory that the run held at once")


@contextmanager
def applied(arguments: argparse.Namespace) -> Iterator[None]:
    """Apply the options that hold for a whole run: device, trace and memory.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        OutputError: the trace cannot be written.
    """
    if arguments.renderer is not None and arguments.renderer.lower() != "pullfocus":
        print_message(f"renderer: Pullfocus, in place of {arguments.renderer}")
    with (
        _without_gpu() if arguments.disableGpu else nullcontext(),
        _traced(arguments.traceToFile, arguments.traceFormat),
    ):
        yield
    if arguments.memstats:
        print_message(f"memory: {_peak_memory_mb():,.0f} MB at most")


@contextmanager
def _without_gpu() -> Iterator[None]:
    before = os.environ.get(NO_GPU)
    os.environ[NO_GPU] = "1"
    try:
        yield
    finally:
        os.environ.pop(NO_GPU)
        if before is not None:
            os.environ[NO_GPU] = before


@contextmanager
def _traced(file: Path | None, format: str) -> Iterator[None]:
    if file is None:
        yield
        return
    check_writable(file)
    collector = Trace.Collector()
    collector.enabled = True
    try:
        yield
    finally:
        collector.enabled = False
    reporter = Trace.Reporter.globalReporter
    (reporter.ReportChromeTracingToFile if format == "chrome" else reporter.Report)(str(file))


def _peak_memory_mb() -> float:
    import resource  # Unix has it alone

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform != "darwin" else 1024**2)


def check_arguments(arguments: argparse.Namespace) -> None:
    """Check that the options fit together.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: both a settings prim and a render pass are named.
    """
    if arguments.renderSettingsPrimPath is not None and arguments.renderPassPrimPath is not None:
        raise SettingsError("--renderPassPrimPath names its own settings: leave out --renderSettingsPrimPath")
