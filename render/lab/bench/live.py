"""The live bench: from a change to the first picture and to the last, while a hand drags the focus, the stop, the time, the
camera and the grade of the demo shot.

pullfocus bench live
pullfocus bench live --focus-maps               the same with the circle of confusion of each pixel
pullfocus bench live --before CHECKOUT          beside the same drags with another checkout's code

The file is a script too: with ``--before`` it runs in a process of its own, on the modules of the other checkout, of which it
uses only what old checkouts have.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from time import perf_counter

import numpy as np
from PIL import Image
from pxr import Gf, UsdGeom

from render.demo.shot import write_demo
from render.errors import GraphicsError
from render.film import GradeChoice
from render.frame import FrameRenderer
from render.lab.bench.live_plan import DRAGS, FIRST_MS, FRAME, LOOK_MS, LivePlan, add_arguments, plan_from_arguments
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.model.arrays import FloatArray
from render.output.encode import encode_jpeg
from render.pictures.live_finisher import LiveFinisher
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest, ProgressivePicture
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot

Change = Callable[[int], PreviewRequest]
"""Function that makes the change of a step of the drag and returns the request."""
SLOWER, GAIN_DB = 1.1, 2.0
"""Goals against another checkout; a tenth is what the same code varies by."""
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
        first_psnr_db: the first picture of the last step of the drag, enlarged, against `record`'s picture of that step, both as
            graded; None where they are equal.
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
    first_psnr_db: float | None


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
        before: the drags with the code of another checkout, if one was asked for.
        focus_maps: whether pictures came with focus maps.
    """

    device: str
    width: int
    height: int
    rays: int
    rows: list[DragRow]
    goals: list[Goal]
    before: list[DragRow] = field(default_factory=list)
    focus_maps: bool = False


class _Stand:
    """The demo shot before a driver."""

    def __init__(self, renderer: FrameRenderer, shot: Shot, plan: LivePlan) -> None:
        self._renderer, self._shot, self._plan = renderer, shot, plan
        self._driver = ProgressiveRenderer(renderer, shot, LiveFinisher(renderer))
        self._camera = shot.default_camera().path
        self._asked = PreviewRequest(None, FRAME, plan.picture)
        if plan.focus_maps:
            self._asked = replace(self._asked, maps_focus=True)
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
            equal = np.array_equal(self._recorded(request), final.graded)
            first_psnr_db = _psnr_db(shown.graded, self._recorded(change(self._plan.steps)))
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
            first_psnr_db,
        )

    def _recorded(self, request: PreviewRequest) -> FloatArray:
        """Graded picture of `record`."""
        return make_picture(
            self._renderer, self._shot, None, request.time, request.settings, choice=request.choice
        ).graded

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
    goals = _goals(rows)
    return LiveBench(device, picture.width, picture.height, picture.rays, rows, goals, focus_maps=plan.focus_maps)


def measure_before(checkout: Path, typed: Sequence[str]) -> list[DragRow]:
    """Measure every drag with the code of another checkout, in a process of its own.

    Args:
        checkout: root of the checkout.
        typed: the bench's arguments.

    Raises:
        GraphicsError: the process failed.
    """
    # not at the top: as a script, this file runs on checkouts that lack the module
    from render.lab.bench.checkouts import script_command, script_environment

    done = subprocess.run(
        [*script_command(Path(__file__)), *typed],
        env=script_environment(checkout),
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise GraphicsError(f"the drags with {checkout} failed with status {done.returncode}")
    return [DragRow(**row) for row in json.loads(done.stdout)]


def main() -> None:
    """Measure every drag, and write the rows as JSON on standard output."""
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    rows = measure(plan_from_arguments(parser.parse_args())).rows
    sys.stdout.write(json.dumps([asdict(row) for row in rows]) + "\n")


def _psnr_db(preview: FloatArray, recorded: FloatArray) -> float | None:
    """PSNR of two graded pictures in dB, the first of which is enlarged as a browser would; None where they are equal."""
    height, width = recorded.shape[:2]
    channels = [
        Image.fromarray(preview[..., channel]).resize((width, height), Image.Resampling.BILINEAR)
        for channel in range(3)
    ]
    error = float(np.mean((np.stack([np.asarray(channel) for channel in channels], axis=-1) - recorded) ** 2))
    return -10 * math.log10(error) if error > 0 else None


def compare(rows: list[DragRow], before: list[DragRow]) -> list[Goal]:
    """Goals of the drags against those of another checkout."""
    goals = []
    for row, old in zip(rows, before, strict=True):
        times = row.first_ms / old.first_ms
        goals.append(
            Goal(f"{row.name}: first picture, times as long as before, at most", SLOWER, times, times <= SLOWER)
        )
        if row.first_psnr_db is not None and old.first_psnr_db is not None:
            gain = row.first_psnr_db - old.first_psnr_db
            goals.append(Goal(f"{row.name}: first picture, dB gained, at least", GAIN_DB, gain, gain >= GAIN_DB))
    return goals


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
    if arguments.before is not None:
        typed = [*(["--quick"] if arguments.quick else []), f"--width={result.width}"]
        before = measure_before(arguments.before, typed)
        result = replace(result, before=before, goals=[*result.goals, *compare(result.rows, before)])
    say(result, report(result), arguments.json)


def report(result: LiveBench) -> str:
    """The table."""
    lines = [
        f"{result.device}; the demo shot, {result.width}x{result.height}, {result.rays} rays at rest",
        f"Milliseconds from before the change until the picture is there as a JPEG{', with its focus map' * result.focus_maps}.",
        "",
        "drag       first: median      p95   of it reading   its width   rays   at rest: first     last   left within"
        "   looks every: p95  longest   first: PSNR dB",
    ]
    lines += _lines(result.rows)
    if result.before:
        lines += ["", "The same with the checkout of before:", *_lines(result.before)]
    return "\n".join([*lines, "", *goal_lines(result.goals)]) + "\n"


def _lines(rows: list[DragRow]) -> list[str]:
    alike = ("equal" if row.first_psnr_db is None else f"{row.first_psnr_db:.1f}" for row in rows)
    return [
        f"{row.name:9}  {row.first_ms:13.0f}  {row.first_p95_ms:7.0f}   {row.read_share:13.0%}   {row.width:9}   {row.rays:4}"
        f"   {row.rest_first_ms:14.0f}  {row.rest_final_ms:7.0f}   {row.left_ms:11.0f}"
        f"   {row.look_p95_ms:16.0f}  {row.look_longest_ms:7.0f}   {next(alike):>14}"
        for row in rows
    ]


if __name__ == "__main__":
    main()
