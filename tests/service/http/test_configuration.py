"""The configuration file: settings by their names, and one sentence for what is wrong."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from render.cli.main import main
from render.errors import SettingsError
from service.http.command import _listen, _parser, _settings
from service.http.configuration import read_configuration


@pytest.fixture
def config(tmp_path):
    def written(text):
        file = tmp_path / "service.toml"
        file.write_text(text)
        return file

    return written


def test_settings_stand_alone_or_in_sections(config, tmp_path):
    file = config(
        'data = "shots"\nhost = "0.0.0.0"\nframe_timeout_s = 60\n[limits]\nmax_upload_mb = 7\n'
        '[log]\nformat = "json"\n[names]\nallowed_hosts = ["lens.example"]\ndemo = false\n'
    )
    assert read_configuration(file) == {
        "data": tmp_path / "shots",
        "host": "0.0.0.0",
        "frame_timeout_s": 60.0,
        "max_upload_mb": 7,
        "log_format": "json",
        "allowed_hosts": ("lens.example",),
        "demo": False,
    }


def test_arguments_go_before_the_file(config, tmp_path):
    file = config('port = 8080\nmax_viewers = 3\ndata = "~/shots"\n')
    settings = _settings(_parser().parse_args(["--config", str(file), "--port", "0", "--no-demo"]))
    assert (settings.port, settings.max_viewers, settings.demo) == (0, 3, False)
    assert settings.data == Path.home() / "shots"
    assert settings.allowed_hosts == ("127.0.0.1", "localhost", "[::1]")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("max_uplod_mb = 3", "max_uplod_mb is no setting: did you mean 'max_upload_mb'"),
        ("[limits]\nports = 3", "[limits] ports is no setting: did you mean 'port'"),
        ('port = "80"', "port takes a whole number, got '80'"),
        ("port = true", "port takes a whole number, got True"),
        ("demo = 1", "demo takes true or false, got 1"),
        ("frame_timeout_s = nan", "frame_timeout_s = nan is no limit"),
        ("max_viewers = -1", "max_viewers = -1 is no limit"),
        ('allowed_hosts = "a"', "allowed_hosts takes a list in [ ], got 'a'"),
        ("allowed_hosts = [1]", "allowed_hosts takes a text, got 1"),
        ('log_format = "xml"', "log_format = 'xml' is none of its values"),
        ("data = 1", "data takes the path of a folder"),
        ("port = 1\n[a]\nport = 2", "[a] port is set a second time"),
        ('static = "x"', "static is no setting"),
        ("= 3", "is no TOML"),
    ],
)
def test_what_is_wrong_is_one_sentence(config, capfd, text, message):
    assert main(["serve", "--config", str(config(text))]) == 2
    printed = capfd.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1


def test_a_configuration_that_is_not_there_is_named(tmp_path):
    with pytest.raises(SettingsError, match=r"none\.toml cannot be read"):
        read_configuration(tmp_path / "none.toml")


@pytest.mark.parametrize("host", ["127.0.0.1", "::1"])
def test_answers_wait_for_no_delayed_ack(host):
    with _listen(host, 0) as listener, socket.create_connection(listener.getsockname()[:2], 10):
        accepted, _ = listener.accept()
        with accepted:
            assert accepted.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
