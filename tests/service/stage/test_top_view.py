"""Bounds of paths from above."""

from __future__ import annotations

import pytest

from service.stage import top_view
from service.stage.opened import OpenedShot
from usd_schemas import FocusPoint


@pytest.mark.parametrize(("most", "count"), [(10, 5), (4, 2), (1, 2)])
def test_many_points_have_paths_of_fewer_times(record, monkeypatch, most, count):
    opened = OpenedShot()
    with opened.use(record, "") as shot:
        for name in ("one", "two"):
            shot.focus.add_point(None, name, FocusPoint(name, target=("/World/far",)))
        edits = shot.edits.history.present.text
        (first, *_, last) = top_view.path_times(shot, 1)
    monkeypatch.setattr(top_view, "MAX_PATH_PLACES", most)
    paths = top_view.read_paths(opened, record, edits, None)
    assert (len(paths.times), paths.times[0], paths.times[-1]) == (count, first, last)
    assert [len(point.positions_m) for point in paths.points] == [count, count]
    assert len(paths.camera_m) == count
