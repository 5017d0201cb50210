"""JSON nested without end is a damaged file like any other, wherever one is read."""

from __future__ import annotations

import pytest

from render.errors import OutputError, SettingsError
from service.http.configuration import read_configuration
from service.identity.cpu_usage import CpuUsage
from service.identity.keys import Keys
from service.json_text import parse_json
from service.storage.blames import FILE, Blames, read_blames
from service.storage.edit_files import HISTORY, INDEX, load_history
from service.storage.migration import LAYOUT_FILE, layout_of
from service.storage.store import RECORD, read_record

NESTED = "[" * 200_000


def test_nested_text_is_no_json():
    assert parse_json(b'{"a": [1]}') == {"a": [1]}
    for wrong in (NESTED, '{"a":' * 200_000):
        with pytest.raises(ValueError, match="nested too deeply"):
            parse_json(wrong)


@pytest.mark.parametrize(("name", "read"), [("keys.json", lambda data: Keys(data).list()), (LAYOUT_FILE, layout_of)])
def test_a_nested_file_of_the_service_is_named(tmp_path, name, read):
    (tmp_path / name).write_text(NESTED)
    with pytest.raises(OutputError, match=name):
        read(tmp_path)


def test_nested_notes_count_for_nothing(tmp_path, caplog):
    for name in ("usage.json", RECORD, FILE):
        (tmp_path / name).write_text(NESTED)
    (tmp_path / HISTORY).mkdir()
    (tmp_path / HISTORY / INDEX).write_text(NESTED)
    assert CpuUsage(tmp_path).used_s("mara") == 0
    assert read_record(tmp_path, "room") is None
    assert read_blames(tmp_path) == Blames()
    assert load_history(tmp_path) is None
    assert caplog.text.count("cannot be read") == 3


def test_a_nested_configuration_is_refused(tmp_path):
    (tmp_path / "c.toml").write_text("port = " + NESTED)
    with pytest.raises(SettingsError, match="nested too deeply"):
        read_configuration(tmp_path / "c.toml")
