"""Lifetime of GPU objects: textures and buffers are released when their scope ends, also by an exception."""

from __future__ import annotations

from contextlib import ExitStack
from types import TracebackType
from typing import Protocol, TypeVar


class Releasable(Protocol):
    """A texture or a buffer of moderngl."""

    def release(self) -> object:
        """Free its GPU memory."""
        ...


Resource = TypeVar("Resource", bound=Releasable)


class Resources(ExitStack):
    """Scope that releases every object registered in it. Register an object without ``release`` through `callback`."""

    def keep(self, resource: Resource) -> Resource:
        """Register an object for release, and return it."""
        self.callback(resource.release)
        return resource


class Construction(Resources):
    """Scope that releases its objects only where an exception leaves it; otherwise the caller owns them."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        if kind is None:
            self.pop_all()
        return bool(super().__exit__(kind, error, trace))
