"""The service bench: many live viewers who drag together, then what an absurd request does to others.

pullfocus bench service
"""

from __future__ import annotations

import argparse
import asyncio
import http.client
import json
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import median
from time import sleep

from render.errors import PullfocusError
from render.lab.bench.progress import check_file, say
from render.lab.bench.soak.shot import write_soak_shot
from service.bench.absurd import LEAVES_AFTER_S, absurd_path, admitted_rays
from service.bench.machine import this_machine
from service.bench.plan import LoadPlan, plan_from_arguments
from service.bench.report import report
from service.bench.requests import FIRST_CLIENT, Abandoned, Repeated, ask, leave_after, repeating, usual_requests
from service.bench.results import AbsurdFound, DelayRow, ServiceBench, ViewersFound, goals_of, spread_of
from service.bench.server import running_service
from service.bench.viewers import Viewer, ViewersBeside, drag_for

BESIDE = 4
"""Viewers who go on while delays are measured."""
SETTLE_S = 2.0
"""Time before a phase: whatever begins anew has begun."""
ABSURD_CLIENT = FIRST_CLIENT + 10
PICTURES = "live pictures: time between two"
PACKAGES = ("pullfocus", "uvicorn", "websockets", "fastapi", "usd-core")


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `service.bench.plan.add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range.
        PullfocusError: the service does not run.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def measure(plan: LoadPlan) -> ServiceBench:
    """Start a service and measure it.

    Raises:
        PullfocusError: the service does not run.
        GraphicsError: there is no device to draw on.
    """
    machine = this_machine(PACKAGES)
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name,
        running_service(Path(name), plan.viewers, first=plan.first) as port,
    ):
        soak_shot = write_soak_shot(Path(name))
        try:
            at_start, running = (_found(asyncio.run(drag_for(port, "demo", plan, plan.viewers))) for _ in range(2))
            other_shot = _upload(port, soak_shot)
            absurd, delays = _delays(port, plan, other_shot)
        except (OSError, http.client.HTTPException) as error:
            raise PullfocusError(
                f"the service of the bench does not answer: {type(error).__name__}: {error}"
            ) from error
    goals = goals_of(at_start, running, absurd, delays)
    return ServiceBench(machine, plan, at_start, running, BESIDE, absurd, delays, goals)


def _found(viewers: Sequence[Viewer]) -> ViewersFound:
    pictures = sorted(viewer.pictures for viewer in viewers)
    return ViewersFound(
        len(viewers),
        sum(bool(viewer.refusals) for viewer in viewers),
        _each_once(reason for viewer in viewers for reason in viewer.refusals),
        pictures,
        pictures[-1] / pictures[0] if pictures[0] else None,
        pictures.count(0),
        spread_of([viewer.first_s for viewer in viewers if viewer.first_s is not None]),
        spread_of([age for viewer in viewers for age in viewer.ages_s]),
        spread_of([gap for viewer in viewers for gap in viewer.gaps_s]),
    )


def _delays(port: int, plan: LoadPlan, other_shot: str) -> tuple[AbsurdFound, list[DelayRow]]:
    """Measure how long others wait: alone, beside an absurd request, and after the client of one has left."""
    requests = usual_requests(port, "demo", other_shot)
    phases: list[dict[str, Repeated]] = []
    with ViewersBeside(port, "demo", plan, BESIDE) as beside:
        for request in requests.values():  # the shots are open, and the workers run
            request()

        def phase() -> None:
            end_phase = beside.begin_phase()
            with repeating(requests) as found:
                sleep(plan.phase_s)
            phases.append(found | {PICTURES: Repeated(*end_phase())})

        beside.wait_for_pictures()
        sleep(SETTLE_S)
        phase()
        admitted, refused = admitted_rays(port, ABSURD_CLIENT, "demo")
        sleep(SETTLE_S)
        absurd = Abandoned(port, ABSURD_CLIENT, absurd_path("demo", admitted, seed=2))
        phase()
        was_busy = not absurd.has_answer()
        absurd.leave()
        sleep(SETTLE_S)
        leave_after(LEAVES_AFTER_S, Abandoned(port, ABSURD_CLIENT, absurd_path("demo", admitted, seed=3)))
        phase()
    rows = [_row(name, [found[name] for found in phases]) for name in phases[0]]
    return AbsurdFound(refused, admitted, was_busy), rows


def _row(name: str, phases: Sequence[Repeated]) -> DelayRow:
    alone, absurd, left = (phase.seconds for phase in phases)
    usual_s = median(alone)
    return DelayRow(
        name,
        spread_of(alone),
        spread_of(absurd),
        spread_of(left),
        max(absurd) - usual_s,
        max(left) - usual_s,
        _each_once(failure for phase in phases for failure in phase.failures),
    )


def _upload(port: int, stage: Path) -> str:
    """Upload a stage and return the id of its shot. Raises `PullfocusError` where it is refused."""
    boundary = "a-boundary-that-the-stage-does-not-have"
    head = f'--{boundary}\r\nContent-Disposition: form-data; name="file"; filename="{stage.name}"\r\n\r\n'
    body = head.encode() + stage.read_bytes() + f"\r\n--{boundary}--\r\n".encode()
    headers = {"Content-Type": f"multipart/form-data; boundary={boundary}"}
    status, answer = ask(port, FIRST_CLIENT, "POST", "/v1/shots", body, headers)
    if status != 201:
        raise PullfocusError(f"the service does not take a shot: {answer.decode(errors='replace')[:500]}")
    shot: str = json.loads(answer)["id"]
    return shot


def _each_once(texts: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(texts))
