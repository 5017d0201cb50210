"""A configuration and a chart of scene-linear light for tests of colour."""

from __future__ import annotations

import numpy as np

from render.model.arrays import FloatArray

# A studio's own configuration: it works in linear Rec. 709 and has no names in common with USD's.
OWN_CONFIG = """
ocio_profile_version: 2.3
roles: {default: Studio Linear, scene_linear: Studio Linear, aces_interchange: AP0, data: Numbers}
file_rules: [!<Rule> {name: Default, colorspace: Studio Linear}]
displays: {Monitor: [!<View> {name: Plain, colorspace: Studio Linear}]}
colorspaces:
  - !<ColorSpace> {name: AP0}
  - !<ColorSpace> {name: Numbers, isdata: true}
  - !<ColorSpace>
    name: Studio Linear
    to_scene_reference: !<MatrixTransform>
      matrix: [0.439632982, 0.382988698, 0.17737832, 0, 0.0897764431, 0.813439429, 0.0967841284, 0,
               0.0175411704, 0.111546553, 0.870912277, 0, 0, 0, 0, 1]
"""

LOOK_WITH_A_FILE = """
looks: [!<Look> {name: Dusk, process_space: Studio Linear, transform: !<FileTransform> {src: FILE}}]
"""
"""Addition to a configuration: a look by a file, FILE."""


def chart() -> FloatArray:
    """Greys, the colours of things and of lamps, and some that no thing has: ``(12, 36, 3)`` float32 in the working space.

    Rows: greys from 12 stops under to 8 stops over middle grey; hues at rising saturation and light up to 16; and last
    colours outside of the working space's triangle, as wide-gamut cameras deliver them.
    """
    greys = np.repeat(0.18 * 2.0 ** np.linspace(-12, 8, 36)[:, None], 3, axis=1)
    rows = [greys]
    phase = 2 * np.pi * (np.arange(36)[:, None] / 36 + np.arange(3) / 3)
    for light, saturation in zip(np.geomspace(0.01, 16, 10), np.linspace(0.2, 1, 10), strict=True):
        rows.append(light * (1 + saturation * np.cos(phase)))
    rows.append(0.5 * (0.9 + 1.2 * np.cos(phase)))
    return np.asarray(rows, np.float32)
