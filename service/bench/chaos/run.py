"""The chaos bench: a render is sent, parts of the system are struck while it is drawn, and every frame is looked at.

pullfocus bench chaos
pullfocus bench chaos --database sqlite --strikes 100 --frames 400
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Literal, TypeVar

from render.demo.shot import write_demo
from render.errors import PullfocusError
from render.lab.bench.progress import check_file, say
from service.bench.chaos.parts import still_running
from service.bench.chaos.plan import ChaosPlan, plan_from_arguments
from service.bench.chaos.report import report
from service.bench.chaos.results import ChaosBench, StrikeRow, count_frames, goals_of
from service.bench.chaos.strikes import KINDS, order_of
from service.bench.chaos.system import System, running_system
from service.bench.machine import this_machine
from service.client.errors import ClientError
from service.client.models import Render
from service.client.operations import ENDED
from service.client.steps import Retries
from service.client.sync_client import Client
from service.jobs.files import FOLDER

Reply = TypeVar("Reply")

PACKAGES = ("pullfocus", "distributed", "sqlalchemy")
START_S = 300.0
"""Time for all parts to start and to take a shot."""
LOOK_PAUSE_S = 0.2
FULL_S = 5.0
"""Time for which the disk stays full."""
ORPHANS_S = 30.0
"""Time for the processes of a part that was killed to end."""
SUFFIX: Literal["png"] = "png"
ONCE = Retries(tries=1)


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `service.bench.chaos.plan.add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range.
        PullfocusError: a part is not installed, or does not start.
        GraphicsError: there is no device to draw on.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def measure(plan: ChaosPlan, stage: Path | None = None) -> ChaosBench:
    """Have a shot drawn by a system that is struck.

    Args:
        plan: of the bench.
        stage: the shot; the demo shot when left out.

    Raises:
        PullfocusError: a part is not installed, or does not start.
        GraphicsError: there is no device to draw on.
    """
    machine = this_machine(PACKAGES)
    with tempfile.TemporaryDirectory(prefix="pullfocus-chaos-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        if os.geteuid() == 0:
            folder.chmod(0o755)  # PostgreSQL's user goes through it
        stage = stage or write_demo(folder / "demo")
        with (
            running_system(folder, plan) as system,
            Client(f"http://127.0.0.1:{system.port}", retries=ONCE) as client,
        ):
            kinds = system.kinds()
            render = _send(system, client, plan, stage)
            began_s = time.monotonic()
            rows, state = _strike(system, client, plan, render.id)
            wall_s = time.monotonic() - began_s
            tasks = _patiently(system, lambda: client.tasks(render))
            files = (system.data / FOLDER / render.id).iterdir()
            stored = {file.name: _hash(file) for file in files if file.is_file()}
            orphans = len(still_running([*system.families, *system.stop()], ORPHANS_S))
        recorded = _record(stage, folder / "recorded", plan)
    left_out = [kind for kind in KINDS if kind not in kinds]
    frames = count_frames(tasks, stored, recorded, SUFFIX)
    restarts = {part.name: part.starts - 1 for part in system.parts}
    goals = goals_of(plan, state, frames, orphans, len(rows))
    return ChaosBench(machine, plan, left_out, rows, state, wall_s, restarts, frames, orphans, goals)


def _send(system: System, client: Client, plan: ChaosPlan, stage: Path) -> Render:
    """Start the system, and send it the shot and the render. Raises `PullfocusError`: it does not start."""
    _patiently(system, client.shots)
    shot = client.push(stage.parent, root=stage.name)
    key = uuid.uuid4().hex
    return _patiently(
        system,
        lambda: client.render(
            shot,
            idempotency_key=key,
            frames=f"1-{plan.frames}",
            width=plan.width,
            rays=plan.rays,
            formats=[SUFFIX],
        ),
    )


def _strike(system: System, client: Client, plan: ChaosPlan, render: str) -> tuple[list[StrikeRow], str]:
    """Strike the system while a render is drawn, and return what was done and the last state of the render."""
    order = order_of(system.kinds(), plan.strikes, plan.seed)
    rows: list[StrikeRow] = []
    began_s = time.monotonic()
    heal_at_s = None
    now = None
    while time.monotonic() - began_s < plan.limit_s:
        system.tend()
        at_s = time.monotonic() - began_s
        with suppress(ClientError):  # the service is gone, or cannot answer for now
            now = client.get(render)
            rows = [_recovered(row, now.done, at_s) for row in rows]
        if heal_at_s is not None and at_s >= heal_at_s:
            system.heal()
            heal_at_s = None
        if now is not None and now.state in ENDED and heal_at_s is None:
            break
        if now is not None and len(rows) < len(order) and now.done * (len(order) + 2) >= plan.frames * (len(rows) + 1):
            kind = order[len(rows)]
            system.strike(kind, len(rows))
            rows.append(StrikeRow(kind, at_s, now.done, None))
            if kind == "fill disk":
                heal_at_s = at_s + FULL_S
        time.sleep(LOOK_PAUSE_S)
    return rows, now.state if now is not None else "unknown"


def _recovered(row: StrikeRow, done: int, at_s: float) -> StrikeRow:
    """Note when the first frame after a strike was done."""
    if row.recovery_s is not None or done <= row.done:
        return row
    return StrikeRow(row.kind, row.at_s, row.done, at_s - row.at_s)


def _patiently(system: System, ask: Callable[[], Reply]) -> Reply:
    """Ask until there is an answer, and start meanwhile what does not run. Raises `PullfocusError`: there is none."""
    end_s = time.monotonic() + START_S
    while True:
        system.tend()
        try:
            return ask()
        except ClientError as error:
            if time.monotonic() > end_s:
                said = " ".join(system.service.last_words().split())[-500:]
                raise PullfocusError(f"the service of the bench does not answer: {error}; it said: {said}") from error
        time.sleep(LOOK_PAUSE_S)


def _record(stage: Path, folder: Path, plan: ChaosPlan) -> dict[int, str]:
    """Draw the frames by the command line, and return their hashes. Raises `PullfocusError`."""
    folder.mkdir()
    command = [sys.executable, "-m", "render.cli", "record", str(stage), str(folder / f"####.{SUFFIX}")]
    options = ["--frames", f"1:{plan.frames}", "--imageWidth", str(plan.width), "--rays", str(plan.rays)]
    ran = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        raise PullfocusError(f"record has failed: {ran.stderr.strip()[-500:]}")
    return {int(file.stem): _hash(file) for file in folder.glob(f"*.{SUFFIX}")}


def _hash(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
