"""UsdLux lights give the light that UsdLux says, whatever their size and the stage's units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

from render import colour
from render.model.scene import Light
from render.stage import StageReader, find_not_honoured
from render.stage.options import StageOptions
from tests.render.kits.stages import add_mesh, codes, new_stage, read, write_picture


def light_of(stage: Usd.Stage) -> Light:
    (light,) = read(stage).lights
    return light


def test_radiance_is_colour_times_intensity_times_exposure() -> None:
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    light.CreateIntensityAttr(3.0)
    light.CreateExposureAttr(2.0)
    light.CreateColorAttr(Gf.Vec3f(1.0, 0.5, 0.25))
    light.CreateRadiusAttr(0.2)
    found = light_of(stage)
    np.testing.assert_allclose(found.radiance, colour.rgb_to_working((12, 6, 3)), rtol=1e-5)
    assert (found.kind, found.radius_m) == ("sphere", pytest.approx(0.2))


def test_colour_temperature_is_honoured_where_enabled() -> None:
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    light.CreateColorTemperatureAttr(3000.0)
    plain = light_of(stage).radiance
    assert plain == pytest.approx((1, 1, 1), rel=1e-3)
    light.CreateEnableColorTemperatureAttr(True)
    red, green, blue = light_of(stage).radiance
    assert red > green > blue
    np.testing.assert_allclose(
        (red, green, blue), colour.rgb_to_working(tuple(UsdLux.BlackbodyTemperatureAsRgb(3000))), rtol=1e-5
    )


@pytest.mark.parametrize("size", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("kind", ["SphereLight", "DiskLight", "RectLight", "CylinderLight"])
def test_a_normalised_light_keeps_its_power_at_any_size(kind: str, size: float) -> None:
    stage = new_stage()
    prim = stage.DefinePrim("/l", kind)
    prim.GetAttribute("inputs:normalize").Set(True)
    UsdGeom.Xformable(prim).AddScaleOp().Set(Gf.Vec3f(size))
    light = light_of(stage)
    area = {
        "sphere": 4 * np.pi * light.radius_m**2,
        "disk": np.pi * light.radius_m**2,
        "rect": light.width_m * light.height_m,
        "cylinder": 2 * np.pi * light.radius_m * light.length_m,
    }[light.kind]
    assert light.radiance[0] * area == pytest.approx(1.0, rel=1e-3)


def test_normalising_counts_area_in_scene_units() -> None:
    """A shot that is converted from metres to centimetres, lights and all, keeps its normalised intensities' meaning."""
    radiance = []
    for metres_per_unit in (1.0, 0.01):
        stage = new_stage(metres_per_unit)
        light = UsdLux.RectLight.Define(stage, "/l")
        light.CreateNormalizeAttr(True)
        light.CreateWidthAttr(3.0)
        light.CreateHeightAttr(2.0)
        radiance.append(light_of(stage).radiance[0])
        assert light_of(stage).width_m == pytest.approx(3 * metres_per_unit)
    assert radiance == pytest.approx([1 / 6, 1 / 6], rel=1e-3)


def test_a_distant_light_gives_irradiance() -> None:
    stage = new_stage(0.01)
    light = UsdLux.DistantLight.Define(stage, "/l")
    light.CreateAngleAttr(2.0)
    light.CreateIntensityAttr(1000.0)
    disk = np.pi * np.sin(np.radians(1)) ** 2
    assert light_of(stage).radiance[0] == pytest.approx(1000 * disk, rel=1e-3)
    assert light_of(stage).angle_rad == pytest.approx(np.radians(2))
    light.CreateNormalizeAttr(True)
    assert light_of(stage).radiance[0] == pytest.approx(1000, rel=1e-3)
    light.GetAngleAttr().Set(0.0)
    light.GetNormalizeAttr().Set(False)
    assert light_of(stage).radiance[0] == pytest.approx(1000, rel=1e-3)


