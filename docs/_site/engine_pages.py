"""The engines' manual pages, which are the docstrings of their modules, below a table of what each engine can do."""

from __future__ import annotations

import re
from inspect import getdoc
from sys import modules

from docs._site.markdown import anchor, plain, table
from render.engines import Engine, all_engines
from render.model.frame_settings import FrameSettings

INTRODUCTION = """# Engines

An engine draws the picture of a scene through a camera. `--engine NAME` chooses one, and the
[guide](../guide/engines.md) compares them. Each page below is the docstring of the engine's module.

"""
_SECTION = re.compile(r"^([A-Z][a-z]+):[ \n]", re.MULTILINE)
_SETTING = re.compile(rf"^ {{4}}({'|'.join(FrameSettings.__dataclass_fields__)}) +(.*)$")


def page() -> str:
    """Capabilities of each engine, and its manual page."""
    return INTRODUCTION + _capabilities() + "\n" + "".join(_manual(engine) for engine in all_engines())


def _capabilities() -> str:
    """A row for each switch of `Engine`: what it means, and the engines that have it."""
    described = dict(re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", _attributes_section(), re.MULTILINE))
    rows = []
    for name in (name for name in Engine.__annotations__ if isinstance(getattr(Engine, name, None), bool)):
        able = (f"[{engine.name}](#{anchor(engine.name)})" for engine in all_engines() if getattr(engine, name))
        rows.append((f"`{name}`", plain(" ".join(described[name].split())), ", ".join(able)))
    return table(("attribute", "meaning", "engines"), rows)


def _attributes_section() -> str:
    return (getdoc(Engine) or "").partition("Attributes:\n")[2]


def _manual(engine: type[Engine]) -> str:
    text = modules[engine.__module__].__doc__ or ""
    summary, _, body = text.partition("\n\n")
    title = summary.split(": ", 1)[-1].strip().rstrip(".")
    heading = f"## {engine.name} {{ #{anchor(engine.name)} }}\n\n{title[:1].upper()}{title[1:]}.\n\n"
    return heading + "\n\n".join(_paragraph(part) for part in body.strip().split("\n\n")) + "\n\n"


def _paragraph(text: str) -> str:
    """A paragraph of a manual page: its first word in bold, a table of settings, or an example."""
    if text == "Example::":
        return "**Example**"
    if text.startswith("    "):
        return f"```text\n{re.sub('^    ', '', text, flags=re.MULTILINE)}\n```"
    if text.startswith("Settings:\n"):
        return "**Settings**\n\n" + _settings(text.splitlines()[1:])
    head, text = _SECTION.split(text, 1)[1:] if _SECTION.match(text) else ("", text)
    text = text.replace("``", "`")
    return f"**{head}.** {text[:1].upper()}{text[1:]}" if head else text


def _settings(lines: list[str]) -> str:
    """Rows `name  meaning` as a table; what follows the last row and is none is a sentence below it."""
    rows: list[list[str]] = []
    remarks: list[str] = []
    for line in lines:
        if match := _SETTING.match(line):
            rows.append([f"`{match[1]}`", match[2]])
        elif line.startswith(" " * 8) and rows and not remarks:
            rows[-1][1] += " " + line.strip()
        else:
            remarks.append(line.strip())
    return table(("setting", "meaning"), rows) + ("\n" + " ".join(remarks) if remarks else "")
