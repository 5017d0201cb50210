"""Light of tubes, of rects with images and of focused lights, by integrals over their surfaces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.layers.facets import gather_facets
from render.layers.light_parts import light_parts
from render.layers.lights import MAX_LIGHTS
from render.model.arrays import DoubleArray
from render.model.scene import PROFILE_SHAPE, Batch, Dome, Image, Light, Material
from tests.render.kits.lit_walls import CAMERA, WALL, centre_radiance, facing_the_wall, lit


def turned(pose: DoubleArray, about_y: float) -> DoubleArray:
    """A pose turned about its own Y axis, radians."""
    turn = np.eye(4)
    turn[:3, :3] = [[np.cos(about_y), 0, np.sin(about_y)], [0, 1, 0], [-np.sin(about_y), 0, np.cos(about_y)]]
    return pose @ turn


def tube(pose: DoubleArray, length_m: float, radius_m: float) -> Light:
    return Light("cylinder", (3.0,) * 3, pose, length_m=length_m, radius_m=radius_m, casts_shadow=False)


def irradiance_of_tube(light: Light, point: DoubleArray, normal: DoubleArray) -> float:
    """Integral over the side of a cylinder, whose radiance is 1."""
    x = (np.arange(2000) + 0.5) / 2000 * light.length_m - light.length_m / 2
    angle = (np.arange(360) + 0.5) / 360 * 2 * np.pi
    outwards = np.stack([np.zeros_like(angle), np.cos(angle), np.sin(angle)], axis=-1)
    places = np.zeros((len(x), len(angle), 3)) + light.radius_m * outwards
    places[..., 0] += x[:, None]
    places = places @ light.pose[:3, :3].T + light.pose[:3, 3]
    toward = places - point
    d2 = (toward**2).sum(-1)
    leaving = np.clip(-(toward * (outwards @ light.pose[:3, :3].T)).sum(-1), 0, None)
    arriving = np.clip(toward @ normal, 0, None)
    area = light.length_m / len(x) * light.radius_m * 2 * np.pi / len(angle)
    return float((leaving * arriving / d2**2).sum() * area)


@pytest.mark.parametrize(
    ("distance_m", "length_m", "radius_m", "turn"),
    [
        (10.0, 1.0, 0.05, 0.0),  # far away: a point that shines as 2·r·length
        (0.5, 3.0, 0.1, 0.0),
        (1.0, 4.0, 0.3, 0.5),
        (0.7, 2.0, 0.05, 1.2),  # its end is behind the wall
        (2.0, 1.0, 0.02, 1.5),  # seen nearly along its axis
        (1.0, 0.2, 0.2, 0.0),  # as wide as it is long
    ],
)
def test_a_tube_lights_as_its_surface_does(
    renderer: FrameRenderer, distance_m: float, length_m: float, radius_m: float, turn: float
) -> None:
    light = tube(turned(facing_the_wall(distance_m), turn), length_m, radius_m)
    expected = 0.5 / np.pi * 3.0 * irradiance_of_tube(light, np.array([0, 0, -4.0]), np.array([0, 0, 1.0]))
    assert centre_radiance(renderer, lit(light))[0] == pytest.approx(expected, rel=0.011)


def test_an_endless_tube_by_its_view_factor(renderer: FrameRenderer) -> None:
    """E = π·L·r/d for an endless cylinder and a surface that faces it (Siegel & Howell, Thermal Radiation Heat Transfer)."""
    for d in (0.5, 2.0):
        light = tube(facing_the_wall(d), 2000.0, 0.1)
        assert centre_radiance(renderer, lit(light))[0] == pytest.approx(0.5 * 3 * 0.1 / d, rel=3e-3)


def test_a_tube_behind_a_wall_does_not_light_it(renderer: FrameRenderer) -> None:
    assert centre_radiance(renderer, lit(tube(facing_the_wall(-1.0), 2.0, 0.1)))[0] == 0


@pytest.mark.parametrize(
    ("roughness", "elevation", "turn", "length_m", "beside_m"),
    [
        (0.3, 90.0, 0.0, 1.0, 0.0),
        (0.3, 25.0, 0.0, 3.0, 0.0),  # grazing: the lobe is narrow along the tube
        (0.3, 40.0, 90.0, 1.0, 0.0),
        (0.25, 30.0, 15.0, 3.0, 1.2),
        (0.5, 40.0, 0.0, 3.0, 1.6),  # beyond the tube's end
    ],
)
def test_a_highlight_of_a_tube_keeps_its_light(
    renderer: FrameRenderer, roughness: float, elevation: float, turn: float, length_m: float, beside_m: float
) -> None:
    """A white metal plate that mirrors the tube to the eye: the integral of the GGX lobe over the tube's solid angle."""
    plate = Material(base_color=(1, 1, 1), metallic=1.0, roughness=roughness)
    floor = Batch(rectangle((0, 0, 0), (40, 0, 0), (0, 40, 0)), plate, np.eye(4)[None])
    up, around, alpha = np.radians(elevation), np.radians(turn), roughness**2
    eye = np.array([0, -np.cos(up), np.sin(up)])
    camera, pose = np.eye(4), np.eye(4)
    camera[:3, 1], camera[:3, 2], camera[:3, 3] = np.cross(eye, [1, 0, 0]), eye, 3 * eye
    axis = pose[:3, 0] = np.array([np.cos(around), np.sin(around), 0])
    pose[:3, 1], pose[:3, 3] = np.cross([0, 0, 1], axis), [beside_m, 2.2 * np.cos(up), 2.2 * np.sin(up)]
    along = (np.arange(8000) + 0.5) / 8000 * length_m - length_m / 2
    toward = pose[:3, 3] + along[:, None] * axis
    d2 = (toward**2).sum(1)
    toward /= np.sqrt(d2)[:, None]
    solid_angle = 2 * 0.02 * np.sqrt(1 - (toward @ axis) ** 2) / d2 * length_m / len(along)
    half_vector = (toward + eye) / np.linalg.norm(toward + eye, axis=1)[:, None]
    nl, nv, nh = toward[:, 2], eye[2], half_vector[:, 2]
    smith = [near * np.sqrt(far**2 * (1 - alpha**2) + alpha**2) for near, far in ((nl, nv), (nv, nl))]
    brdf = alpha**2 / (np.pi * (nh**2 * (alpha**2 - 1) + 1) ** 2) * 0.5 / (smith[0] + smith[1])
    expected = 3.0 * float((brdf * nl * solid_angle).sum())
    scene = lit(tube(pose, length_m, 0.02), batches=(floor,))
    settings = FrameSettings(9, 9, rays=1, supersample=1, engine="pinhole")
    shown = renderer.render(scene, replace(CAMERA, world_from_camera=camera), settings).color[4, 4, 0]
    assert shown == pytest.approx(expected, rel=0.04)