def test_a_light_shines_along_its_own_minus_z_on_a_z_up_stage_too() -> None:
    stage = new_stage(0.01, "Z")
    light = UsdLux.RectLight.Define(stage, "/l")
    light.AddTranslateOp().Set(Gf.Vec3d(0, 0, 300))
    light.AddScaleOp().Set(Gf.Vec3f(200, 100, 50))
    found = light_of(stage)
    np.testing.assert_allclose(found.pose[:3, 3], [0, 3, 0], atol=1e-9)
    np.testing.assert_allclose(-found.pose[:3, 2], [0, -1, 0], atol=1e-9)
    np.testing.assert_allclose(found.pose[:3, :3].T @ found.pose[:3, :3], np.eye(3), atol=1e-12)
    assert (found.width_m, found.height_m) == pytest.approx((2, 1))


def test_shaping_shadow_and_multipliers() -> None:
    stage = new_stage()
    prim = UsdLux.DiskLight.Define(stage, "/l").GetPrim()
    plain = light_of(stage)
    assert (plain.cone_angle_rad, plain.casts_shadow) == (pytest.approx(np.pi), True)
    shaping = UsdLux.ShapingAPI.Apply(prim)
    shaping.CreateShapingConeAngleAttr(30.0)
    shaping.CreateShapingConeSoftnessAttr(0.4)
    UsdLux.ShadowAPI.Apply(prim).CreateShadowEnableAttr(False)
    UsdLux.LightAPI(prim).CreateDiffuseAttr(0.5)
    UsdLux.LightAPI(prim).CreateSpecularAttr(0.25)
    found = light_of(stage)
    assert found.cone_angle_rad == pytest.approx(np.pi / 6)
    assert (found.cone_softness, found.diffuse, found.specular) == pytest.approx((0.4, 0.5, 0.25))
    assert not found.casts_shadow


def test_a_point_light_has_its_power_too() -> None:
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    light.CreateRadiusAttr(0.0)
    reader = StageReader(stage)
    assert reader.read(0).lights == ()
    assert codes(reader) == {"light_without_area"}
    light.CreateNormalizeAttr(True)
    found = light_of(stage)
    assert found.radiance[0] * 4 * np.pi * found.radius_m**2 == pytest.approx(1, rel=1e-3)


@pytest.mark.parametrize("kind", ["SphereLight", "DomeLight"])
def test_a_light_whose_numbers_are_not_finite_is_off(kind: str) -> None:
    stage = new_stage()
    stage.DefinePrim("/l", kind).GetAttribute("inputs:intensity").Set(float("nan"))
    reader = StageReader(stage)
    scene = reader.read(0)
    assert scene.lights == ()
    assert scene.dome is None or scene.dome.radiance == (0, 0, 0)
    assert codes(reader) == {"bad_light"}


def test_hidden_lights_are_off() -> None:
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    light.CreateVisibilityAttr().Set("invisible", 0)
    light.GetVisibilityAttr().Set("inherited", 10)
    reader = StageReader(stage)
    assert len(reader.read(0).lights) == 0
    assert len(reader.read(10).lights) == 1


def test_what_is_not_honoured_is_reported() -> None:
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    UsdLux.LightFilter.Define(stage, "/filter")
    light.GetFiltersRel().AddTarget("/filter")
    UsdLux.DomeLight.Define(stage, "/dome1")
    UsdLux.DomeLight.Define(stage, "/dome2")
    reader = StageReader(stage)
    scene = reader.read(0)
    assert len(scene.lights) == 1
    assert scene.dome is not None
    assert codes(reader) == {"second_dome", "unsupported_filter"}
    assert find_not_honoured(stage) == []


