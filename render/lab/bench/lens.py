"""The lens bench: the paper's table 1 for three generated scenes, and sweeps. Lee, Eisemann & Seidel 2010, section 5.

pullfocus bench lens                      the table, the sweeps and the goals
python -m render.lab.bench.lens --json -      the same where only numpy, pyrender and moderngl are installed
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from render.engines.shared.layer_scale import traced_scale
from render.errors import PullfocusError, SettingsError
from render.files import check_writable, write_atomic
from render.lab.bench.goals import judge
from render.lab.bench.measure import (
    SceneMaker,
    Subject,
    aperture_sweep,
    layers_sweep,
    rays_sweep,
    scene_row,
    subject,
    surfaces_sweep,
)
from render.lab.bench.plan import PICTURE, SWEPT, Plan, add_arguments, plan_from_arguments
from render.lab.bench.results import LensBench, Sweeps, as_json
from render.lab.bench.rig import LensRig
from render.lab.bench.text import report
from render.lab.reference.bench_scenes import SCENES

Row = TypeVar("Row")


def measure(scenes: Mapping[str, SceneMaker], plan: Plan, say: Callable[[str], None]) -> LensBench:
    """Measure everything.

    Args:
        scenes: at least one, by name.
        plan: what.
        say: receives progress messages.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    rows, subjects, picture = [], {}, plan.picture
    with LensRig() as rig:
        for name, make in scenes.items():
            say(f"{name}: building the scene, and {plan.runs} references of {picture.rays} views")
            subjects[name] = subject(rig, name, make, picture, plan.repeats, plan.sweep_repeats)
            rows.append(scene_row(subjects[name], plan.runs))
            say(f"{name}: {rows[-1].total_ms:.0f} ms, reference {rows[-1].reference_ms:.0f} ms")
        swept = subjects[SWEPT if SWEPT in subjects else next(iter(subjects))]
        rig.load(swept.scene, swept.camera)
        sweeps = _sweep(swept, plan, say)
        result = LensBench(
            device=rig.graphics.renderer,
            software=rig.graphics.is_software,
            width=picture.width,
            height=picture.height,
            rays=picture.rays,
            supersample=traced_scale(picture),
            scenes=rows,
            sweeps=sweeps,
            layers_mb_1024x768=rig.layers_bytes(swept.camera, 1024, 768, 4) / 1e6,
        )
    is_standard = replace(picture, supersample=PICTURE.supersample) == PICTURE
    return replace(result, goals=judge(result)) if is_standard else result


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.plan.add_arguments` declares them.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    plan, target = plan_from_arguments(arguments), _asked_file(arguments.json)
    scenes = SCENES if arguments.scene is None else {arguments.scene: SCENES[arguments.scene]}
    result = measure(scenes, plan, _say)
    text = as_json(result)
    try:
        if target is not None:
            write_atomic(target, text.encode())
    finally:  # minutes of measurement are printed even if the file cannot be written
        sys.stdout.write(text if arguments.json == "-" else report(result))


def main() -> int:
    """Run as a module; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m render.lab.bench.lens", description="Measure the lens engine.")
    add_arguments(parser)
    try:
        run(parser.parse_args())
    except PullfocusError as error:
        _say(f"{parser.prog}: {error.detail}")
        return 2 if isinstance(error, SettingsError) else 1
    return 0


def _asked_file(typed: str | None) -> Path | None:
    """Path of the JSON. A path that cannot be written is reported before anything is measured."""
    if typed is None or typed == "-":
        return None
    check_writable(typed)
    return Path(typed)


def _sweep(of: Subject, plan: Plan, say: Callable[[str], None]) -> Sweeps:
    def measure_sweep(what: str, rows: Iterable[Row]) -> list[Row]:
        made = []
        for row in rows:
            made.append(row)
            say(f"{of.name}: {what}, {len(made)} done")
        return made

    return Sweeps(
        of.name,
        measure_sweep("rays", rays_sweep(of, plan.rays)),
        measure_sweep("layers", layers_sweep(of, plan.layers)),
        measure_sweep("apertures", aperture_sweep(of, plan.f_stops)),
        measure_sweep("lenses", surfaces_sweep(of, plan.lenses)),
    )


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
