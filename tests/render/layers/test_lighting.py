"""Light by closed forms: what a white wall sends back under lights whose irradiance is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.layers.materials import INPUTS, LEAST_GLASS_OPACITY, HalfTexture, PreviewSurface
from render.model.scene import Batch, Dome, Image, Light, LitBy, Material, Scene, TextureLookup
from render.optics.view import PinholeView
from tests.render.kits.lit_walls import CAMERA, MATT, WALL, centre_radiance, facing_the_wall, lit


def test_a_distant_light(renderer: FrameRenderer) -> None:
    """L = ρ·E/π."""
    sun = Light("distant", (2.0, 1.0, 0.5), np.eye(4))
    np.testing.assert_allclose(centre_radiance(renderer, lit(sun)), 0.5 / np.pi * np.array([2, 1, 0.5]), rtol=2e-3)


def test_a_sphere_light_by_the_inverse_square(renderer: FrameRenderer) -> None:
    """E = π·L·(r/d)²: Lambert's sphere, exact above the horizon."""
    for d in (1.0, 2.0):
        bulb = Light("sphere", (50.0,) * 3, facing_the_wall(d), radius_m=0.1)
        assert centre_radiance(renderer, lit(bulb))[0] == pytest.approx(0.5 * 50 * 0.01 / d**2, rel=2e-3)


def test_a_disk_light_on_its_axis(renderer: FrameRenderer) -> None:
    """E = π·L·r²/(d² + r²): exact on the axis of a disc."""
    disk = Light("disk", (3.0,) * 3, facing_the_wall(1.5), radius_m=0.8)
    assert centre_radiance(renderer, lit(disk))[0] == pytest.approx(0.5 * 3 * 0.64 / (2.25 + 0.64), rel=2e-3)


def test_a_rect_light_shines_one_way(renderer: FrameRenderer) -> None:
    away = facing_the_wall(1.0) @ np.diag([-1.0, 1, -1, 1])
    assert centre_radiance(renderer, lit(Light("rect", (3.0,) * 3, away, width_m=1, height_m=1)))[0] == 0
    small = Light("rect", (300.0,) * 3, facing_the_wall(2.0), width_m=0.1, height_m=0.2)
    assert centre_radiance(renderer, lit(small))[0] == pytest.approx(0.5 / np.pi * 300 * 0.02 / 4, rel=4e-3)


def test_a_uniform_dome_is_a_furnace(renderer: FrameRenderer) -> None:
    """A white Lambert surface under the same light from everywhere has that light's radiance, less its faint sheen's share."""
    white = replace(WALL, material=replace(MATT, base_color=(1.0, 1.0, 1.0)))
    got = centre_radiance(renderer, lit(batches=(white,), dome=Dome((0.7, 0.7, 0.7), np.eye(4), visible=False)))
    np.testing.assert_allclose(got, 0.7, rtol=0.01)