@pytest.mark.parametrize("kind", ["PluginLight", "Volume"])
def test_a_light_that_cannot_be_drawn_is_named(kind: str) -> None:
    stage = new_stage()
    prim = stage.DefinePrim("/l", kind)
    if kind == "Volume":
        UsdLux.VolumeLightAPI.Apply(prim)
    reader = StageReader(stage)
    assert reader.read(0).lights == ()
    assert "unsupported_light" in codes(reader)
    assert all(finding.path == "/l" for finding in reader.findings)


def test_a_cylinder_light_has_its_size() -> None:
    stage = new_stage(0.01)
    light = UsdLux.CylinderLight.Define(stage, "/l")
    light.CreateLengthAttr(100.0)
    light.CreateRadiusAttr(2.0)
    light.CreateTreatAsLineAttr(True)
    light.AddScaleOp().Set(Gf.Vec3f(3, 2, 2))
    found = light_of(stage)
    assert (found.kind, found.length_m, found.radius_m) == ("cylinder", pytest.approx(3.0), pytest.approx(0.04))
    np.testing.assert_allclose(found.pose[:3, :3], np.eye(3), atol=1e-12)
    light.CreateNormalizeAttr(True)
    assert light_of(stage).radiance[0] == pytest.approx(1 / (2 * np.pi * 4 * 300), rel=1e-3)  # its ends are dark
    light.GetRadiusAttr().Set(0.0)
    assert light_of(stage).radius_m > 0
    light.GetNormalizeAttr().Set(False)
    reader = StageReader(stage)
    assert reader.read(0).lights == ()
    assert codes(reader) == {"light_without_area"}
    assert find_not_honoured(stage) == []


def test_focus_and_the_colour_of_shadows_are_read() -> None:
    stage = new_stage()
    prim = UsdLux.DiskLight.Define(stage, "/l").GetPrim()
    shaping = UsdLux.ShapingAPI.Apply(prim)
    shaping.CreateShapingFocusAttr(3.0)
    shaping.CreateShapingFocusTintAttr(Gf.Vec3f(1, 0.5, 0))
    UsdLux.ShadowAPI.Apply(prim).CreateShadowColorAttr(Gf.Vec3f(0.25, 0, 0.5))
    found = light_of(stage)
    assert found.focus == 3.0
    np.testing.assert_allclose(found.focus_tint, colour.rgb_to_working((1, 0.5, 0)), rtol=1e-5)
    np.testing.assert_allclose(found.shadow_color, colour.rgb_to_working((0.25, 0, 0.5)), rtol=1e-5)
    assert find_not_honoured(stage) == []
    prim.GetAttribute("inputs:shadow:color").Set(Gf.Vec3f(float("nan"), 0, 0))
    prim.GetAttribute("inputs:shaping:focus").Set(float("inf"))
    assert np.isfinite([light_of(stage).focus, *light_of(stage).shadow_color]).all()


def test_how_far_shadows_reach_is_read() -> None:
    """In units of the stage; a negative distance, the default, is none."""
    stage = new_stage(0.01)
    shadow = UsdLux.ShadowAPI.Apply(UsdLux.DiskLight.Define(stage, "/l").GetPrim())
    assert np.isinf(light_of(stage).shadow_reach_m)
    shadow.CreateShadowDistanceAttr(200.0)
    shadow.CreateShadowFalloffAttr(50.0)
    shadow.CreateShadowFalloffGammaAttr(2.0)
    found = light_of(stage)
    assert (found.shadow_reach_m, found.shadow_fade_m, found.shadow_gamma) == pytest.approx((2.0, 0.5, 2.0))
    assert find_not_honoured(stage) == []
    shadow.GetShadowFalloffAttr().Set(900.0)
    shadow.GetShadowFalloffGammaAttr().Set(float("nan"))
    found = light_of(stage)
    assert (found.shadow_fade_m, found.shadow_gamma) == pytest.approx((2.0, 1.0))
    shadow.GetShadowDistanceAttr().Set(float("nan"))
    assert np.isinf(light_of(stage).shadow_reach_m)


