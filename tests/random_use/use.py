"""Random use of one shot by several pages at once, and whether they come to the same state without an error."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
from playwright.sync_api import Error, Page

from service.bench.page.gestures import Gestures
from service.bench.requests import FIRST_CLIENT, ask

WATCH = Path(__file__).with_name("watch.js")
HISTORY = "/v1/shots/demo/edits/history"
STEPS_OF_ROUND = 40
"""Gestures between two comparisons, of all pages together."""
REST_S = 240.0
"""Longest wait for the pages to come to rest."""
RELOAD_SHARE = 0.01
REFUSALS = "404|409|412|422|429"
"""Statuses that edits may be refused with: somebody else was faster, or the value is absurd."""
_REFUSED = re.compile(rf"Failed to load resource.*status of ({REFUSALS})")
_DRAIN = """() => {
    const { acknowledged, shown } = window.pullfocusUse ?? { acknowledged: [], shown: [] };
    return [acknowledged.splice(0), shown.splice(0)];
}"""
_DISMISS = """() => {
    const complaint = document.querySelector(".complaint[role=alert]");
    const text = complaint?.querySelector("p")?.innerText ?? null;
    complaint?.querySelector("[aria-label=Dismiss]")?.click();
    return text;
}"""


@dataclass(frozen=True)
class Noted:
    """Something that a page has noted of the edits.

    Attributes:
        at_ms: when, ms since 1970.
        page: number of the page.
        kind: `edit`, `undo` or `redo` for what was acknowledged to it; `shown` for what it shows.
        revision: of the edits.
    """

    at_ms: float
    page: int
    kind: str
    revision: str


@dataclass
class Found:
    """Result of a run.

    Attributes:
        kinds: gestures by kind.
        complaints: what the pages said in their line for errors.
        findings: what must not be.
        notes: what the pages have noted.
    """

    kinds: Counter[str] = field(default_factory=Counter)
    complaints: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)
    notes: list[Noted] = field(default_factory=list)

    def delays_ms(self) -> list[float]:
        """Return the times from each acknowledged edit until each other page shows it, or a later one, ms."""
        acknowledged = sorted((each for each in self.notes if each.kind != "shown"), key=lambda each: each.at_ms)
        delays = []
        for number, edit in enumerate(acknowledged):
            later = {each.revision for each in acknowledged[number:]}
            for page in {each.page for each in self.notes} - {edit.page}:
                times = [
                    each.at_ms - edit.at_ms
                    for each in self.notes
                    if each.kind == "shown" and each.page == page and each.revision in later
                ]
                # An event may come before the answer; what was shown long before is the same state after an undo.
                delays += sorted(max(time, 0.0) for time in times if time > -1000)[:1]
        return delays


class Use:
    """Uses pages.

    Args:
        pages: with `WATCH` in them; each in a browser context of its own.
        port: of the service.
        seed: of the gestures.
    """

    def __init__(self, pages: list[Page], port: int, seed: int) -> None:
        self.found = Found()
        self._pages = pages
        self._port = port
        self._gestures = [Gestures(page, 1000 * seed + number) for number, page in enumerate(pages)]
        self._random = np.random.default_rng(seed)
        for number, page in enumerate(pages):
            self._listen(number, page)

    def run(self, seconds: float, most_steps: int | None = None) -> Found:
        """Make gestures for a time, or so many; compare the pages now and then, and at the end.

        Args:
            seconds: time of the gestures and comparisons.
            most_steps: gestures after which it ends earlier; None for no such end.
        """
        until_s, steps = monotonic() + seconds, 0
        try:
            while monotonic() < until_s and (most_steps is None or steps < most_steps):
                number = int(self._random.integers(len(self._pages)))
                self._step(number)
                steps += 1
                if steps % STEPS_OF_ROUND == 0:
                    self.compare()
            self.compare()
        except Error as error:
            self._find(f"a page does not do what is expected: {error}")
        for gestures in self._gestures:
            self.found.kinds.update(gestures.kinds)
        return self.found

    def compare(self) -> None:
        """Let the pages come to rest; they must show the edits that the service has, and it all that it acknowledged."""
        for page in self._pages:
            self._calm(page)
        until_s = monotonic() + REST_S
        while True:
            history = json.loads(ask(self._port, FIRST_CLIENT, "GET", HISTORY)[1])
            for page in self._pages:
                self._draw_stopped(page)
            shown = [self._shown(page) for page in self._pages]
            if all(each == history["revision"] for each in shown):
                break
            if monotonic() > until_s:
                self._find(f"the service has revision {history['revision']}, the pages show {shown}")
                break
            self._pages[0].wait_for_timeout(200)
        self._drain()
        self._check_kept(history)

    def _step(self, number: int) -> None:
        page = self._pages[number]
        if self._random.random() < RELOAD_SHARE:
            self._drain()
            page.reload()
            page.wait_for_selector("canvas")
            self.found.kinds["reload"] += 1
            self._gestures[number].last.append("reload")
            return
        self._gestures[number].step()
        said: str | None = page.evaluate(_DISMISS)
        if said is not None:
            self.found.complaints[said] += 1

    def _calm(self, page: Page) -> None:
        for _ in range(3):
            page.keyboard.press("Escape")
        page.evaluate("() => document.activeElement?.blur()")
        page.keyboard.press("k")
        self._draw_stopped(page)
        page.evaluate(_DISMISS)

    def _draw_stopped(self, page: Page) -> None:
        """Have a picture drawn that was stopped."""
        stopped = page.locator('button:text-is("Draw it")')
        if stopped.count() > 0:
            stopped.first.click()

    def _shown(self, page: Page) -> str | None:
        canvas = page.locator("canvas[data-edits]")
        return canvas.first.get_attribute("data-edits") if canvas.count() > 0 else None

    def _drain(self) -> None:
        for number, page in enumerate(self._pages):
            acknowledged, shown = page.evaluate(_DRAIN)
            for each in acknowledged:
                self.found.notes.append(Noted(each["atMs"], number, each["kind"], each["revision"]))
            for each in shown:
                self.found.notes.append(Noted(each["atMs"], number, "shown", each["revision"]))

    def _check_kept(self, history: dict[str, Any]) -> None:
        """Check that what was acknowledged since the last undo is in the history."""
        walks = [each.at_ms for each in self.found.notes if each.kind in ("undo", "redo")]
        since_ms = max(walks, default=0.0)
        kept = {step["revision"] for step in history["steps"]}
        newest = [each for each in self.found.notes if each.kind == "edit" and each.at_ms > since_ms][-len(kept) :]
        for each in newest:
            if each.revision not in kept:
                self._find(f"the edit {each.revision} was acknowledged to page {each.page} and is lost")

    def _listen(self, number: int, page: Page) -> None:
        def said(message: Any) -> None:
            if message.type == "error" and not _REFUSED.search(message.text):
                self._find(f"console of page {number}: {message.text} ({message.location})")

        def answered(response: Any) -> None:
            if response.status >= 500:
                self._find(f"{response.status} to {response.request.method} {response.url}")

        page.on("pageerror", lambda error: self._find(f"page {number}: {error.message}\n{error.stack or ''}"))
        page.on("crash", lambda _: self._find(f"page {number} has crashed"))
        page.on("console", said)
        page.on("response", answered)

    def _find(self, text: str) -> None:
        last = [list(gestures.last)[-6:] for gestures in self._gestures]
        self.found.findings.append(f"{text}\n  after {last}")
