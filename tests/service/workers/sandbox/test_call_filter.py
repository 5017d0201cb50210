"""The filter's program, run as the kernel's machine would, for both architectures."""

from __future__ import annotations

import errno
import re
from pathlib import Path

import pytest

from service.workers.sandbox.call_filter import ALLOW, ERROR, KILL_PROCESS, Instruction, make_filter
from service.workers.sandbox.forbidden_calls import FORBIDDEN

PID = 1234
REFUSED = ERROR | errno.EPERM
MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
CALLS = {
    "clone": (56, 220),
    "ioctl": (16, 29),
    "fcntl": (72, 25),
    "kill": (62, 129),
    "tgkill": (234, 131),
    "prlimit64": (302, 261),
    "utimensat": (280, 88),
    "rt_sigqueueinfo": (129, 138),
    "rt_tgsigqueueinfo": (297, 240),
}
THREAD, NEW_USER_NAMESPACE = 0x00010000, 0x10000000


def _judge(program: list[Instruction], number: int, audit: int, arguments: tuple[int, ...]) -> int:
    """Run a filter, by the kernel's description of classic BPF, and return its answer."""
    words = [number, audit, 0, 0, *(half for value in arguments for half in (value & 0xFFFFFFFF, value >> 32))]
    position, loaded = 0, 0
    while True:
        operation, if_so, if_not, operand = program[position]
        position += 1
        if operation == 0x06:
            return operand
        if operation == 0x20:
            loaded = words[operand // 4]
        else:
            holds = {0x15: loaded == operand, 0x35: loaded >= operand, 0x45: bool(loaded & operand)}[operation]
            position += if_so if holds else if_not


def _answer(machine: str, number: int, *arguments: int) -> int:
    return _judge(make_filter(machine, PID), number, MACHINES[machine][1], (*arguments, *[0] * (6 - len(arguments))))


@pytest.mark.parametrize("machine", MACHINES)
def test_forbidden_calls_are_refused_and_others_made(machine: str) -> None:
    column, _ = MACHINES[machine]
    forbidden = {call[column] for call in FORBIDDEN.values()} - {None}
    judged = {call[column] for call in CALLS.values()} | {435}

    answers = {number: _answer(machine, number) for number in range(480) if number not in judged}

    assert {number for number, answer in answers.items() if answer == REFUSED} == forbidden
    assert {number for number, answer in answers.items() if answer == ALLOW} == answers.keys() - forbidden


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(
    ("call", "arguments", "answer"),
    [
        ("clone", (THREAD | 0x3D0F00,), ALLOW),
        ("clone", (17,), REFUSED),
        ("clone", (THREAD | NEW_USER_NAMESPACE,), REFUSED),
        ("kill", (PID, 9), ALLOW),
        ("kill", (PID + 1, 9), REFUSED),
        ("kill", (0xFFFFFFFF, 9), REFUSED),
        ("kill", (0, 9), REFUSED),
        ("tgkill", (PID, 77, 9), ALLOW),
        ("tgkill", (1, 1, 9), REFUSED),
        ("rt_sigqueueinfo", (1, 9), REFUSED),
        ("rt_tgsigqueueinfo", (1, 1, 9), REFUSED),
        ("prlimit64", (0, 7), ALLOW),
        ("prlimit64", (PID, 7), ALLOW),
        ("prlimit64", (1, 7), REFUSED),
        ("ioctl", (0, 0x5401), ALLOW),
        ("ioctl", (0, 0x5412), REFUSED),
        ("ioctl", (0, 0xFFFFFFFF00005412), REFUSED),
        ("ioctl", (0, 0x541C), REFUSED),
        ("ioctl", (3, 0x8901), REFUSED),
        ("ioctl", (3, 0x8902), REFUSED),
        ("fcntl", (3, 2, 1), ALLOW),
        ("fcntl", (3, 8, 1), REFUSED),
        ("fcntl", (3, 10, 9), REFUSED),
        ("fcntl", (3, 15, 0x7F0000000000), REFUSED),
        ("utimensat", (3, 0), ALLOW),
        ("utimensat", (3, 0x7F0000000000), REFUSED),
        ("utimensat", (3, 0x1000), REFUSED),
    ],
)
def test_some_calls_are_judged_by_their_arguments(
    machine: str, call: str, arguments: tuple[int, ...], answer: int
) -> None:
    assert _answer(machine, CALLS[call][MACHINES[machine][0]], *arguments) == answer


@pytest.mark.parametrize("machine", MACHINES)
def test_the_c_library_is_told_that_there_is_no_clone3(machine: str) -> None:
    assert _answer(machine, 435) == ERROR | errno.ENOSYS


def test_calls_of_other_architectures_end_the_process() -> None:
    nothing = (0,) * 6
    i386, of_x32 = 0x40000003, 0x40000000 | 1

    assert _judge(make_filter("x86_64", PID), 1, i386, nothing) == KILL_PROCESS
    assert _judge(make_filter("x86_64", PID), of_x32, MACHINES["x86_64"][1], nothing) == KILL_PROCESS


@pytest.mark.parametrize(
    ("machine", "header"),
    [("x86_64", "/usr/include/x86_64-linux-gnu/asm/unistd_64.h"), ("aarch64", "/usr/include/asm-generic/unistd.h")],
)
def test_numbers_are_those_of_the_kernels_headers(machine: str, header: str) -> None:
    if not Path(header).is_file():
        pytest.skip("the kernel's headers are not installed")
    found = dict(re.findall(r"#define __NR(?:3264)?_(\w+)\s+(\d+)", Path(header).read_text()))
    column, _ = MACHINES[machine]
    ours = {name: call[column] for name, call in {**FORBIDDEN, **CALLS}.items() if name in found}

    assert len(ours) > 80
    assert ours == {name: int(found[name]) for name in ours}
