"""Sets of UDIM tiles: each tile at its own unit square of texture coordinates, and nothing of it beyond."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdShade, UsdUtils

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.unlit import looked_up
from render.layers.texture_budget import TEXTURE_BUDGET_BYTES
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Scene, TextureLookup
from render.model.udim import layers_at, tile_bits, tiles_at
from render.shot.focus.opacity import opacity_at
from render.stage import StageReader
from render.stage.materials import textures
from render.stage.opening import open_stage
from tests.render.kits.stages import T, add_mesh, add_textured_material, codes, new_stage, set_primvar, write_picture

GREYS = {1001: 50, 1002: 100, 1011: 150, 1100: 200}
FALLBACK = 0.125
SETTINGS = FrameSettings(40, 40, rays=1, engine="pinhole", shading="unlit")
CAMERA = Camera(np.eye(4), 50, 36, 36)


def write_tiles(folder: Path, greys: dict[int, int] = GREYS, side: int = 2) -> None:
    """Tiles of one grey each, of unlike sizes."""
    for number, grey in greys.items():
        height, width = (side, side) if number == 1001 else (1, side) if number == 1002 else (2 * side, side)
        write_picture(folder / f"t.{number}.png", np.full((height, width, 3), grey, np.uint8))


def tiled_stage(folder: Path, corners: tuple[tuple[float, float], ...]) -> Usd.Stage:
    """A stage in a file, with a square from -1 to 1 at z = -2.8, whose corners have texture coordinates."""
    stage = new_stage()
    mesh = add_mesh(stage, "/m", [(-1, -1, -2.8), (1, -1, -2.8), (1, 1, -2.8), (-1, 1, -2.8)])
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "vertex", corners)
    texture = add_textured_material(stage, mesh.GetPrim(), "./t.<UDIM>.png")
    texture.CreateInput("sourceColorSpace", T.Token).Set("raw")
    texture.CreateInput("wrapS", T.Token).Set("repeat")
    texture.CreateInput("fallback", T.Float4).Set(Gf.Vec4f(FALLBACK))
    stage.GetRootLayer().Export(str(folder / "a.usda"))
    return Usd.Stage.Open(str(folder / "a.usda"))


def square(low: tuple[float, float], side: float) -> tuple[tuple[float, float], ...]:
    return tuple((low[0] + side * x, low[1] + side * y) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))


def lookup_of(reader: StageReader) -> TextureLookup:
    return reader.read(0).batches[0].material.lookups["base_color"]


def draw(renderer: FrameRenderer, scene: Scene) -> FloatArray:
    """The grey of each pixel, first row at the top."""
    renderer.forget_layers()
    return renderer.render(scene, CAMERA, SETTINGS).color[..., 1]


def test_each_tile_is_drawn_in_its_square(tmp_path: Path, renderer: FrameRenderer) -> None:
    """A missing tile shows the fallback, and no tile shows beyond its border."""
    write_tiles(tmp_path)
    picture = draw(renderer, StageReader(tiled_stage(tmp_path, square((0, 0), 2))).read(0))
    low, high = slice(1, 19), slice(21, 39)
    for rows, columns, number in ((high, low, 1001), (high, high, 1002), (low, low, 1011)):
        np.testing.assert_allclose(picture[rows, columns], GREYS[number] / 255, atol=2e-3)
    np.testing.assert_allclose(picture[low, high], FALLBACK, atol=2e-3)


def test_tiles_far_away_keep_to_themselves(tmp_path: Path, renderer: FrameRenderer) -> None:
    """A tile's smallest mip level is its own mean: 8 tiles across 40 pixels, black and white in turn."""
    write_tiles(tmp_path, {1001 + n: 255 * (n % 2) for n in range(8)}, side=64)
    picture = draw(renderer, StageReader(tiled_stage(tmp_path, square((0, 0), 8))).read(0))
    np.testing.assert_allclose(picture[37, 2::5], [0, 1] * 4, atol=1e-3)
    np.testing.assert_allclose(picture[32, 2::5], FALLBACK, atol=1e-3)


