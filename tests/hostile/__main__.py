"""``python -m tests.hostile``: the whole hostile corpus against a service of its own, as a table or as JSON."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import tempfile
from collections import Counter
from contextlib import nullcontext, suppress
from pathlib import Path
from statistics import median

from tests.hostile.asking import ask_all, ask_briefly
from tests.hostile.bystander import Bystander
from tests.hostile.corpus import controls
from tests.hostile.families import all_cases
from tests.hostile.runner import Verdict, finished_in, peak_memory, run_cases
from tests.hostile.trace import Tried, read_trace, traced
from tests.hostile.world import hostile_world

MOST_ROWS = 60
CACHES = ".cache/pullfocus-service"
"""Compiled shaders, in the home folder; a worker reads the common ones and writes its own."""


def main() -> int:
    """Run the corpus until its end or Ctrl+C; 1 where a case is bad, or a request of somebody else fails."""
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    parser.add_argument("--all", action="store_true", help="all cases, which takes hours; as --every 1")
    parser.add_argument("--every", type=int, default=10, metavar="N", help="every Nth case (default: 10)")
    parser.add_argument(
        "--skip", type=int, default=0, metavar="N", help="leave the first N cases out: go on with a run"
    )
    parser.add_argument("--brief", action="store_true", help="ask for data and frames alone: no live or long pictures")
    parser.add_argument("--only", default="", help="cases whose names contain this")
    parser.add_argument("--json", action="store_true", help="one line of JSON for each case")
    parser.add_argument("--trace", action="store_true", help="show by strace what the workers tried")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, hostile_world(Path(folder)) as world:
        cases = [case for case in all_cases(world.canaries) if options.only in case.name]
        cases = cases[:: 1 if options.all or options.only else options.every][options.skip :]
        verdicts, ask = [], ask_briefly if options.brief else ask_all
        bystander, trace = Bystander(world.client.base_url, next(controls())), Path(folder) / "trace"
        tracing = traced(world.template(), trace) if options.trace else nullcontext()
        with tracing, bystander, suppress(KeyboardInterrupt):  # what was found until then is shown
            for verdict in run_cases(world.client, cases, world.canaries, world.places, ask):
                verdicts.append(verdict)
                print(json.dumps(dataclasses.asdict(verdict)) if options.json else _row(verdict), flush=True)
        peaks, finished = peak_memory(world.client), finished_in(world.client)
        tried = read_trace(trace.open(errors="replace")) if options.trace else None
        inside = (*world.places, sys.base_prefix, str(Path.cwd()), str(Path.home() / CACHES))
    bad = [verdict for verdict in verdicts if not verdict.is_good]
    slowest = max((v.seconds for v in verdicts), default=0.0)
    memory = ", ".join(f"{worker} {peak:,} of {limit:,}" for worker, (peak, limit) in sorted(peaks.items()))
    print(
        f"{len(verdicts)} files, {len(bad)} bad, slowest {slowest:.1f} s; peak memory, MiB: {memory}", file=sys.stderr
    )
    statuses = Counter(status for verdict in verdicts for status in verdict.statuses)
    print(f"answers by status: {dict(sorted(statuses.items()))}; work by lane: {finished}", file=sys.stderr)
    for kind, delay_s in bystander.delays_s().items():
        alone, beside = (median(times[kind]) for times in (bystander.alone_s, bystander.beside_s))
        count, line = len(bystander.beside_s[kind]), f"seconds of another client's {kind}: median {alone:.2f} alone"
        print(f"{line}, {beside:.2f} beside; longest delay of {count}: {delay_s:.2f}", file=sys.stderr)
    print(f"failed requests of the other client: {len(bystander.failures)} {bystander.failures[:5]}", file=sys.stderr)
    if tried is not None:
        _print_trace(tried, inside)
    return bool(bad or bystander.failures)


def _print_trace(tried: Tried, inside: tuple[str, ...]) -> None:
    outside = tried.opened_outside(inside)
    refused = tried.refused.most_common()
    print(f"{tried.calls} system calls, {sum(tried.refused.values())} of them refused; refused:", file=sys.stderr)
    for named, count in refused[:MOST_ROWS]:
        print(f"{count:8} {named}", file=sys.stderr)
    print(f"opened beside the system, the program and the data: {len(outside)} {outside[:MOST_ROWS]}", file=sys.stderr)


def _row(verdict: Verdict) -> str:
    statuses, word = " ".join(map(str, verdict.statuses)), "ok " if verdict.is_good else "BAD"
    return f"{word} {verdict.seconds:6.1f} s {verdict.peak_mib:6} MiB  {verdict.case[:60]:60} {statuses} {verdict.leaks or ''}"


if __name__ == "__main__":
    sys.exit(main())
