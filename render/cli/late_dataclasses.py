"""Dataclasses whose methods are compiled when they are first used.

The `dataclasses` module writes the source of ``__init__``, ``__repr__``, ``__eq__`` and three more methods of each class, and
compiles it as the class is made. `pullfocus record` loads 230 dataclasses. Their 1,200 methods take up to a third of a second to
compile; it uses 140 of them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial
from types import FunctionType
from typing import Any

_COMPILE = "_create_fn"
"""Function of Python 3.11 and 3.12 that compiles one method. Later versions compile all methods of a class together."""

Compile = Callable[[], FunctionType]


def compile_methods_late() -> None:
    """Compile the methods of dataclasses that are made from now on when they are first used.

    Does nothing where `dataclasses` has no function that compiles one method.
    """
    compile_method = getattr(dataclasses, _COMPILE, None)
    if isinstance(compile_method, FunctionType):

        def make_late(name: str, *source: Any, **scope: Any) -> _LateMethod:
            return _LateMethod(name, partial(compile_method, name, *source, **scope))

        setattr(dataclasses, _COMPILE, partial(make_late))  # no function: it is replaced once


class _LateMethod:
    """Method that is compiled when it is first looked up or called, and takes its own place in the class then."""

    __slots__ = ("__name__", "_compile", "_method")

    def __init__(self, name: str, compile_method: Compile) -> None:
        self.__name__, self._compile = name, compile_method
        self._method: FunctionType | None = None

    def __get__(self, instance: object, owner: type) -> Any:
        method = self._compiled()
        for kind in owner.__mro__:
            if vars(kind).get(self.__name__) is self:
                method.__qualname__ = f"{kind.__qualname__}.{self.__name__}"
                setattr(kind, self.__name__, method)
        return method.__get__(instance, owner)

    def __call__(self, *values: Any) -> Any:
        """Call the method: `dataclasses` wraps ``__repr__`` in a function that calls it."""
        return self._compiled()(*values)

    def _compiled(self) -> FunctionType:
        if self._method is None:
            self._method = self._compile()
        return self._method
