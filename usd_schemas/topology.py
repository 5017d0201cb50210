"""A fingerprint of a mesh's topology, so that a focus point can tell whether its face still means the same."""

from __future__ import annotations

import hashlib

import numpy as np
from pxr import Usd, UsdGeom, Vt


def topology_fingerprint(mesh: UsdGeom.Mesh, time: float | None = None) -> str:
    """Sixteen hexadecimal digits of the mesh's face counts and indices at a time; points may move, faces may not."""
    code = Usd.TimeCode.EarliestTime() if time is None else Usd.TimeCode(time)
    digest = hashlib.sha256()
    for attribute in (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()):
        authored = attribute.Get(code)
        values = np.asarray(authored if isinstance(authored, Vt.IntArray) else [], "<i4")
        digest.update(np.int64(len(values)).tobytes() + values.tobytes())
    return digest.hexdigest()[:16]
