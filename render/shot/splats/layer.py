"""Captured splats as a USD layer: a prim of the type ParticleField3DGaussianSplat."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, get_args

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, Vt

from render.files import explain_write_errors, replace_whole
from render.shot.splats.ply import CapturedSplats

PRIM = "/Splats"
UpAxis = Literal["-y", "y", "z", "-z"]
"""Direction of a capture that is up. In that of most programs y points down, as in the pictures that it is made of."""
UP_AXES: tuple[UpAxis, ...] = get_args(UpAxis)
_TURNS: dict[UpAxis, float] = {"-y": 180.0, "y": 0.0, "z": -90.0, "-z": 90.0}
"""Angle about x that turns each of them to +y, degrees."""
_EXTENT_SIGMAS = 3.0


def write_splats(path: Path, splats: CapturedSplats, *, up: UpAxis = "-y", metres: float = 1.0) -> None:
    """Write splats as a layer with one prim, which others reference.

    Args:
        path: the layer, of the kind that its name's ending says; an existing file is replaced.
        splats: the splats.
        up: direction of the capture that is up.
        metres: length of its unit.

    Raises:
        OutputError: it cannot be written.
    """
    layer = Sdf.Layer.CreateAnonymous(path.suffix)
    stage = Usd.Stage.Open(layer)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    prim = stage.DefinePrim(PRIM, "ParticleField3DGaussianSplat")
    stage.SetDefaultPrim(prim)
    placed = UsdGeom.Xformable(prim)
    placed.AddScaleOp().Set(Gf.Vec3f(metres))
    placed.AddRotateXOp().Set(_TURNS[up])
    turns = np.ascontiguousarray(splats.orientations[:, [1, 2, 3, 0]])
    reach = _EXTENT_SIGMAS * splats.scales.max(axis=1, keepdims=True)
    extent = np.stack([(splats.positions - reach).min(axis=0), (splats.positions + reach).max(axis=0)])
    coefficients = splats.harmonics.reshape(-1, 3)
    values = {
        "positions": Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(splats.positions)),
        "scales": Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(splats.scales)),
        "orientations": Vt.QuatfArray.FromNumpy(turns),
        "opacities": Vt.FloatArray.FromNumpy(np.ascontiguousarray(splats.opacities)),
        "radiance:sphericalHarmonicsDegree": splats.degree,
        "radiance:sphericalHarmonicsCoefficients": Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(coefficients)),
        "extent": Vt.Vec3fArray.FromNumpy(extent.astype(np.float32)),
    }
    for name, value in values.items():
        prim.GetAttribute(name).Set(value)
    prim.GetAttribute("radiance:sphericalHarmonicsCoefficients").SetColorSpace("srgb_rec709_scene")
    with replace_whole(path) as beside, explain_write_errors(path):
        named = beside.with_name(beside.name + path.suffix)
        try:
            layer.Export(str(named))
            named.rename(beside)
        except Tf.ErrorException as problem:
            raise OSError(" ".join(str(problem).split())[:200]) from problem
        finally:
            named.unlink(missing_ok=True)
