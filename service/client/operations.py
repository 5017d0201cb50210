"""Operations of the client as steps, for both clients."""

from __future__ import annotations

import json
import re
import time
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from .decoding import camel_case
from .errors import AnswerError, RefusedError, SettingError, WaitTimeoutError
from .frame_files import SUFFIXES, FetchedFile, StoredFile, file_name, files_of, find_fetched
from .listening import LISTEN_S, Listener
from .models import Render, RenderList, RenderPlan, RenderTask, RenderTaskList, Shot, ShotList, ShotSummary
from .packing import open_package
from .steps import PATIENT, Call, Pause, Retries, Steps, Upload, Work, perform, read

ENDED = ("done", "failed", "canceled")
"""States of a render that has ended."""
MOVIES = ("mp4", "mov", "webm")
"""Kinds of movies."""
REPORTS = {"csv": "text/csv", "json": "application/json", "html": "text/html"}
"""Types of focus reports by the endings of their files."""
MOST_LISTED = 200
"""Renders of one answer."""
_FIRST_LOOK_S, _LONGEST_LOOK_S = 0.25, 3.0
_LOG_LOOK_S = 1.0
"""Time between two looks at a log that is followed, s."""
_LONG_S = 900.0
"""Time for an answer that takes the service work: the check of an upload, a movie, s."""
_SENDABLE = re.compile(r"[\x21-\x7e]{1,200}")

AnyShot = Shot | ShotSummary | str
"""A shot, or its id."""
AnyRender = Render | str
"""A render, or its id."""


def shots(retries: Retries) -> Steps[list[ShotSummary]]:
    """List the shots."""
    return (yield from read(ShotList, Call("GET", "/v1/shots"), retries)).shots


def shot(wanted: AnyShot, retries: Retries) -> Steps[Shot]:
    """Read a shot."""
    return (yield from read(Shot, Call("GET", _address("shots", wanted)), retries))


def push(
    path: Path,
    name: str | None,
    root: str | None,
    project: str | None,
    files: Sequence[Path] | None,
    retries: Retries,
) -> Steps[Shot]:
    """Pack and upload a shot."""
    package = yield Work(lambda: open_package(path, name, root, files))
    try:
        fields = {key: value for key, value in (("root", package.root), ("project", project)) if value is not None}
        upload = Upload(package.name, package.file, fields)
        call = Call("POST", "/v1/shots", upload=upload, is_repeatable=False, answer_s=_LONG_S)
        return (yield from read(Shot, call, retries))
    finally:
        package.file.close()


def delete(wanted: AnyShot, retries: Retries) -> Steps[None]:
    """Move a shot to the trash."""
    yield from perform(Call("DELETE", _address("shots", wanted)), retries)


def plan(wanted: AnyShot, settings: Mapping[str, Any], retries: Retries) -> Steps[RenderPlan]:
    """Check a render, and send nothing."""
    call = Call("POST", "/v1/render-plans", content=_render_body(wanted, settings))
    return (yield from read(RenderPlan, call, retries))


def render(wanted: AnyShot, settings: Mapping[str, Any], key: str | None, retries: Retries) -> Steps[Render]:
    """Send a render, with an idempotency key in any case."""
    key = key or uuid.uuid4().hex
    if not _SENDABLE.fullmatch(key):
        raise SettingError("an idempotency key has 1 to 200 letters, digits and signs, without spaces")
    call = Call(
        "POST", "/v1/renders", content=_render_body(wanted, settings), headers={"Idempotency-Key": key}, answer_s=120.0
    )
    return (yield from read(Render, call, retries))


def renders(most: int, retries: Retries) -> Steps[list[Render]]:
    """List the newest renders, page by page."""
    found: list[Render] = []
    before: str | None = None
    while len(found) < most:
        params: dict[str, str | int] = {"most": min(most - len(found), MOST_LISTED)}
        page = yield from read(
            RenderList, Call("GET", "/v1/renders", params | ({"before": before} if before else {})), retries
        )
        found += page.renders
        if page.next is None or not page.renders:
            break
        before = page.next
    return found[:most]


def get(wanted: AnyRender, retries: Retries) -> Steps[Render]:
    """Read how far a render is."""
    return (yield from read(Render, Call("GET", _address("renders", wanted)), retries))


def tasks(wanted: AnyRender, retries: Retries) -> Steps[list[RenderTask]]:
    """List the frames of a render."""
    return (yield from read(RenderTaskList, Call("GET", f"{_address('renders', wanted)}/tasks"), retries)).tasks


def act(wanted: AnyRender, action: str, retries: Retries) -> Steps[Render]:
    """Change a render. A request without an answer is not sent again: somebody else may act, too."""
    call = Call("POST", f"{_address('renders', wanted)}/{action}", is_repeatable=False)
    return (yield from read(Render, call, retries))


