"""Findings: requests of a stage that are not honoured, and parts of it that cannot be used."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from render.errors import one_line


@dataclass(frozen=True)
class Finding:
    """Finding about a stage, for the user.

    Attributes:
        code: a short stable word for programs, such as ``unsupported_light``.
        path: the prim (or file) that it is about.
        message: one sentence.
        count: prims that it stands for; the path is the first one's.
    """

    code: str
    path: str
    message: str
    count: int = 1

    def __post_init__(self) -> None:
        """The message is one line, whatever the names in it."""
        object.__setattr__(self, "message", one_line(self.message))


def condense(findings: Iterable[Finding], most: int) -> list[Finding]:
    """Shorten a list of findings: of each code the first ones stay, and one finding stands for all others of it.

    Args:
        findings: any number.
        most: how many of one code stay; one more does, too.
    """
    by_code: dict[str, list[Finding]] = {}
    for finding in findings:
        by_code.setdefault(finding.code, []).append(finding)
    return [finding for alike in by_code.values() for finding in _condense_alike(alike, most)]


def _condense_alike(findings: list[Finding], most: int) -> list[Finding]:
    rest = findings[most:]
    if len(rest) < 2:
        return findings
    message = f"{len(rest):,} more findings like these: {rest[0].message}"
    return [*findings[:most], Finding(rest[0].code, rest[0].path, message, sum(finding.count for finding in rest))]


class FindingLog:
    """Collects findings, each once for its code and path."""

    def __init__(self) -> None:
        self._findings: dict[tuple[str, str], Finding] = {}

    def add(self, code: str, path: object, message: str) -> None:
        """Add a finding, unless the same one exists."""
        key = (code, str(path))
        self._findings.setdefault(key, Finding(code, str(path), message))

    def as_list(self) -> list[Finding]:
        """All findings, in the order they were made."""
        return list(self._findings.values())
