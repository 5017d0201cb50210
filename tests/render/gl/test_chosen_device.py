"""The device that a context is made on, where there are several."""

from __future__ import annotations

import pytest

from render.gl import context


@pytest.mark.parametrize(
    ("number", "chosen"), [("0", "first"), ("1", "second"), ("2", "first"), ("", None), ("x", None)]
)
def test_a_number_chooses_among_the_gpus(monkeypatch, number, chosen):
    monkeypatch.setattr(context, "hardware_devices", lambda: ["first", "second"])
    monkeypatch.delenv("PULLFOCUS_NO_GPU", raising=False)
    monkeypatch.setenv(context.GPU, number)
    assert context._chosen_device() == chosen


def test_without_gpus_the_driver_chooses(monkeypatch):
    monkeypatch.setattr(context, "hardware_devices", list)
    monkeypatch.delenv("PULLFOCUS_NO_GPU", raising=False)
    monkeypatch.setenv(context.GPU, "1")
    assert context._chosen_device() is None
