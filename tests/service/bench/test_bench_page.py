"""`pullfocus bench page` judges what it measures in a real browser, and says what it needs."""

from __future__ import annotations

import argparse
import builtins
import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from render.errors import PullfocusError, SettingsError
from service.bench.page.browser import fresh_page, installed, running_browser
from service.bench.page.drags import FARTHEST, frames_back
from service.bench.page.gestures import Gestures
from service.bench.page.memory import Held, MemoryMeter, resident_mb
from service.bench.page.plan import PagePlan, add_arguments, plan_from_arguments
from service.bench.page.report import report
from service.bench.page.results import (
    ControlRow,
    DragRow,
    OpeningFound,
    PageBench,
    PageError,
    PlaybackFound,
    RandomUse,
    Round,
    TogetherFound,
    goals_of,
    growth_of,
    longest_gap,
    rate_of,
    scrub_row,
)
from service.bench.page.run import measure, run
from service.bench.results import Machine, spread_of

SECOND = spread_of([1.0])
SEEN = TogetherFound(SECOND, spread_of([1.5]))


def needs_chromium(test: Any) -> Any:
    """Mark a test that drives a browser."""
    return pytest.mark.e2e(pytest.mark.skipif(installed() is None, reason="chromium is not installed")(test))


def opening(first_s: float = 1.0, later_s: float = 1.0) -> OpeningFound:
    return OpeningFound(SECOND, SECOND, SECOND, spread_of([later_s]), 1 + first_s, first_s)


def round_with(heap_mb: float, *, nodes: int = 1000, listeners: int = 50, is_undone: bool = True) -> Round:
    return Round(100, 20, is_undone, Held(heap_mb, nodes, listeners, 10 * heap_mb))


def used(rounds: list[Round], errors: int = 0) -> RandomUse:
    told = [PageError("TypeError: x is null", ["press key: p"])] * errors
    return RandomUse(7, 3.0, {"press key": 300}, Held(8.0, 1000, 50, None), rounds, told, {}, growth_of(rounds))


def test_goals_are_met_where_every_control_answers_at_once():
    quick, fluent = ControlRow("typed", spread_of([0.02, 0.05])), PlaybackFound(24, 9.0, "", 24.0, 0, 0.05)
    goals = goals_of(opening(1.5, 1.5), [quick], fluent, SEEN, used([round_with(9.0)] * 3))
    assert [goal.holds for goal in goals] == [True] * 12


def test_one_slow_answer_misses_the_goal_for_the_slowest():
    slow = ControlRow("clicked", spread_of([0.02, 0.02, 0.08]))
    late = TogetherFound(spread_of([0.2, 1.1]), SECOND)
    goals = goals_of(opening(1.6, 1.4), [slow], PlaybackFound(24, 9.0, "", 23.9, 1, 0.1), late, None)
    assert [goal.holds for goal in goals] == [False, True, True, False, False, False, False]


def test_growth_is_between_the_first_and_the_last_third():
    heaps = [9.0, 11.0, 30.0, 10.0, 16.0, 12.0]
    growth = growth_of([round_with(heap, nodes=int(100 * heap)) for heap in heaps])
    assert growth is not None
    assert (growth.heap_mb, growth.nodes, growth.listeners, growth.resident_mb) == (5.0, 500, 0, 50.0)
    assert growth_of([round_with(9.0)] * 2) is None


def test_errors_growth_and_edits_that_stay_miss_their_goals():
    rounds = [round_with(9.0), round_with(9.0, is_undone=False), round_with(15.0, nodes=2000, listeners=151)]
    goals = goals_of(
        opening(), [ControlRow("typed", SECOND)], PlaybackFound(24, 9.0, "", None, 0, None), SEEN, used(rounds, 1)
    )
    assert [(goal.got, goal.holds) for goal in goals[-5:]] == [
        (1, False),
        (1, False),
        (6, False),
        (1000, False),
        (101, False),
    ]


def test_a_drag_without_pictures_has_its_own_length_as_gap():
    nothing, some = scrub_row("forward", [4.0]), scrub_row("forward", [1.0, 1.5, 4.0])
    assert (nothing.pictures, nothing.pictures_per_s, nothing.longest_gap_s) == (0, 0.0, 4.0)
    assert (some.pictures, some.pictures_per_s, some.longest_gap_s) == (2, 0.5, 2.5)


def test_the_rate_counts_the_times_between_pictures():
    assert rate_of([0.0, 0.0417, 0.0833, 0.125]) == 24.0
    assert rate_of([1.0]) is None
    assert longest_gap([1.0]) is None


def test_each_move_of_a_key_goes_to_another_frame():
    places = [frames_back(number) for number in range(1, 41)]
    assert set(places) == set(range(1, FARTHEST + 1))
    assert all(abs(before - after) == 1 for before, after in pairwise(places))


def test_memory_of_processes_is_added_up(tmp_path: Path):
    for process, kilobytes in ((1, 1000), (2, 3000)):
        (tmp_path / str(process)).mkdir()
        (tmp_path / str(process) / "status").write_text(f"Name:\tchromium\nVmRSS:\t{kilobytes} kB\n")
    assert resident_mb([1, 2, 3], tmp_path) == 4.096
    assert resident_mb([3], tmp_path) is None


def plan_of(*typed: str) -> PagePlan:
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    return plan_from_arguments(parser.parse_args(typed))