def test_a_dome_image_lights_from_where_it_is_bright(renderer: FrameRenderer) -> None:
    """Bright above (row 0 looks up): a floor is lit, a ceiling is not. E/π of a cap of half angle θ overhead: L·sin²θ."""
    pixels = np.zeros((64, 128, 4), np.float16)
    pixels[:16, :, :3] = 4.0
    dome = Dome((1, 1, 1), np.eye(4), Image(pixels), visible=False)
    floor = Batch(rectangle((0, 0, -4), (40, 0, 0), (0, 0, -40)), MATT, np.eye(4)[None], double_sided=True)
    down = np.eye(4)
    down[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    down[:3, 3] = [0, 2, -4]
    from_above = replace(CAMERA, world_from_camera=down)
    frame = renderer.render(lit(batches=(floor,), dome=dome), from_above, FrameSettings(9, 9, rays=1, engine="pinhole"))
    assert frame.color[4, 4, 0] == pytest.approx(0.5 * 4 * np.sin(np.pi / 4) ** 2, rel=0.01)
    up = np.eye(4)
    up[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    up[:3, 3] = [0, -2, -4]
    below = renderer.render(
        lit(batches=(floor,), dome=dome),
        replace(CAMERA, world_from_camera=up),
        FrameSettings(9, 9, rays=1, engine="pinhole"),
    )
    assert below.color[4, 4, 0] < 0.1


@pytest.mark.parametrize("place", [(3, 20), (31, 5), (40, 126), (62, 64)])
def test_a_small_sun_in_a_dome_lights_by_its_cosine(renderer: FrameRenderer, place: tuple[int, int]) -> None:
    """The integral over one bright pixel, for normals all around: within 1.5 % of the most."""
    pixels = np.zeros((64, 128, 4), np.float16)
    pixels[place] = 1000.0
    theta, phi = (place[0] + 0.5) / 64 * np.pi, (0.5 - (place[1] + 0.5) / 128) * 2 * np.pi
    sun = np.array([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)])
    most = 0.5 / np.pi * 1000 * (np.cos(place[0] / 64 * np.pi) - np.cos((place[0] + 1) / 64 * np.pi)) * 2 * np.pi / 128
    dome = Dome((1, 1, 1), np.eye(4), Image(pixels), visible=False)
    for normal in ([0.0, 0, 1], [0, 1, 0], [0, -1, 0], [0.6, 0.64, 0.48], [-0.8, 0.1, -0.5], [0.1, 0.99, 0.05]):
        n = np.array(normal) / np.linalg.norm(normal)
        side = np.cross([0, 0, 1.0] if abs(n[2]) < 0.9 else [1.0, 0, 0], n)
        side /= np.linalg.norm(side)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([side, np.cross(n, side), n], axis=1)
        pose[:3, 3] = 4 * n
        board = Batch(rectangle((0, 0, 0), tuple(5 * side), tuple(5 * np.cross(n, side))), MATT, np.eye(4)[None])
        settings = FrameSettings(9, 9, rays=1, supersample=1, engine="pinhole")
        camera = replace(CAMERA, world_from_camera=pose)
        shown = renderer.render(lit(batches=(board,), dome=dome), camera, settings).color[4, 4, 0]
        assert shown == pytest.approx(most * max(float(n @ sun), 0.0), abs=0.015 * most)


def test_the_camera_sees_the_dome_the_right_way_round(renderer: FrameRenderer) -> None:
    """OpenEXR's latitude-longitude map: the centre looks along +Z and +X lies to its left. Looking along -Z we see the seam;
    to the camera's right (+X) is the column a quarter from the left."""
    pixels = np.zeros((64, 128, 4), np.float16)
    pixels[:, 28:36, 0] = 1.0
    dome = Dome((1, 1, 1), np.eye(4), Image(pixels))
    right = np.eye(4)
    right[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]  # -Z of the camera along +X
    frame = renderer.render(Scene((), (), dome), replace(CAMERA, world_from_camera=right), FrameSettings(9, 9, rays=1))
    np.testing.assert_allclose(frame.color[4, 4], [1, 0, 0, 0], atol=1e-3)
    ahead = renderer.render(Scene((), (), dome), CAMERA, FrameSettings(9, 9, rays=1))
    assert ahead.color[4, 4, 0] == 0


def test_the_background_is_black_without_a_dome_that_shows(renderer: FrameRenderer) -> None:
    """Also after a picture with one, whose textures are used again."""
    settings = FrameSettings(9, 9, rays=1)
    shown = Dome((1, 1, 1), np.eye(4))
    for dome in (None, replace(shown, visible=False), replace(shown, radiance=(0.0, 0.0, 0.0))):
        assert renderer.render(Scene((), (), shown), CAMERA, settings).color[..., :3].min() > 0.9
        assert not renderer.render(Scene((), (), dome), CAMERA, settings).color.any()


def test_a_shadow_falls_where_the_light_is_hidden(renderer: FrameRenderer) -> None:
    ball = Batch(sphere((0.0, 0.0, -2.0), 0.3, prim=1), MATT, np.eye(4)[None])
    pose = np.eye(4)
    pose[:3, 3] = [1.0, 0.0, -0.5]  # the light, the ball and the wall's (-4/3, 0, -4) are on a line
    for kind, size in (("sphere", {"radius_m": 0.05}), ("disk", {"radius_m": 0.1}), ("distant", {})):
        aimed = pose.copy()
        direction = np.array([-1.0, 0, -1.5]) / np.linalg.norm([1.0, 1.5])
        aimed[:3, 2], aimed[:3, 1] = -direction, [0, 1, 0]
        aimed[:3, 0] = np.cross(aimed[:3, 1], aimed[:3, 2])
        lamp = Light(kind, (500.0,) * 3, aimed, **size)  # type: ignore[arg-type]
        hidden = (np.array([-4 / 3 / 4, 0.0]) * 0.5 * 2 + 0.5) * 90
        frames = [
            renderer.render(
                lit(replace(lamp, casts_shadow=casts), batches=(WALL, ball)), CAMERA, FrameSettings(90, 90, rays=4)
            )
            for casts in (True, False)
        ]
        x, y = int(hidden[0]), 45
        assert frames[1].color[y, x, 0] > 0.001, kind
        assert frames[0].color[y, x, 0] < 0.05 * frames[1].color[y, x, 0], kind
        np.testing.assert_allclose(frames[0].color[8, 80], frames[1].color[8, 80], rtol=1e-3, err_msg=kind)


def test_each_of_six_bulbs_casts_its_shadow(renderer: FrameRenderer) -> None:
    """Light adds up, shadows included."""
    ball = Batch(sphere((0.0, 0.0, -2.0), 0.3, prim=1), MATT, np.eye(4)[None])
    lamps = []
    for turn in np.arange(6) * np.pi / 3:
        pose = np.eye(4)
        pose[:3, 3] = [np.cos(turn), np.sin(turn), -0.5]
        lamps.append(Light("sphere", (500.0,) * 3, pose, radius_m=0.05, path=f"/lamp{len(lamps)}"))
    settings = FrameSettings(60, 60, rays=1, supersample=1, engine="pinhole")
    together, *alone = (
        renderer.render(lit(*each, batches=(WALL, ball)), CAMERA, settings).color[..., 0]
        for each in (lamps, *([x] for x in lamps))
    )
    np.testing.assert_allclose(together, np.sum(alone, axis=0), rtol=2e-3, atol=1e-3)
    shadows = [picture < 0.02 * picture.max() for picture in alone]
    assert all((shadow & ~other).any() for shadow in shadows for other in shadows if other is not shadow)


def test_a_shaping_cone_ends_the_light(renderer: FrameRenderer) -> None:
    spot = Light("sphere", (50.0,) * 3, facing_the_wall(2.0), radius_m=0.1, cone_angle_rad=0.3)
    frame = renderer.render(lit(spot), CAMERA, FrameSettings(91, 91, rays=4))
    edge_px = 45.5 + 2 * np.tan(0.3) / 4 * 91
    assert frame.color[45, int(edge_px) - 3, 0] > 0.02
    assert frame.color[45, int(edge_px) + 3, 0] == 0


def test_the_edge_of_a_cone_is_soft_by_its_angle(renderer: FrameRenderer) -> None:
    """A smooth step from the angle times 1 - softness to the angle (hdEmbree's lightSamplers.cpp, as of USD 25.02)."""
    plain = Light("sphere", (50.0,) * 3, facing_the_wall(2.0), radius_m=0.1)
    for turn in (0.1, 0.5, 0.9):
        pose = plain.pose.copy()
        pose[:3, :3] = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
        spot = replace(plain, pose=pose, cone_angle_rad=1.0, cone_softness=0.8)
        along = np.clip((turn - 0.2) / 0.8, 0, 1)
        expected = (1 - along**2 * (3 - 2 * along)) * centre_radiance(renderer, lit(plain))[0]
        assert centre_radiance(renderer, lit(spot))[0] == pytest.approx(expected, rel=0.01)


def test_unlit_is_the_base_colour(renderer: FrameRenderer) -> None:
    pixels = np.zeros((2, 2, 4), np.float16)
    pixels[..., :] = [0.2, 0.4, 0.6, 1.0]
    textured = replace(
        MATT, lookups={"base_color": TextureLookup(Image(pixels), scale=np.array([2, 1, 1, 1], np.float32))}
    )
    geometry = replace(WALL.geometry, uvs=np.zeros((4, 2), np.float32))
    scene = lit(batches=(replace(WALL, geometry=geometry, material=textured),))
    np.testing.assert_allclose(centre_radiance(renderer, scene, "unlit"), [0.4, 0.4, 0.6], rtol=2e-3)


def test_row_0_of_an_image_is_at_the_top(renderer: FrameRenderer) -> None:
    """t = 1 is the top of a picture in USD, and row 0 of the array."""
    pixels = np.zeros((2, 2, 4), np.float16)
    pixels[0, 0, 0] = pixels[1, 1, 1] = 1.0  # red top left, green bottom right
    material = replace(MATT, lookups={"base_color": TextureLookup(Image(pixels), wrap_s="clamp", wrap_t="clamp")})
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    card = rectangle((0, 0, -1), (0.5, 0, 0), (0, 0.5, 0))
    scene = lit(batches=(Batch(replace(card, uvs=corners), material, np.eye(4)[None]),))
    frame = renderer.render(scene, CAMERA, FrameSettings(40, 40, rays=1, engine="pinhole", shading="unlit"))
    np.testing.assert_allclose(frame.color[2, 2, :3], [1, 0, 0], atol=1e-3)
    np.testing.assert_allclose(frame.color[37, 37, :3], [0, 1, 0], atol=1e-3)


def test_a_scene_with_no_light_is_lit_from_the_camera(renderer: FrameRenderer) -> None:
    dark = Scene((WALL,), (), None, ("/wall",))
    assert centre_radiance(renderer, dark)[0] == pytest.approx(0.5, rel=0.02)


@pytest.mark.parametrize(("lit_by", "with_sun", "with_sky"), [("camera", 0.5, 0.5), ("both", 1.0, 0.9)])
def test_a_lit_scene_may_be_lit_from_the_camera(
    renderer: FrameRenderer, lit_by: LitBy, with_sun: float, with_sky: float
) -> None:
    """Beside the stage's lights, the faint dome gives way to the stage's."""
    sun = Light("distant", (np.pi,) * 3, facing_the_wall(2.0), casts_shadow=False)
    lights = replace(lit(sun, dome=None), lit_by=lit_by), replace(lit(dome=Dome((1.0,) * 3, np.eye(4))), lit_by=lit_by)
    found = [centre_radiance(renderer, scene)[0] for scene in lights]
    assert found == pytest.approx([with_sun, with_sky], rel=0.02)


def test_a_scene_with_no_light_stays_dark_if_asked(renderer: FrameRenderer) -> None:
    dark = Scene((WALL,), (), None, ("/wall",), lit_by="stage")
    assert centre_radiance(renderer, dark)[0] == 0


@pytest.mark.parametrize(("radius_m", "roughness"), [(0.1, 0.2), (0.2, 0.4), (0.2, 0.1), (0.5, 0.2)])
def test_a_highlight_keeps_the_light_that_its_lobe_gathers(
    renderer: FrameRenderer, radius_m: float, roughness: float
) -> None:
    """A white metal plate that mirrors a sphere light to the eye: radiance over the light's is the share of the GGX lobe that
    the light fills. For a lobe about a mirror at normal incidence and a cap of half angle t: 1 - 1/(1 + tan²(t/2)/α²)."""
    plate = replace(WALL, material=Material(base_color=(1, 1, 1), metallic=1.0, roughness=roughness))
    bulb = Light("sphere", (1.0,) * 3, facing_the_wall(2.0), radius_m=radius_m)
    half_angle, alpha = np.arcsin(radius_m / 2.0), roughness**2
    gathered = 1 - 1 / (1 + np.tan(half_angle / 2) ** 2 / alpha**2)
    assert centre_radiance(renderer, lit(bulb, batches=(plate,)))[0] == pytest.approx(gathered, rel=0.12)


def test_a_flattened_instance_is_lit_and_finite(renderer: FrameRenderer) -> None:
    """A scale of zero leaves no normal; the triangle's own takes its place."""
    pose = np.diag([1.0, 1, 0, 1])
    pose[2, 3] = -4.0
    flat = replace(WALL, poses=pose[None], double_sided=True)
    sun = Light("distant", (2.0,) * 3, np.eye(4))
    np.testing.assert_allclose(centre_radiance(renderer, lit(sun, batches=(flat,))), 1 / np.pi, rtol=0.01)


def test_the_sun_casts_a_small_shadow_in_a_large_world(renderer: FrameRenderer) -> None:
    """A ball over a ground of two kilometres: its shadow is there, though one map over all of it could not show it."""
    down = np.eye(4)
    down[:3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    ground = Batch(rectangle((0, -1, 0), (1000, 0, 0), (0, 0, -1000)), MATT, np.eye(4)[None])
    ball = Batch(sphere((0, 0, -5), 0.5, prim=1), MATT, np.eye(4)[None])
    camera = replace(CAMERA, focus_distance_m=5.0, vertical_offset_mm=-12)
    sun = Light("distant", (3.0,) * 3, down)
    pixels, _ = PinholeView.from_camera(camera, 90, 90).project(np.array([[0.0, -1.0, -5.0]]))
    x, y = pixels[0].astype(int)
    shadow, open_ground = (
        renderer.render(lit(sun, batches=batches), camera, FrameSettings(90, 90, rays=4)).color[y, x, 0]
        for batches in ((ground, ball), (ground,))
    )
    assert open_ground > 0.3
    assert shadow < 0.05 * open_ground


@pytest.mark.parametrize("workflow", ["metallic", "specular"])
def test_maps_of_one_value_are_as_the_value_itself(renderer: FrameRenderer, workflow: str) -> None:
    values: dict[str, tuple[float, float, float]] = {
        "base_color": (0.6, 0.3, 0.2),
        "emissive": (0.1, 0.2, 0.3),
        workflow: (0.5, 0.5, 0.5),
        "roughness": (0.4, 0.4, 0.4),
        "clearcoat": (0.8, 0.8, 0.8),
        "clearcoat_roughness": (0.2, 0.2, 0.2),
        "ior": (1.8, 1.8, 1.8),
    }
    scalars = {"metallic", "roughness", "occlusion", "clearcoat", "clearcoat_roughness", "ior"}
    plain = Material(**{name: value[0] if name in scalars else value for name, value in values.items()})  # type: ignore[arg-type]
    lookups = {
        name: TextureLookup(Image(np.tile(np.float16([*value, 1]), (2, 2, 1))), channel=0 if name in scalars else -1)
        for name, value in {**values, "occlusion": (1.0, 1.0, 1.0), "normal": (0.0, 0.0, 1.0)}.items()
    }
    mapped = Material(specular=(0, 0, 0) if workflow == "specular" else None, lookups=lookups)
    board = replace(WALL.geometry, uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32))
    sun = Light("distant", (2.0, 1.0, 0.5), np.eye(4))
    seen = [
        centre_radiance(renderer, lit(sun, batches=(Batch(board, material, np.eye(4)[None]),)))
        for material in (mapped, plain)
    ]
    np.testing.assert_allclose(*seen, rtol=3e-3)


@pytest.mark.parametrize("opacity", [0.0, 0.25, 0.75])
def test_opacity_of_glass_fades_its_diffuse_light_alone(renderer: FrameRenderer, opacity: float) -> None:
    """Against a fading pane, whose light is that of an opaque one times its opacity."""
    sun = Light("distant", (2.0, 2.0, 2.0), np.eye(4))

    def seen(fades: bool, opacity: float, base: float) -> float:
        look = Material("", (base,) * 3, (0.1,) * 3, roughness=0.4, opacity=opacity, fades_highlights=fades)
        return float(centre_radiance(renderer, lit(sun, batches=(replace(WALL, material=look),)))[0])

    highlight, whole = seen(True, 1.0, 0.0), seen(True, 1.0, 0.5)
    assert seen(True, opacity, 0.5) == pytest.approx(opacity * whole, rel=3e-3)
    shown = max(opacity, LEAST_GLASS_OPACITY)
    assert seen(False, opacity, 0.5) == pytest.approx(highlight + shown * (whole - highlight), rel=3e-3)


def test_constant_occlusion_dims_the_dome(renderer: FrameRenderer) -> None:
    dome = Dome((0.7, 0.7, 0.7), np.eye(4), visible=False)
    seen = [
        centre_radiance(renderer, lit(batches=(replace(WALL, material=replace(MATT, occlusion=share)),), dome=dome))
        for share in (1.0, 0.25)
    ]
    np.testing.assert_allclose(seen[1], 0.25 * seen[0], rtol=3e-3)


def test_inputs_that_share_an_image_share_its_unit(renderer: FrameRenderer) -> None:
    """Eleven inputs of one image, and more than there are texture units if each had one."""
    image = Image(np.full((2, 2, 4), 0.5, np.float16))
    scalars = {"metallic", "roughness", "opacity", "occlusion", "clearcoat", "clearcoat_roughness", "ior"}
    lookups = {name: TextureLookup(image, channel=0 if name in scalars else -1) for name in INPUTS}
    look = PreviewSurface(Material(lookups=lookups), dict.fromkeys(lookups, HalfTexture(image)))
    assert set(look.units) == {0}
    board = replace(WALL.geometry, uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32))
    batch = Batch(board, Material(lookups=lookups), np.eye(4)[None])
    shown = centre_radiance(renderer, lit(batches=(batch,)), "unlit")
    np.testing.assert_allclose(shown, 0.25, rtol=3e-3)
