"""Run `pullfocus record` in this process and write where its time goes: the script that the start bench runs.

    python -P recorder.py TIMES.json record STAGE OUT ...

Functions of the product are wrapped as their modules are loaded. A function that calls another wrapped one is charged with its
own time alone. A function that is missing, as in an older checkout, is passed over; TIMES.json names it. The script imports
nothing of the product and is started by its file name, so that it can measure a checkout other than its own.
"""

from __future__ import annotations

import sys
from time import perf_counter

_BEGAN = perf_counter()

import json  # noqa: E402 - the clock starts first
from collections.abc import Callable, Generator  # noqa: E402
from functools import partial, wraps  # noqa: E402
from importlib import import_module  # noqa: E402
from importlib.abc import Loader, MetaPathFinder  # noqa: E402
from importlib.machinery import ModuleSpec  # noqa: E402
from inspect import isgeneratorfunction  # noqa: E402
from pathlib import Path  # noqa: E402
from types import ModuleType  # noqa: E402
from typing import Any  # noqa: E402

WATCHED: tuple[tuple[str, str, str], ...] = (
    ("render.shot.shot", "Shot.open", "stage"),
    ("render.shot.shot", "Shot.scene_at", "stage"),
    ("render.shot.shot", "Shot.camera_at", "stage"),
    ("render.gl.context", "GraphicsContext.__init__", "context"),
    ("render.layers.peel", "Peeler.load", "upload"),
    ("render.trace.rays", "make_ray_pattern", "ray pattern"),
    ("render.trace.bundles", "BundleMaker.make_bundle", "lens table"),
    ("render.gl.shaders", "ProgramCache.compute", "shaders"),
    ("render.layers.source_program", "SourceProgram._add_to_context", "shaders"),
    ("render.layers.peel", "Peeler.nearest_w", "peel"),
    ("render.layers.peel", "Peeler.peel_by", "peel"),
    ("render.layers.nbuffers", "NBufferBuilder.build", "peel"),
    ("render.trace.highlights.carrier", "HighlightCarrier.find", "highlights"),
    ("render.trace.highlights.carrier", "HighlightCarrier.carry", "highlights"),
    ("render.trace.tracer", "Tracer.passes", "trace"),
    ("render.shot.film.shot_film", "ShotFilm.finish", "film"),
    ("render.pictures.picture", "develop_picture", "film"),
    ("render.output.write", "write_frame", "write"),
)
"""Module, function and stage that its time is charged to."""
ON_DEVICE = ("upload", "lens table", "peel", "highlights", "trace")
"""Stages that end when the device has executed their commands."""
FIRST_PIXEL = ("render.cli.console", "FrameProgress.update")
"""Called when the first rays are traced."""
OTHER = "other"


class Stopwatch:
    """Time by stage, each moment charged to the innermost stage, before the first pixel and after it."""

    def __init__(self) -> None:
        self.before: dict[str, float] = {}
        self.after: dict[str, float] = {}
        self.first_pixel: float | None = None
        self._open: list[str] = [OTHER]
        self._since = _BEGAN

    def enter(self, stage: str) -> None:
        """Begin a stage within the current one."""
        self._charge()
        self._open.append(stage)

    def leave(self) -> None:
        """End the innermost stage."""
        self._charge()
        self._open.pop()

    def note_first_pixel(self) -> None:
        """Note that the first rays are traced; later calls change nothing."""
        if self.first_pixel is None:
            self._charge()
            self.first_pixel = self._since

    def _charge(self) -> None:
        now = perf_counter()
        spent = self.before if self.first_pixel is None else self.after
        spent[self._open[-1]] = spent.get(self._open[-1], 0.0) + now - self._since
        self._since = now


