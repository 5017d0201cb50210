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
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from render.errors import PullfocusError
from service.bench.requests import FIRST_CLIENT, ask
from service.http.settings import Settings

START_S, READY_S, STOP_S, PAUSE_S = 120.0, 600.0, 30.0, 0.5
"""Time for the service to listen, to compile its shaders at low priority, and to end; time between two questions."""


@contextmanager
def running_service(
    folder: Path, viewers: int = 0, *, first: bool = False, settings: Mapping[str, str] | None = None
) -> Iterator[int]:
    """Run `pullfocus serve` until the end of the context.

    Unless it is the first start on a machine, its cache is the user's, and it has compiled its shaders before the context begins.

    Args:
        folder: where its data goes.
        viewers: how many live viewers come at the same time.
        first: whether it starts as on a machine where it never ran: its cache is empty.
        settings: more of its settings.

    Yields:
        Its port on 127.0.0.1.

    Raises:
        PullfocusError: it does not start.
    """
    configuration = folder / "serve.toml"
    cache = 'cache = "cache"\n' if first else ""
    most = max(viewers, Settings.max_viewers)
    others = "".join(f"{name} = {json.dumps(value)}\n" for name, value in (settings or {}).items())
    configuration.write_text(f'data = "data"\n{cache}port = 0\nmax_viewers = {most}\n{others}', encoding="utf-8")
    command = [sys.executable, "-m", "render.cli", "serve", "--log-format", "text", "--config", str(configuration)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        said: deque[str] = deque(maxlen=50)
        late = threading.Timer(START_S, process.kill)  # which ends the loop below
        late.start()
        try:
            address = None
            for line in process.stderr:
                said.append(line)
                address = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
                if address:
                    break
            late.cancel()
            if address is None:
                raise PullfocusError("the service did not start: " + " ".join(said)[-500:])
            # Read on and dropped: a full pipe would stop the service.
            threading.Thread(target=said.extend, args=(process.stderr,), daemon=True).start()
            port = int(address[1])
            _wait_until_ready(port, may_warm=first)
            yield port
        finally:
            late.cancel()
            process.terminate()
            try:
                process.wait(STOP_S)
            except subprocess.TimeoutExpired:
                process.kill()


def _wait_until_ready(port: int, *, may_warm: bool) -> None:
    """Wait until the service is ready.

    Args:
        port: of the service.
        may_warm: do not wait until it has compiled its shaders.

    Raises:
        PullfocusError: it is not ready in time, or it has ended.
    """
    until_s = time.monotonic() + READY_S
    while True:
        try:
            status, detail = ask(port, FIRST_CLIENT, "GET", "/readyz")
        except (OSError, http.client.HTTPException) as error:
            raise PullfocusError(f"the service ended before it was ready: {type(error).__name__}: {error}") from error
        if status == 200 and (may_warm or not json.loads(detail)["warming"]):
            return
        if time.monotonic() > until_s:
            raise PullfocusError(f"the service is not ready: {detail.decode(errors='replace')[:500]}")
        time.sleep(PAUSE_S)
