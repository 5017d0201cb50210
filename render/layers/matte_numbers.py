"""Numbers of surfaces for mattes: what the ids that layers hold stand for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.errors import SettingsError
from render.layers.index import Draw
from render.model.arrays import IntArray
from render.model.mattes import MatteSum
from render.model.scene import Batch, Scene
from render.model.splats import MOST_MATTE_CLOUDS


@dataclass(frozen=True, eq=False)
class MatteNumbers:
    """Numbers of the surfaces of a scene.

    Attributes:
        objects: ``(n, 2)`` uint32 for each object number of the index: where its numbers begin, and 1 where each triangle has
            one, 0 where there is one for all.
        surfaces: ``(m,)`` uint32 numbers of `MatteSum.number`.
        is_deep: `MatteSum.is_deep`.
        splats: numbers of the scene's batches of splats; 0 of those that are held out.
    """

    objects: NDArray[np.uint32]
    surfaces: NDArray[np.uint32]
    is_deep: bool = False
    splats: tuple[int, ...] = ()


def number_surfaces(draws: Sequence[Draw], scene: Scene, mattes: MatteSum) -> MatteNumbers:
    """Number the surfaces of draws.

    Args:
        draws: draws of the index, in its order.
        scene: the scene that they draw.
        mattes: gives the numbers.

    Raises:
        SettingsError: there are more clouds of splats than mattes tell apart.
    """
    if len(scene.splats) > MOST_MATTE_CLOUDS:
        raise SettingsError(
            f"mattes tell up to {MOST_MATTE_CLOUDS} clouds of Gaussian splats apart, and the shot has {len(scene.splats)}: "
            "leave the mattes out, or join clouds"
        )
    splats = tuple(
        0 if batch.is_holdout else mattes.number(scene.prim_paths[batch.prim_id], "") for batch in scene.splats
    )
    objects, surfaces = [np.zeros((0, 2), np.uint32)], [np.zeros(0, np.uint32)]
    used = 0
    for draw in draws:
        prims, materials, each_triangle = _ids(draw.batch)
        if not each_triangle:
            prims, materials = prims[draw.instances], materials[draw.instances]
        numbers = _number(prims, materials, scene, mattes)
        count = len(draw.instances)
        if each_triangle and (numbers == numbers[:1]).all():
            each_triangle, numbers = False, np.repeat(numbers[:1], count)
        first = np.full(count, used) if each_triangle else used + np.arange(count)
        objects.append(np.stack([first, np.full(count, each_triangle)], axis=1).astype(np.uint32))
        surfaces.append(numbers)
        used += len(numbers)
    return MatteNumbers(np.concatenate(objects), np.concatenate(surfaces), mattes.is_deep, splats)


def _ids(batch: Batch) -> tuple[IntArray, IntArray, bool]:
    """Prim and material of each triangle or, where an instance has its own, of each instance; and which of the two it is."""
    geometry = batch.geometry
    materials = geometry.material_ids
    if materials is None:
        materials = np.full(len(geometry.triangles), -1, np.int32)
    if batch.instance_prim_ids is None and batch.instance_material_ids is None:
        return geometry.prim_ids, materials, True
    count = len(batch.poses)
    prims = batch.instance_prim_ids
    own = batch.instance_material_ids
    return (
        np.repeat(geometry.prim_ids[:1], count) if prims is None else prims,
        np.repeat(materials[:1], count) if own is None else own,
        False,
    )


def _number(prims: IntArray, materials: IntArray, scene: Scene, mattes: MatteSum) -> NDArray[np.uint32]:
    """Numbers of pairs of a prim and a material."""
    pairs, which = np.unique(prims.astype(np.int64) << 32 | (materials + 1), return_inverse=True)
    numbers = [
        mattes.number(scene.prim_paths[pair >> 32], scene.material_paths[material - 1] if material else "")
        for pair, material in zip(pairs.tolist(), (pairs & 0xFFFFFFFF).tolist(), strict=True)
    ]
    return np.array(numbers, np.uint32)[which]
