"""Tests of reading what strace has written of the workers' system calls."""

from tests.hostile.trace import read_trace

LINES = """\
71 openat(AT_FDCWD, "/etc/passwd", O_RDONLY|O_CLOEXEC) = -1 EACCES (Permission denied)
71 openat(AT_FDCWD, "/etc/passwd", O_RDONLY|O_CLOEXEC) = -1 EACCES (Permission denied)
72 socket(AF_INET, SOCK_STREAM, IPPROTO_TCP) = -1 EPERM (Operation not permitted)
72 openat(AT_FDCWD, "/data/shots/a/files/a.usda", O_RDONLY) = 9
72 openat(AT_FDCWD, "/home/somebody/secret", O_RDONLY) = 10
72 openat(AT_FDCWD, "/usr/lib/libGL.so", O_RDONLY) = 11
72 newfstatat(AT_FDCWD, "/no/such/file", 0x7ffd, 0) = -1 ENOENT (No such file or directory)
72 +++ exited with 0 +++
""".splitlines()


def test_refused_calls_are_counted_by_what_they_name():
    tried = read_trace(LINES)
    assert tried.calls == 7
    assert tried.refused == {"openat /etc/passwd": 2, "socket AF_INET, SOCK_STREAM, IPPROTO_TCP": 1}


def test_what_was_opened_outside_is_listed():
    assert read_trace(LINES).opened_outside(["/data/"]) == ["/home/somebody/secret"]
