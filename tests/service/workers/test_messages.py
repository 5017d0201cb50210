"""Messages of a worker that a hostile file has taken control of."""

from __future__ import annotations

import copyreg
import os
import pickle
from dataclasses import replace

import pytest

from render.errors import StageError
from service.models.shots import FrameRange
from service.picture.requests import LivePicture
from service.workers import messages, streaming
from service.workers.messages import Answer, Begun, UnsafeMessageError, pack, read_answer
from service.workers.streaming import Signals, create_memory

ANSWER = b"cservice.workers.messages\nAnswer\n"


@pytest.mark.parametrize(
    "value",
    [
        None,
        b"picture" * 1000,
        {"a": (1, 2.5, "b", frozenset({1}))},
        FrameRange(start=1, end=2, frames_per_second=24),
        [FrameRange(start=1, end=2, frames_per_second=24)] * 3,
    ],
)
def test_values_and_models_arrive(value):
    assert read_answer(pack(Answer(value=value))) == Answer(value=value)


@pytest.mark.parametrize(
    "content",
    [
        b"}"
        + b")"
        + b"\x85" * 500_000
        + b"Ns.",  # a tuple in a tuple in a tuple as a key: its hash would end the process
        b"}(" + b")" + b"\x85" * 500_000 + b"Nu.",
        b"(" + b")" + b"\x85" * 500_000 + b"Nd.",
        b"\x8f(" + b")" + b"\x85" * 500_000 + b"\x90.",
        b"(" + b")" + b"\x85" * 500_000 + b"\x91.",
        b"cbuiltins\nfrozenset\n](" + b")" + b"\x85" * 500_000 + b"e\x85R.",
        b"}" + ANSWER + b")" + b"\x85" * 500_000 + b"\x85R" + b"Ns.",  # as a part of a dataclass
        b"\x96" + (1 << 40).to_bytes(8, "little") + b".",  # an array of bytes takes its memory at once
    ],
)
def test_no_message_ends_the_service(content):
    with pytest.raises(UnsafeMessageError, match="cannot be read"):
        read_answer(b"\x80\x05" + content)


@pytest.mark.parametrize(
    "changes", [{"stage": "invented"}, {"stage": "x" * 1000}, {"width": "640"}, {"data": None}, {"took_ms": {"a": "b"}}]
)
def test_a_picture_has_what_its_types_declare(changes):
    picture = LivePicture("final", "png", 64, 36, {"total": 1.5}, rays=8, scale=1.0, share=1, data=b"png")
    assert read_answer(pack(Answer(value=picture))) == Answer(value=picture)
    with pytest.raises(UnsafeMessageError, match="other types than declared"):
        read_answer(pack(Answer(value=replace(picture, **changes))))


@pytest.mark.parametrize("answer", [Answer(error="no error"), Answer(fault=b"bytes"), Answer(is_last=2)])
def test_an_answer_has_what_its_types_declare(answer):
    with pytest.raises(UnsafeMessageError, match="other types than declared"):
        read_answer(pack(answer))


def test_errors_arrive():
    error = read_answer(pack(Answer(error=StageError("bad", code="stage_unreadable", path="a")))).error
    assert (type(error), str(error), error.path) == (StageError, "bad", "a")
    assert read_answer(pack(Begun())) == Begun()


def test_errors_arrive_whatever_a_library_registered(monkeypatch):
    """Dask registers a function for each class of exception, which is not in the list of what an answer may hold."""
    monkeypatch.setitem(copyreg.dispatch_table, StageError, lambda error: (eval, (repr(str(error)),)))
    assert str(read_answer(pack(Answer(error=StageError("bad", code="stage_unreadable")))).error) == "bad"


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no pickle at all",
        pickle.dumps("no answer"),
        b"cos\nsystem\n(S'true'\ntR.",
        b"cservice.workers.calls\nresolve\n(S'os:system'\ntR.",
        b"cservice.workers.messages\nimport_module\n(S'os'\ntR.",
        b"cservice.workers.messages\npack\n(NtR.",
        b"cservice.stage.shots\ndescribe_shot\n.",
        ANSWER + b"(N(dS'__new__'\ncbuiltins\ncomplex\nsR.",
    ],
)
def test_anything_else_is_refused(content):
    with pytest.raises(UnsafeMessageError):
        read_answer(content)


def test_an_answer_cannot_change_a_class():
    before = Answer.__new__
    evil = ANSWER + b"(N(S'__new__'\ncbuiltins\ncomplex\ndtb."
    with pytest.raises(UnsafeMessageError, match="may not change a class"):
        read_answer(evil)
    assert Answer.__new__ is before


def test_a_short_message_takes_no_more_memory_than_its_size():
    refused = pack(Answer(value=1))[:-1] + b"r\xff\xff\xff\x07."  # a memo of 2**27 entries
    assert read_answer(refused) == Answer(value=1)
    with pytest.raises(UnsafeMessageError):
        read_answer(b"cbuiltins\nbytearray\n(I3000000000\ntR.")


def test_a_message_of_endless_steps_is_refused(monkeypatch):
    monkeypatch.setattr(messages, "MAX_STEPS", 1000)
    with pytest.raises(UnsafeMessageError, match="steps"):
        read_answer(b"]" * 2000)


def test_a_worker_cannot_shrink_the_memory_of_signals():
    memory = create_memory()
    signals = Signals(memory)
    for size in (0, 1 << 20):
        with pytest.raises(PermissionError):
            os.ftruncate(memory, size)
    os.close(memory)
    signals.queue_length = 7
    assert (signals.queue_length, streaming._BYTES) == (7, 16)