def test_a_set_is_read_with_all_its_tiles(tmp_path: Path) -> None:
    write_tiles(tmp_path)
    reader = StageReader(tiled_stage(tmp_path, square((0, 0), 1)))
    lookup = lookup_of(reader)
    assert lookup.image.tiles == tuple(GREYS)
    assert lookup.image.pixels.shape == (4, 4, 2, 4), "the highest and the widest"
    np.testing.assert_allclose(lookup.image.pixels[:, 0, 0, 0] * 255, list(GREYS.values()), rtol=2e-3)
    np.testing.assert_allclose(lookup.fallback[:3], FALLBACK, rtol=1e-3)
    assert codes(reader) == set(), "the surface uses the first tile alone"


@pytest.mark.parametrize(
    ("low", "named"),
    [
        ((1, 1), "tile 1012 of"),
        ((9, 9), ""),
        ((3, -1), "places outside of the tiles 1001 to 1100"),
        ((10, 0), "places"),
    ],
)
def test_missing_tiles_are_named(tmp_path: Path, low: tuple[float, float], named: str) -> None:
    write_tiles(tmp_path)
    reader = StageReader(tiled_stage(tmp_path, square(low, 1)))
    reader.read(0)
    messages = [finding.message for finding in reader.findings if finding.code == "udim_missing"]
    assert len(messages) == (1 if named else 0)
    assert all(named in message and message.startswith("/m uses") for message in messages)


def test_a_damaged_tile_is_named_and_others_stay(tmp_path: Path) -> None:
    write_tiles(tmp_path)
    (tmp_path / "t.1002.png").write_bytes(b"no picture")
    reader = StageReader(tiled_stage(tmp_path, square((0, 0), 1)))
    assert lookup_of(reader).image.tiles == (1001, 1011, 1100)
    (finding,) = reader.findings
    assert finding.code == "texture_unreadable"
    assert "tile 1002" in finding.message


def test_a_set_without_tiles_is_its_fallback(tmp_path: Path) -> None:
    (tmp_path / "t.1101.png").write_bytes(b"beyond the last row")
    reader = StageReader(tiled_stage(tmp_path, square((0, 0), 1)))
    material = reader.read(0).batches[0].material
    assert material.lookups == {}
    assert material.base_color == pytest.approx((FALLBACK,) * 3, abs=1e-3)
    assert "has no tiles from 1001 to 1100" in reader.findings[0].message


def test_a_tile_outside_of_the_shot_is_refused(tmp_path: Path) -> None:
    """The set's own path is inside; one of its tiles is a link that leaves."""
    inside = tmp_path / "shot"
    inside.mkdir()
    write_tiles(inside, {1001: 50})
    write_tiles(tmp_path, {1002: 100})
    (inside / "t.1002.png").symlink_to(tmp_path / "t.1002.png")
    tiled_stage(inside, square((0, 0), 1))
    reader = StageReader(open_stage(inside / "a.usda", confined_to=inside))
    assert lookup_of(reader).image.tiles == (1001,)
    assert any("tile 1002" in finding.message and "outside" in finding.message for finding in reader.findings)


def test_tiles_are_read_from_a_package(tmp_path: Path) -> None:
    write_tiles(tmp_path)
    tiled_stage(tmp_path, square((0, 0), 1))
    assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "a.usda"), str(tmp_path / "a.usdz"))
    for file in tmp_path.glob("t.*"):
        file.unlink()
    reader = StageReader(Usd.Stage.Open(str(tmp_path / "a.usdz")))
    assert lookup_of(reader).image.tiles == tuple(GREYS)


