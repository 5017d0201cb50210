"""A polygon mesh as arrays, and what is done to any mesh: move it, join it, count it.

Lengths are metres, +Y is up, faces are counter-clockwise seen from outside. Vertices are doubled where normals or texture
coordinates break, so that everything is one value for each vertex. Texture coordinates are lengths in metres too, unless
a shape says otherwise; materials scale them to their picture (UsdTransform2d).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int32]


def _no_faces(corners: int) -> Indices:
    return np.zeros((0, corners), np.int32)


@dataclass(frozen=True, eq=False)
class Mesh:
    """Quads and triangles over shared vertices.

    Attributes:
        points: ``(n, 3)`` metres.
        normals: ``(n, 3)`` unit length.
        uvs: ``(n, 2)`` texture coordinates.
        quads: ``(m, 4)`` vertex indices.
        triangles: ``(k, 3)`` vertex indices.
    """

    points: Array
    normals: Array
    uvs: Array
    quads: Indices = field(default_factory=lambda: _no_faces(4))
    triangles: Indices = field(default_factory=lambda: _no_faces(3))

    @property
    def triangle_count(self) -> int:
        """Triangles drawn: a quad is two."""
        return 2 * len(self.quads) + len(self.triangles)

    def transform(self, matrix: Array) -> Mesh:
        """The mesh under an affine ``(4, 4)`` matrix for column vectors; a mirroring one keeps faces outward."""
        linear = matrix[:3, :3]
        normals = self.normals @ np.linalg.inv(linear)
        mesh = replace(
            self,
            points=self.points @ linear.T + matrix[:3, 3],
            normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        )
        if np.linalg.det(linear) >= 0:
            return mesh
        return replace(mesh, quads=self.quads[:, ::-1], triangles=self.triangles[:, ::-1])

    def at(self, x: float, y: float, z: float) -> Mesh:
        """The mesh moved by an offset in metres."""
        return replace(self, points=self.points + np.array([x, y, z]))

    def rotate(self, *, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        """The mesh turned about the axes, in degrees; X first, then Y, then Z."""
        return self.transform(rotation(x=x, y=y, z=z))

    def scale(self, x: float, y: float | None = None, z: float | None = None) -> Mesh:
        """The mesh scaled about the origin; one number scales all ways alike."""
        factors = [x, x if y is None else y, x if z is None else z, 1.0]
        return self.transform(np.diag(factors).astype(np.float64))


def merge(meshes: Iterable[Mesh]) -> Mesh:
    """Joins meshes into one, in the order given."""
    parts = list(meshes)
    starts = np.cumsum([0] + [len(part.points) for part in parts])
    return Mesh(
        points=np.concatenate([part.points for part in parts]),
        normals=np.concatenate([part.normals for part in parts]),
        uvs=np.concatenate([part.uvs for part in parts]),
        quads=np.concatenate([part.quads + start for part, start in zip(parts, starts, strict=False)]).astype(np.int32),
        triangles=np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=False)]).astype(
            np.int32
        ),
    )


def rotation(*, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Array:
    """``(4, 4)`` rotation for column vectors, in degrees about the axes: X first, then Y, then Z."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians([x, y, z])), np.sin(np.radians([x, y, z]))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    matrix = np.eye(4)
    matrix[:3, :3] = about_z @ about_y @ about_x
    return matrix


def translation(offset: ArrayLike) -> Array:
    """``(4, 4)`` translation for column vectors, in metres."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix


def unit(vectors: Array) -> Array:
    """Vectors along the last axis scaled to length 1; a zero vector becomes +Y."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.maximum(lengths, 1e-12), np.array([0.0, 1.0, 0.0]))
