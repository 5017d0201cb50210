"""The template process: it imports what workers need, once, and forks a worker whenever the service asks.

A worker is there within milliseconds, and shares the memory of the imported modules. The template does nothing but import and
fork. It never has a second thread, since a fork copies one thread only, and so it opens no stage and no GL context.

Run as ``python -m service.workers.template CONTROL PRELOAD``: the descriptor of the service's socket, and the module whose import
prepares all workers. The service sends JSON:

- ``{"do": "fork"}``, with the descriptors of a pipe, a `Signals` and the memory of its output, is answered by ``{"pid": 7}``;
- ``{"do": "reap", "pid": 7}`` waits for the end of a worker and is answered by its ``status``, ``peak_bytes`` and ``cpu_s``;
- ``{"do": "try"}`` forks a process that ends at once, and is answered by ``{}``, or by ``error`` where none can be forked.

A worker ends with the template, and the template with the service, however these end.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import socket
import sys
import traceback
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any

MESSAGE_BYTES = 4096
_PR_SET_PDEATHSIG = 1


def main(control_fd: int, preload: str) -> None:
    """Fork workers until the service is gone."""
    _end_with_parent()  # for a template that is stopped by a signal, and so cannot see that its socket was closed
    for sent_to_all in (signal.SIGINT, signal.SIGTERM):  # they end the service, which then closes the socket
        signal.signal(sent_to_all, signal.SIG_IGN)
    import_module(preload)
    from service.workers.serving import serve  # after the preloaded modules, which choose what threads may start

    with socket.socket(fileno=control_fd) as control:
        control.send(json.dumps({"threads": len(os.listdir("/proc/self/task"))}).encode())
        while True:
            message, descriptors, _, _ = socket.recv_fds(control, MESSAGE_BYTES, 3)
            if not message:
                return
            request = json.loads(message)
            if request["do"] == "fork":
                answer = _fork(control, descriptors, serve)
                for descriptor in descriptors:
                    os.close(descriptor)
            elif request["do"] == "try":
                answer = _try_fork()
            else:
                _, status, usage = os.wait4(request["pid"], 0)
                answer = {
                    "status": status,
                    "peak_bytes": usage.ru_maxrss * 1024,
                    "cpu_s": usage.ru_utime + usage.ru_stime,
                }
            control.send(json.dumps(answer).encode())


def _fork(control: socket.socket, descriptors: list[int], serve: Any) -> dict[str, object]:
    template = os.getpid()
    try:
        pid = os.fork()
    except OSError as error:
        return {"error": os.strerror(error.errno or 0)}
    if pid:
        return {"pid": pid}
    try:
        control.close()
        _end_with_parent()
        if os.getppid() == template:
            pipe_fd, signals_fd, output_fd = descriptors
            serve(Connection(pipe_fd), signals_fd, output_fd)
    except BaseException:
        traceback.print_exc()  # a sandbox that cannot be entered, most likely
        sys.stderr.flush()
        os._exit(70)
    os._exit(0)  # a worker never returns into the template's loop


def _try_fork() -> dict[str, object]:
    try:
        pid = os.fork()
    except OSError as error:
        return {"error": os.strerror(error.errno or 0)}
    if not pid:
        os._exit(0)
    os.waitpid(pid, 0)
    return {}


def _end_with_parent() -> None:
    """Have the kernel end this process when the thread that started it ends."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
