"""``python -m tests.random_use``: several browsers use one shot at random, at once; no error, and no lost edit."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from service.bench.page.browser import fresh_page, open_demo, running_browser
from service.bench.page.plan import PagePlan
from service.bench.server import running_service
from tests.random_use.use import WATCH, Found, Use

PLAN = PagePlan(width=900, height=560, pixel_ratio=0.5)


def use_at_random(seed: int, minutes: float, browsers: int, most_steps: int | None = None) -> Found:
    """Start a service and a browser with pages that share nothing, and use them.

    Args:
        seed: of the gestures.
        minutes: time of the use.
        browsers: number of pages.
        most_steps: gestures after which it ends earlier; None for no such end.
    """
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        browser = stack.enter_context(running_browser(None))
        port = stack.enter_context(running_service(Path(folder), first=True))  # which waits for no shaders
        pages = [stack.enter_context(fresh_page(browser, port, PLAN, probed=False)) for _ in range(browsers)]
        use = Use(pages, port, seed)
        for page in pages:
            page.add_init_script(path=WATCH)
            open_demo(page, 40)
        return use.run(60 * minutes, most_steps)


def summary(found: Found) -> dict[str, Any]:
    """Return the counts, delays and findings of a run, for JSON."""
    delays = found.delays_ms()
    quantiles = np.quantile(delays, (0.5, 0.95, 1)) if delays else (None, None, None)
    return {
        "gestures": dict(found.kinds.most_common()),
        "acknowledged": sum(note.kind != "shown" for note in found.notes),
        "delays": len(delays),
        "delayMs": {
            name: value and round(float(value))
            for name, value in zip(("median", "p95", "most"), quantiles, strict=True)
        },
        "complaints": dict(found.complaints.most_common()),
        "findings": found.findings,
    }


def main() -> int:
    """Run; 1 where something was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.random_use", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="chooses the gestures (default: 1)")
    parser.add_argument("--minutes", type=float, default=60.0, help="time of the use (default: 60)")
    parser.add_argument("--browsers", type=int, default=2, help="pages at the shot (default: 2)")
    parser.add_argument("--json", type=Path, help="file to write the result to")
    options = parser.parse_args()
    began = time.monotonic()
    found = use_at_random(options.seed, options.minutes, options.browsers)
    result = {"seed": options.seed, "seconds": round(time.monotonic() - began), **summary(found)}
    if options.json:
        options.json.write_text(json.dumps(result, indent=1) + "\n")
    for name in ("median", "p95", "most"):
        print(f"{name:>8} {result['delayMs'][name] or 0:8} ms from an acknowledged edit to the other page")
    print(json.dumps(result, indent=1))
    return bool(found.findings)


if __name__ == "__main__":
    sys.exit(main())
