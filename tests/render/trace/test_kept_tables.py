"""Lens tables from the cache on disk are those that are computed, to the bit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from render.disk_cache import ENVIRONMENT
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.camera import Camera
from render.model.lens import Lens, SeidelErrors
from render.optics.view import PinholeView
from render.trace.bundles import BundleMaker
from render.trace.lens_table import GridTable, LensTable, table_arrays, table_from_arrays
from render.trace.rays import make_ray_pattern
from tests.render.kits.lenses import DOUBLE_GAUSS

LENSES = {
    "prescription": Lens("prescription", prescription=DOUBLE_GAUSS.prescription),
    "seidel": Lens("seidel", seidel=SeidelErrors(w040=2.0, lateral_color_mm=0.02)),
    "drawn": Lens(pupil_power=(1.0, 1.1, 1.3), expressive_blend=1.0),
}


@pytest.fixture(scope="module")
def graphics() -> Iterator[GraphicsContext]:
    with GraphicsContext() as graphics:
        yield graphics


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of an empty cache."""
    monkeypatch.setenv(ENVIRONMENT, str(tmp_path))
    return tmp_path


def make_table(graphics: GraphicsContext, lens: Lens, focus_distance_m: float = 3.0) -> LensTable:
    """Make the table of a lens with a maker of its own, as in a new process."""
    camera = Camera(np.eye(4), 50.0, f_stop=2.8, focus_distance_m=focus_distance_m, near_m=0.1, lens=lens)
    maker = BundleMaker(graphics.ctx, ProgramCache(graphics.ctx))
    table = maker.make_bundle(camera, PinholeView.from_camera(camera, 32, 18), make_ray_pattern(4, camera.iris)).table
    assert table is not None
    return table


def assert_equal(found: LensTable, expected: LensTable) -> None:
    """Compare all fields of two tables, to the bit and with their types."""
    assert type(found) is type(expected)
    for field in fields(expected):
        one, other = getattr(found, field.name), getattr(expected, field.name)
        assert type(one) is type(other)
        np.testing.assert_array_equal(one, other)


@pytest.mark.gl
@pytest.mark.parametrize("name", LENSES)
def test_a_kept_table_is_the_computed_one(
    graphics: GraphicsContext, folder: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    computed = make_table(graphics, LENSES[name])
    assert len(list(folder.glob("lens-table-*"))) == 1
    monkeypatch.setattr("render.trace.bundles.BundleMaker._make_table", None)  # it would fail
    assert_equal(make_table(graphics, LENSES[name]), computed)


@pytest.mark.gl
def test_another_focus_distance_has_another_table(graphics: GraphicsContext, folder: Path) -> None:
    near, far = (make_table(graphics, LENSES["prescription"], distance) for distance in (1.0, 10.0))
    assert len(list(folder.glob("lens-table-*"))) == 2
    assert table_arrays(near)["rows"].tobytes() != table_arrays(far)["rows"].tobytes()


@pytest.mark.gl
def test_an_entry_of_something_else_is_computed_anew(graphics: GraphicsContext, folder: Path) -> None:
    computed = make_table(graphics, LENSES["prescription"])
    (entry,) = folder.glob("lens-table-*")
    entry.write_bytes(b"\0\0\0\0")  # whole, and without arrays
    assert_equal(make_table(graphics, LENSES["prescription"]), computed)
    assert entry.stat().st_size > 4


def test_the_table_of_a_lens_without_symmetry_comes_back() -> None:
    numbers = np.random.default_rng(1).random((1, 9, 4, 4, 6), np.float32)
    table = GridTable(numbers[..., :4], numbers[..., 4:], (3, 3), (0.4, 0.3), 0.01, 0.02)
    assert_equal(table_from_arrays(table_arrays(table)), table)
