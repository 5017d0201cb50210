"""The live bench: from a change to the first picture and to the last, while a hand drags the focus, the stop, the time, the
camera and the grade of the demo shot.

pullfocus bench live
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np
from pxr import Gf, UsdGeom

from render.demo.shot import write_demo
from render.film import GradeChoice
from render.frame import FrameRenderer
from render.lab.bench.live_plan import DRAGS, FIRST_MS, FRAME, LOOK_MS, LivePlan, plan_from_arguments
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.output.encode import encode_jpeg
from render.pictures.live_finisher import LiveFinisher
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest, ProgressivePicture
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot

Change = Callable[[int], PreviewRequest]
"""Function that makes the change of a step of the drag and returns the request."""
_STALE_AFTER_S = (0.05, 0.4, 1.0)


@dataclass(frozen=True)
class DragRow:
    """One drag, in milliseconds from before the change to the encoded JPEG.

    Attributes:
        name: dragged quantity.
        steps: number of steps.
        first_ms: the first picture of a step: the median.
        first_p95_ms: 95th percentile of the same.
        read_share: of a step, that goes to reading the shot.
        width: of the first picture in pixels.
        rays: of it.
        rest_first_ms: the first picture when the hand rests.
        rest_final_ms: time to the last picture, which equals `record`'s.
        left_ms: from when the work became stale until it was left: the longest of some tries.
        look_p95_ms: 95th percentile of the time between two cancellation points.
        look_longest_ms: and always.
        equal: whether the last one is equal to what `record` makes, to the bit.
    """

    name: str
    steps: int
    first_ms: float
    first_p95_ms: float
    read_share: float
    width: int
    rays: int
    rest_first_ms: float
    rest_final_ms: float
    left_ms: float
    look_p95_ms: float
    look_longest_ms: float
    equal: bool


@dataclass(frozen=True)
class LiveBench:
    """Results of the live bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        width: width of the picture at rest in pixels.
        height: height of the picture at rest in pixels.
        rays: rays per pixel of the picture at rest.
        rows: the drags.
        goals: goals and whether they are met.
    """

    device: str
    width: int
    height: int
    rays: int
    rows: list[DragRow]
    goals: list[Goal]


class _Stand:
    """The demo shot before a driver."""

    def __init__(self, renderer: FrameRenderer, shot: Shot, plan: LivePlan) -> None:
        self._renderer, self._shot, self._plan = renderer, shot, plan
        self._driver = ProgressiveRenderer(renderer, shot, LiveFinisher(renderer))
        self._camera = shot.default_camera().path
        self._asked = PreviewRequest(None, FRAME, plan.picture)
        self.drags: dict[str, Change] = {
            "focus": self._focus,
            "aperture": self._aperture,
            "time": lambda step: replace(self._asked, time=FRAME + step),
            "camera": self._pose,
            "grade": self._grade,
        }

    def row(self, name: str) -> DragRow:
        """Drag, rest, and compare; all is as it was after it."""
        change = self.drags[name]
        with self._put_back():
            self._first(change(0), moving=True)  # compiles, and peels what the drag then keeps
            if name == "grade":
                self._final(change(0))
            steps = [self._step(change, step) for step in range(1, self._plan.steps + 1)]
            firsts = [spent for spent, _ in steps]
            shown = steps[-1][1]
            later = self._plan.steps + 1
            left_ms = max(self._left(change(later + i), after_s) for i, after_s in enumerate(_STALE_AFTER_S))
            request = change(later + len(_STALE_AFTER_S))
            rest_first_ms, rest_final_ms, final, looks = self._final(request)
            plain = make_picture(
                self._renderer, self._shot, None, request.time, request.settings, choice=request.choice
            )
            equal = np.array_equal(plain.graded, final.graded)
        return DragRow(
            name,
            len(steps),
            float(np.median(firsts)),
            float(np.percentile(firsts, 95)),
            float(np.mean([shown.timing.read_ms / shown.timing.total_ms for _, shown in steps])),
            shown.graded.shape[1],
            shown.rays,
            rest_first_ms,
            rest_final_ms,
            left_ms,
            float(np.percentile(looks, 95)),
            max(looks),
            equal,
        )

    def _step(self, change: Change, step: int) -> tuple[float, ProgressivePicture]:
        began = perf_counter()
        shown = self._first(change(step), moving=True)
        return 1000 * (perf_counter() - began), shown

    def _first(self, request: PreviewRequest, *, moving: bool) -> ProgressivePicture:
        shown = next(self._driver.pictures(replace(request, is_moving=moving)))
        encode_jpeg(shown.graded, shown.metadata)
        return shown

    def _final(self, request: PreviewRequest) -> tuple[float, float, ProgressivePicture, list[float]]:
        """Times to the first and to the last picture, the last picture, and times between cancellation points, in
        milliseconds.
        """
        began = perf_counter()
        times, looks, looked = [], [0.0], began

        def is_stale() -> bool:
            nonlocal looked
            looks.append(1000 * (perf_counter() - looked))
            looked = perf_counter()
            return False

        for shown in self._driver.pictures(request, is_stale=is_stale):
            encode_jpeg(shown.graded, shown.metadata)
            looked = perf_counter()
            times.append(1000 * (looked - began))
        return times[0], times[-1], shown, looks

    def _left(self, request: PreviewRequest, after_s: float) -> float:
        """Time for which work goes on after it becomes stale, ``after_s`` after its first picture; 0 where it ends before."""
        self._driver.release()
        since: list[float] = []  # the first picture

        def is_stale() -> bool:
            return bool(since) and perf_counter() > since[0] + after_s

        is_done = False
        for shown in self._driver.pictures(request, is_stale=is_stale):
            since.append(perf_counter())
            is_done = shown.is_final
        return 0.0 if is_done else 1000 * (perf_counter() - since[0] - after_s)

    @contextmanager
    def _put_back(self) -> Iterator[None]:
        before = self._shot.edits.snapshot()
        try:
            yield
        finally:
            self._shot.edits.restore(before)

    def _focus(self, step: int) -> PreviewRequest:
        self._shot.camera.set(None, focus_distance_m=2.5 + 0.15 * step)
        return self._asked

    def _aperture(self, step: int) -> PreviewRequest:
        self._shot.camera.set(None, f_stop=1.4 + 0.1 * step)
        return self._asked

    def _pose(self, step: int) -> PreviewRequest:
        with self._shot.edits.transaction("move the camera"):
            xform = UsdGeom.Xformable(self._shot.stage.GetPrimAtPath(self._camera))
            named = [op for op in xform.GetOrderedXformOps() if op.GetOpName() == "xformOp:translate:drag"]
            op = named[0] if named else xform.AddTranslateOp(opSuffix="drag")
            op.Set(Gf.Vec3d(1.5 * step, 0, 0))
        return self._asked

    def _grade(self, step: int) -> PreviewRequest:
        return replace(self._asked, choice=GradeChoice(view="Raw") if step % 2 else None)


def measure(plan: LivePlan) -> LiveBench:
    """Measure every drag.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    with tempfile.TemporaryDirectory() as folder, FrameRenderer() as renderer:
        shot = Shot.open(write_demo(Path(folder)))
        stand = _Stand(renderer, shot, plan)
        rows = [stand.row(name) for name in DRAGS]
        device = renderer.graphics.renderer
    picture = plan.picture
    return LiveBench(device, picture.width, picture.height, picture.rays, rows, _goals(rows))


