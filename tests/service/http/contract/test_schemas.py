"""Schemas that change: what was sent is taken further on, and what is answered is what was promised."""

from __future__ import annotations

import copy
import json

import pytest

from service.http.contract.schemas import SchemaComparison, Side

TEXT, NUMBER, WHOLE, NULL = ({"type": name} for name in ("string", "number", "integer", "null"))
LIST = {"type": "array", "items": WHOLE}


def thing(*required, **properties):
    """An object that takes no further properties."""
    return {"type": "object", "properties": properties, "required": [*required], "additionalProperties": False}


def findings(side, before, now, components=None, components_now=None):
    """Findings as text, without the side."""
    comparison = SchemaComparison(components or {}, components_now or components or {}, side)
    found = comparison.compare(copy.deepcopy(before), copy.deepcopy(now), "it")
    return [str(one).replace(f", {side.value}", "") for one in found]


def requested(*schemas, **components):
    return findings(Side.REQUEST, *schemas, **components)


def answered(*schemas, **components):
    return findings(Side.ANSWER, *schemas, **components)


NARROWED = [
    (NUMBER, WHOLE, "number is not taken any longer"),
    ({}, TEXT, "anything is not taken any longer"),
    ({"anyOf": [TEXT, NULL]}, TEXT, "null is not taken any longer"),
    ({"type": ["string", "null"]}, TEXT, "null is not taken any longer"),
    ({"oneOf": [WHOLE, TEXT]}, {"oneOf": [WHOLE]}, "string is not taken any longer"),
    (WHOLE, WHOLE | {"minimum": 1}, "`minimum` was none, is 1"),
    (WHOLE | {"minimum": 0}, WHOLE | {"minimum": 1}, "`minimum` was 0, is 1"),
    (NUMBER | {"minimum": 0}, NUMBER | {"exclusiveMinimum": 0}, "`minimum` was 0, is 0 (exclusive)"),
    (NUMBER | {"exclusiveMaximum": 9}, NUMBER | {"maximum": 8}, "`maximum` was 9 (exclusive), is 8"),
    (TEXT | {"maxLength": 80}, TEXT | {"maxLength": 40}, "`maxLength` was 80, is 40"),
    (TEXT, TEXT | {"minLength": 1}, "`minLength` was none, is 1"),
    (LIST, LIST | {"maxItems": 5}, "`maxItems` was none, is 5"),
    (LIST, LIST | {"uniqueItems": True}, "`uniqueItems` was none, is true"),
    (TEXT, TEXT | {"pattern": "^a"}, '`pattern` was none, is "^a"'),
    (TEXT, TEXT | {"format": "date-time"}, '`format` was none, is "date-time"'),
    (TEXT, TEXT | {"enum": ["a", "b"]}, 'takes only "a", "b" now'),
    (thing(a=thing(b=WHOLE)), thing(a=thing(b=WHOLE | {"maximum": 3})), ".a.b: `maximum` was none, is 3"),
    (LIST, {"type": "array", "items": WHOLE | {"maximum": 3}}, "[]: `maximum` was none, is 3"),
    (
        {"type": "object", "additionalProperties": NUMBER},
        {"type": "object", "additionalProperties": WHOLE},
        ".*: number is not taken any longer",
    ),
    (
        {"type": "array", "prefixItems": [TEXT, NUMBER], "maxItems": 2},
        {"type": "array", "prefixItems": [TEXT, WHOLE], "maxItems": 2},
        "[1]: number is not taken any longer",
    ),
    (thing(a=TEXT), {"allOf": [thing(a=TEXT | {"maxLength": 1}), {"required": []}]}, ".a: `maxLength` was none, is 1"),
]
"""Schemas, and the change of the second one that refuses what the first one takes."""


@pytest.mark.parametrize(("wide", "narrow", "change"), NARROWED)
def test_a_request_that_takes_less_is_found(wide, narrow, change):
    assert [one.removeprefix("it").removeprefix(": ") for one in requested(wide, narrow)] == [change]
    assert requested(narrow, wide) == []


@pytest.mark.parametrize(("wide", "narrow", "change"), NARROWED)
def test_an_answer_that_may_be_more_is_found(wide, narrow, change):
    assert len(answered(narrow, wide)) == 1
    assert answered(wide, narrow) == []


@pytest.mark.parametrize(
    ("keyword", "before", "now"), [("pattern", "^a", "^b"), ("format", "date", "time"), ("not", {"const": "a"}, {})]
)
def test_where_it_cannot_be_told_it_is_a_break(keyword, before, now):
    for compare in (requested, answered):
        (change,) = compare(TEXT | {keyword: before}, TEXT | {keyword: now})
        assert f"`{keyword}`" in change


@pytest.mark.parametrize("schema", [schema for case in NARROWED for schema in case[:2]], ids=json.dumps)
def test_a_schema_keeps_its_own_promise(schema):
    assert requested(schema, schema) == answered(schema, schema) == []


def test_another_type_is_found():
    assert requested(TEXT, WHOLE) == ["it: string is not taken any longer"]
    assert answered(TEXT, WHOLE) == ["it: may be integer now"]