def test_a_tube_casts_shadows(renderer: FrameRenderer) -> None:
    board = replace(WALL, geometry=rectangle((0, 0, -3.5), (0.2, 0, 0), (0, 0.2, 0), prim=1))
    light = replace(tube(facing_the_wall(1.0), 0.2, 0.02), casts_shadow=True)
    # the board hides the middle of the wall from the tube; the camera stands between
    open_wall = centre_radiance(renderer, lit(light))[0]
    pose = np.eye(4)
    pose[2, 3] = -3.8
    assert open_wall > 0.001
    near = replace(CAMERA, world_from_camera=pose)
    frame = renderer.render(lit(light, batches=(WALL, board)), near, FrameSettings(9, 9, rays=1, engine="pinhole"))
    assert frame.color[4, 4, 0] < 0.02 * open_wall


def checked(bright: tuple[slice, slice]) -> Image:
    pixels = np.zeros((8, 8, 4), np.float16)
    pixels[bright] = 1.0
    return Image(pixels)


def test_a_rect_of_one_colour_is_as_its_image(renderer: FrameRenderer) -> None:
    plain = Light("rect", (3.0,) * 3, facing_the_wall(2.0), width_m=0.5, height_m=0.4)
    pixels = np.ones((3, 5, 4), np.float16) * np.float16([0.5, 0.25, 1.0, 1.0])
    pictured = replace(plain, image=Image(pixels))
    expected = centre_radiance(renderer, lit(plain)) * [0.5, 0.25, 1.0]
    np.testing.assert_allclose(centre_radiance(renderer, lit(pictured)), expected, rtol=5e-3)


