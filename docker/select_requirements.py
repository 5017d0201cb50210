"""Prints the part of requirements.lock that the program and all of its extras but `dev` need.

usage: python3 docker/select_requirements.py >requirements.txt

The lock file says below each package which others ask for it (``# via``). What the needed ones ask for is needed, too.
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

_NAME = re.compile(r"[A-Za-z0-9._-]+")
_ASKED_FOR_BY = re.compile(r"^    #(?: via|  ) ([A-Za-z0-9._-]+)$", re.MULTILINE)
_NOT_INSTALLED = "dev"


def select(lock: str, project: str) -> str:
    """Select the packages that are needed.

    Args:
        lock: a lock file of uv, with hashes and with the names of those who ask for a package.
        project: the project file, of which the lock file was made.

    Returns:
        The lock file with fewer packages.
    """
    entries = [(_canonical(entry), entry) for entry in re.findall(r"^[^\s#].*\n(?:[ #].*\n)*", lock, re.MULTILINE)]
    needed = _named_by(project)
    while True:
        more = {name for name, entry in entries if needed & set(_ASKED_FOR_BY.findall(entry))} - needed
        if not more:
            return "".join(entry for name, entry in entries if name in needed)
        needed |= more


def _named_by(project: str) -> set[str]:
    """Return the packages that the project itself names."""
    table = tomllib.loads(project)["project"]
    extras = [named for extra, named in table["optional-dependencies"].items() if extra != _NOT_INSTALLED]
    return {_canonical(requirement) for named in (table["dependencies"], *extras) for requirement in named}


def _canonical(requirement: str) -> str:
    """Return the name at the beginning of a requirement, as lock files write it."""
    match = _NAME.match(requirement)
    assert match is not None
    return re.sub(r"[-_.]+", "-", match[0]).lower()


if __name__ == "__main__":
    sys.stdout.write(select(Path("requirements.lock").read_text(), Path("pyproject.toml").read_text()))
