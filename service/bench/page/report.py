"""The page bench for people: plain tables."""

from __future__ import annotations

from collections.abc import Iterator

from render.lab.bench.progress import goal_lines
from service.bench.page.memory import Held
from service.bench.page.results import PageBench, RandomUse
from service.bench.results import Spread

_NAME = 34
_MOST_TOLD = 10


def report(found: PageBench) -> str:
    """The tables."""
    parts = (_head(found), _opening(found), _responses(found), _pictures(found), _random_use(found), _goals(found))
    return "\n".join(line for part in parts for line in part) + "\n"


def _head(found: PageBench) -> Iterator[str]:
    machine, plan = found.machine, found.plan
    versions = ", ".join(f"{name} {version}" for name, version in machine.versions.items())
    yield f"{machine.device}; {machine.cores} cores, load {machine.load:.1f} before; {machine.date}"
    yield f"Chromium {found.browser}, Python {machine.python}, {versions}"
    yield f"Demo shot in a window of {plan.width}x{plan.height}, {plan.pixel_ratio:g} device pixels each"


def _opening(found: PageBench) -> Iterator[str]:
    opening = found.opening
    yield ""
    yield (
        f"First picture of a service that has just started: {opening.first_picture_s:.2f} s after the navigation began, "
        f"{opening.first_after_loaded_s:.2f} s after the page was up"
    )
    yield _line("later fresh opens, s", "count", "median", "worst")
    for name, spread in (
        ("page up (load event)", opening.loaded),
        ("first paint with content", opening.contentful),
        ("first picture", opening.picture),
        ("first picture after the page is up", opening.picture_after_loaded),
    ):
        yield _line(name, str(spread.count), _s(spread.median_s), _s(spread.most_s))


def _responses(found: PageBench) -> Iterator[str]:
    yield ""
    yield _line("control: input to new state, ms", "count", "median", "worst")
    for row in found.controls:
        yield _ms_line(row.control, row.response)


def _pictures(found: PageBench) -> Iterator[str]:
    yield ""
    yield _line("drag: move to changed picture, ms", "count", "median", "worst")
    for row in found.drags:
        yield _ms_line(row.key, row.picture)
    yield ""
    yield _line(f"scrub, {found.plan.scrub_s:g} s each", "pictures", "a second", "longest gap, s")
    for scrub in found.scrubs:
        yield _line(scrub.drag, str(scrub.pictures), f"{scrub.pictures_per_s:.1f}", _s(scrub.longest_gap_s))
    playback = found.playback
    yield ""
    yield (
        f"Cached playback of {playback.frames} frames, {found.plan.play_s:g} s: {_number(playback.fps)} pictures a second, "
        f"{playback.dropped} dropped, longest gap {_s(playback.longest_gap_s)} s; cached in {playback.cache_s:.1f} s"
    )
    yield f"  {playback.said}"
    yield ""
    yield _line("edit seen by another browser, s", "count", "median", "p95", "worst")
    for name, seen in (("its value", found.together.value), ("a picture of it", found.together.picture)):
        yield _line(name, str(seen.count), _s(seen.median_s), _s(seen.p95_s), _s(seen.most_s))


def _random_use(found: PageBench) -> Iterator[str]:
    use = found.random_use
    if use is None:
        return
    gestures, undone = (sum(getattr(each, name) for each in use.rounds) for name in ("gestures", "undone"))
    yield ""
    yield (
        f"Random use for {use.minutes:g} minutes, seed {use.seed}: {gestures} gestures in {len(use.rounds)} rounds, "
        f"{undone} presses of undo; {sum(each.is_undone for each in use.rounds)} rounds undone to the letter"
    )
    yield f"  {', '.join(f'{kind} {count}' for kind, count in use.kinds.items())}"
    yield _line("everything undone, after", "heap, MB", "nodes", "listeners", "resident, MB")
    yield _held_line("opening", use.before)
    for number, each in enumerate(use.rounds, 1):
        yield _held_line(f"round {number}", each.held)
    if use.growth is not None:
        growth = use.growth
        yield _line(
            "growth, first third to last",
            *(f"{growth.heap_mb:+.1f}", f"{growth.nodes:+d}", f"{growth.listeners:+d}"),
            "unknown" if growth.resident_mb is None else f"{growth.resident_mb:+.0f}",
        )
    yield from _said(use)


def _said(use: RandomUse) -> Iterator[str]:
    yield f"Errors in the console: {len(use.errors)}"
    for error in use.errors[:_MOST_TOLD]:
        yield f"  {error.text.strip()}"
        yield f"    after: {' | '.join(error.gestures)}"
    if use.complaints:
        yield f"Complaints of the page: {sum(use.complaints.values())}"
        yield from (f"  {count} x {text}" for text, count in list(use.complaints.items())[:_MOST_TOLD])


def _goals(found: PageBench) -> Iterator[str]:
    yield ""
    if not found.goals:
        yield "The goals are set for a window of 1440x900: at this size there is nothing to hold."
    yield from goal_lines(found.goals)


def _held_line(name: str, held: Held) -> str:
    resident = "unknown" if held.resident_mb is None else f"{held.resident_mb:.0f}"
    return _line(name, f"{held.heap_mb:.1f}", str(held.nodes), str(held.listeners), resident)


def _ms_line(name: str, spread: Spread) -> str:
    cells = ("none" if each is None else f"{1000 * each:.0f}" for each in (spread.median_s, spread.most_s))
    return _line(name, str(spread.count), *cells)


def _line(name: str, *cells: str) -> str:
    return f"{name:<{_NAME}}{''.join(f'{cell:>16}' for cell in cells)}"


def _s(seconds: float | None) -> str:
    return "none" if seconds is None else f"{seconds:.2f}"


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.1f}"
