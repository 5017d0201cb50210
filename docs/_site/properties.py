"""Properties of USD's schemas that are honoured, that have no effect, and that are not honoured, from the renderer's rules."""

from __future__ import annotations

from collections.abc import Mapping

from docs._site.markdown import plain, table
from render.stage.honoured.rules import EVERYTHING, IGNORED_SCHEMAS, NAMED_SCHEMAS, NEUTRAL_PLUGINS, RULES, Rules

INTRODUCTION = """# Properties

`pullfocus inspect` names each property that is authored and not honoured, by what USD's schema registry says of each prim. A
property counts where it has another value than its schema's, time samples, connections or targets. One that stands in no table
below is not honoured, and neither is a schema without rules. Properties that no schema declares are left alone.

"""


def page() -> str:
    """Rules by schema, and schemas that are honoured nowhere or have no effect."""
    rules = table(
        ("schema", "honoured", "without effect", "not honoured"),
        ((f"`{schema}`", _honoured(rule), _reasons(rule.neutral), _ignored(rule)) for schema, rule in RULES.items()),
    )
    schemas = table(("schema", "drawn instead"), ((f"`{name}`", plain(text)) for name, text in IGNORED_SCHEMAS.items()))
    families = table(("plugin", "reason"), ((f"`{name}`", plain(text)) for name, text in NEUTRAL_PLUGINS.items()))
    named = ", ".join(f"`{name}`" for name in NAMED_SCHEMAS)
    return (
        f"{INTRODUCTION}{rules}\n## Schemas without rules\n\n{schemas}\n"
        f"Prims of other types that are {named}, or derive from one of these, are named by a finding of their own.\n\n"
        f"## Schemas without effect\n\n{families}"
    )


def _honoured(rule: Rules) -> str:
    return "all others" if rule.honoured == EVERYTHING else _names(rule.honoured)


def _ignored(rule: Rules) -> str:
    named = dict.fromkeys(rule.named, "")
    return _reasons({**rule.ignored, **named})


def _reasons(texts: Mapping[str, str]) -> str:
    return "; ".join(f"{_names(names)}{': ' if text else ''}{plain(text)}" for names, text in texts.items())


def _names(names: str) -> str:
    return ", ".join(f"`{name}`" for name in names.split())
