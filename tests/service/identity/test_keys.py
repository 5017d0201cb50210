"""Keys on disk: hashed, private, and whole whoever changes them at once."""

from __future__ import annotations

import hmac
import stat
import subprocess
import sys
from datetime import UTC, datetime, timedelta

import pytest

from render.cli.main import main
from render.errors import NotFoundError, OutputError, SettingsError
from service.identity.keys import Keys
from service.identity.principal import SCOPES
from service.identity.roles import scopes_of

READ = frozenset({"read"})


def test_a_key_is_known_by_its_text_alone(tmp_path):
    keys = Keys(tmp_path)
    key, text = keys.create("Mara", READ, "default")
    assert keys.verify(text) == key
    assert text.startswith(f"pf_{key.id}_")
    wrong = text[:-1] + ("A" if text[-1] != "A" else "B")
    for other in (wrong, text[:-1], text + "x", text.upper(), "", f"pf_{'0' * 12}_{'x' * 43}", text + "\n"):
        assert keys.verify(other) is None, other


def test_the_file_is_private_and_holds_no_secret(tmp_path):
    keys = Keys(tmp_path)
    _, text = keys.create("Mara", READ, "default")
    file = tmp_path / "keys.json"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert text.split("_", 2)[2] not in file.read_text()


def test_secrets_are_compared_in_constant_time(tmp_path, monkeypatch):
    keys = Keys(tmp_path)
    _, text = keys.create("Mara", READ, "default")
    compared = []
    monkeypatch.setattr(hmac, "compare_digest", lambda a, b: compared.append((a, b)) or a == b)
    keys.verify(text)
    keys.verify(f"pf_{'0' * 12}_{'x' * 43}")  # an unknown id takes the same steps
    assert [len(a) == len(b) == 64 for a, b in compared] == [True, True]


def test_a_key_expires_and_is_revoked(tmp_path):
    now = datetime(2026, 11, 23, tzinfo=UTC)
    keys = Keys(tmp_path, lambda: now)
    key, text = keys.create("Mara", READ, "default", now + timedelta(days=1))
    assert keys.verify(text)
    now += timedelta(days=1)
    assert keys.verify(text) is None
    assert keys.list() == [key]
    keys.revoke(key.id)
    assert keys.list() == []
    with pytest.raises(NotFoundError):
        keys.revoke(key.id)


def test_another_process_s_changes_are_seen(tmp_path):
    service, shell = Keys(tmp_path), Keys(tmp_path)
    key, text = shell.create("Mara", READ, "default")
    assert service.verify(text)
    shell.revoke(key.id)
    assert service.verify(text) is None


def test_keys_made_at_once_are_all_kept(tmp_path):
    code = (
        "import sys; from pathlib import Path; from service.identity.keys import Keys\n"
        "for n in range(10): Keys(Path(sys.argv[1])).create('k', frozenset({'read'}), 'default')"
    )
    processes = [subprocess.Popen([sys.executable, "-c", code, str(tmp_path)]) for _ in range(4)]
    assert [process.wait(120) for process in processes] == [0] * 4
    assert len(Keys(tmp_path).list()) == 40


@pytest.mark.parametrize("text", ["{", "[]", '{"keys": [{}]}', '{"keys": 1}'])
def test_a_damaged_file_lets_nobody_in(tmp_path, text):
    keys = Keys(tmp_path)
    _, sent = keys.create("Mara", READ, "default")
    (tmp_path / "keys.json").write_text(text)
    assert keys.verify(sent) is None
    with pytest.raises(OutputError, match=r"keys\.json"):
        keys.create("Ada", READ, "default")
    assert (tmp_path / "keys.json").read_text() == text


@pytest.mark.parametrize(
    ("label", "scopes", "project"),
    [
        ("", READ, "default"),
        ("a\nb", READ, "default"),
        ("x", frozenset(), "default"),
        ("x", READ, "../x"),
        ("x", SCOPES, "a"),
    ],
)
def test_an_unusable_key_is_refused(tmp_path, label, scopes, project):
    with pytest.raises(SettingsError):
        Keys(tmp_path).create(label, scopes, project)
    assert not (tmp_path / "keys.json").exists()


def test_roles_are_sets_of_scopes():
    assert scopes_of(["artist"]) == {"read", "edit", "render"}
    assert scopes_of(["reader", "render"]) == scopes_of(["viewer"])
    for words in ([], ["king"], ["reader", "x"]):
        with pytest.raises(SettingsError, match="artist"):
            scopes_of(words)


def test_the_command_makes_lists_and_revokes_keys(tmp_path, capsys):
    data = ["--data", str(tmp_path)]
    assert main(["keys", "create", "Mara", "--role", "artist", "--project", "tram", "--days", "90", *data]) == 0
    text = capsys.readouterr().out.strip()
    key = Keys(tmp_path).verify(text)
    assert key.project == "tram"
    assert datetime.fromisoformat(key.expires_at) - datetime.fromisoformat(key.created_at) == timedelta(days=90)
    assert main(["keys", "list", *data]) == 0
    printed = capsys.readouterr().out
    assert key.id in printed
    assert text not in printed
    assert main(["keys", "revoke", key.id, *data]) == 0
    assert Keys(tmp_path).verify(text) is None
    assert main(["keys", "revoke", key.id, *data]) == 1
    assert main(["keys", "create", "x", "--role", "king", *data]) == 2
    assert "king" in capsys.readouterr().err
