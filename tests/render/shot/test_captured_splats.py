"""Captured splats: .ply files read, hostile ones refused, and the layers that they become."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from render.errors import InputError
from render.shot.splats import read_ply, write_splats
from render.stage import StageReader, open_stage
from tests.render.kits.cli_shots import Command

NAMES = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"]
SHAPE = ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]


def names_of(degree: int) -> list[str]:
    return [*NAMES, *(f"f_rest_{i}" for i in range(3 * ((degree + 1) ** 2 - 1))), *SHAPE]


def values_of(count: int, degree: int) -> np.ndarray:
    values = np.random.default_rng(degree).normal(size=(count, len(names_of(degree)))).astype(np.float32)
    values[:, -4:] /= np.linalg.norm(values[:, -4:], axis=1, keepdims=True)
    return values


def header(names: list[str], count: object, form: str = "binary_little_endian", more: str = "") -> bytes:
    lines = ["ply", f"format {form} 1.0", "comment made by a test", f"element vertex {count}"]
    lines += [f"property float {name}" for name in names]
    return ("\n".join(lines) + "\n" + more + "end_header\n").encode()


def write_ply(path: Path, values: np.ndarray, degree: int, form: str = "binary_little_endian") -> Path:
    order = {"binary_little_endian": "<f4", "binary_big_endian": ">f4"}.get(form)
    if order is None:
        body = "".join(" ".join(f"{value:.9g}" for value in row) + "\n" for row in values).encode()
    else:
        body = values.astype(order).tobytes()
    path.write_bytes(header(names_of(degree), len(values), form) + body)
    return path


@pytest.mark.parametrize("form", ["binary_little_endian", "binary_big_endian", "ascii"])
@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_a_file_is_read_in_its_own_units(tmp_path: Path, degree: int, form: str) -> None:
    values, names = values_of(5, degree), names_of(degree)
    splats = read_ply(write_ply(tmp_path / "cloud.ply", values, degree, form))
    own = {name: values[:, names.index(name)].astype(np.float64) for name in names}
    np.testing.assert_array_equal(splats.positions[:, 1], own["y"].astype(np.float32))
    np.testing.assert_allclose(splats.scales[:, 2], np.exp(own["scale_2"]), rtol=1e-6)
    np.testing.assert_allclose(splats.opacities, 1 / (1 + np.exp(-own["opacity"])), rtol=1e-6)
    np.testing.assert_allclose(splats.orientations[:, 0], own["rot_0"], rtol=1e-5)
    assert splats.harmonics.shape == (5, (degree + 1) ** 2, 3)
    np.testing.assert_array_equal(splats.harmonics[:, 0, 1], own["f_dc_1"].astype(np.float32))
    each = (degree + 1) ** 2 - 1
    for channel in range(3 * (degree > 0)):
        found = splats.harmonics[:, 1:, channel]
        np.testing.assert_array_equal(found[:, 0], own[f"f_rest_{channel * each}"].astype(np.float32))
        np.testing.assert_array_equal(found[:, -1], own[f"f_rest_{channel * each + each - 1}"].astype(np.float32))


def test_splats_without_numbers_are_left_out(tmp_path: Path) -> None:
    values = values_of(4, 0)
    values[0, 0] = np.nan
    values[1, -4:] = 0
    values[2, -5] = 1000  # a logarithm whose size is infinite
    splats = read_ply(write_ply(tmp_path / "cloud.ply", values, 0))
    assert (len(splats.positions), splats.unusable) == (1, 3)


GOOD = names_of(0)
HOSTILE = {
    "nothing": b"",
    "another kind": b"\x89PNG\r\n\x1a\n" + bytes(100),
    "no end": b"ply\nformat ascii 1.0\n" + b"comment x\n" * 10_000,
    "one long line": b"ply\n" + b"x" * (1 << 20),
    "no format": b"ply\nelement vertex 1\nend_header\n",
    "another format": header(GOOD, 1, "binary_middle_endian"),
    "a mesh": header(["x", "y", "z"], 3, more="element face 1\nproperty list uchar int vertex_indices\n") + bytes(99),
    "faces first": b"ply\nformat ascii 1.0\nelement face 1\nend_header\n",
    "a list": header(GOOD, 1, more="property list uchar int more\n") + bytes(999),
    "two of a name": header([*GOOD, "x"], 1) + bytes(999),
    "too many properties": header([*GOOD, *(f"p{i}" for i in range(500))], 1) + bytes(9999),
    "no splats": header(GOOD, 0),
    "too many splats": header(GOOD, 10**12),
    "absurdly many splats": header(GOOD, "9" * 400),
    "negative": header(GOOD, -1),
    "cut short": header(GOOD, 100) + bytes(68 * 99),
    "odd harmonics": header([*GOOD, *(f"f_rest_{i}" for i in range(10))], 1) + bytes(999),
    "gaps in harmonics": header([*GOOD, *(f"f_rest_{i + 1}" for i in range(9))], 1) + bytes(999),
    "no numbers": header(GOOD, 2) + np.full(34, np.nan, np.float32).tobytes(),
    "words": header(GOOD, 1, "ascii") + b" ".join([b"one"] * 17) + b"\n",
    "ragged lines": header(GOOD, 2, "ascii") + b"1 " * 17 + b"\n" + b"1 " * 16 + b"\n",
    "too few lines": header(GOOD, 2, "ascii") + b"1.2345 " * 17 + b"\n",
}


@pytest.mark.parametrize("content", HOSTILE.values(), ids=HOSTILE)
def test_files_that_cannot_be_used_are_one_error(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "cloud.ply"
    file.write_bytes(content)
    with pytest.raises(InputError, match=r"cloud\.ply") as caught:
        read_ply(file)
    assert "\n" not in caught.value.detail
    assert len(caught.value.detail) < 300


def test_folders_and_missing_files_are_errors(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "none.ply"):
        with pytest.raises(InputError):
            read_ply(path)


@pytest.mark.parametrize("suffix", [".usda", ".usdc"])
def test_a_written_layer_is_read_as_the_same_splats(tmp_path: Path, suffix: str) -> None:
    captured = read_ply(write_ply(tmp_path / "cloud.ply", values_of(6, 2), 2))
    layer = tmp_path / f"cloud{suffix}"
    write_splats(layer, captured, up="-y", metres=0.5)
    reader = StageReader(open_stage(layer))
    (batch,) = reader.read(0).splats
    assert not reader.findings
    np.testing.assert_allclose(batch.cloud.positions, captured.positions, rtol=1e-6)
    np.testing.assert_allclose(batch.cloud.harmonics, captured.harmonics, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(batch.cloud.axes, axis=1), captured.scales, rtol=1e-5)
    np.testing.assert_allclose(batch.poses[0], np.diag([0.5, -0.5, -0.5, 1]), atol=1e-7)
    assert [file.name for file in tmp_path.iterdir() if file.name.startswith(".")] == []


@pytest.mark.parametrize("up", ["-y", "y", "z", "-z"])
def test_the_direction_that_is_up_is_turned_up(tmp_path: Path, up: str) -> None:
    captured = read_ply(write_ply(tmp_path / "cloud.ply", values_of(2, 0), 0))
    write_splats(tmp_path / "cloud.usda", captured, up=up)  # type: ignore[arg-type]
    (batch,) = StageReader(open_stage(tmp_path / "cloud.usda")).read(0).splats
    direction = np.zeros(3)
    direction["xyz".index(up[-1])] = -1 if up[0] == "-" else 1
    np.testing.assert_allclose(batch.poses[0, :3, :3] @ direction, [0, 1, 0], atol=1e-7)


def test_the_command_writes_a_layer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pullfocus, values = Command(capsys), values_of(3, 0)
    values[0, 0] = np.inf
    cloud, layer = write_ply(tmp_path / "cloud.ply", values, 0), tmp_path / "set.usdc"
    ended = pullfocus("splats", str(cloud), str(layer), "--scale", "2")
    assert ended.status == 0
    assert "2 splats at /Splats" in ended.out
    assert "1 splats are left out" in ended.err
    assert len(StageReader(open_stage(layer)).read(0).splats[0].cloud.positions) == 2


@pytest.mark.parametrize(
    ("name", "options", "status"),
    [("set.obj", (), 2), ("set.usdc", ("--scale", "0"), 2), ("none/set.usdc", (), 1), ("set.usdc", ("--up", "x"), 2)],
)
def test_wrong_arguments_write_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, options: tuple[str, ...], status: int
) -> None:
    cloud = write_ply(tmp_path / "cloud.ply", values_of(3, 0), 0)
    assert Command(capsys)("splats", str(cloud), str(tmp_path / name), *options).status == status
    assert [file.name for file in tmp_path.iterdir()] == ["cloud.ply"]
