"""A bench as the command line knows it."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Bench:
    """A bench.

    Attributes:
        name: typed after ``pullfocus bench``.
        purpose: what it measures, for people.
        add_arguments: declares its arguments.
        module: has the function ``run``, which takes the parsed arguments. It is imported late: it may need OpenGL.
    """

    name: str
    purpose: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    module: str
