"""Objects of the device, held for as long as they are needed: no error leaves any behind while their context lives on."""

from __future__ import annotations

from contextlib import ExitStack
from types import TracebackType
from typing import Protocol, TypeVar


class Releasable(Protocol):
    """A texture or a buffer of moderngl."""

    def release(self) -> object:
        """Give its memory back."""
        ...


Made = TypeVar("Made", bound=Releasable)


class Held(ExitStack):
    """Gives back what was made within it, however it ends. What has no ``release`` is given back by a `callback`."""

    def keep(self, made: Made) -> Made:
        """Take note of an object that was just made, and hand it on."""
        self.callback(made.release)
        return made


class Making(Held):
    """Gives back what was made within it, where the rest could not be made; else it is the caller's."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        if kind is None:
            self.pop_all()
        return bool(super().__exit__(kind, error, trace))
