"""`pullfocus doctor`, `backup` and `restore`: what they print, and their exit status."""

from __future__ import annotations

import json
import socket
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from render.cli.main import main
from service.storage.store import ShotStore
from service.upkeep import doctor as doctor_module
from service.upkeep.command import backup, doctor, restore
from tests.service.kits.issuer import KEYS, running_issuer

CHECKS = {"python", "kernel", "sandbox", "limits", "port", "data", "disk", "database", "libraries", "gl"}


def findings(capsys, *arguments):
    status = doctor([*arguments, "--json"])
    return status, {finding["name"]: finding for finding in json.loads(capsys.readouterr().out)}


def test_the_commands_are_found_by_their_entry_points():
    values = {entry.name: entry.value for entry in entry_points(group="pullfocus.commands")}
    for name in ("doctor", "backup", "restore"):
        assert values[name] == f"service.upkeep.command:{name}"


def test_a_sound_machine_passes(capsys, tmp_path):
    status, found = findings(capsys, "--data", str(tmp_path / "new"), "--port", "0")
    assert found.keys() == CHECKS
    assert [name for name, finding in found.items() if finding["state"] == "fail"] == []
    assert status == 0
    assert "renderer" in found["gl"]["text"]
    assert "OpenColorIO 2" in found["libraries"]["text"]
    assert not (tmp_path / "new").exists()


def test_each_fault_is_named_with_a_remedy(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(doctor_module, "LEAST_FREE_BYTES", 2**62)
    monkeypatch.setattr(doctor_module, "LEAST_FILES", 10**9)
    file = tmp_path / "file"
    file.write_text("")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        status, found = findings(capsys, "--data", str(file), "--port", str(taken.getsockname()[1]))
    assert status == 1
    assert {found[name]["state"] for name in ("data", "disk")} == {"fail"}
    assert {found[name]["state"] for name in ("port", "limits")} == {"warn"}
    assert all(finding["remedy"] for finding in found.values() if finding["state"] != "ok")


def test_an_issuer_of_tokens_is_asked_for_its_keys():
    with running_issuer() as issuer:
        assert (doctor_module._issuer(issuer.address).state, issuer.asked[-1]) == ("ok", KEYS)
        issuer.keys.clear()
        assert "no public keys" in doctor_module._issuer(issuer.address).text
    gone = doctor_module._issuer(issuer.address)
    assert (gone.state, issuer.address in gone.text) == ("fail", True)
    assert doctor_module._issuer("http://login.example").state == "fail"


def test_the_settings_of_a_file_are_checked(capsys, tmp_path, monkeypatch):
    pytest.importorskip("psycopg")
    monkeypatch.setattr(doctor_module, "_probe", lambda what, _: doctor_module.Finding(what, "ok", ""))
    (tmp_path / "studio.toml").write_text(
        'data = "studio"\ndatabase = "postgresql://mara:pa55word@127.0.0.1:1/renders"\n'
    )
    status, found = findings(capsys, "--config", str(tmp_path / "studio.toml"), "--port", "0")
    assert (status, found["database"]["state"]) == (1, "fail")
    assert "'renders' of PostgreSQL on 127.0.0.1 cannot be opened" in found["database"]["text"]
    assert "pa55word" not in json.dumps(found)
    assert str(tmp_path / "studio") in found["data"]["text"]


def test_a_bucket_is_looked_at(bucket):
    assert doctor_module._bucket(bucket["bucket"], bucket["bucket_endpoint"]).state == "ok"
    gone = doctor_module._bucket(bucket["bucket"], "http://127.0.0.1:1")
    assert (gone.state, "AWS_ACCESS_KEY_ID" in gone.remedy) == ("fail", True)
    assert doctor_module._bucket("renders", "").state == "fail"


def test_a_library_that_kills_its_process_is_a_finding(monkeypatch):
    monkeypatch.setattr(doctor_module.sys, "executable", "/bin/false")
    finding = doctor_module._probe("gl", "mend it")
    assert (finding.state, finding.text, finding.remedy) == ("fail", "the process ended with status 1", "mend it")


def test_a_folder_of_the_earlier_layout_is_a_warning(capsys, tmp_path):
    (tmp_path / "shots").mkdir()
    _, found = findings(capsys, "--data", str(tmp_path), "--port", "0")
    assert (found["data"]["state"], "layout 1" in found["data"]["text"]) == ("warn", True)
    assert not (tmp_path / "layout.json").exists()


def test_lines_for_people_have_the_remedy_below(capsys, tmp_path):
    (tmp_path / "shots").mkdir()
    doctor(["--data", str(tmp_path), "--port", "0"])
    lines = capsys.readouterr().out.splitlines()
    (at,) = [number for number, line in enumerate(lines) if line.startswith("warn  data")]
    assert lines[at + 1].strip().startswith("back it up")


def test_backup_and_restore_are_one_command_each(capsys, tmp_path):
    ShotStore(tmp_path / "data").close()
    archive = tmp_path / "b.tar.gz"
    assert backup([str(archive), "--data", str(tmp_path / "data")]) == 0
    assert "read again and compared" in capsys.readouterr().err
    assert restore([str(archive), "--data", str(tmp_path / "new")]) == 0
    assert (tmp_path / "new" / "layout.json").is_file()


@pytest.mark.parametrize(
    ("command", "arguments", "status", "message"),
    [
        ("backup", ["b.zip"], 2, "a backup is a .tar.gz"),
        ("backup", ["b.tar.gz", "--data", "nowhere"], 1, "no data folder"),
        ("restore", ["none.tar.gz", "--data", "new"], 1, "there is no file none.tar.gz"),
        ("restore", ["text.tar.gz", "--data", "new"], 1, "is no backup"),
    ],
)
def test_what_is_wrong_is_one_sentence(capfd, tmp_path, monkeypatch, command, arguments, status, message):
    monkeypatch.chdir(tmp_path)
    Path("text.tar.gz").write_text("text")
    assert main([command, *arguments]) == status
    printed = capfd.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
