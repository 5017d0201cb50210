"""Steps of the client, without input and output: both clients take the same ones.

An operation is a generator. It yields an `Exchange`, a `Pause` or a piece of `Work`, is sent the answer or the result, and
returns what the operation is for. A client only carries the steps out, by a thread or by an event loop.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import dataclass, field
from email.utils import parsedate_to_datetime
from http import HTTPStatus
from typing import Any, BinaryIO, Protocol, TypeVar

import httpx

from .decoding import decode
from .errors import AnswerError, ClientError, ConnectionFailedError, FileError, Finding, RefusedError

T = TypeVar("T")

CHUNK_BYTES = 1 << 20
MOST_ANSWER_BYTES = 256 << 20
"""Length of an answer that is no frame: ten thousand frames with many attempts at each are far below."""
_MOST_REFUSAL_CHARS = 4000
_NOT_SENT = (httpx.ConnectError, httpx.ConnectTimeout, httpx.PoolTimeout, httpx.UnsupportedProtocol)
"""Errors that come before a request is sent."""
_NOT_DONE = (HTTPStatus.TOO_MANY_REQUESTS, HTTPStatus.SERVICE_UNAVAILABLE)
"""Statuses of what the service has not begun: it is safe to send again."""
_PERHAPS_DONE = (HTTPStatus.BAD_GATEWAY, HTTPStatus.GATEWAY_TIMEOUT)
"""Statuses of a proxy that got no answer."""


@dataclass(frozen=True)
class Retries:
    """Rule by which a request is sent again.

    Attributes:
        tries: number of times that a request is sent at most.
        first_s: pause after the first, s; it doubles.
        longest_s: longest pause, s. A service that asks for a longer one is not waited for.
    """

    tries: int = 5
    first_s: float = 0.5
    longest_s: float = 30.0

    def pauses(self) -> Iterator[float | None]:
        """Return the pause after each try, s, and None after the last; somewhat random, so that clients do not come in step."""
        for number in range(self.tries - 1):
            yield min(self.first_s * 2**number, self.longest_s) * random.uniform(0.75, 1)
        yield None


PATIENT = Retries(tries=30)
"""While a render is watched: a service that restarts, or is away for some ten minutes, is waited for."""


@dataclass(frozen=True)
class Upload:
    """A file that is sent.

    Attributes:
        name: of the file.
        file: open for reading.
        fields: sent with it.
    """

    name: str
    file: BinaryIO
    fields: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Call:
    """A request.

    Attributes:
        method: of HTTP.
        path: below the address of the service.
        params: of the query.
        content: body in JSON.
        upload: a file, in place of `content`.
        headers: further ones.
        is_repeatable: whether it is safe to send it again where no answer came.
        answer_s: time that the service may take before it answers, s.
    """

    method: str
    path: str
    params: Mapping[str, str | int] = field(default_factory=dict)
    content: bytes | None = None
    upload: Upload | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    is_repeatable: bool = True
    answer_s: float = 60.0

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of `httpx.Client.stream`."""
        headers = dict(self.headers)
        arguments: dict[str, Any] = {"method": self.method, "url": self.path, "headers": headers}
        arguments["timeout"] = httpx.Timeout(self.answer_s, connect=10.0)
        if self.params:
            arguments["params"] = dict(self.params)
        if self.upload is not None:
            self.upload.file.seek(0)  # it was read by the try before
            arguments["files"] = {"file": (self.upload.name, self.upload.file)}
            arguments["data"] = dict(self.upload.fields)
        elif self.content is not None:
            headers["Content-Type"] = "application/json"
            arguments["content"] = self.content
        return arguments


class Sink(Protocol):
    """Place that the body of an answer is written to."""

    def restart(self) -> None:
        """Drop what is written: the request is sent again."""

    def write(self, chunk: bytes) -> None:
        """Write a part. Raises `ClientError`: it is too long, or cannot be written."""


@dataclass(frozen=True)
class Answer:
    """An answer of the service.

    Attributes:
        status: of HTTP.
        headers: of HTTP.
        content: body; empty where it went into a sink.
    """

    status: int
    headers: httpx.Headers
    content: bytes = b""

    @property
    def is_success(self) -> bool:
        """Whether the request was carried out."""
        return 200 <= self.status < 300


class Receiver:
    """The body of an answer, while it comes.

    Args:
        response: of httpx, of which the head is there.
        sink: the place for the body of a success; None keeps it.
    """

    def __init__(self, response: httpx.Response, sink: Sink | None) -> None:
        self._head = Answer(response.status_code, response.headers)
        self._sink = sink if self._head.is_success else None
        self._content = bytearray()
        if response.headers.get("Content-Encoding", "identity").lower() != "identity":
            raise AnswerError("the answer is compressed, which was not asked for: a proxy is in the way")
        if self._sink is not None:
            self._sink.restart()

    def write(self, chunk: bytes) -> None:
        """Take a part of the body. Raises `ClientError`: it is too long, or cannot be written."""
        if self._sink is not None:
            self._sink.write(chunk)
        elif len(self._content) + len(chunk) > MOST_ANSWER_BYTES:
            raise AnswerError(f"the answer is longer than {MOST_ANSWER_BYTES >> 20} MiB")
        else:
            self._content += chunk

    def answer(self) -> Answer:
        """Return the answer, once its body is there."""
        return Answer(self._head.status, self._head.headers, bytes(self._content))


