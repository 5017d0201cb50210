"""Messages between the service and a worker process, over a pipe that both hold.

A hostile file may have taken control of a worker. Its messages are therefore read by a restricted unpickler, which makes plain
values and the models and errors of this program, and calls nothing else. Messages of the service are trusted.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass, is_dataclass
from enum import Enum
from functools import cache
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar, get_type_hints

from pydantic import BaseModel, TypeAdapter, ValidationError

from render.errors import PullfocusError
from render.steps import Step
from service.workers.calls import Call, StreamCall
from service.workers.places import Place
from service.workers.roles import Role

State = TypeVar("State")

MAX_MESSAGE_BYTES = 1 << 30
"""Limit on the size of a worker's message: twice that of the largest picture, as OpenEXR with all channels."""

MAX_STEPS = 5_000_000
"""Limit on the values, names and marks in a worker's message, some of which need far more memory than their bytes."""

MAX_KEY_PARTS = 16
"""Limit on the parts of a tuple that is a key or in a set."""
_ATOMS = (str, int, float, bytes, Enum, type(None))

_PLAIN = {
    "builtins": {"complex"},
    "datetime": {"datetime", "date", "timedelta", "timezone"},
}
_OWN = (
    "render.errors",
    "render.model.",
    "service.edit_context",
    "service.models.",
    "service.picture.requests",
    __name__,
)
"""Modules whose classes may be in an answer: they load neither USD nor GL."""
_FLAT = ("service.picture.requests",)
"""Modules of dataclasses whose fields are plain values; those of an answer are judged by their declared types."""


@dataclass(frozen=True)
class Assignment(Generic[State]):
    """First message to a worker.

    Attributes:
        role: its kind.
        place: the shot that it serves.
        gpu: number of the GPU that it draws on, or None for the one that the driver prefers.
        cache: folder of its own that it may write, for compiled shaders, tables and temporary files; None for none.
        base: folder that the cache begins as a copy of; None for an empty one.
    """

    role: Role[State]
    place: Place
    gpu: int | None = None
    cache: Path | None = None
    base: Path | None = None


@dataclass(frozen=True)
class Order(Generic[State]):
    """A call, as it is sent to a worker.

    Attributes:
        call: the function and its arguments.
        cpu_s: processor time that it may take, s.
        serial: number of the stream in `service.workers.streaming.Signals`; 0 for a plain call.
        has_yielded: as for `service.workers.streaming.StaleCheck`.
        grace_s: likewise.
        records_steps: whether the times of its steps are wanted.
        records_output: whether its output is wanted (`service.workers.output`).
    """

    call: Call[State, Any] | StreamCall[State, Any]
    cpu_s: float
    serial: int = 0
    has_yielded: bool = False
    grace_s: float = 0.0
    records_steps: bool = False
    records_output: bool = False


@dataclass(frozen=True)
class Answer:
    """A message of a worker.

    Attributes:
        value: the reply, or an item of a stream.
        error: raised by the function on purpose.
        fault: traceback of a bug.
        is_last: whether it ends the call.
        steps: times of the call and of its parts, where they are wanted (`render.steps.Step`).
    """

    value: object = None
    error: PullfocusError | None = None
    fault: str = ""
    is_last: bool = True
    steps: tuple[Step, ...] = ()


@dataclass(frozen=True)
class Begun:
    """First message of a worker after an order: from here on, the call may have had effects."""


class UnsafeMessageError(Exception):
    """A worker sent something that is no answer."""


class _Writer(pickle.Pickler):
    """Pickler that writes errors by their own methods, whatever a library registered for all exceptions (`tblib` does)."""

    def reducer_override(self, value: Any) -> Any:
        """Return how an error is written; NotImplemented, pickle's usual way, for any other value."""
        return value.__reduce_ex__(pickle.HIGHEST_PROTOCOL) if isinstance(value, PullfocusError) else NotImplemented


def pack(message: object) -> bytes:
    """Pickle a message. Raises what pickle raises for a value that has no copy."""
    content = io.BytesIO()
    _Writer(content, pickle.HIGHEST_PROTOCOL).dump(message)
    return content.getvalue()


def receive_trusted(pipe: Connection) -> Any:
    """Read a message of the service, in the worker. Raises `EOFError` where the service is gone."""
    return pickle.loads(pipe.recv_bytes())


def receive_answer(pipe: Connection) -> Answer | Begun:
    """Read a message of a worker, in the service.

    Raises:
        EOFError: the worker is gone.
        OSError: the worker is gone, or sent more than `MAX_MESSAGE_BYTES`.
        UnsafeMessageError: it is no answer, or holds an object of a class that is not allowed.
    """
    return read_answer(pipe.recv_bytes(MAX_MESSAGE_BYTES))