def test_an_image_near_a_wall_lights_what_is_near(renderer: FrameRenderer) -> None:
    """A quarter of a rect shines, close to a corner: the integral over that quarter."""
    light = Light("rect", (2.0,) * 3, facing_the_wall(0.8), width_m=2.0, height_m=2.0, casts_shadow=False)
    shining = {
        "top at +X": (checked((slice(0, 4), slice(0, 4))), (0.5, 0.5)),
        "bottom at -X": (checked((slice(4, 8), slice(4, 8))), (-0.5, -0.5)),
        "top at -X": (checked((slice(0, 4), slice(4, 8))), (-0.5, 0.5)),
    }
    for name, (image, (x, y)) in shining.items():
        places = (np.arange(200) + 0.5) / 200 - 0.5
        d2 = (places[:, None] + x) ** 2 + (places + y) ** 2 + 0.8**2
        expected = 0.5 / np.pi * 2.0 * float((0.8**2 / d2**2).mean())
        shown = centre_radiance(renderer, lit(replace(light, image=image)))[0]
        assert shown == pytest.approx(expected, rel=0.08), name


def test_each_part_of_an_image_stands_in_its_place() -> None:
    """A texture's least coordinates are at (+X, +Y), its greatest at (-X, -Y) (UsdLuxRectLight's comment). hdEmbree mirrors
    them."""
    image = checked((slice(0, 2), slice(0, 2)))
    light = Light("rect", (1.0, 2.0, 4.0), facing_the_wall(1.0), width_m=4.0, height_m=8.0, image=image)
    (parts,) = light_parts([light])
    assert len(parts) == 16
    bright = [part for part in parts if part.radiance[0] > 0]
    assert [part.radiance for part in bright] == [pytest.approx((1, 2, 4))]
    np.testing.assert_allclose(bright[0].pose[:3, 3], [1.5, 3.0, -3.0])  # row 0 at +Y, column 0 at +X
    assert (bright[0].width_m, bright[0].height_m) == (1.0, 2.0)


def test_images_share_the_room_for_lights() -> None:
    image = checked((slice(0, 8), slice(0, 4)))
    light = Light("rect", (1.0,) * 3, np.eye(4), width_m=1.0, height_m=1.0, image=image)
    for count in (6, 7, 20, 40, MAX_LIGHTS):
        parts = light_parts([light] * count)
        assert sum(map(len, parts)) <= MAX_LIGHTS
        power = sum(part.radiance[0] * part.width_m * part.height_m for part in parts[0])
        assert power == pytest.approx(0.5)


def test_focus_narrows_the_light_and_tints_the_rest(renderer: FrameRenderer) -> None:
    """The light's cosine to the power of the focus goes from the tint to all of it, behind too (UsdLux, ShapingAPI; hdEmbree)."""
    for turn in (0.0, 0.8, np.pi - 0.4):
        plain = Light("sphere", (50.0,) * 3, turned(facing_the_wall(2.0), turn), radius_m=0.1)
        share = np.cos(turn) ** 4
        focused = replace(plain, focus=4.0, focus_tint=(0.0, 0.5, 1.0))
        expected = centre_radiance(renderer, lit(plain)) * (share + (1 - share) * np.array([0, 0.5, 1]))
        np.testing.assert_allclose(centre_radiance(renderer, lit(focused)), expected, rtol=3e-3, atol=1e-6)


def test_a_profile_shines_in_its_directions(renderer: FrameRenderer) -> None:
    """A profile that grows with the angle from -Z, and has another strength in each quarter around it."""
    around, along = PROFILE_SHAPE
    quarters = np.arange(around) * 4 // around + 1.0
    profile = (quarters[:, None] * np.linspace(0, np.pi, along)).astype(np.float32)
    plain = Light("sphere", (50.0,) * 3, facing_the_wall(2.0), radius_m=0.1)
    for quarter, about_z in enumerate(np.pi / 4 + np.arange(4) * np.pi / 2):
        # the point of the wall before the eye lies 0.6 radians from -Z, in that direction around it
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(about_z), -np.sin(about_z)], [np.sin(about_z), np.cos(about_z)]]
        pose = turned(plain.pose, 0.6) @ np.linalg.inv(turn)
        light = replace(plain, pose=pose, profile=profile)
        expected = 0.6 * (quarter + 1) * centre_radiance(renderer, lit(replace(plain, pose=pose)))
        np.testing.assert_allclose(centre_radiance(renderer, lit(light)), expected, rtol=5e-3)


