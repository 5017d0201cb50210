"""Declaration of a setting: once, as a dataclass field, from which every other place derives.

A declaration holds the name in USD, the default, the limits, the unit, whether it takes keys, the documentation and the display
group; the field's name is the name in Python, with its unit, and in camelCase it is the name in REST and in the page. A field
of this module's `setting` in a class with `schema_group` declares one USD property:

    @schema_group("Film", rest="film")
    @dataclass(frozen=True)
    class FilmData:
        push: float = setting(
            "film:push",
            0.0,
            "Push",
            "Longer (push, positive) or shorter (pull, negative) development.",
            unit="stops",
            hard=(-5, 5),
            soft=(-2, 2),
            slider=Slider(-2, 3, 0.5),
        )

`usd_schemas.generate` writes the schema, its plugin files and the page's table from the declarations. The REST models and the
command line derive from them when they are imported. Nothing here imports pxr, so a process without USD can use it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cache
from math import inf
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

Floats = tuple[float, ...]
Pair = tuple[float, float]
Triple = tuple[float, float, float]
Pairs = tuple[Pair, ...]
Triples = tuple[Triple, ...]
Limits = tuple[float | None, float | None]
Resource = Literal["", "film", "exposure", "focus", "focusPoint", "camera"]

MAX_FINITE = sys.float_info.max
"""The end of a range that excludes infinity alone."""
MAX_NUMBER = 1e9
"""The largest number that REST takes where a declaration has a least value alone."""
MAX_UNLIMITED = 1e6
"""The largest size of a number that REST takes where a declaration has no limits."""

_UNITS = ("s", "k", "e", "m", "mm", "um", "deg", "stops")
"""Units as names end with them."""

Kind = TypeVar("Kind", bound=type)


@dataclass(frozen=True)
class Asset:
    """A file that a property names.

    Attributes:
        path: as it is authored.
        resolved: where the asset resolver finds it; empty where it does not. Not compared, never authored.
    """

    path: str = ""
    resolved: str = field(default="", compare=False)


@dataclass(frozen=True)
class Range:
    """Numbers that a picture can be made with.

    Attributes:
        least: of each of them.
        most: likewise.
        unit: behind the numbers in messages.
        zero: meaning of 0, which is then allowed outside the range too; empty for none.
        above: whether numbers must be above ``least``, which is itself refused then.
    """

    least: float
    most: float
    unit: str = ""
    zero: str = ""
    above: bool = False

    def holds(self, number: float) -> bool:
        """Whether a number is allowed; NaN never is."""
        is_enough = number > self.least if self.above else number >= self.least
        return (is_enough and number <= self.most) or (number == 0 and self.zero != "")

    def __str__(self) -> str:
        span = f"from {self.least:g} to {self.most:g}{self.unit}"
        return f"{span}, or 0 for {self.zero}" if self.zero else span


@dataclass(frozen=True)
class Bounds:
    """Values that REST takes.

    Attributes:
        least: of a number, and of each number of a list.
        most: likewise.
        above: whether numbers must be above ``least``, which is itself refused then.
        length: most characters of a word, most entries of a list.
    """

    least: float = -MAX_UNLIMITED
    most: float = MAX_UNLIMITED
    above: bool = False
    length: int | None = None


@dataclass(frozen=True)
class Slider:
    """A slider of the page.

    Attributes:
        least: at its left end.
        most: at its right end.
        step: of an arrow key; a ratio where the scale is logarithmic.
        scale: equal travel for equal differences; the others are logarithmic: ``stop`` with third stops as engraved on lenses,
            ``iso`` with the values of the ISO dial, ``zoom`` with halves of a millimetre up to 100 mm and whole ones above,
            and ``ring`` ends at infinity.
        zero: word that stands for 0; empty for the number.
        unit: behind the number; a share is shown in ``%``.
        label: beside the slider, where the property's display name is too long.
        panel: of the page that has it; empty for the panel of the setting's resource.
    """

    least: float
    most: float
    step: float
    scale: Literal["linear", "stop", "iso", "zoom", "ring"] = "linear"
    zero: str = ""
    unit: str = ""
    label: str = ""
    panel: str = ""


@dataclass(frozen=True)
class Option:
    """An option of the command line that sets a camera for one run.

    Attributes:
        flag: such as ``--iso``.
        metavar: of its value; it does not matter where there are choices, or of a switch.
        range: numbers that it takes, where they are fewer than the setting's.
        noun: names such a number in messages.
        is_time: whether it also takes fractions, such as 1/50, as times are written.
    """

    flag: str
    metavar: str = "N"
    range: Range | None = None
    noun: str = "a number"
    is_time: bool = False


@dataclass(frozen=True)
class Setting:
    """One setting: what a property of a camera is called, may be and means.

    Attributes:
        usd: name of the USD property, without an instance's prefix.
        default: the value where nothing is authored.
        label: display name.
        help: first sentence of the documentation.
        more: rest of the documentation; a line that begins with ``- `` is an entry of a list.
        unit: in words.
        usd_type: USD's name of the type.
        keyable: whether it may change over time.
        hard: limits that USD tools enforce; None where there is none.
        soft: limits that a slider of a USD tool spans.
        accepts: numbers that a picture can be made with, where `hard` does not say it.
        settable: numbers that can be written to a shot, where `accepts` does not say it.
        bounds: values that REST takes, where they do not follow from `hard`.
        rest: resource of REST that has it; empty for none.
        rest_name: name of its field in REST's models, in snake case, where it is not `name`.
        read_only: whether REST cannot set it.
        slider: of the page; None for none of its own.
        option: of the command line; None for none of its own.
        name: in Python, with the names of the groups that it is in.
        type: of its value in Python.
        group: display group.
        schema: the API schema that brings it; empty for what every USD camera has.
        relationship: whether the property is a relationship, and not an attribute.
        length: USD's unit of a length that has another one in Python: tenths of a scene unit, or scene units.
    """

    usd: str
    default: Any
    label: str
    help: str
    more: str = ""
    unit: str = ""
    usd_type: str = ""
    keyable: bool = True
    hard: Limits = (None, None)
    soft: Limits = (None, None)
    accepts: Range | None = None
    settable: Range | None = None
    bounds: Bounds | None = None
    rest: Resource | None = None
    rest_name: str = ""
    read_only: bool = False
    slider: Slider | None = None
    option: Option | None = None
    name: str = ""
    type: Any = None
    group: str = ""
    schema: str = ""
    relationship: bool = False
    length: Literal["", "tenths", "units"] = ""

    @property
    def doc(self) -> str:
        """The documentation without the unit."""
        joint = "\n" if self.more.startswith("- ") else " "
        return f"{self.help}{joint}{self.more}".rstrip()

    @property
    def rest_doc(self) -> str:
        """The documentation as REST has it: names carry their unit there, save scene units."""
        return f"{self.doc} In scene units." if self.unit == "scene units" else self.doc

    @property
    def choices(self) -> tuple[str, ...]:
        """The words that it may be; none where it is no choice."""
        return get_args(self.type) if get_origin(self.type) is Literal else ()

    @property
    def field_name(self) -> str:
        """Name of its field in REST's models."""
        return self.rest_name or self.name

    @property
    def camel_name(self) -> str:
        """Its name in the page and, unless its field has another, in REST; keys are set by it."""
        first, *others = self.name.split("_")
        return first + "".join(word.capitalize() for word in others)

    @property
    def words(self) -> str:
        """Its name in words, without the unit."""
        words = self.name.split("_")
        while len(words) > 1 and words[-1] in _UNITS:
            words.pop()
        return " ".join(words)

    @property
    def rest_keyable(self) -> bool:
        """Whether REST sets keys of it: of numbers that may change over time, and of the switches of the focus and its points."""
        numbers = (float, bool) if self.rest in ("focus", "focusPoint") else (float,)
        return self.keyable and self.type in numbers

    @property
    def accepted(self) -> Range:
        """The numbers that a picture can be made with."""
        if self.accepts is not None:
            return self.accepts
        least, most = self.hard
        return Range(-inf if least is None else least, inf if most is None else most)

    @property
    def sent(self) -> Bounds:
        """The values that REST takes."""
        if self.bounds is not None:
            return self.bounds
        least, most = self.hard
        if least is None and most is None:
            return Bounds()
        return Bounds(-MAX_NUMBER if least is None else least, MAX_NUMBER if most is None else most)


