"""The argument parser of every `pullfocus` command."""

from __future__ import annotations

import argparse
import re
from typing import Any, NoReturn

from render.errors import one_line

WRONG_ARGUMENTS = 2
"""Exit status where the arguments are wrong."""


class Parser(argparse.ArgumentParser):
    """Parser with one-line errors that takes negative numbers as values: ``--cdl -1,1,1`` and ``--shutter -1/50``."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._negative_number_matcher = re.compile(r"-(\d|\.\d|inf$|nan$)")  # argparse itself knows plain numbers only

    def error(self, message: str) -> NoReturn:
        if message.endswith("expected one argument"):
            message += "; a value that begins with - is written after a =, such as --look=-NAME"
        self.exit(WRONG_ARGUMENTS, f"{self.prog}: {one_line(message)} ({self.prog} --help says more)\n")
