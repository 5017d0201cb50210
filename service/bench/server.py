"""A service of the bench's own: a new process on a free port, with an empty data folder and the demo shot."""

from __future__ import annotations

import http.client
import json
import re
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from render.errors import PullfocusError

START_S, STOP_S, PAUSE_S = 120.0, 30.0, 0.5


@contextmanager
def running_service(folder: Path, *, first: bool) -> Iterator[int]:
    """Run `pullfocus serve` until the end of the context.

    Args:
        folder: where its data goes.
        first: whether its cache begins empty, as at the first start on a machine. Else it is the user's, and the service has
            compiled its shaders before the context begins.

    Yields:
        Its port on 127.0.0.1.

    Raises:
        PullfocusError: it does not start.
    """
    configuration = folder / "serve.toml"
    cache = 'cache = "cache"\n' if first else ""
    configuration.write_text(f'data = "data"\n{cache}port = 0\n', encoding="utf-8")
    command = [sys.executable, "-m", "render.cli", "serve", "--log-format", "text", "--config", str(configuration)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        said: deque[str] = deque(maxlen=50)
        try:
            address = None
            for line in process.stderr:
                said.append(line)
                address = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
                if address:
                    break
            if address is None:
                raise PullfocusError("the service did not start: " + " ".join(said)[-500:])
            # Read on and dropped: a full pipe would stop the service.
            threading.Thread(target=said.extend, args=(process.stderr,), daemon=True).start()
            port = int(address[1])
            while _is_warming(port) and not first:
                time.sleep(PAUSE_S)
            yield port
        finally:
            process.terminate()
            try:
                process.wait(STOP_S)
            except subprocess.TimeoutExpired:
                process.kill()


def _is_warming(port: int) -> bool:
    """Wait until the service is ready. Returns whether it is compiling shaders. Raises `PullfocusError`: it is not ready."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=START_S)
    connection.request("GET", "/readyz")
    answer = connection.getresponse()
    detail = answer.read()
    connection.close()
    if answer.status != 200:
        raise PullfocusError(f"the service is not ready: {detail.decode()[:500]}")
    return bool(json.loads(detail)["warming"])