def test_large_sets_are_held_to_a_number_of_pixels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four tiles of at most 8 x 4 pixels have 128; half of the sides is a quarter of them."""
    write_tiles(tmp_path, side=4)
    monkeypatch.setattr(textures, "MAX_SET_PIXELS", 40)
    reader = StageReader(tiled_stage(tmp_path, square((0, 0), 1)))
    assert lookup_of(reader).image.pixels.shape[:3] == (4, 4, 2)
    messages = [finding.message for finding in reader.findings if finding.code == "texture_scaled"]
    assert "texture t.1011.png is 4 x 8 pixels and is drawn at 2 x 4" in messages


def test_a_small_tile_is_enlarged_between_its_pixels(tmp_path: Path) -> None:
    write_picture(tmp_path / "t.1001.png", np.array([[[0] * 3, [255] * 3]], np.uint8))
    write_picture(tmp_path / "t.1002.png", np.zeros((1, 4, 3), np.uint8))
    image = lookup_of(StageReader(tiled_stage(tmp_path, square((0, 0), 1)))).image
    np.testing.assert_allclose(image.pixels[0, 0, :, 0], [0, 0.25, 0.75, 1], atol=1e-3)


def test_tile_sets_within_a_small_budget_look_the_same(tmp_path: Path, renderer: FrameRenderer) -> None:
    """Tiles of 256 pixels seen at some 18: their finest levels are not needed."""
    noise = np.random.default_rng(5).integers(0, 255, (2, 256, 256, 3), np.uint8)
    for number, pixels in zip((1001, 1002), noise, strict=True):
        write_picture(tmp_path / f"t.{number}.png", pixels)
    scene = StageReader(tiled_stage(tmp_path, square((0, 0.2), 2))).read(0)
    budget = renderer.device.peeler.textures
    whole = draw(renderer, scene)
    try:
        budget.bytes = 300_000
        reduced = draw(renderer, scene)
        (texture,) = renderer.device.peeler.index.textures
        assert texture.bytes_from(texture.first_level) <= budget.bytes < texture.bytes_from(0)
    finally:
        budget.bytes = TEXTURE_BUDGET_BYTES
    np.testing.assert_allclose(reduced, whole, atol=1e-3)
    assert whole.std() > 0.05


def test_opacity_of_tiles_counts_for_lines_of_sight(tmp_path: Path) -> None:
    """The same tile at the same place as the reference's bilinear look-up, whose tiles are of one value each."""
    write_tiles(tmp_path)
    batch = StageReader(tiled_stage(tmp_path, square((0, 0), 2))).read(0).batches[0]
    lookup = replace(batch.material.lookups["base_color"], channel=1)
    batch = replace(batch, material=replace(batch.material, lookups={"opacity": lookup}))
    geometry = batch.geometry
    assert geometry.uvs is not None
    corners = geometry.triangles[[0, 0, 1, 1]]
    u, v = np.array([0.2, 0.7, 0.6, 0.1]), np.array([0.1, 0.2, 0.3, 0.8])
    places = np.einsum("nc,nck->nk", np.stack([1 - u - v, u, v], axis=1), geometry.uvs[corners])
    expected = looked_up(lookup, places)[:, 1]
    np.testing.assert_allclose(opacity_at(batch, corners, u, v, np.zeros(4, np.int64)), expected, atol=1e-3)
    assert len(set(np.round(expected, 3))) > 1


def test_tiles_are_numbered_from_the_lower_left() -> None:
    places = np.array([[0.5, 0.5], [1.0, 0.0], [9.99, 0.1], [0.1, 1.1], [9.5, 9.5], [-0.1, 0], [10.0, 0], [0, 10.0]])
    assert tiles_at(places).tolist() == [1001, 1002, 1010, 1011, 1100, 0, 0, 0]
    assert layers_at((1002, 1100), places).tolist() == [-1, 0, -1, -1, 1, -1, -1, -1]
    assert tile_bits((1001, 1033, 1100)) == (1, 1, 0, 8)


def test_a_set_may_become_an_image_over_time(tmp_path: Path) -> None:
    """A set at one time, and a single image at another."""
    write_tiles(tmp_path)
    stage = tiled_stage(tmp_path, square((0, 0), 1))
    file = UsdShade.Shader(stage.GetPrimAtPath("/looks/textured/diffuse")).GetInput("file")
    file.Set("./t.<UDIM>.png", 1)
    file.Set("./t.1001.png", 2)
    reader = StageReader(stage)
    kinds = [reader.read(time).batches[0].material.lookups["base_color"].image.tiles for time in (1, 2)]
    assert kinds == [tuple(GREYS), ()]
