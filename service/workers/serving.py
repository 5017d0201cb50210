"""The loop of a worker process: it enters its sandbox, creates its state once, and runs one call at a time."""

from __future__ import annotations

import gc
import os
import traceback
from contextlib import closing, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, TypeVar

from render.errors import PullfocusError, SettingsError
from render.steps import Step, StepRecorder, recorder, step
from service.workers.calls import StreamCall, resolve
from service.workers.messages import Answer, Assignment, Begun, Order, pack, receive_trusted, sendable_error
from service.workers.output import Redirection, write_line
from service.workers.own_cache import begin_cache
from service.workers.sandbox import Sandbox, allow_cpu, enter
from service.workers.streaming import Signals, StaleCheck

State = TypeVar("State")


def serve(pipe: Connection, signals_fd: int, output_fd: int) -> None:
    """Run calls until the service is gone. Runs in the worker.

    Args:
        pipe: the first message on it is an `Assignment`, all others are `Order`s.
        signals_fd: memory of `Signals`.
        output_fd: memory of its output.
    """
    signals = Signals(signals_fd)
    os.close(signals_fd)
    redirection = Redirection(output_fd)
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):  # the service is gone
        state = _begin(receive_trusted(pipe))
        while True:
            order: Order[Any] = receive_trusted(pipe)
            redirection.set(order.records_output)
            pipe.send_bytes(pack(Begun()))
            allow_cpu(order.cpu_s)
            pipe.send_bytes(_answer(order, state, pipe, signals))


def _begin(assignment: Assignment[State]) -> State:
    """Give up what the worker may not do, and create its state."""
    gc.freeze()  # what was imported is not garbage: it stays shared with the template
    role, place, cache, base = assignment.role, assignment.place, assignment.cache, assignment.base
    with suppress(OSError):  # Linux only: when memory runs out, the kernel ends a worker rather than the service
        Path("/proc/self/oom_score_adj").write_text("500")
    os.nice(role.niceness)
    if assignment.gpu is not None:
        os.environ["PULLFOCUS_GPU"] = str(assignment.gpu)
    make_state = resolve(role.state)
    read = place.read if base is None else (*place.read, base)
    write = place.write if cache is None else (*place.write, cache)
    enter(Sandbox(read=read, write=write, limits=role.limits, graphics=role.draws))
    if cache is not None:
        begin_cache(cache, base)
    state: State = make_state()
    return state


def _answer(order: Order[State], state: State, pipe: Connection, signals: Signals) -> bytes:
    """Run a call and pickle its reply. A reply that cannot be pickled is a fault of the program, not the end of the worker."""
    steps = StepRecorder(_write_step) if order.records_output else StepRecorder()
    asked = recorder.set(steps if order.records_steps or order.records_output else None)
    try:
        with step(order.call.function.rpartition(":")[2]):
            value = _run(order, state, pipe, signals)
        return pack(Answer(value=value, steps=tuple(steps.steps)))
    except (EOFError, BrokenPipeError, ConnectionResetError):  # the service is gone
        raise
    except PullfocusError as error:
        return pack(Answer(error=sendable_error(error), steps=tuple(steps.steps)))
    except MemoryError:
        return pack(Answer(error=SettingsError("this takes more memory than a worker has", code="out_of_memory")))
    except Exception:
        return pack(Answer(fault=traceback.format_exc()))
    finally:
        recorder.reset(asked)


def _write_step(step: Step) -> None:
    name, begun_ns, ended_ns, _ = step
    write_line(f"{name}: {(ended_ns - begun_ns) / 1e9:.3f} s", ended_ns / 1e9)


def _run(order: Order[State], state: State, pipe: Connection, signals: Signals) -> object:
    """Run a call and return its reply, which for a stream is whether it came to its end."""
    if isinstance(order.call, StreamCall):
        return _stream(order, order.call, state, pipe, signals)
    return order.call.run(state)


def _stream(
    order: Order[State], call: StreamCall[State, Any], state: State, pipe: Connection, signals: Signals
) -> bool:
    """Send the items of a stream. Returns whether the stream came to its end."""
    is_stale = StaleCheck(signals, order.serial, has_yielded=order.has_yielded, grace_s=order.grace_s)
    items: Any = call.run(state, is_stale)
    with closing(items):
        for item in items:
            pipe.send_bytes(pack(Answer(value=item, is_last=False)))
            is_stale.has_yielded = True
    return not is_stale.has_ended