class Watcher(MetaPathFinder):
    """Import hook: charges imports, and wraps the watched functions of each module that is loaded."""

    def __init__(self, stopwatch: Stopwatch) -> None:
        self._stopwatch = stopwatch
        self._finish: Callable[[], None] = lambda: None
        self.device = ""
        self.missing = [f"{module}:{name}" for module, name, _ in WATCHED]

    def find_spec(self, name: str, path: Any, target: ModuleType | None = None) -> ModuleSpec | None:
        """Find a module as without the hook, with a loader that is watched."""
        self._stopwatch.enter("imports")
        try:
            for finder in sys.meta_path:
                spec = None if finder is self else finder.find_spec(name, path, target)
                if spec is not None:
                    if isinstance(spec.loader, Loader):
                        self._watch(name, spec.loader)
                    return spec
            return None
        finally:
            self._stopwatch.leave()

    def _watch(self, name: str, loader: Loader) -> None:
        load = loader.exec_module

        def exec_module(module: ModuleType) -> None:
            self._stopwatch.enter("imports")
            try:
                load(module)
            finally:
                self._stopwatch.leave()
            self._wrap_functions(name, module)

        try:
            loader.exec_module = exec_module  # type: ignore[method-assign]
        except AttributeError:  # a loader shared by modules, such as that of built-in ones
            return

    def _wrap_functions(self, name: str, module: ModuleType) -> None:
        for watched, function, stage in WATCHED:
            if watched == name and self._replace(module, function, partial(self._timed, stage)):
                self.missing.remove(f"{watched}:{function}")
        if name == FIRST_PIXEL[0]:
            self._replace(module, FIRST_PIXEL[1], self._noting_first_pixel)

    def _replace(self, module: ModuleType, function: str, wrap: Callable[[Any], Any]) -> bool:
        *owners, attribute = function.split(".")
        owner: Any = module
        for part in owners:
            owner = getattr(owner, part, None)
        inner = None if owner is None else vars(owner).get(attribute)
        if inner is None:
            return False
        is_class_method = isinstance(inner, classmethod)
        wrapped = wrap(inner.__func__ if is_class_method else inner)
        setattr(owner, attribute, classmethod(wrapped) if is_class_method else wrapped)
        return True

    def _noting_first_pixel(self, inner: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(inner)
        def update(*arguments: Any, **options: Any) -> Any:
            self._stopwatch.note_first_pixel()
            return inner(*arguments, **options)

        return update

    def _timed(self, stage: str, inner: Callable[..., Any]) -> Callable[..., Any]:
        if isgeneratorfunction(inner):

            @wraps(inner)
            def steps(*arguments: Any, **options: Any) -> Generator[Any, None, Any]:
                work = inner(*arguments, **options)
                while True:
                    self._stopwatch.enter(stage)
                    try:
                        step = next(work)
                    except StopIteration as end:
                        return end.value
                    finally:
                        self._leave(stage)
                    yield step

            return steps

        @wraps(inner)
        def timed(*arguments: Any, **options: Any) -> Any:
            self._stopwatch.enter(stage)
            try:
                return inner(*arguments, **options)
            finally:
                if stage == "context":
                    graphics = arguments[0]
                    self._finish, self.device = graphics.ctx.finish, graphics.renderer
                self._leave(stage)

        return timed

    def _leave(self, stage: str) -> None:
        if stage in ON_DEVICE:
            self._finish()
        self._stopwatch.leave()


def main(file: Path, arguments: list[str]) -> int:
    """Run `pullfocus` and write its times, in seconds.

    Args:
        file: of the times: ``began``, ``first_pixel`` and ``ended`` by the system's monotonic clock; ``before`` and ``after``
            the first pixel, by stage; ``modules``, the number that are loaded; ``missing`` functions; ``device``, the driver's
            name of it.
        arguments: as typed after ``pullfocus``.
    """
    stopwatch = Stopwatch()
    watcher = Watcher(stopwatch)
    sys.meta_path.insert(0, watcher)
    status: int = import_module("render.cli.main").main(arguments)
    stopwatch.enter(OTHER)
    times = {
        "began": _BEGAN,
        "first_pixel": stopwatch.first_pixel,
        "ended": perf_counter(),
        "before": stopwatch.before,
        "after": stopwatch.after,
        "modules": len(sys.modules),
        "missing": watcher.missing,
        "device": watcher.device,
    }
    file.write_text(json.dumps(times), encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