def test_a_rect_light_has_its_picture(tmp_path: Path) -> None:
    stage = new_stage()
    pixels = np.zeros((2, 4, 3), np.float32)
    pixels[0, 0] = 5.0
    light = UsdLux.RectLight.Define(stage, "/l")
    light.CreateTextureFileAttr(write_picture(tmp_path / "card.exr", pixels))
    found = light_of(stage)
    assert found.image is not None
    np.testing.assert_allclose(found.image.pixels[0, 0, :3], 5, rtol=2e-3)
    assert find_not_honoured(stage) == []
    light.GetTextureFileAttr().Set(Sdf.AssetPath(str(tmp_path / "gone.exr")))
    reader = StageReader(stage)
    assert reader.read(0).lights[0].image is None
    assert [finding.message for finding in reader.findings if finding.code == "texture_unreadable"] == [
        f"texture {tmp_path}/gone.exr is missing; light /l shines evenly"
    ]


def test_a_mesh_shines_where_it_is() -> None:
    stage = new_stage(0.01)
    mesh = add_mesh(stage, "/board", [(0, 0, 0), (200, 0, 0), (200, 100, 0), (0, 100, 0)])
    UsdLux.MeshLightAPI.Apply(mesh.GetPrim())
    mesh.AddTranslateOp().Set(Gf.Vec3d(0, 0, 300))
    geometry = UsdLux.GeometryLight.Define(stage, "/old")
    geometry.CreateGeometryRel().AddTarget("/board")
    reader = StageReader(stage)
    scene = reader.read(0)
    assert {light.path for light in scene.lights} == {"/board", "/old"}
    for light in scene.lights:
        assert light.triangles is not None
        assert light.kind == "mesh"
        np.testing.assert_allclose(light.pose[:3, 3], [1, 0.5, 3])
        np.testing.assert_allclose(light.radius_m, np.hypot(1, 0.5))
        first, second, third = (light.triangles[:, corner] for corner in range(3))
        np.testing.assert_allclose(np.cross(second - first, third - first).sum(0) / 2, [0, 0, 2], atol=1e-9)
    assert len(scene.batches) == 1
    assert reader.findings == find_not_honoured(stage) == []
    mesh.CreateOrientationAttr("leftHanded")
    UsdLux.LightAPI(mesh.GetPrim()).CreateNormalizeAttr(True)
    turned = next(light for light in read(stage).lights if light.path == "/board")
    assert turned.triangles is not None
    assert np.cross(*np.diff(turned.triangles[0], axis=0))[2] < 0
    assert turned.radiance[0] == pytest.approx(1 / 20_000, rel=1e-3)


@pytest.mark.parametrize("fault", ["no points", "corners beyond", "no target"])
def test_a_mesh_that_cannot_shine_is_a_finding(fault: str) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/board")
    UsdLux.GeometryLight.Define(stage, "/l").CreateGeometryRel().AddTarget(
        "/none" if fault == "no target" else "/board"
    )
    if fault == "no points":
        mesh.GetPointsAttr().Clear()
    if fault == "corners beyond":
        mesh.GetFaceVertexIndicesAttr().Set([0, 1, 2, 99])
    reader = StageReader(stage)
    assert reader.read(0).lights == ()
    assert codes(reader) & {"bad_light", "light_without_area"}


def test_a_portal_changes_nothing() -> None:
    """It guides the sampling of a dome, which is not sampled."""
    stage = new_stage()
    portal = UsdLux.PortalLight.Define(stage, "/sky/portal")
    portal.CreateIntensityAttr(3.0)
    UsdLux.DomeLight.Define(stage, "/sky").CreatePortalsRel().AddTarget("/sky/portal")
    reader = StageReader(stage)
    assert reader.read(0).lights == ()
    assert reader.read(0).dome is not None
    assert reader.findings == find_not_honoured(stage) == []