def test_a_dome_has_its_multipliers(renderer: FrameRenderer) -> None:
    mirror = replace(WALL, material=Material(base_color=(1, 1, 1), metallic=1.0, roughness=0.2))
    sky = Dome((0.7, 0.7, 0.7), np.eye(4), visible=False)
    for wall, responses in ((WALL, (0.25, 1.0)), (mirror, (1.0, 0.25))):
        dimmed = replace(sky, diffuse=responses[0], specular=responses[1])
        plain, got = (centre_radiance(renderer, lit(batches=(wall,), dome=dome)) for dome in (sky, dimmed))
        np.testing.assert_allclose(got, 0.25 * plain, rtol=0.02)


def mesh_light(triangles: DoubleArray) -> Light:
    middle = np.eye(4)
    middle[:3, 3] = triangles.mean((0, 1))
    radius_m = float(np.linalg.norm(triangles - middle[:3, 3], axis=2).max())
    return Light("mesh", (3.0,) * 3, middle, triangles=triangles, radius_m=radius_m, casts_shadow=False)


def test_a_ball_that_shines_is_as_a_sphere_light(renderer: FrameRenderer) -> None:
    """E = π·L·(r/d)²; of 16 facets a few are seen."""
    for d in (1.0, 3.0):
        ball = sphere((0.0, 0.0, -4.0 + d), 0.3)
        light = mesh_light(ball.positions[ball.triangles].astype(np.float64))
        assert centre_radiance(renderer, lit(light))[0] == pytest.approx(0.5 * 3 * 0.09 / d**2, rel=0.07)


def test_a_board_that_shines_by_the_integral_over_it(renderer: FrameRenderer) -> None:
    """A square with a side of 2 m that two triangles cover, 1.5 m before a wall; it shines one way."""
    corners = np.array([[-1, -1, -2.5], [1, -1, -2.5], [1, 1, -2.5], [-1, 1, -2.5]])
    triangles = corners[[[0, 2, 1], [0, 3, 2]]]
    places = (np.arange(400) + 0.5) / 200 - 1
    d2 = places[:, None] ** 2 + places**2 + 1.5**2
    expected = 0.5 / np.pi * 3 * 4 * float((1.5**2 / d2**2).mean())
    assert centre_radiance(renderer, lit(mesh_light(triangles)))[0] == pytest.approx(expected, rel=0.05)
    assert centre_radiance(renderer, lit(mesh_light(triangles[:, ::-1])))[0] == 0


def test_shadows_of_a_mesh_are_seen_from_its_middle(renderer: FrameRenderer) -> None:
    """Its parts stand beside it; what hides the middle hides them all, whichever of the six maps it is in."""
    ball = sphere((0.0, 0.0, -2.0), 0.4)
    shining = replace(mesh_light(ball.positions[ball.triangles].astype(np.float64)), casts_shadow=True)
    board = replace(WALL, geometry=rectangle((0, 0, -3.0), (1.0, 0, 0), (0, 1.0, 0), prim=1))
    pose = np.eye(4)
    pose[2, 3] = -3.5
    near = replace(CAMERA, world_from_camera=pose)
    settings = FrameSettings(9, 9, rays=1, supersample=1, engine="pinhole")
    shown = [
        renderer.render(lit(shining, batches=batches), near, settings).color[..., 0]
        for batches in ((WALL, board), (WALL,))
    ]
    assert shown[1].min() > 0.01
    assert shown[0].max() < 0.02 * shown[1].min()


def test_facets_keep_the_area_vector_of_a_surface() -> None:
    """Half of a ball: its facets add up to the disc that closes it, π·r²."""
    ball = sphere((0.0, 0.0, 0.0), 1.0)
    triangles = ball.positions[ball.triangles].astype(np.float64)
    half = triangles[triangles.mean(1)[:, 2] > 0]
    for count in (1, 4, 16):
        facets = gather_facets(half, count)
        assert len(facets) == count
        np.testing.assert_allclose(facets[:, 3:].sum(0), [0, 0, np.pi], rtol=0.03, atol=0.03)
    assert len(gather_facets(np.zeros((3, 3, 3)), 16)) == 0
