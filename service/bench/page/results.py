"""Results of the page bench as plain data: the fields are the keys of its JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from render.lab.bench.results import Goal
from service.bench.page.memory import Held
from service.bench.page.plan import PagePlan
from service.bench.results import Machine, Spread

RESPONSE_MS, PLAYED_FPS, FIRST_PICTURE_S, SEEN_S = 50.0, 24.0, 1.5, 1.0
GROWTH_MB, GROWTH_NODES, GROWTH_LISTENERS = 5.0, 500, 100
"""Growth from the first third of the random use to the last that still counts as none: no two states are quite alike."""
FEWEST_ROUNDS = 3


@dataclass(frozen=True)
class ControlRow:
    """Response of one control.

    Attributes:
        control: its name, and the input.
        response: from the input to the frame that shows the new state.
    """

    control: str
    response: Spread


@dataclass(frozen=True)
class DragRow:
    """A key that is dragged.

    Attributes:
        key: where it is.
        picture: from a move of the pointer to the changed picture on screen.
    """

    key: str
    picture: Spread


@dataclass(frozen=True)
class ScrubRow:
    """A drag of the scrubber through the whole shot.

    Attributes:
        drag: which one.
        pictures: how many were painted.
        pictures_per_s: in a second.
        longest_gap_s: longest time without a new one, s.
    """

    drag: str
    pictures: int
    pictures_per_s: float
    longest_gap_s: float


def scrub_row(drag: str, painted_s: Sequence[float]) -> ScrubRow:
    """Summarize a drag of the scrubber.

    Args:
        drag: its name.
        painted_s: times of the pictures since the drag began, s; the last one is its end.
    """
    *pictures, end_s = painted_s
    gap_s = longest_gap((0.0, *painted_s)) or 0.0
    return ScrubRow(drag, len(pictures), len(pictures) / end_s, gap_s)


def longest_gap(painted_s: Sequence[float]) -> float | None:
    """Return the longest time between two pictures, s; None for fewer than two.

    Args:
        painted_s: their times, s.
    """
    return max((later - earlier for earlier, later in pairwise(painted_s)), default=None)


@dataclass(frozen=True)
class PlaybackFound:
    """Playing of cached frames.

    Attributes:
        frames: how many were cached.
        cache_s: time that the caching took, s.
        said: what the page says of its cache.
        fps: pictures painted a second; None for fewer than two.
        dropped: frames dropped, as the page counts them.
        longest_gap_s: longest time without a new picture, s; None for fewer than two.
    """

    frames: int
    cache_s: float
    said: str
    fps: float | None
    dropped: int
    longest_gap_s: float | None


def rate_of(painted_s: Sequence[float]) -> float | None:
    """Return how many pictures a second were painted; None for fewer than two times.

    Args:
        painted_s: their times, s; the last one is the end.
    """
    if len(painted_s) < 2:
        return None
    return (len(painted_s) - 1) / (painted_s[-1] - painted_s[0])


@dataclass(frozen=True)
class OpeningFound:
    """Fresh opens of the demo shot. The spreads leave out the very first one, of a service that has just started, unless it is
    the only one.

    Attributes:
        loaded: from the begin of the navigation to the end of the load event: the page is up.
        contentful: from the same to the first paint with content.
        picture: from the same to the first picture.
        picture_after_loaded: from the page being up to the first picture.
        first_picture_s: `picture` of the very first open, s.
        first_after_loaded_s: `picture_after_loaded` of the very first open, s.
    """

    loaded: Spread
    contentful: Spread
    picture: Spread
    picture_after_loaded: Spread
    first_picture_s: float
    first_after_loaded_s: float


@dataclass(frozen=True)
class TogetherFound:
    """Edits of one browser, seen in another one.

    Attributes:
        value: from the key press that makes an edit to its value in the other's panel.
        picture: from the same to the other's first picture of the new state.
    """

    value: Spread
    picture: Spread


@dataclass(frozen=True)
class PageError:
    """Error in the page's console, or one that the page does not catch.

    Attributes:
        text: the error.
        gestures: what was done before, oldest first.
    """

    text: str
    gestures: list[str]


@dataclass(frozen=True)
class Round:
    """A round of random gestures, at whose end everything is undone.

    Attributes:
        gestures: how many.
        undone: presses of undo at its end.
        is_undone: whether the edits are to the letter what they were at first.
        held: memory at its end.
    """

    gestures: int
    undone: int
    is_undone: bool
    held: Held


@dataclass(frozen=True)
class Growth:
    """Growth of memory from the first third of the rounds to the last, by the most in each.

    Attributes:
        heap_mb: of the JavaScript heap, megabytes.
        nodes: of documents.
        listeners: of events.
        resident_mb: of the renderer processes, megabytes; None where the system does not tell.
    """

    heap_mb: float
    nodes: int
    listeners: int
    resident_mb: float | None


def growth_of(rounds: Sequence[Round]) -> Growth | None:
    """Compare the last third of the rounds with the first; None where there are too few."""
    if len(rounds) < FEWEST_ROUNDS:
        return None
    third = len(rounds) // 3
    first, last = ([each.held for each in part] for part in (rounds[:third], rounds[-third:]))
    resident = [[held.resident_mb for held in part if held.resident_mb is not None] for part in (first, last)]
    return Growth(
        max(held.heap_mb for held in last) - max(held.heap_mb for held in first),
        max(held.nodes for held in last) - max(held.nodes for held in first),
        max(held.listeners for held in last) - max(held.listeners for held in first),
        max(resident[1]) - max(resident[0]) if all(resident) else None,
    )


@dataclass(frozen=True)
class RandomUse:
    """Random use of the page.

    Attributes:
        seed: of the gestures.
        minutes: time of the gestures.
        kinds: number of gestures of each kind.
        before: memory before.
        rounds: the rounds.
        errors: in the console and uncaught.
        complaints: what the page said in its line for errors, and how often; some gestures deserve it.
        growth: of the memory; None for fewer than three rounds.
    """

    seed: int
    minutes: float
    kinds: dict[str, int]
    before: Held
    rounds: list[Round]
    errors: list[PageError]
    complaints: dict[str, int]
    growth: Growth | None


@dataclass(frozen=True)
class PageBench:
    """All of it.

    Attributes:
        machine: what it ran on.
        browser: its version.
        plan: of the measurements.
        opening: fresh opens.
        controls: rows by control.
        drags: rows by key.
        scrubs: rows by drag.
        playback: playing of cached frames.
        together: edits seen by another browser.
        random_use: None where none was asked for.
        goals: none where the window is not that for which they are set.
    """

    machine: Machine
    browser: str
    plan: PagePlan
    opening: OpeningFound
    controls: list[ControlRow]
    drags: list[DragRow]
    scrubs: list[ScrubRow]
    playback: PlaybackFound
    together: TogetherFound
    random_use: RandomUse | None
    goals: list[Goal]


def goals_of(
    opening: OpeningFound,
    controls: Sequence[ControlRow],
    playback: PlaybackFound,
    together: TogetherFound,
    random_use: RandomUse | None,
) -> list[Goal]:
    """Judge what was found."""
    medians, most = (
        [1000 * (getattr(row.response, name) or 0.0) for row in controls] for name in ("median_s", "most_s")
    )
    fps = playback.fps or 0.0
    return [
        _at_most(
            "first picture after the page is up, service just started, s", FIRST_PICTURE_S, opening.first_after_loaded_s
        ),
        _at_most(
            "first picture after the page is up, slowest later open, s",
            FIRST_PICTURE_S,
            opening.picture_after_loaded.most_s or 0.0,
        ),
        _at_most("control response, slowest control's median, ms", RESPONSE_MS, max(medians)),
        _at_most("control response, slowest of all, ms", RESPONSE_MS, max(most)),
        Goal("cached playback, pictures a second, at least", PLAYED_FPS, fps, fps >= PLAYED_FPS),
        _at_most("cached playback, frames dropped", 0, playback.dropped),
        _at_most("edit seen by another browser, value, p95, s", SEEN_S, together.value.p95_s or 0.0),
        *(_of_random_use(random_use) if random_use else ()),
    ]


def _of_random_use(found: RandomUse) -> Iterator[Goal]:
    yield _at_most("random use: errors in the console", 0, len(found.errors))
    yield _at_most("random use: rounds not undone to the letter", 0, sum(not each.is_undone for each in found.rounds))
    if found.growth is not None:
        yield _at_most("random use: growth of the heap, MB", GROWTH_MB, found.growth.heap_mb)
        yield _at_most("random use: growth in nodes", GROWTH_NODES, found.growth.nodes)
        yield _at_most("random use: growth in listeners", GROWTH_LISTENERS, found.growth.listeners)


def _at_most(goal: str, want: float, got: float) -> Goal:
    return Goal(f"{goal}, at most", want, got, got <= want)
