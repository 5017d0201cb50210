"""Calls of functions in a worker process, sent by name.

A function that other processes may call is registered where it is defined, with `register` or a decorator that is typed for one
kind of worker (`service.stage.opened.stage_function`, `service.picture.state.picture_function`). The HTTP process never imports
the defining module, which may load USD or GL: at run time it holds a `FunctionReference` in place of the function. A type checker
sees the function itself, so arguments and replies are checked where the call is made.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

from service.workers.streaming import StaleCheck

State = TypeVar("State")
Reply = TypeVar("Reply")
Item = TypeVar("Item")
Arguments = ParamSpec("Arguments")
Registered = TypeVar("Registered", bound=Callable[..., Any])

_registered: dict[str, Callable[..., Any]] = {}


class UnregisteredFunctionError(Exception):
    """No registered function has the name that was sent to a worker."""


def register(function: Registered) -> Registered:
    """Allow a function, or the class of a worker's state, to be called by name in a worker process."""
    _registered[name_of(function)] = function
    return function


def name_of(function: Callable[..., Any]) -> str:
    """Return module and qualified name of a function, or of a reference to one: ``service.stage.shots:describe_shot``."""
    return f"{function.__module__}:{function.__qualname__}"


def resolve(name: str) -> Callable[..., Any]:
    """Import the module of a registered function and return the function.

    Args:
        name: as `name_of` gives it.

    Raises:
        UnregisteredFunctionError: the module registers no such function.
        ImportError: there is no such module.
    """
    import_module(name.partition(":")[0])
    if name not in _registered:
        raise UnregisteredFunctionError(f"{name} is not registered for calls from other processes")
    return _registered[name]


@dataclass(frozen=True)
class Call(Generic[State, Reply]):
    """One call of a registered function, as it is sent to a worker.

    Attributes:
        function: its name, as `name_of` gives it.
        args: positional arguments after the worker's state; they must be picklable, and so must the reply.
        kwargs: keyword arguments.
    """

    function: str
    args: tuple[Any, ...]
    kwargs: dict[str, Any]

    def run(self, state: State) -> Reply:
        """Call the function in the worker process."""
        reply: Reply = resolve(self.function)(state, *self.args, **self.kwargs)
        return reply


@dataclass(frozen=True)
class StreamCall(Generic[State, Item]):
    """One call of a registered generator function; see `Call`."""

    function: str
    args: tuple[Any, ...]
    kwargs: dict[str, Any]

    def run(self, state: State, is_stale: StaleCheck) -> Iterator[Item]:
        """Call the function in the worker process. It ends early once ``is_stale`` returns True."""
        items: Iterator[Item] = resolve(self.function)(state, is_stale, *self.args, **self.kwargs)
        return items


def call(
    function: Callable[Concatenate[State, Arguments], Reply], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Call[State, Reply]:
    """Make a call of a registered function.

    Args:
        function: the function, or a reference to it.
        *args: its arguments after the worker's state.
        **kwargs: its keyword arguments.
    """
    return Call(name_of(function), args, kwargs)


def stream_call(
    function: Callable[Concatenate[State, StaleCheck, Arguments], Iterator[Item]],
    *args: Arguments.args,
    **kwargs: Arguments.kwargs,
) -> StreamCall[State, Item]:
    """Make a call of a registered generator function.

    Args:
        function: the function, or a reference to it.
        *args: its arguments after the worker's state and ``is_stale``.
        **kwargs: its keyword arguments.
    """
    return StreamCall(name_of(function), args, kwargs)


class FunctionReference:
    """Name of a function that this process does not import.

    Args:
        module: where the function is defined.
        name: its name there.
    """

    def __init__(self, module: str, name: str) -> None:
        self.__module__ = module
        self.__qualname__ = name


class RemoteModule:
    """Stand-in for a module that this process does not import; its attributes are references to the functions there.

    Args:
        name: full name of the module.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> FunctionReference:
        """Return a reference to a function of the module."""
        if name.startswith("_"):
            raise AttributeError(name)
        return FunctionReference(self._name, name)
