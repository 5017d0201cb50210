"""Assembly of meshes into a `Scene` of few draws: meshes of one look are merged into one batch, as by the stage reader."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from render.demo.shapes.mesh import Mesh, merge
from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Geometry, Image, Light, Material, Scene, TextureLookup, Wrap

MODEL_SCALE = 1 / 26
"""The scenes are models of streets and halls: a lens of 35 mm at f/1.4 blurs by 30 px both ways only where it is focused within
half a metre."""


@dataclass(frozen=True)
class Look:
    """Material, and whether its surfaces are double-sided."""

    material: Material
    double_sided: bool = False


_SCALED_DOWN: DoubleArray = np.diag([MODEL_SCALE, MODEL_SCALE, MODEL_SCALE, 1.0])


@dataclass
class Assembly:
    """Collects the objects of a scene.

    Attributes:
        looks: by name.
    """

    looks: dict[str, Look]
    _merged: dict[str, list[tuple[Mesh, int]]] = field(default_factory=dict)
    _instanced: list[Batch] = field(default_factory=list)
    _paths: list[str] = field(default_factory=list)

    def add(self, look: str, mesh: Mesh, path: str) -> None:
        """Add a mesh at its position, in metres before the model is scaled down."""
        self._merged.setdefault(look, []).append((mesh, self._prim(path)))

    def add_instances(self, look: str, mesh: Mesh, poses: DoubleArray, path: str) -> None:
        """Add a mesh at each of ``(k, 4, 4)`` poses, as one draw."""
        prim = self._prim(path)
        material = self.looks[look]
        geometry = _geometry([(mesh, prim)])
        numbers = np.arange(len(poses), dtype=np.int32)
        self._instanced.append(
            Batch(
                geometry,
                material.material,
                _SCALED_DOWN @ poses,
                material.double_sided,
                np.full(len(poses), prim, np.int32),
                numbers,
            )
        )

    def scene(self, lights: tuple[Light, ...], dome: Dome) -> Scene:
        """The scene, one batch for each look and each set of instances."""
        merged = tuple(
            Batch(_geometry(parts), self.looks[name].material, _SCALED_DOWN[None], self.looks[name].double_sided)
            for name, parts in self._merged.items()
        )
        return Scene((*merged, *self._instanced), lights, dome, tuple(self._paths))

    def _prim(self, path: str) -> int:
        if path not in self._paths:
            self._paths.append(path)
        return self._paths.index(path)


def textured(
    image: Image, tile_m: float | tuple[float, float] = 1.0, *, clamped: bool = False, channel: int = -1
) -> TextureLookup:
    """A look-up that repeats the image every ``tile_m`` of texture coordinates (metres on most shapes)."""
    across, up = tile_m if isinstance(tile_m, tuple) else (tile_m, tile_m)
    transform = np.array([[1 / across, 0, 0], [0, 1 / up, 0]], np.float32)
    wrap: Wrap = "clamp" if clamped else "repeat"
    return TextureLookup(image, transform, wrap_s=wrap, wrap_t=wrap, channel=channel)


def poses_at(
    places: DoubleArray, turns_rad: FloatArray | DoubleArray | float = 0.0, scales: DoubleArray | float = 1.0
) -> DoubleArray:
    """``(k, 4, 4)`` poses that scale, turn about +Y and move to ``places`` ``(k, 3)`` metres."""
    places = np.asarray(places, np.float64)
    turn, scale = np.broadcast_to(turns_rad, len(places)), np.broadcast_to(scales, len(places))
    poses = np.tile(np.eye(4), (len(places), 1, 1))
    poses[:, 0, 0] = poses[:, 2, 2] = np.cos(turn)
    poses[:, 0, 2], poses[:, 2, 0] = np.sin(turn), -np.sin(turn)
    poses[:, :3, :3] *= scale[:, None, None]
    poses[:, :3, 3] = places
    return poses


def look_at(eye: tuple[float, float, float], target: tuple[float, float, float]) -> DoubleArray:
    """``(4, 4)`` pose at ``eye`` whose -Z points to ``target`` and whose +Y is upward."""
    back = np.asarray(eye, np.float64) - target
    back /= np.linalg.norm(back)
    right = np.cross([0.0, 1, 0], back)
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(back, right), back], axis=1)
    pose[:3, 3] = eye
    return pose


def bench_camera(
    eye: tuple[float, float, float], target: tuple[float, float, float], focus_m: float, path: str
) -> Camera:
    """A camera of 35 mm at f/1.4 before a 24 by 18 mm gate; places and the distance in focus are those before scaling down."""
    world = look_at(eye, target)
    world[:3, 3] *= MODEL_SCALE
    return Camera(
        world,
        focal_length_mm=35,
        horizontal_aperture_mm=24,
        vertical_aperture_mm=18,
        f_stop=1.4,
        focus_distance_m=focus_m * MODEL_SCALE,
        near_m=2.0 * MODEL_SCALE,
        path=path,
    )


def sun(radiance: tuple[float, float, float], along: tuple[float, float, float], path: str) -> Light:
    """A sun that shines along a direction and casts shadows."""
    return Light("distant", radiance, look_at((0, 0, 0), along), angle_rad=0.01, path=path)


def lamp_lights(
    places: DoubleArray, radiance: tuple[float, float, float], radius_m: float, path: str
) -> tuple[Light, ...]:
    """Shadowless spheres of light at ``places`` ``(k, 3)``, lengths those before scaling down; paths are numbered."""
    return tuple(
        Light("sphere", radiance, pose, radius_m=radius_m * MODEL_SCALE, casts_shadow=False, path=f"{path}{i}")
        for i, pose in enumerate(poses_at(MODEL_SCALE * places))
    )


def _geometry(parts: list[tuple[Mesh, int]]) -> Geometry:
    mesh = merge(part for part, _ in parts)
    triangles = [_triangles(part) for part, _ in parts]
    starts = np.cumsum([0] + [len(part.points) for part, _ in parts[:-1]])
    prims: list[IntArray] = [np.full(len(t), prim, np.int32) for t, (_, prim) in zip(triangles, parts, strict=True)]
    joined = np.concatenate([t + start for t, start in zip(triangles, starts, strict=True)]).astype(np.int32)
    return Geometry(
        positions=mesh.points.astype(np.float32),
        normals=mesh.normals.astype(np.float32),
        triangles=joined,
        prim_ids=np.concatenate(prims),
        face_ids=np.concatenate([np.arange(len(t), dtype=np.int32) for t in triangles]),
        fan_ids=np.zeros(len(joined), np.int32),
        uvs=mesh.uvs.astype(np.float32),
    )


def _triangles(mesh: Mesh) -> IntArray:
    q = mesh.quads
    halves = np.stack([q[:, [0, 1, 2]], q[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
    return np.concatenate([halves, mesh.triangles]).astype(np.int32)
