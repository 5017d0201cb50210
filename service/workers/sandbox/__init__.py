"""The sandbox that a worker process enters before it reads files of strangers.

A worker sees read-only the program and what `Sandbox.read` names, read-write what `Sandbox.write` names, and nothing else: no
network, no other process, none of the service's environment (`worker_environment`). Landlock and a filter of system calls
(seccomp) hold where the kernel has them, resource limits everywhere; `support` says which.
"""

from __future__ import annotations

from service.workers.sandbox.environment import cache_environment, worker_environment
from service.workers.sandbox.limits import Limits, allow_cpu
from service.workers.sandbox.policy import Sandbox, SandboxError, Support, enter, support

__all__ = [
    "Limits",
    "Sandbox",
    "SandboxError",
    "Support",
    "allow_cpu",
    "cache_environment",
    "enter",
    "support",
    "worker_environment",
]