def read_answer(content: bytes) -> Answer | Begun:
    """Unpickle an answer. Raises `UnsafeMessageError`: it is none, or holds an object of a class that is not allowed."""
    try:
        answer = _AnswerReader(io.BytesIO(content)).load()
    except Exception as error:  # whatever a damaged pickle, or a value that a model refuses, raises
        raise UnsafeMessageError(f"a message cannot be read: {error!r}") from error
    if not isinstance(answer, Answer | Begun):
        raise UnsafeMessageError(f"a message is a {type(answer).__name__}")
    if isinstance(answer, Answer):
        _check_types(answer)
    return answer


def _check_types(answer: Answer) -> None:
    """Raise `UnsafeMessageError` where an answer, or the dataclass that it holds, has values of other types than declared."""
    try:
        is_answer = isinstance(answer.fault, str) and isinstance(answer.is_last, bool)
        if not is_answer or not isinstance(answer.error, PullfocusError | None):
            raise UnsafeMessageError("an answer is of other types than declared")
        kind: Any = type(answer.value)
        if kind.__module__ in _FLAT:
            for name, adapter in _declared(kind).items():
                adapter.validate_python(getattr(answer.value, name), strict=True)
    except (AttributeError, ValidationError) as error:
        raise UnsafeMessageError(f"an answer is of other types than declared: {error}") from error


@cache
def _declared(kind: type) -> dict[str, TypeAdapter[Any]]:
    """Types of the fields of a dataclass."""
    return {name: TypeAdapter(declared) for name, declared in get_type_hints(kind, include_extras=True).items()}


def sendable_error(error: PullfocusError) -> PullfocusError:
    """Return an error as the nearest class that an answer may hold, with the same text."""
    kind = next(kind for kind in type(error).__mro__ if kind.__module__.startswith(_OWN))
    return error if kind is type(error) else kind(error.detail, code=error.code, path=error.path)


def _counted(step: Callable[[Any], None]) -> Callable[[Any], None]:
    def counted(reader: _AnswerReader) -> None:
        reader.steps += 1
        if reader.steps > MAX_STEPS:
            raise pickle.UnpicklingError(f"a message has more than {MAX_STEPS:,} steps")
        step(reader)

    return counted


def _load_build(reader: Any) -> None:
    """Set the state of an object, and never that of a class, which all answers share."""
    if isinstance(reader.stack[-2], type):
        raise pickle.UnpicklingError("an answer may not change a class")
    _Unpickler.load_build(reader)


def _load_bytearray(reader: Any) -> None:
    """Refuse an array of bytes, whose memory is taken before its bytes are there."""
    raise pickle.UnpicklingError("an answer may not hold an array of bytes")


def _with_plain_keys(step: Callable[[Any], None], keys_of: Callable[[Any], Sequence[object]]) -> Callable[[Any], None]:
    """Judge what a step puts in a dictionary or a set: nested tuples are hashed by a recursion that can end the service."""

    def judged(reader: Any) -> None:
        for key in keys_of(reader):
            parts = key if type(key) is tuple else (key,)
            if len(parts) > MAX_KEY_PARTS or not all(isinstance(part, _ATOMS) for part in parts):
                raise pickle.UnpicklingError("an answer may not have nested values as keys")
        step(reader)

    return judged


_Unpickler: Any = (
    pickle._Unpickler
)  # in Python, so that its steps can be judged; the bytes of a picture are one of them


class _AnswerReader(_Unpickler):  # type: ignore[misc]
    """Unpickler that makes plain values and the models and errors of this program alone."""

    steps = 0
    dispatch: ClassVar = {code: _counted(step) for code, step in _Unpickler.dispatch.items()} | {
        code: _counted(step)
        for code, step in (
            (pickle.BUILD[0], _load_build),
            (pickle.BYTEARRAY8[0], _load_bytearray),
            (pickle.SETITEM[0], _with_plain_keys(_Unpickler.load_setitem, lambda reader: reader.stack[-2:-1])),
            (pickle.SETITEMS[0], _with_plain_keys(_Unpickler.load_setitems, lambda reader: reader.stack[::2])),
            (pickle.DICT[0], _with_plain_keys(_Unpickler.load_dict, lambda reader: reader.stack[::2])),
            (pickle.ADDITEMS[0], _with_plain_keys(_Unpickler.load_additems, lambda reader: reader.stack)),
            (pickle.FROZENSET[0], _with_plain_keys(_Unpickler.load_frozenset, lambda reader: reader.stack)),
        )
    }

    def find_class(self, module: str, name: str) -> Any:
        """Return a class that may be in an answer. Raises `pickle.UnpicklingError` for all others."""
        if name in _PLAIN.get(module, ()):
            return super().find_class(module, name)
        found = getattr(import_module(module), name, None) if module.startswith(_OWN) else None
        if isinstance(found, type) and found.__module__ == module and _is_value(found):
            return found
        raise pickle.UnpicklingError(f"{module}.{name} may not be in an answer")


def _is_value(kind: type) -> bool:
    return is_dataclass(kind) or issubclass(kind, BaseModel | PullfocusError | Enum)
