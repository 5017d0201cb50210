"""Comparison of JSON schemas: changes after which a request is refused that was taken, or an answer is none that was promised.

Each value of a request's schema before has to be one of its schema now; each value of an answer's schema now has to be one of its
schema before. Both are one relation with the sides changed: each value of an *inner* schema has to fit the *outer* one. Where
that cannot be told, it counts as a break.

Three things differ from that relation, as the guide promises: clients ignore properties of answers that they do not know; they
take words of a choice that they do not know; and no property is removed, even one that could be missing.
"""

from __future__ import annotations

import enum
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from service.http.contract.kinds import (
    COMPOSED,
    CONTRADICTIONS,
    Json,
    Kind,
    Schema,
    has_other_tag,
    has_type,
    kinds_of,
    values_of,
)

UNKNOWN = "`{}` has changed, of which a check cannot tell whether it breaks clients"
"""Change that is not judged."""
_RANGES = {"minimum": 1, "maximum": -1}
_LENGTHS = {"minLength": 1, "maxLength": -1, "minItems": 1, "maxItems": -1, "minProperties": 1, "maxProperties": -1}
"""Keywords of limits: 1 for lower ones, -1 for upper ones."""
_EXCLUSIVE = {"minimum": "exclusiveMinimum", "maximum": "exclusiveMaximum"}
_FORMS = ("pattern", "format", "multipleOf", "contentMediaType", "contentEncoding", "uniqueItems")
"""Keywords that narrow a schema, and of which it is not told whether one value is narrower than another."""
_OF_OBJECTS = ("properties", "required", "additionalProperties", "propertyNames")
_OF_ARRAYS = ("items", "prefixItems")
_COMPARED = {*_RANGES, *_EXCLUSIVE.values(), *_LENGTHS, *_FORMS, *_OF_OBJECTS, *_OF_ARRAYS}
_COMPARED |= {*COMPOSED, "type", "enum", "const", "default", "discriminator"} - {CONTRADICTIONS}


class Side(enum.Enum):
    """The sender of a value."""

    REQUEST = "in requests"
    ANSWER = "in answers"


@dataclass(frozen=True, order=True)
class Finding:
    """A change that breaks the promise.

    Attributes:
        place: what has changed, such as ``Render.state, in answers``.
        change: the change of it.
    """

    place: str
    change: str

    def __str__(self) -> str:
        return f"{self.place}: {self.change}"


