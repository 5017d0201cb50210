"""The soak: thousands of random edits of a shot, each answered by the progressive renderer, some to the end, some left half way.

Now and then what it rests on is held against a renderer that was made for that picture alone. Memory has to stay as it is.

pullfocus bench soak
"""

from __future__ import annotations

import argparse
import random
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np
from pxr import Gf, UsdGeom

from render.engines import engine_names
from render.errors import PullfocusError, SettingsError
from render.film import GradeChoice
from render.frame import FrameRenderer
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.lab.bench.soak.plan import SoakPlan, plan_from_arguments
from render.lab.bench.soak.shot import BALLS, CAMERA, FRAMES, write_soak_shot
from render.model.frame_settings import FrameSettings
from render.pictures.live_finisher import LiveFinisher
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot

PICTURE = FrameSettings(128, 72, rays=24, layers=3, supersample=1)
MOST_LEVELS, MOST_MB = 1.0, 64.0
_SETTLED = 0.3
"""Share of the edits after which memory must be stable: by then every program and texture has been needed."""


@dataclass(frozen=True)
class SoakBench:
    """Results of the soak; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        edits: number of edits.
        seconds: duration of the soak.
        pictures: number of pictures shown.
        finals: number of them that were the last of their edit.
        left: number of edits whose pictures were cancelled half way.
        edits_by_kind: number of edits of each kind.
        checks: number of comparisons with a new renderer.
        drift_levels: greatest difference from it, in 255 levels.
        memory_mb: memory of the process at each check, with the new renderer closed.
        growth_mb: growth of memory since the first third.
        gl_errors: OpenGL errors reported by the device.
        goals: goals and whether they are met.
    """

    device: str
    edits: int
    seconds: float
    pictures: int
    finals: int
    left: int
    edits_by_kind: dict[str, int]
    checks: int
    drift_levels: float
    memory_mb: list[float]
    growth_mb: float
    gl_errors: int
    goals: list[Goal]