def _goals(rows: list[DragRow]) -> list[Goal]:
    times = {row.name: row.first_ms for row in rows}
    goals = [
        Goal(f"first picture of a drag of {name}, median, ms, at most", want, times[name], times[name] <= want)
        for name, want in FIRST_MS.items()
    ]
    looks = max(row.look_p95_ms for row in rows)
    goals.append(
        Goal("work looks whether it is wanted, 95 of 100 times, every ms, at most", LOOK_MS, looks, looks <= LOOK_MS)
    )
    equal = sum(row.equal for row in rows)
    return [*goals, Goal("drags that rest on record's picture to the bit", len(rows), equal, equal == len(rows))]


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the table on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.live_plan.add_arguments` declares them.

    Raises:
        SettingsError: the picture is too small or too large.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def report(result: LiveBench) -> str:
    """The table."""
    lines = [
        f"{result.device}; the demo shot, {result.width}x{result.height}, {result.rays} rays at rest",
        "Milliseconds from before the change until the picture is there as a JPEG.",
        "",
        "drag       first: median      p95   of it reading   its width   rays   at rest: first     last   left within"
        "   looks every: p95  longest",
    ]
    lines += [
        f"{row.name:9}  {row.first_ms:13.0f}  {row.first_p95_ms:7.0f}   {row.read_share:13.0%}   {row.width:9}   {row.rays:4}"
        f"   {row.rest_first_ms:14.0f}  {row.rest_final_ms:7.0f}   {row.left_ms:11.0f}"
        f"   {row.look_p95_ms:16.0f}  {row.look_longest_ms:7.0f}"
        for row in result.rows
    ]
    return "\n".join([*lines, "", *goal_lines(result.goals)]) + "\n"