def test_parts_that_contradict_each_other_are_not_judged():
    two = {"allOf": [TEXT | {"maxLength": 9}, {"maxLength": 5}]}
    assert requested(two, two) == []
    (change,) = requested(two, {"allOf": [TEXT | {"maxLength": 9}, {"maxLength": 4}]})
    assert "cannot tell" in change


def test_words_of_a_choice():
    few, many = TEXT | {"enum": ["a", "b"]}, TEXT | {"enum": ["a", "b", "c"]}
    assert requested(many, few) == ['it: "c" is not taken any longer']
    assert requested(few, many) == []
    assert answered(few, many) == [], "clients take words that they do not know"
    assert answered(many, few) == []
    assert answered(few, TEXT) == ['it: may be none of "a", "b" now']
    assert answered(WHOLE | {"enum": [1]}, WHOLE | {"enum": [1, 2]}) == ["it: may be 2 now"]
    assert requested({"const": "a"}, {"const": "b"}) == ['it: "a" is not taken any longer']


def test_properties_of_requests():
    assert requested(thing(), thing("a", a=TEXT)) == ["it.a: is required now"]
    assert requested(thing(a=TEXT), thing("a", a=TEXT)) == ["it.a: is required now"]
    assert requested(thing("a", a=TEXT), thing(a=TEXT)) == []
    assert requested(thing(), thing(a=TEXT)) == []
    opened = thing() | {"additionalProperties": True}
    assert requested(opened, thing()) == ["it: takes no further properties any longer"]
    assert requested(thing(), opened) == []


def test_properties_of_answers():
    assert answered(thing("a", a=TEXT), thing(a=TEXT)) == ["it.a: may be missing now"]
    assert answered(thing("a", a=TEXT), thing()) == ["it.a: is removed"]
    assert answered(thing(a=TEXT), thing()) == ["it.a: is removed"]
    assert answered(thing(a=TEXT), thing("a", a=TEXT)) == []
    assert answered(thing(), thing("a", a=TEXT)) == [], "clients ignore what they do not know"
    assert answered(thing(a=TEXT), thing(a={"anyOf": [TEXT, NULL]})) == ["it.a: may be null now"]


def test_a_value_that_is_left_out_means_the_same():
    assert requested(WHOLE | {"default": 16}, WHOLE | {"default": 8}) == ["it: `default` was 16, is 8"]
    assert requested(WHOLE | {"default": 16}, WHOLE) == ["it: `default` was 16, is none"]
    assert requested(WHOLE, WHOLE | {"default": 16}) == []
    assert answered(WHOLE | {"default": 16}, WHOLE | {"default": 8}) == []


def test_references_are_followed_and_name_the_place():
    to_shot = {"$ref": "#/components/schemas/Shot"}
    before, now = {"Shot": thing("name", name=TEXT)}, {"Shot": thing("name", name=TEXT | {"maxLength": 9})}
    shots = {"type": "array", "items": {"anyOf": [to_shot, NULL]}}
    components = {"components": before, "components_now": now}
    assert requested(shots, shots, **components) == ["Shot.name: `maxLength` was none, is 9"]
    assert answered(shots, shots, **components) == []
    inline = {"type": "array", "items": {"anyOf": [now["Shot"], NULL]}}
    assert requested(shots, inline, **components) == ["Shot.name: `maxLength` was none, is 9"]


def test_schemas_that_hold_themselves_are_compared():
    to_folder = {"$ref": "#/components/schemas/Folder"}
    folder = thing("name", name=TEXT, within={"type": "array", "items": to_folder}, above={"anyOf": [to_folder, NULL]})
    before, now = {"Folder": folder}, {"Folder": folder | {"required": ["name", "above"]}}
    assert requested(to_folder, to_folder, components=before, components_now=now) == ["Folder.above: is required now"]
    flat = {"Folder": thing("name", name=TEXT, within={"type": "array", "items": folder}, above=to_folder)}
    assert requested(to_folder, to_folder, components=before, components_now=flat) == [
        "Folder.above: null is not taken any longer"
    ]


def test_a_kind_of_a_union_is_told_by_its_tag():
    add = thing("type", "at", type={"const": "add", "type": "string"}, at=WHOLE)
    drop = thing("type", type={"const": "drop", "type": "string"}, name=TEXT)
    components = {"Add": add, "Drop": drop, "Move": thing("type", type={"const": "move", "type": "string"})}
    to_add, to_drop, to_move = ({"$ref": f"#/components/schemas/{name}"} for name in components)
    assert requested({"oneOf": [to_add, to_drop]}, {"oneOf": [to_add, to_move]}, components=components) == [
        "it: Drop is not taken any longer"
    ]
    now = components | {"Add": add | {"required": ["type"]}, "Drop": drop | {"required": ["type", "name"]}}
    both = {"oneOf": [to_add, to_drop]}
    assert requested(both, both, components=components, components_now=now) == ["Drop.name: is required now"]
    assert answered(both, both, components=components, components_now=now) == ["Add.at: may be missing now"]
    assert answered({"oneOf": [to_add]}, both, components=components) == ["it: may be Drop now"]