@dataclass(frozen=True)
class _Class:
    group: str
    rest: Resource


_CLASSES: dict[type, _Class] = {}


def schema_group(group: str, rest: Resource = "") -> Callable[[Kind], Kind]:
    """Give a dataclass of settings its display group, and the resource of REST that has them unless they say otherwise."""

    def decorate(kind: Kind) -> Kind:
        _CLASSES[kind] = _Class(group, rest)
        return kind

    return decorate


def setting(usd: str, default: Any, label: str, help: str, more: str = "", **declared: Any) -> Any:
    """Declare a setting as a dataclass field; the arguments are the attributes of `Setting`."""
    return field(
        default=default, metadata={"usd": usd, "setting": Setting(usd, default, label, help, more, **declared)}
    )


def relationship(usd: str, label: str, help: str, more: str = "", *, default: Any = (), **declared: Any) -> Any:
    """Declare a relationship to other prims as a dataclass field: paths, or with the default ``""`` one path or none."""
    declaration = Setting(usd, default, label, help, more, relationship=True, **declared)
    return field(default=default, metadata={"setting": declaration})


def group(kind: type, prefix: str | None = None) -> Any:
    """Declare a dataclass field that holds further settings in a dataclass of its own.

    Args:
        kind: the dataclass.
        prefix: put before the names of its settings; None for the field's name.
    """
    return field(default_factory=kind, metadata={"group": kind, "prefix": prefix})