@dataclass(frozen=True)
class Exchange:
    """Send a request and receive its answer. An error of httpx is raised in the operation.

    Attributes:
        call: the request.
        sink: for the body of a success; None keeps it in the answer.
        is_enough: asked after each part of the body, which comes as the network has it then; True ends the exchange. None
            receives the whole body.
    """

    call: Call
    sink: Sink | None = None
    is_enough: Callable[[], bool] | None = None

    @property
    def chunk_bytes(self) -> int | None:
        """Length of the parts that the body is received by; None for those of the network."""
        return CHUNK_BYTES if self.is_enough is None else None

    def is_over(self) -> bool:
        """Whether the rest of the body is not needed."""
        return self.is_enough is not None and self.is_enough()


@dataclass(frozen=True)
class Pause:
    """Wait.

    Attributes:
        seconds: how long.
    """

    seconds: float


@dataclass(frozen=True)
class Work:
    """Call a function that reads or writes files.

    Attributes:
        function: without arguments.
    """

    function: Callable[[], object]


Step = Exchange | Pause | Work
Steps = Generator[Step, Any, T]


def perform(call: Call, retries: Retries, sink: Sink | None = None) -> Steps[Answer]:
    """Send a request, again where that is safe and may help.

    Args:
        call: the request.
        retries: how often.
        sink: for the body of a success; None keeps it in the answer.

    Raises:
        RefusedError: the service refuses it.
        ConnectionFailedError: no answer comes.
        AnswerError: the answer is none of this service.
        FileError: a file cannot be read or written.
    """
    was_lost = False
    for pause in retries.pauses():
        try:
            answer: Answer = yield Exchange(call, sink)
        except httpx.TransportError as error:
            is_lost = not isinstance(error, _NOT_SENT)
            if pause is None or (is_lost and not call.is_repeatable):
                raise _connection_failed(error, is_lost=is_lost and not call.is_repeatable) from error
            was_lost |= is_lost
            yield Pause(pause)
            continue
        except OSError as error:
            raise FileError(f"{error.filename or 'a file'}: {error.strerror or error}") from error
        if answer.is_success or (was_lost and call.method == "DELETE" and answer.status == HTTPStatus.NOT_FOUND):
            return answer
        may_help = answer.status in _NOT_DONE or (answer.status in _PERHAPS_DONE and call.is_repeatable)
        asked_s = _retry_after(answer) if may_help else 0.0
        if pause is None or not may_help or asked_s > retries.longest_s:
            raise _refusal(answer)
        yield Pause(max(pause, asked_s))
    raise AssertionError("the last try has no pause")


def read(kind: type[T], call: Call, retries: Retries) -> Steps[T]:
    """Send a request, and return its answer as a dataclass.

    Args:
        kind: the dataclass.
        call: the request.
        retries: how often it is sent.

    Raises:
        ClientError: as of `perform` and `decode`.
    """
    answer = yield from perform(call, retries)
    return decode(kind, answer.content)


@dataclass(frozen=True)
class _Problem:
    code: str
    detail: str
    path: str | None = None
    errors: list[Finding] = field(default_factory=list)


def _refusal(answer: Answer) -> ClientError:
    if 300 <= answer.status < 400:
        leads = answer.headers.get("Location", "elsewhere")[:200]
        return AnswerError(f"the service answers {answer.status} and leads to {leads}, which is not followed")
    try:
        problem = decode(_Problem, answer.content)
    except AnswerError:
        phrase = HTTPStatus(answer.status).phrase if answer.status in set(HTTPStatus) else "unknown"
        return RefusedError(answer.status, f"http_{answer.status}", f"the service answers {answer.status}, {phrase}")
    detail = problem.detail[:_MOST_REFUSAL_CHARS]
    return RefusedError(answer.status, problem.code, detail, problem.path, problem.errors)


def _connection_failed(error: httpx.TransportError, *, is_lost: bool) -> ConnectionFailedError:
    said = " ".join(str(error).split()) or type(error).__name__
    doubt = "; it may have been carried out" if is_lost else ""
    return ConnectionFailedError(f"no answer of the service: {said}{doubt}")


def _retry_after(answer: Answer) -> float:
    """Return the pause that the service asks for, s: seconds, or a date (RFC 9110, section 10.2.3)."""
    text = answer.headers.get("Retry-After", "").strip()
    if text.isascii() and text.isdigit():
        return float(text[:9])
    try:
        at = parsedate_to_datetime(text)
        now = parsedate_to_datetime(answer.headers["Date"])
        return max((at - now).total_seconds(), 0.0)
    except (ValueError, TypeError, KeyError, OverflowError):
        return 0.0