class _Soak:
    """Shot and driver of the soak, with its random edits."""

    def __init__(self, renderer: FrameRenderer, shot: Shot, seed: int) -> None:
        self._renderer, self._shot = renderer, shot
        self._driver = ProgressiveRenderer(renderer, shot, LiveFinisher(renderer))
        self._random = random.Random(seed)
        self.request = PreviewRequest(CAMERA, FRAMES[0], PICTURE)
        self._edits: tuple[Callable[[], object], ...] = (
            self._focus,
            self._stop,
            self._zoom,
            self._mode,
            self._walk,
            self._push,
            self._hide,
            self._expose,
            self._scrub,
            self._load_film,
            self._grade,
            self._resize,
            self._other_engine,
            self._undo,
            self._redo,
        )
        self.kinds: Counter[str] = Counter()
        self.pictures = self.finals = self.left = self.gl_errors = 0

    def step(self) -> None:
        """Make one edit and its pictures."""
        edit = self._random.choice(self._edits)
        self.kinds[edit.__name__.strip("_").replace("_", " ")] += 1
        edit()
        patience = self._random.choice((0, 0, 0, 0, 3, 20, 10**9))
        request = replace(self.request, is_moving=patience == 0)
        asks = 0

        def is_stale() -> bool:
            nonlocal asks
            asks += 1
            return asks > patience

        is_final = False
        with suppress(SettingsError):  # the accumulation buffer knows planes of focus alone
            for shown in self._driver.pictures(request, is_stale=is_stale):
                self.pictures += 1
                is_final = shown.is_final
        self.finals += is_final
        self.left += not is_final and patience > 0
        self.gl_errors += self._renderer.graphics.ctx.error != "GL_NO_ERROR"

    def drift_levels(self) -> float:
        """Difference between the picture at rest and a new renderer's, in levels; 0 where neither can be made."""
        request = self.request
        try:
            *_, shown = self._driver.pictures(request)
        except SettingsError:
            return 0.0
        with FrameRenderer() as other:
            plain = make_picture(
                other,
                self._shot,
                request.camera_path,
                request.time,
                request.settings,
                stock=request.stock,
                choice=request.choice,
            )
        return float(255 * np.abs(plain.graded - shown.graded).max())

    def _focus(self) -> None:
        self._shot.camera.set(CAMERA, focus_distance_m=self._random.uniform(1.0, 12.0))

    def _stop(self) -> None:
        self._shot.camera.set(CAMERA, f_stop=self._random.choice((0.0, 0.7, 1.4, 2.8, 8.0)))

    def _zoom(self) -> None:
        self._shot.camera.set(CAMERA, focal_length_mm=self._random.uniform(24, 90))

    def _mode(self) -> None:
        self._shot.camera.set(CAMERA, focus_mode=self._random.choice(("manual", "points", "tiltPlane", "surface")))

    def _walk(self) -> None:
        place = Gf.Vec3d(self._random.uniform(-1, 1), self._random.uniform(0.5, 1.5), self._random.uniform(1, 2))
        self._translate(CAMERA, place)

    def _push(self) -> None:
        ball = self._random.choice([i for i in range(BALLS) if i != 1])
        self._translate(f"/World/ball{ball}", Gf.Vec3d(self._random.uniform(-2, 2), 0.3, -2.0 - 1.1 * ball))

    def _translate(self, path: str, place: Gf.Vec3d) -> None:
        with self._shot.edits.transaction(f"move {path}"):
            UsdGeom.Xformable(self._shot.stage.GetPrimAtPath(path)).GetOrderedXformOps()[0].Set(place)

    def _hide(self) -> None:
        ball = UsdGeom.Imageable(self._shot.stage.GetPrimAtPath(f"/World/ball{self._random.randrange(1, 4)}"))
        with self._shot.edits.transaction("hide or show a ball"):
            ball.GetVisibilityAttr().Set(self._random.choice(("invisible", "inherited")))

    def _expose(self) -> None:
        self._shot.exposure.set(CAMERA, compensation_stops=self._random.uniform(-1, 1))

    def _scrub(self) -> None:
        self.request = replace(self.request, time=self._random.uniform(*FRAMES))

    def _load_film(self) -> None:
        self.request = replace(self.request, stock=self._random.choice((None, None, "5219", "5222")))

    def _grade(self) -> None:
        self.request = replace(self.request, choice=self._random.choice((None, GradeChoice(view="Raw"))))

    def _resize(self) -> None:
        width = self._random.choice((96, 128, 160))
        self.request = replace(
            self.request, settings=replace(self.request.settings, width=width, height=width * 9 // 16)
        )

    def _other_engine(self) -> None:
        engine = self._random.choice(("lens", *engine_names(), "importance"))
        self.request = replace(self.request, settings=replace(self.request.settings, engine=engine))

    def _undo(self) -> None:
        with suppress(PullfocusError):  # there is nothing to undo
            self._shot.edits.undo()

    def _redo(self) -> None:
        with suppress(PullfocusError):
            self._shot.edits.redo()


def measure(plan: SoakPlan) -> SoakBench:
    """Edit and compare.

    Raises:
        GraphicsError: there is no device to draw on, or it refuses one of the pictures.
    """
    began, memory, drift = perf_counter(), [], [0.0]
    with tempfile.TemporaryDirectory() as folder, FrameRenderer() as renderer:
        soak = _Soak(renderer, Shot.open(write_soak_shot(Path(folder))), plan.seed)
        for edit in range(1, plan.edits + 1):
            soak.step()
            if edit % plan.check_every == 0 or edit == plan.edits:
                drift.append(soak.drift_levels())
                memory.append(memory_mb())
        device = renderer.graphics.renderer
    growth = max(memory[int(_SETTLED * len(memory)) :]) - memory[int(_SETTLED * len(memory))]
    return SoakBench(
        device,
        plan.edits,
        perf_counter() - began,
        soak.pictures,
        soak.finals,
        soak.left,
        dict(sorted(soak.kinds.items())),
        len(memory),
        max(drift),
        memory,
        growth,
        soak.gl_errors,
        _goals(max(drift), growth, soak.gl_errors),
    )


def memory_mb() -> float:
    """Resident memory of the process, megabytes (10⁶)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 1e6


def _goals(drift: float, growth: float, errors: int) -> list[Goal]:
    return [
        Goal("drift from a new renderer, of 255 levels, at most", MOST_LEVELS, drift, drift <= MOST_LEVELS),
        Goal("growth of memory after a third, MB, at most", MOST_MB, growth, growth <= MOST_MB),
        Goal("errors of the device, at most", 0, errors, errors == 0),
    ]


def run(arguments: argparse.Namespace) -> None:
    """Soak, print the table on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.soak.plan.add_arguments` declares them.

    Raises:
        SettingsError: no edits are asked for.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def report(result: SoakBench) -> str:
    """The table."""
    kinds = ", ".join(f"{name} {count}" for name, count in result.edits_by_kind.items())
    lines = [
        f"{result.device}; {result.edits:,} edits in {result.seconds:.0f} s: {kinds}",
        f"{result.pictures:,} pictures, {result.finals:,} of them at rest; left half way {result.left:,} times",
        f"compared with a new renderer {result.checks:,} times: at most {result.drift_levels:.3f} of 255 levels apart",
        f"memory {result.memory_mb[0]:.0f} MB at the first of these, {result.memory_mb[-1]:.0f} MB at the last",
    ]
    return "\n".join([*lines, "", *goal_lines(result.goals)]) + "\n"
