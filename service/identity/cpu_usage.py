"""Processor time that each sender has used in the last day, kept over restarts.

::

    DATA/usage.json     seconds by name and hour; replaced as a whole, now and then
"""

from __future__ import annotations

import json
import logging
import math
import threading
import time
from collections.abc import Callable
from pathlib import Path

from render.errors import OutputError
from render.files import write_atomic
from service.json_text import parse_json

log = logging.getLogger("pullfocus.service")

HOUR_S = 3600
WINDOW_HOURS = 24
MAX_NAMES = 10_000
"""Names that are counted; of more, those that have used the least are forgotten."""


class CpuUsage:
    """Processor time by name, in a window of 24 hours that moves by the hour. Any thread may use it.

    Args:
        data: the data folder.
        now: time since 1970, s. Where it goes back, what was used in the future counts as used in the present hour.
    """

    def __init__(self, data: Path, now: Callable[[], float] = time.time) -> None:
        self._file = data / "usage.json"
        self._now = now
        self._lock = threading.Lock()
        self._saving = threading.Lock()
        self._is_changed = False
        for part in data.glob(f".{self._file.name}.*.part"):  # of a writer that was killed
            part.unlink(missing_ok=True)
        self._hours = self._read()

    def charge(self, name: str, cpu_s: float) -> None:
        """Add processor time, s."""
        with self._lock:
            hours = self._present(name)
            hour = self._hour()
            hours[hour] = hours.get(hour, 0.0) + cpu_s
            self._hours[name] = hours
            self._is_changed = True
            if len(self._hours) > MAX_NAMES:
                del self._hours[min(self._hours, key=lambda other: sum(self._hours[other].values()))]

    def used_s(self, name: str) -> float:
        """Return the processor time that a name has used in the window, s."""
        with self._lock:
            return sum(self._present(name).values())

    def wait_s(self, name: str, allowed_s: float) -> int:
        """Return the time after which a name will have used less than it is allowed to, s; 0 where it has."""
        with self._lock:
            hours, freed_s = self._present(name), self._now()
            used_s = sum(hours.values())
            for hour in sorted(hours):
                if used_s < allowed_s:
                    break
                used_s -= hours[hour]
                freed_s = (hour + WINDOW_HOURS) * HOUR_S
            return math.ceil(freed_s - self._now())

    def save(self) -> None:
        """Write the file, if anything has changed since it was written. A file that cannot be written is logged."""
        with self._saving:
            with self._lock:
                if not self._is_changed:
                    return
                names = {name: hours for name in self._hours if (hours := self._present(name))}
                self._hours, self._is_changed = names, False
                content = json.dumps({"cpu_s": names}).encode()
            try:
                write_atomic(self._file, content)
            except OutputError as error:
                log.error("%s; the processor time that was used is not kept until it can be", error.detail)
                self._is_changed = True

    def _read(self) -> dict[str, dict[int, float]]:
        try:
            fields = parse_json(self._file.read_text(encoding="utf-8"))["cpu_s"]
            return {name: {int(hour): _checked(s) for hour, s in hours.items()} for name, hours in fields.items()}
        except FileNotFoundError:
            pass
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            log.error("%s cannot be read, and processor time is counted anew: %r", self._file.name, error)
        return {}

    def _present(self, name: str) -> dict[int, float]:
        """Return the hours of a name that are in the window, those of the future as the present one."""
        now = self._hour()
        present: dict[int, float] = {}
        for hour, used_s in self._hours.get(name, {}).items():
            if hour > now - WINDOW_HOURS:
                present[min(hour, now)] = present.get(min(hour, now), 0.0) + used_s
        return present

    def _hour(self) -> int:
        return int(self._now() // HOUR_S)


def _checked(seconds: object) -> float:
    """Return a time, s. Raises `ValueError`: it is none."""
    if not isinstance(seconds, int | float) or not 0 <= seconds < math.inf:
        raise ValueError(f"{seconds!r} is no time")
    return float(seconds)
