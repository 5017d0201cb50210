"""Ray patterns, balanced tables and focused lenses from the cache on disk are those that are computed, to the bit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from render.disk_cache import ENVIRONMENT, ArrayCache
from render.model.lens import IrisShape
from render.optics.prescription import focusing
from render.optics.prescription.completion import complete_prescription
from render.trace import rays
from render.trace.highlights import light_balance
from render.trace.highlights.light_balance import balance_light
from render.trace.lens_table import LIGHT, REGION, ROW_LENGTH, PolynomialTable
from tests.render.kits.lenses import DOUBLE_GAUSS

MASK = np.linspace(0.2, 1.0, 16).reshape(4, 4)
IRISES = {"round": IrisShape(), "bladed": IrisShape(6, 0.3), "mask": IrisShape(mask=MASK)}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of an empty cache."""
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("name", IRISES)
def test_a_kept_ray_pattern_is_the_computed_one(folder: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    def make() -> list[bytes | None]:
        pattern = rays.make_ray_pattern(16, IRISES[name], seed=3)
        arrays = pattern.points, pattern.iris_points, pattern.iris_image
        return [None if array is None else array.tobytes() for array in arrays]

    def forbid() -> None:
        monkeypatch.setattr(rays, "lens_samples", None)

    assert_kept(folder, monkeypatch, rays, make, forbid)


def test_a_kept_balance_is_the_computed_one(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = np.random.default_rng(1).random((2, 4, ROW_LENGTH), np.float32)
    rows[..., LIGHT], rows[..., REGION + 3] = 0.5, 1.0
    table = PolynomialTable(rows, 0.4, 0.01, 0.02, 7, 5)

    def make() -> bytes:
        balance_light.cache_clear()
        return balance_light(table).rows.tobytes()

    def forbid() -> None:
        monkeypatch.setattr(light_balance, "mean_light", None)

    assert_kept(folder, monkeypatch, light_balance, make, forbid)


def test_a_kept_focus_is_the_computed_one(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lens = complete_prescription(DOUBLE_GAUSS.prescription)

    def make() -> bytes:
        return focusing.focus_lens(lens, 2.0, 2.8).vertices_mm.tobytes()

    def forbid() -> None:
        monkeypatch.setattr("render.optics.prescription.focus_mechanism.FocusMechanism.spot_shift", None)

    assert_kept(folder, monkeypatch, focusing, make, forbid)


def assert_kept(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    module: ModuleType,
    make: Callable[[], object],
    forbid: Callable[[], None],
) -> None:
    """Make a result without a cache, with an empty one, and as another process from the entry alone."""

    def forget() -> None:
        monkeypatch.setattr(module, "_cache", ArrayCache("a-test", ("optics", "trace")))

    forget()
    with monkeypatch.context() as patch:
        patch.setenv(ENVIRONMENT, "off")
        computed = make()
    assert list(folder.iterdir()) == []
    forget()
    assert make() == computed
    assert len(list(folder.iterdir())) == 1
    forget()
    forbid()
    assert make() == computed
