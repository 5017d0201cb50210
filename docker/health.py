"""Health of a container, for its health check and probes: the exit status is 0 where it is well.

usage: python3 health.py http PORT PATH     a server of this container answers 200
       python3 health.py joined PORT        a scheduler of Dask, which listens on PORT, has this container's worker

A scheduler closes the connection of a worker that has not told of itself for five minutes. So a connection stands for a worker
that runs, and one that is looking for its scheduler, or hangs, is not well.
"""

from __future__ import annotations

import sys
from contextlib import suppress
from http.client import HTTPConnection, HTTPException
from pathlib import Path

ANSWER_S = 8.0
_CONNECTIONS = Path("/proc/net/tcp"), Path("/proc/net/tcp6")
_ESTABLISHED = "01"


def answers(port: int, path: str) -> bool:
    """Whether the HTTP server on a port of this container answers a path with 200."""
    with suppress(OSError, HTTPException):
        connection = HTTPConnection("127.0.0.1", port, timeout=ANSWER_S)  # no proxy of the environment goes between
        connection.request("GET", path)
        return connection.getresponse().status == 200
    return False


def has_joined(port: int) -> bool:
    """Whether this container has a connection to a port of another one."""
    for file in _CONNECTIONS:
        with suppress(FileNotFoundError):  # without IPv6
            for line in file.read_text().splitlines()[1:]:
                _, _, remote, state = line.split()[:4]
                if state == _ESTABLISHED and int(remote.rpartition(":")[2], 16) == port:
                    return True
    return False


def main(typed: list[str]) -> int:
    """Return the exit status: 0 well, 1 not well, 2 wrong arguments."""
    match typed:
        case ["http", port, path] if port.isdecimal():
            return 0 if answers(int(port), path) else 1
        case ["joined", port] if port.isdecimal():
            return 0 if has_joined(int(port)) else 1
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
