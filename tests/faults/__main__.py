"""``python -m tests.faults``: a service under faults at random, and whether every acknowledged edit is there."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

from tests.faults.disk import enter_namespace
from tests.faults.run import run_faults


def main() -> int:
    """Run; 1 where something was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="time for which faults are made (default: 60)")
    parser.add_argument("--seed", type=int, default=1, help="chooses faults and edits (default: 1)")
    parser.add_argument("--only", action="append", default=[], help="a fault by name, once each time that it is given")
    parser.add_argument("--json", type=Path, help="file to write the counts and findings to")
    options = parser.parse_args()
    enter_namespace("tests.faults")
    began = time.monotonic()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        log = run_faults(Path(folder), options.seed, options.seconds, options.only)
    result = {
        "seed": options.seed,
        "seconds": round(time.monotonic() - began),
        "counts": dict(sorted(log.counts.items())),
        "findings": log.findings,
    }
    if options.json:
        options.json.write_text(json.dumps(result, indent=1) + "\n")
    print(json.dumps(result, indent=1))
    if "full disk" not in log.counts and not options.only:
        print("the disk was not filled: this needs the right to mount (root), or no run came to it", file=sys.stderr)
    return bool(log.findings)


if __name__ == "__main__":
    sys.exit(main())
