"""Memory that a page holds, after a forced garbage collection."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page

MEGABYTE = 1e6
_COLLECTIONS = 3
"""Collections in a row: a later one gets what finalizers let go of."""


@dataclass(frozen=True)
class Held:
    """Memory and objects of a page.

    Attributes:
        heap_mb: of the JavaScript heap in use, megabytes.
        nodes: of all documents, those that are not in the page included.
        listeners: of events.
        resident_mb: memory of the renderer processes in the machine, megabytes; None where the system does not tell.
    """

    heap_mb: float
    nodes: int
    listeners: int
    resident_mb: float | None


class MemoryMeter:
    """Meter of the memory of a page.

    Args:
        page: to be measured.
    """

    def __init__(self, page: Page) -> None:
        self._page = page.context.new_cdp_session(page)
        self._page.send("Performance.enable")
        browser = page.context.browser
        self._browser = None if browser is None else browser.new_browser_cdp_session()

    def read(self) -> Held:
        """Collect what nothing holds, and read the rest."""
        for _ in range(_COLLECTIONS):
            self._page.send("HeapProfiler.collectGarbage")
        metrics = {each["name"]: each["value"] for each in self._page.send("Performance.getMetrics")["metrics"]}
        return Held(
            metrics["JSHeapUsedSize"] / MEGABYTE,
            int(metrics["Nodes"]),
            int(metrics["JSEventListeners"]),
            self._resident_mb(),
        )

    def _resident_mb(self) -> float | None:
        if self._browser is None:
            return None
        processes = self._browser.send("SystemInfo.getProcessInfo")["processInfo"]
        return resident_mb(int(process["id"]) for process in processes if process["type"] == "renderer")


def resident_mb(processes: Iterable[int], system: Path = Path("/proc")) -> float | None:
    """Read how much memory processes have in the machine.

    Args:
        processes: their numbers; one that has ended counts as nothing.
        system: folder of Linux's process information.

    Returns:
        Megabytes; None where the system does not tell.
    """
    kilobytes = []
    for process in processes:
        with suppress(OSError):
            lines = (system / str(process) / "status").read_text().splitlines()
            kilobytes += [int(line.split()[1]) for line in lines if line.startswith("VmRSS:")]
    return 1024 * sum(kilobytes) / MEGABYTE if kilobytes else None