def test_a_plain_light_has_no_findings() -> None:
    stage = new_stage()
    placed = ("SphereLight", "DiskLight", "RectLight", "CylinderLight", "DistantLight")
    for kind in (*placed, "DomeLight", "DomeLight_1"):
        prim = UsdLux.LightAPI(stage.DefinePrim(f"/{kind}", kind)).GetPrim()
        if kind != "DomeLight_1":
            UsdLux.ShadowAPI.Apply(prim)
    stage.RemovePrim("/DomeLight")
    reader = StageReader(stage)
    assert len(reader.read(0).lights) == len(placed)
    assert reader.findings == find_not_honoured(stage) == []


def test_a_dome_has_its_picture_and_its_turn(tmp_path: Path) -> None:
    stage = new_stage()
    pixels = np.zeros((4, 8, 3), np.float32)
    pixels[0] = 5.0
    dome = UsdLux.DomeLight.Define(stage, "/dome")
    dome.CreateTextureFileAttr(write_picture(tmp_path / "sky.exr", pixels))
    dome.CreateIntensityAttr(2.0)
    dome.CreateDiffuseAttr(0.5)
    dome.CreateSpecularAttr(0.25)
    dome.AddRotateYOp().Set(90.0)
    found = read(stage).dome
    assert found is not None
    assert found.image is not None
    np.testing.assert_allclose(found.image.pixels[0, 0, :3], 5, rtol=2e-3)
    np.testing.assert_allclose(found.radiance, [2, 2, 2], rtol=1e-3)
    assert (found.diffuse, found.specular) == (0.5, 0.25)
    np.testing.assert_allclose(found.pose[:3, :3] @ [0, 0, 1], [1, 0, 0], atol=1e-9)


@pytest.mark.parametrize("kind", ["DomeLight", "DomeLight_1"])
def test_a_dome_turns_over_time(kind: str) -> None:
    stage = new_stage()
    turn = UsdGeom.Xformable(stage.DefinePrim("/dome", kind)).AddRotateYOp()
    turn.Set(0.0, 1)
    turn.Set(90.0, 3)
    reader = StageReader(stage)
    for time, ahead in ((1, [0, 0, 1]), (2, [0.5**0.5, 0, 0.5**0.5]), (3, [1, 0, 0])):
        found = reader.read(time).dome
        assert found is not None
        np.testing.assert_allclose(found.pose[:3, :3] @ [0, 0, 1], ahead, atol=1e-9)


@pytest.mark.parametrize(("kind", "top"), [("DomeLight", [0, 0, -1]), ("DomeLight_1", [0, 1, 0])])
def test_the_pole_of_a_dome_on_a_z_up_stage(kind: str, top: list[int]) -> None:
    """DomeLight's pole is its own +Y, which lies level on a Z-up stage; DomeLight_1's is the stage's up axis."""
    stage = new_stage(1.0, "Z")
    stage.DefinePrim("/dome", kind)
    found = read(stage).dome
    assert found is not None
    np.testing.assert_allclose(found.pose[:3, :3] @ [0, 1, 0], top, atol=1e-9)


def test_a_subdivision_surface_shines_from_its_limit() -> None:
    """A cube of 2 units shrinks to a ball of about a third of its area (9.2 of 24), whatever the camera."""
    stage = new_stage()
    mesh = UsdGeom.Mesh.Define(stage, "/cube")
    mesh.CreatePointsAttr([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    mesh.CreateFaceVertexIndicesAttr([0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6])
    UsdLux.MeshLightAPI.Apply(mesh.GetPrim())
    for complexity, area in (("low", 24.0), ("auto", 9.2)):
        (light,) = StageReader(stage, StageOptions(complexity=complexity)).read(0).lights
        assert light.triangles is not None
        first, second, third = (light.triangles[:, corner] for corner in range(3))
        found = np.linalg.norm(np.cross(second - first, third - first), axis=1).sum() / 2
        assert found == pytest.approx(area, rel=0.05)