def remove(wanted: AnyRender, retries: Retries) -> Steps[None]:
    """Remove a render and its files."""
    yield from perform(Call("DELETE", _address("renders", wanted)), retries)


class Watch:
    """A render while it is watched.

    Args:
        render: the render, or its id.
        timeout_s: time until `WaitTimeoutError`, s; None waits for as long as it takes.
        retries: for the first request; later ones are repeated for some ten minutes.
    """

    def __init__(self, render: AnyRender, timeout_s: float | None, retries: Retries) -> None:
        self._render = render
        self._timeout_s = timeout_s
        self._end = None if timeout_s is None else time.monotonic() + timeout_s
        self._retries = retries
        self._listener = Listener()
        self._before: Render | None = None
        self._looked_s = 0.0

    def next_change(self) -> Steps[Render]:
        """Read the render at first, and then wait until it has changed.

        It is looked at after each of its events, and every 15 s without one. Where the service tells no events, it is looked at
        every few seconds.
        """
        before, pause_s = self._before, _FIRST_LOOK_S
        if before is None:
            self._before = yield from get(self._render, self._retries)
            return self._before
        while True:
            if (yield from self._listener.listen(before.id, self._within_time(LISTEN_S, before))):
                yield from self._pause_since_look(before)
            else:
                yield Pause(self._within_time(pause_s, before))
                pause_s = min(pause_s * 1.5, _LONGEST_LOOK_S)
            now = yield from self._get_in_time(before)
            self._looked_s = time.monotonic()
            if now != before:
                self._before = now
                return now

    def _pause_since_look(self, now: Render) -> Steps[None]:
        """Wait until some time has passed since the look before, so that many events at once are one."""
        pause_s = self._looked_s + _FIRST_LOOK_S - time.monotonic()
        if pause_s > 0:
            yield Pause(self._within_time(pause_s, now))

    def _get_in_time(self, before: Render) -> Steps[Render]:
        """Read the render; the pauses between its tries end in time, too."""
        steps = get(self._render, PATIENT)
        try:
            step = next(steps)
            while True:
                if isinstance(step, Pause):
                    step = Pause(self._within_time(step.seconds, before))
                try:
                    answer = yield step
                except Exception as error:
                    step = steps.throw(error)
                else:
                    step = steps.send(answer)
        except StopIteration as end:
            now: Render = end.value
            return now

    def _within_time(self, pause_s: float, now: Render) -> float:
        if self._end is None:
            return pause_s
        left_s = self._end - time.monotonic()
        if left_s <= 0:
            raise WaitTimeoutError(f"render {now.id} is {now.state} after {self._timeout_s:g} s")
        return min(pause_s, left_s)


def log(render: AnyRender, frame: int, attempt: int | None, tail: int | None, retries: Retries) -> Steps[str]:
    """Read the log of a frame."""
    answer = yield from perform(_log_call(render, frame, {"attempt": attempt, "tail": tail}), retries)
    return answer.content.decode("utf-8", "replace")


class LogReader:
    """Log of an attempt at a frame that is followed.

    Args:
        render: the render.
        frame: number of the frame.
        attempt: number of the attempt; None for the last one, once there is one.
        retries: for each look.

    Attributes:
        has_ended: whether the attempt has ended, and all of its log is read.
    """

    def __init__(self, render: AnyRender, frame: int, attempt: int | None, retries: Retries) -> None:
        self.has_ended = False
        self._render = render
        self._frame = frame
        self._wanted = self._attempt = attempt
        self._retries = retries
        self._length = 0

    def next_text(self) -> Steps[str]:
        """Wait until there are further lines, or the attempt has ended, and return the lines."""
        while True:
            try:
                answer = yield from perform(
                    _log_call(self._render, self._frame, {"attempt": self._attempt}), self._retries
                )
            except RefusedError as error:
                is_put_off = error.code == "attempt_not_found" and self._wanted is None and self._attempt is not None
                if error.code != "frame_not_begun" and not is_put_off:
                    raise
                self._attempt, self._length = self._wanted, 0
            else:
                text = answer.content.decode("utf-8", "replace")
                number = answer.headers.get("Pullfocus-Attempt", "")
                if not (number.isascii() and number.isdigit()):
                    raise AnswerError("the log does not say which attempt it is of")
                self._attempt = int(number[:9])
                self.has_ended = answer.headers.get("Pullfocus-Ended") == "true"
                new, self._length = text[self._length :], len(text)
                if new or self.has_ended:
                    return new
            yield Pause(_LOG_LOOK_S)


def _log_call(render: AnyRender, frame: int, query: Mapping[str, int | None]) -> Call:
    params = {name: value for name, value in query.items() if value is not None}
    return Call("GET", f"{_address('renders', render)}/frames/{frame}/log", params)


