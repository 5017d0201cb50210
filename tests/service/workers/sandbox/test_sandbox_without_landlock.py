"""A sandbox on a kernel that offers less, and what people are told about it."""

from __future__ import annotations

from pathlib import Path

import pytest

from service.workers.sandbox import Support
from tests.service.workers.sandbox.confined import NOTHING, OFFERED, Confined

FILTER_ALONE = Support(0, True)
needs_filter = pytest.mark.skipif(not OFFERED.seccomp, reason="this system filters no system calls")


def test_limits_hold_where_the_kernel_offers_nothing(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path, {"descriptors": 32}, offered=NOTHING)

    lines = sandbox.output(f"""
        import resource
        print(held.landlock_abi, held.seccomp, resource.getrlimit(resource.RLIMIT_NOFILE))
        print(error_of(lambda: open({str(sandbox.other / "secret")!r})))
    """)

    assert lines == ["0 False (32, 32)", "done"]


@needs_filter
@pytest.mark.parametrize(
    "action",
    [
        "os.chmod(path, 0o777)",
        "os.chown(path, 1, 1)",
        "os.utime(path)",
        "os.setxattr(path, 'user.name', b'x')",
        "os.link(path, path + '.link')",
        "os.symlink('/etc/passwd', path + '.link')",
        "os.mkfifo(path + '.pipe')",
        "os.chroot(path)",
    ],
)
def test_files_keep_what_landlock_does_not_protect(tmp_path: Path, action: str) -> None:
    sandbox = Confined(tmp_path, offered=FILTER_ALONE)
    path = str(sandbox.edits / "edits.usda")
    Path(path).touch(0o600)

    assert sandbox.output(f"path = {path!r}\nprint(error_of(lambda: {action}))") == ["EPERM"]
    assert Path(path).stat().st_mode & 0o777 == 0o600


@needs_filter
def test_times_of_an_open_file_are_set(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path, offered=FILTER_ALONE)

    sandbox.output(f"with open({str(sandbox.edits / 'entry')!r}, 'w') as file: os.utime(file.fileno(), (1, 1))")

    assert (sandbox.edits / "entry").stat().st_mtime == 1


def test_capabilities_of_root_are_given_up(tmp_path: Path) -> None:
    status = Confined(tmp_path, offered=NOTHING).output("print(Path('/proc/self/status').read_text())")

    held = {line.split()[0]: int(line.split()[1], 16) for line in status if line.startswith("Cap")}
    override_permissions = 1 << 1
    assert held["CapEff:"] | held["CapPrm:"] | override_permissions == override_permissions
    assert held["CapInh:"] == 0


@pytest.mark.parametrize(
    ("support", "named", "unnamed"),
    [
        (Support(7, True), ["Landlock (ABI 7)", "seccomp", "resource limits"], "no Landlock"),
        (Support(0, True), ["This kernel offers no Landlock", "seccomp"], "(ABI"),
        (Support(0, False), ["by resource limits.", "no Landlock", "network"], "seccomp"),
    ],
)
def test_people_are_told_what_holds(support: Support, named: list[str], unnamed: str) -> None:
    sentence = support.describe()

    assert [words for words in named if words not in sentence] == []
    assert unnamed not in sentence
