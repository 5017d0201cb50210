"""The page bench: how soon the page answers to its controls, drags, scrubbing, playing and opening, and to edits elsewhere; its
memory under random use.

pullfocus bench page
pullfocus bench page --minutes 30 --seed 7      more random use, and another
"""

from __future__ import annotations

import argparse
import http.client
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from render.errors import PullfocusError
from render.lab.bench.progress import check_file, say
from service.bench.machine import this_machine
from service.bench.page.browser import fresh_page, open_demo, running_browser
from service.bench.page.controls import CONTROLS, FRAME, response_times
from service.bench.page.drags import KNOT, LANE_KEY, key_drag_times, scrub, show_curve
from service.bench.page.opening import Opened, open_fresh
from service.bench.page.plan import PagePlan, plan_from_arguments
from service.bench.page.playing import cache_and_play
from service.bench.page.random_use import use_at_random
from service.bench.page.report import report
from service.bench.page.results import (
    ControlRow,
    DragRow,
    OpeningFound,
    PageBench,
    PlaybackFound,
    RandomUse,
    ScrubRow,
    TogetherFound,
    goals_of,
    longest_gap,
    rate_of,
    scrub_row,
)
from service.bench.page.shot import read_edits, restore_edits
from service.bench.page.together import edits_seen
from service.bench.results import spread_of
from service.bench.server import running_service

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

PACKAGES = ("pullfocus", "playwright", "uvicorn", "websockets", "fastapi", "usd-core")


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `service.bench.page.plan.add_arguments` declares them.

    Raises:
        SettingsError: a number is out of range.
        PullfocusError: there is no Playwright or no Chromium, or the service or the page does not do what it should.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def measure(plan: PagePlan) -> PageBench:
    """Start a browser and a service, and measure the page; raises as `run` does."""
    with running_browser(plan.browser) as browser:
        machine = this_machine(PACKAGES)
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name, running_service(Path(name)) as port:
            try:
                opening = _opening(browser, port, plan)
                controls = _controls(browser, port, plan)
                drags, scrubs = _drags(browser, port, plan), _scrubs(browser, port, plan)
                playback = _playback(browser, port, plan)
                together = _together(browser, port, plan)
                random_use = _random_use(browser, port, plan) if plan.minutes > 0 else None
            except (OSError, http.client.HTTPException) as error:
                raise PullfocusError(
                    f"the service of the bench does not answer: {type(error).__name__}: {error}"
                ) from error
        goals = goals_of(opening, controls, playback, together, random_use) if plan.is_judged else []
        return PageBench(
            machine, browser.version, plan, opening, controls, drags, scrubs, playback, together, random_use, goals
        )


def _opening(browser: Browser, port: int, plan: PagePlan) -> OpeningFound:
    opened = [open_fresh(browser, port, plan) for _ in range(plan.opens)]
    later = opened[1:] or opened
    return OpeningFound(
        spread_of([each.loaded_s for each in later]),
        spread_of([each.contentful_s for each in later]),
        spread_of([each.picture_s for each in later]),
        spread_of([_after_loaded_s(each) for each in later]),
        opened[0].picture_s,
        _after_loaded_s(opened[0]),
    )


def _after_loaded_s(opened: Opened) -> float:
    return opened.picture_s - opened.loaded_s


def _controls(browser: Browser, port: int, plan: PagePlan) -> list[ControlRow]:
    with _demo_page(browser, port, plan) as page:
        return [ControlRow(each.name, spread_of(response_times(page, each, plan.repeats))) for each in CONTROLS]


def _drags(browser: Browser, port: int, plan: PagePlan) -> list[DragRow]:
    with _demo_page(browser, port, plan) as page:
        in_lane = key_drag_times(page, LANE_KEY, plan.moves)
        show_curve(page)
        on_curve = key_drag_times(page, KNOT, plan.moves)
    return [
        DragRow("a key in its lane", spread_of(in_lane)),
        DragRow("a key on its curve", spread_of(on_curve)),
    ]


def _scrubs(browser: Browser, port: int, plan: PagePlan) -> list[ScrubRow]:
    with _demo_page(browser, port, plan) as page:
        return [
            scrub_row(name, scrub(page, plan.scrub_s, back=back))
            for name, back in (("forward, nothing kept", False), ("back over kept frames", True))
        ]


def _playback(browser: Browser, port: int, plan: PagePlan) -> PlaybackFound:
    with fresh_page(browser, port, plan) as page:
        played = cache_and_play(page, plan.cached_frames, plan.play_s)
    painted = played.painted_s
    return PlaybackFound(
        plan.cached_frames, played.cache_s, played.said, rate_of(painted), played.dropped, longest_gap(painted)
    )


def _together(browser: Browser, port: int, plan: PagePlan) -> TogetherFound:
    untouched = read_edits(port).revision
    seen = edits_seen(browser, port, plan)
    restore_edits(port, untouched)
    return TogetherFound(spread_of([each.value_s for each in seen]), spread_of([each.picture_s for each in seen]))


def _random_use(browser: Browser, port: int, plan: PagePlan) -> RandomUse:
    with fresh_page(browser, port, plan, probed=False) as page:
        return use_at_random(page, port, plan.minutes, plan.seed)


@contextmanager
def _demo_page(browser: Browser, port: int, plan: PagePlan) -> Iterator[Page]:
    """Open the demo shot, and take back at the end how it was edited."""
    untouched = read_edits(port).revision
    with fresh_page(browser, port, plan) as page:
        open_demo(page, FRAME)
        yield page
    restore_edits(port, untouched)