class Download:
    """Frames of a render that go to a folder.

    Args:
        folder: made where it is missing.
        retries: for each frame.
    """

    def __init__(self, folder: Path, retries: Retries) -> None:
        self._folder = folder
        self._retries = retries
        self._fetched: dict[tuple[int, str], str] = {}

    def new_files(self, render: Render) -> Steps[list[StoredFile]]:
        """List the files that are stored and not fetched."""
        found = yield from tasks(render, self._retries)
        stored = [one for task in found if task.state == "done" for one in files_of(task)]
        return [one for one in stored if self._fetched.get((one.frame, one.file.format)) != one.file.sha256]

    def fetch(self, render: Render, stored: StoredFile) -> Steps[Path]:
        """Fetch a file of a frame, unless it is there already; return its path."""
        path: Path | None = yield Work(lambda: find_fetched(self._folder, render, stored))
        if path is None:
            path = yield from self._receive(render, stored)
        self._fetched[stored.frame, stored.file.format] = stored.file.sha256
        return path

    def _receive(self, render: Render, stored: StoredFile) -> Steps[Path]:
        frame, wanted = stored.frame, stored.file.format
        with FetchedFile(self._folder, f"frame {frame}", stored.file) as file:
            call = Call("GET", f"{_address('renders', render)}/frames/{frame}", {"format": wanted})
            answer = yield from perform(call, self._retries, file)
            kind = answer.headers.get("Content-Type", "").partition(";")[0].strip().lower()
            if SUFFIXES.get(kind) != wanted:
                raise AnswerError(f"frame {frame} comes as {kind[:80]!r}, expected {wanted}")
            kept: Path = yield Work(lambda: file.keep(file_name(render, frame, wanted)))
            return kept


def fetch_movie(render: AnyRender, path: Path, retries: Retries) -> Steps[Path]:
    """Fetch the movie of a render, whose kind is the ending of the path. Raises `SettingError`: it is no movie's."""
    ending = path.suffix.lower().removeprefix(".")
    if ending not in MOVIES:
        raise SettingError(f"a movie is a .{', .'.join(MOVIES)} file, got {path.name!r}")
    return _fetch_product(render, "movie", {"format": ending}, path, "video/", retries)


def fetch_contact_sheet(render: AnyRender, path: Path, retries: Retries) -> Steps[Path]:
    """Fetch the contact sheet of a render, a PNG. Raises `SettingError`: the path has another ending."""
    if path.suffix.lower() != ".png":
        raise SettingError(f"a contact sheet is a .png file, got {path.name!r}")
    return _fetch_product(render, "contact-sheet", {}, path, "image/png", retries)


def fetch_focus_report(render: AnyRender, path: Path, frames: str | None, retries: Retries) -> Steps[Path]:
    """Fetch the focus report of a render, whose kind is the ending of the path. Raises `SettingError`: it is no report's."""
    ending = path.suffix.lower().removeprefix(".")
    if ending not in REPORTS:
        raise SettingError(f"a focus report is a .{', .'.join(REPORTS)} file, got {path.name!r}")
    query = {"format": ending} | ({} if frames is None else {"frames": frames})
    return _fetch_product(render, "focus-report", query, path, REPORTS[ending], retries)


def _fetch_product(
    render: AnyRender, product: str, query: Mapping[str, str | int], path: Path, expected: str, retries: Retries
) -> Steps[Path]:
    with FetchedFile(path.parent, product, None) as file:
        call = Call("GET", f"{_address('renders', render)}/{product}", query, answer_s=_LONG_S)  # it may be made now
        answer = yield from perform(call, retries, file)
        kind = answer.headers.get("Content-Type", "")
        if not kind.lower().startswith(expected):
            raise AnswerError(f"the {product} comes as {kind[:80]!r}, expected {expected.removesuffix('/')}")
        kept: Path = yield Work(lambda: file.keep(path.name))
        return kept


def _address(kind: str, wanted: Shot | ShotSummary | Render | str) -> str:
    name = wanted if isinstance(wanted, str) else wanted.id
    if name in ("", ".", ".."):
        raise SettingError(f"{name!r} is no id of {kind}")
    try:
        return f"/v1/{kind}/{quote(name, safe='')}"
    except UnicodeEncodeError as error:
        raise SettingError(f"{name!r} is no id of {kind}") from error


def _render_body(wanted: AnyShot, settings: Mapping[str, Any]) -> bytes:
    name = wanted if isinstance(wanted, str) else wanted.id
    sent = {camel_case(key): value for key, value in settings.items()}
    try:
        return json.dumps({"shot": name} | sent, allow_nan=False).encode()
    except (TypeError, ValueError) as error:
        raise SettingError(f"the settings cannot be sent: {error}") from error
