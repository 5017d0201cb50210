"""Records the contract of the API: ``python -m service.http.contract``. Refuses where the present one breaks clients."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from service.http.contract.operations import breaking_changes
from service.http.contract.record import COMMAND, RECORD, contract_of, contract_text, report
from service.http.openapi import openapi_text


def main(arguments: Sequence[str] | None = None, record: Path = RECORD) -> int:
    """Record the present contract; return the exit status.

    Args:
        arguments: of the command line; those of the process when left out.
        record: the file.
    """
    parser = argparse.ArgumentParser(prog=COMMAND, description=__doc__)
    parser.add_argument("--accept", action="store_true", help="record it even though it breaks clients")
    options = parser.parse_args(arguments)
    document = json.loads(openapi_text())
    breaks = breaking_changes(json.loads(record.read_text(encoding="utf-8")), contract_of(document))
    if breaks:
        print(report(breaks), file=sys.stderr)
        if not options.accept:
            return 1
    record.write_text(contract_text(document), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
