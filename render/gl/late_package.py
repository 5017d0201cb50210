"""Packages whose own code runs late, so that one of their submodules can be imported without all the others."""

from __future__ import annotations

import sys
import threading
from importlib.util import find_spec, module_from_spec
from types import ModuleType
from typing import Any

_lock = threading.RLock()


class _LatePackage(ModuleType):
    """Package or module whose code runs when a name of it is first used. Its submodules are imported as from any package."""

    def __getattr__(self, name: str) -> Any:
        missing = AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        if name.startswith("__") or self.__spec__ is None or self.__spec__.loader is None:
            raise missing
        with _lock:  # other threads wait until the code has run
            if type(self) is _RunningPackage:
                raise missing
            if type(self) is _LatePackage:
                self.__class__ = _RunningPackage
                self.__spec__.loader.exec_module(self)
                self.__class__ = ModuleType  # type: ignore[assignment]  # from now on it looks its names up by itself
        return getattr(self, name)


class _RunningPackage(_LatePackage):
    """Late package whose code runs."""


def import_late(name: str) -> None:
    """Make a package importable whose code runs when one of its names is first used. A loaded one stays as it is.

    Args:
        name: of the package or module; what holds it is imported.

    Raises:
        ImportError: it is not installed.
    """
    if name in sys.modules:
        return
    spec = find_spec(name)
    if spec is None:
        raise ImportError(f"No module named {name!r}", name=name)
    module = module_from_spec(spec)
    module.__class__ = _LatePackage
    sys.modules[name] = module
    holder, _, short = name.rpartition(".")
    if holder:
        setattr(sys.modules[holder], short, module)