def test_a_quick_bench_is_not_judged():
    assert plan_of("--minutes", "30", "--seed", "7") == PagePlan(minutes=30, seed=7)
    assert plan_of().is_judged
    assert not plan_of("--quick").is_judged
    with pytest.raises(SettingsError, match="--minutes must be from 0 to 1440, got -1"):
        plan_of("--minutes", "-1")


def test_the_tables_tell_errors_and_complaints():
    machine = Machine("2026-11-26T00:00:00+00:00", 2, "llvmpipe", 0.1, "3.12", {"pullfocus": "0.1.0"})
    use = used([round_with(9.0)] * 3, errors=1)
    use.complaints["Nothing is there."] = 2
    found = PageBench(
        machine,
        "156.0",
        PagePlan(),
        opening(),
        [ControlRow("typed", spread_of([0.02, 0.05]))],
        [DragRow("a key in its lane", spread_of([0.4]))],
        [scrub_row("forward", [1.0, 1.5, 4.0])],
        PlaybackFound(24, 9.0, "All frames are cached.", 24.0, 0, 0.05),
        SEEN,
        use,
        goals_of(opening(), [ControlRow("typed", SECOND)], PlaybackFound(24, 9.0, "", 24.0, 0, 0.05), SEEN, use),
    )
    lines = report(found).splitlines()
    assert [line.split() for line in lines if line.startswith("typed")] == [["typed", "2", "35", "50"]]
    assert "  TypeError: x is null" in lines
    assert "    after: press key: p" in lines
    assert "  2 x Nothing is there." in lines
    assert sum(line.startswith(("pass", "FAIL")) for line in lines) == len(found.goals) == 12
    assert [line.split()[-3:] for line in lines if line.startswith("a picture of it")] == [["1.50"] * 3]


def test_without_playwright_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    load = builtins.__import__

    def refuse(name: str, *rest: Any, **named: Any) -> Any:
        if name.startswith("playwright"):
            raise ImportError(name)
        return load(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(PullfocusError, match="needs Playwright, which is not installed: run `pip install playwright`"):
        measure(PagePlan())


def test_without_chromium_one_line_says_what_to_install(tmp_path: Path):
    with pytest.raises(PullfocusError, match="needs Chromium, which does not start: install the package chromium"):
        measure(PagePlan(browser=str(tmp_path / "none")))


PAGE = """<!doctype html><button aria-pressed="false">x</button><div class="picture"><canvas width="8"></canvas></div><script>
    const [button] = document.getElementsByTagName("button");
    const press = () => button.setAttribute("aria-pressed", "true");
    button.onclick = () => setTimeout(press, 30);
</script>"""


@needs_chromium
def test_the_probe_measures_until_the_state_has_changed():
    with running_browser(None) as chromium, fresh_page(chromium, 9, PagePlan()) as page:
        page.route("**/*", lambda route: route.fulfill(content_type="text/html", body=PAGE))
        page.goto("/")
        page.hover("button")
        took = []
        for within in (100_000, 10):  # the second click changes nothing
            watched = ["pointerup", "button", "aria-pressed", within]
            page.evaluate(
                "([event, selector, read, within]) => pullfocusProbe.watchState(event, selector, read, within)", watched
            )
            page.mouse.down()
            page.mouse.up()
            took.append(page.evaluate("() => pullfocusProbe.result()"))
        assert took[0] >= 30
        assert took[1] is None
        page.evaluate("() => { document.querySelector('canvas').width = 8; }")
        page.wait_for_function("() => pullfocusProbe.drawn.length === 1")
        assert page.evaluate("() => pullfocusProbe.opening().picture") > took[0]


@needs_chromium
def test_random_gestures_with_a_seed_are_the_same_again():
    kinds = []
    for _ in range(2):
        with running_browser(None) as chromium, fresh_page(chromium, 9, PagePlan(), probed=False) as page:
            page.route("**/*", lambda route: route.fulfill(content_type="text/html", body=PAGE))
            page.goto("/")
            page.wait_for_timeout = lambda _: None  # type: ignore[method-assign]
            gestures = Gestures(page, 3)
            for _ in range(60):
                gestures.step()
            kinds.append(gestures.kinds)
            assert MemoryMeter(page).read().heap_mb > 0
    assert kinds[0] == kinds[1]
    assert len(kinds[0]) > 1


@pytest.mark.gl
@needs_chromium
def test_a_quick_bench_measures_everything(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    file = tmp_path / "page.json"
    run(argparse.Namespace(json=str(file), quick=True, minutes=None, seed=1, browser=None))
    found = json.loads(file.read_text())
    assert all(row["response"]["count"] == 2 for row in found["controls"])
    assert [row["picture"]["count"] for row in found["drags"]] == [2, 2]
    assert all(row["longest_gap_s"] > 0 for row in found["scrubs"])
    assert found["playback"]["frames"] == 2
    assert all(found["together"][name]["count"] == 2 for name in ("value", "picture"))
    assert found["opening"]["picture"]["median_s"] > found["opening"]["loaded"]["median_s"] > 0
    assert found["random_use"]["rounds"][0]["gestures"] > 0
    assert found["random_use"]["rounds"][0]["held"]["heap_mb"] > 0
    assert found["goals"] == []
    assert "nothing to hold" in capsys.readouterr().out
