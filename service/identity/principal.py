"""Who sends a request, and what they may do."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime
from typing import Literal, get_args

ScopeName = Literal["read", "edit", "render", "admin"]
SCOPES: frozenset[str] = frozenset(get_args(ScopeName))
DEFAULT_PROJECT = "default"
"""Project of the shots that were stored without one."""
ALL_PROJECTS = "*"
PROJECT_PATTERN = r"^[a-z0-9][a-z0-9_-]{0,63}$"


@dataclass(frozen=True)
class Principal:
    """Sender of a request.

    Attributes:
        id: stable and unique, for audit lines, limits and turns: ``key:ID``, ``oidc:SUBJECT``, ``anyone``.
        label: name for people.
        scopes: what it may do, of `SCOPES`.
        project: whose shots it sees; `ALL_PROJECTS` for every project.
        ends_at: time from which its credentials hold no more; None for never.
    """

    id: str
    label: str
    scopes: frozenset[str]
    project: str
    ends_at: datetime | None = None

    def until(self, end: datetime) -> Principal:
        """Return the same sender, whose credentials hold until ``end`` at the latest."""
        return replace(self, ends_at=end if self.ends_at is None else min(self.ends_at, end))

    def sees(self, project: str) -> bool:
        """Return whether it may know of the shots of a project."""
        return self.project in (ALL_PROJECTS, project)


ANYONE = Principal("anyone", "anyone", SCOPES, ALL_PROJECTS)
"""Sender of every request to a service without identities."""
NOBODY = Principal("nobody", "nobody", frozenset(), "")
"""Sender of a request without valid credentials."""
