"""``python -m tests.hostile``: the whole hostile corpus against a service of its own, as a table or as JSON."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import tempfile
from pathlib import Path

from tests.hostile.corpus import corpus
from tests.hostile.runner import Verdict, peak_memory, run_cases
from tests.hostile.world import hostile_world


def main() -> int:
    """Run the corpus; 1 where a case is bad."""
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    parser.add_argument("--all", action="store_true", help="all cases, not every tenth")
    parser.add_argument("--only", default="", help="cases whose names contain this")
    parser.add_argument("--json", action="store_true", help="one line of JSON for each case")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, hostile_world(Path(folder)) as world:
        cases = [case for case in corpus(world.canaries) if options.only in case.name]
        verdicts = []
        for verdict in run_cases(
            world.client, cases[:: 1 if options.all or options.only else 10], world.canaries, world.places
        ):
            verdicts.append(verdict)
            print(json.dumps(dataclasses.asdict(verdict)) if options.json else _row(verdict), flush=True)
        peaks = peak_memory(world.client)
    bad = [verdict for verdict in verdicts if not verdict.is_good]
    slowest = max(v.seconds for v in verdicts)
    memory = ", ".join(f"{worker} {peak:,} of {limit:,}" for worker, (peak, limit) in sorted(peaks.items()))
    print(
        f"{len(verdicts)} files, {len(bad)} bad, slowest {slowest:.1f} s; peak memory, MiB: {memory}", file=sys.stderr
    )
    return bool(bad)


def _row(verdict: Verdict) -> str:
    statuses, word = " ".join(map(str, verdict.statuses)), "ok " if verdict.is_good else "BAD"
    return f"{word} {verdict.seconds:6.1f} s {verdict.peak_mib:6} MiB  {verdict.case[:60]:60} {statuses} {verdict.leaks or ''}"


if __name__ == "__main__":
    sys.exit(main())