@cache
def settings_of(kind: type, schema: str = "") -> tuple[Setting, ...]:
    """The settings that a dataclass declares, those of its groups too, in order.

    Args:
        kind: the dataclass.
        schema: the API schema that brings them; empty for what every USD camera has.
    """
    return tuple(_settings(kind, schema, ""))


def _settings(kind: Any, schema: str, prefix: str) -> list[Setting]:
    shared, hints, found = _CLASSES[kind], get_type_hints(kind), []
    for item in fields(kind):
        if "group" in item.metadata:
            own = item.metadata["prefix"]
            found += _settings(item.metadata["group"], schema, prefix + (f"{item.name}_" if own is None else own))
        elif "setting" in item.metadata:
            declared: Setting = item.metadata["setting"]
            found.append(
                replace(
                    declared,
                    name=prefix + item.name,
                    type=hints[item.name],
                    usd_type=declared.usd_type or _usd_type(hints[item.name]),
                    group=declared.group or shared.group,
                    rest=shared.rest if declared.rest is None else declared.rest,
                    schema=schema,
                )
            )
    return found


_USD_TYPES: dict[Any, str] = {
    bool: "bool",
    int: "int",
    float: "double",
    str: "string",
    Asset: "asset",
    tuple[float, ...]: "double[]",
    tuple[str, ...]: "string[]",
    tuple[int, int]: "int2",
    tuple[float, float]: "double2",
    tuple[float, float, float]: "double3",
    tuple[tuple[float, float], ...]: "double2[]",
    tuple[tuple[float, float, float], ...]: "double3[]",
}


def _usd_type(hint: Any) -> str:
    return "token" if get_origin(hint) is Literal else _USD_TYPES[hint]