class SchemaComparison:
    """Compares schemas of two documents, of one side.

    Args:
        before: components of the document that was promised, by name.
        now: components of the present document.
        side: the sender of the values.
    """

    def __init__(self, before: Mapping[str, Schema], now: Mapping[str, Schema], side: Side) -> None:
        self._before = before
        self._now = now
        self._side = side
        self._is_request = side is Side.REQUEST
        self._known: dict[tuple[int, int], list[Finding]] = {}

    def compare(self, before: Schema, now: Schema, place: str) -> list[Finding]:
        """Return the changes that break the promise.

        Args:
            before: a schema of the document that was promised.
            now: the one in its place.
            place: of the schema; findings within a component have the component's name in its place.
        """
        if not (before and now) or isinstance(before, bool) or isinstance(now, bool):
            return self._compare(before, now, place)
        key = id(before), id(now)  # the documents are finite, though schemas may refer to themselves
        if key not in self._known:
            self._known[key] = []
            defaults = self._defaults(before, now, place) if self._is_request else ()
            self._known[key] = list(dict.fromkeys([*defaults, *self._compare(before, now, place)]))
        return self._known[key]

    def _compare(self, before: Schema, now: Schema, place: str) -> list[Finding]:
        inner, outer = self._ordered(kinds_of(before, self._before), kinds_of(now, self._now))
        return [finding for kind in inner for finding in self._fit(kind, outer, place)]

    def _ordered(self, before: Any, now: Any) -> tuple[Any, Any]:
        """Return the inner and the outer one of two things; called with those, it returns them as before and now."""
        return (before, now) if self._is_request else (now, before)

    def _fit(self, kind: Kind, outer: Sequence[Kind], place: str) -> list[Finding]:
        """Return why a kind fits none of some: what is wrong with the most similar one."""
        if any(not other.schema for other in outer):
            return []
        similar = [other for other in outer if has_type(kind, other) and not has_other_tag(kind, other)]
        tries = [list(self._compare_kinds(*self._ordered(kind, other), place)) for other in similar]
        return min(tries, key=len, default=[self._misfit(place, kind.name)])

    def _compare_kinds(self, before: Kind, now: Kind, place: str) -> Iterator[Finding]:
        place = before.component or place
        yield from self._limits(before.schema, now.schema, place)
        yield from self._choices(before.schema, now.schema, place)
        if "object" in (before.type, now.type):
            yield from self._properties(before.schema, now.schema, place)
            yield from self._further_properties(before.schema, now.schema, place)
        if "array" in (before.type, now.type):
            yield from self._items(before.schema, now.schema, place)
        for keyword in sorted({*before.schema, *now.schema} - _COMPARED):
            if before.schema.get(keyword) != now.schema.get(keyword):
                yield self._finding(place, UNKNOWN.format(keyword))

    def _defaults(self, before: Json, now: Json, place: str) -> Iterator[Finding]:
        """Compare what a client means that leaves a value out."""
        if "default" in before and ("default" not in now or before["default"] != now["default"]):
            yield self._changed(before, now, "default", place)

    def _limits(self, before: Json, now: Json, place: str) -> Iterator[Finding]:
        inner, outer = self._ordered(before, now)
        for keyword, sign in (_RANGES | _LENGTHS).items():
            wanted, given = _bound(outer, keyword, sign), _bound(inner, keyword, sign)
            if wanted is not None and (given is None or given < wanted):
                was, now_is = _show_bound(before, keyword), _show_bound(now, keyword)
                yield self._finding(place, f"`{keyword}` was {was}, is {now_is}")
        for keyword in _FORMS:
            if outer.get(keyword, False) is not False and inner.get(keyword) != outer[keyword]:
                yield self._changed(before, now, keyword, place)

    def _choices(self, before: Json, now: Json, place: str) -> Iterator[Finding]:
        inner, outer = (values_of(schema) for schema in self._ordered(before, now))
        if outer is None:
            return
        if inner is None:
            words = ", ".join(outer)
            yield self._finding(place, f"takes only {words} now" if self._is_request else f"may be none of {words} now")
            return
        for value in inner:
            is_word_of_answer = not self._is_request and value.startswith('"')
            if value not in outer and not is_word_of_answer:
                yield self._misfit(place, value)

    def _properties(self, before: Json, now: Json, place: str) -> Iterator[Finding]:
        old, new = before.get("properties", {}), now.get("properties", {})
        for name, schema in old.items():
            if name in new:
                yield from self.compare(schema, new[name], f"{place}.{name}")
            else:
                yield self._finding(f"{place}.{name}", "is removed")
        required, required_now = before.get("required", ()), now.get("required", ())
        if self._is_request:
            for name in sorted({*required_now} - {*required}):
                yield self._finding(f"{place}.{name}", "is required now")
        else:
            for name in sorted({*required} - {*required_now}):
                if name in new or name not in old:
                    yield self._finding(f"{place}.{name}", "may be missing now")

    def _further_properties(self, before: Json, now: Json, place: str) -> Iterator[Finding]:
        """Compare the properties that have no schema of their own."""
        old, new = before.get("additionalProperties", True), now.get("additionalProperties", True)
        is_open_answer = not self._is_request and isinstance(old, bool)
        if self._is_request and old is not False and new is False:
            yield self._finding(place, "takes no further properties any longer")
        elif old is not False and new is not False and not is_open_answer:
            yield from self.compare(old, new, f"{place}.*")
        names, new_names = before.get("propertyNames", True), now.get("propertyNames", True)
        yield from self.compare(names, new_names, f"names in {place}")

    def _items(self, before: Json, now: Json, place: str) -> Iterator[Finding]:
        count = max(len(schema.get("prefixItems", ())) for schema in (before, now))
        most = self._ordered(before, now)[0].get("maxItems", count + 1)
        for index in range(min(count, most)):
            yield from self.compare(_item(before, index), _item(now, index), f"{place}[{index}]")
        if most > count:
            yield from self.compare(before.get("items", True), now.get("items", True), f"{place}[]")

    def _changed(self, before: Json, now: Json, keyword: str, place: str) -> Finding:
        return self._finding(place, f"`{keyword}` was {_show(before, keyword)}, is {_show(now, keyword)}")

    def _misfit(self, place: str, value: str) -> Finding:
        change = f"{value} is not taken any longer" if self._is_request else f"may be {value} now"
        return self._finding(place, change)

    def _finding(self, place: str, change: str) -> Finding:
        return Finding(f"{place}, {self._side.value}", change)


def _bound(schema: Json, keyword: str, sign: int) -> tuple[float, bool] | None:
    """Return a limit that is the stricter the greater it is, and whether it is exclusive."""
    words = ((keyword, False), (_EXCLUSIVE.get(keyword, keyword), True))
    return max(((sign * schema[word], is_exclusive) for word, is_exclusive in words if word in schema), default=None)


def _show_bound(schema: Json, keyword: str) -> str:
    exclusive = _EXCLUSIVE.get(keyword, "")
    return f"{schema[exclusive]} (exclusive)" if exclusive in schema else _show(schema, keyword)


def _show(schema: Json, keyword: str) -> str:
    return json.dumps(schema[keyword], ensure_ascii=False) if keyword in schema else "none"


def _item(schema: Json, index: int) -> Schema:
    prefix = schema.get("prefixItems", ())
    item: Schema = prefix[index] if index < len(prefix) else schema.get("items", True)
    return item
