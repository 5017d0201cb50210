"""Dataclasses with late methods behave like those of Python, and compile only what is used."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import sys
from collections.abc import Callable, Iterator
from types import FunctionType, ModuleType
from typing import Any

import pytest

from render.cli.late_dataclasses import compile_methods_late

pytestmark = pytest.mark.skipif(not hasattr(dataclasses, "_create_fn"), reason="this Python compiles a class at once")

SOURCE = '''
from __future__ import annotations
from dataclasses import KW_ONLY, InitVar, dataclass, field

@dataclass(frozen=True)
class Point:
    """A point."""
    x: float
    y: float = 2.0
    tags: list[str] = field(default_factory=list, compare=False)

@dataclass(frozen=True)
class Named(Point):
    name: str = "a"

@dataclass(order=True, slots=True)
class Slotted:
    a: int
    _: KW_ONLY
    b: int = 3

@dataclass(eq=False)
class Checked:
    n: int
    scale: InitVar[int] = 1
    def __post_init__(self, scale: int) -> None:
        if self.n < 0:
            raise ValueError("n")
        self.n *= scale

class Plain(Point):
    def __init__(self) -> None:
        super().__init__(5.0)
'''

COMPARED: dict[str, Callable[[Any], object]] = {
    "init": lambda m: (
        m.Point(1.0).y,
        m.Named(1.0, name="b").name,
        m.Slotted(1, b=2).b,
        m.Checked(2, 5).n,
        m.Plain().x,
    ),
    "repr": lambda m: (repr(m.Point(1.0)), repr(m.Named(1.0)), repr(m.Point(1.0)), repr(m.Slotted(1))),
    "equality": lambda m: (
        m.Point(1.0) == m.Point(1.0, tags=["a"]),
        m.Point(1.0) == m.Named(1.0),
        m.Checked(1) == m.Checked(1),
    ),
    "order": lambda m: (m.Slotted(1) < m.Slotted(2), sorted([m.Slotted(2), m.Slotted(1)])[0].a),
    "hash": lambda m: (hash(m.Point(1.0)) == hash(m.Point(1.0)), len({m.Named(1.0), m.Named(1.0)})),
    "unhashable": lambda m: hash(m.Slotted(1)),
    "assignment": lambda m: setattr(m.Point(1.0), "x", 2.0),
    "assignment to a heir": lambda m: setattr(m.Named(1.0), "name", "c"),
    "deletion": lambda m: delattr(m.Point(1.0), "x"),
    "missing value": lambda m: m.Point(),
    "too many values": lambda m: m.Slotted(1, 2),
    "unknown name": lambda m: m.Point(1.0, z=2.0),
    "check": lambda m: m.Checked(-1),
    "replacement": lambda m: dataclasses.astuple(dataclasses.replace(m.Named(1.0), y=7.0)),
    "copies": lambda m: dataclasses.asdict(pickle.loads(pickle.dumps(copy.deepcopy(m.Named(1.0, tags=["a"]))))),
    "signatures": lambda m: [str(inspect.signature(kind)) for kind in (m.Point, m.Named, m.Slotted, m.Checked)],
    "names": lambda m: [(f.__qualname__, f.__name__) for f in (m.Point.__init__, m.Point.__repr__, m.Named.__eq__)],
}


def run_module(name: str) -> ModuleType:
    """Run the source as a module of a name."""
    module = ModuleType(name)
    sys.modules[name] = module
    exec(SOURCE, vars(module))
    return module


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The classes as Python makes them."""
    yield run_module("plain_dataclasses")
    del sys.modules["plain_dataclasses"]


@pytest.fixture
def late(plain: ModuleType, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The classes with late methods."""
    monkeypatch.setattr(dataclasses, "_create_fn", dataclasses._create_fn)  # type: ignore[attr-defined]
    compile_methods_late()
    yield run_module("late_dataclasses")
    del sys.modules["late_dataclasses"]


def outcome(run: Callable[[Any], object], module: ModuleType) -> object:
    """Result of a function, or the error that it raises."""
    try:
        return run(module)
    except Exception as error:
        return type(error), str(error)


@pytest.mark.parametrize("what", COMPARED)
def test_late_methods_do_what_those_of_python_do(plain: ModuleType, late: ModuleType, what: str) -> None:
    for _ in range(2):  # as it is compiled, and once it is
        assert outcome(COMPARED[what], late) == outcome(COMPARED[what], plain)


def test_only_what_is_used_is_compiled(late: ModuleType) -> None:
    late.Named(1.0)
    compiled = {name for name, value in vars(late.Named).items() if isinstance(value, FunctionType)}
    assert compiled == {"__init__", "__repr__"}  # dataclasses wraps __repr__ in a function
    assert not any(isinstance(vars(late.Point)[name], FunctionType) for name in ("__init__", "__eq__", "__hash__"))
