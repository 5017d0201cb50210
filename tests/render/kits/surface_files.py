"""Files of one element, whose first surface is to be filled in."""

from __future__ import annotations

ZEMAX = """MODE SEQ
UNIT MM
FNUM 8 0
SURF 0
  TYPE STANDARD
  CURV 0
  DISZ INFINITY
SURF 1
  TYPE {kind}
  CURV {curvature}
  CONI {conic}
{parameters}  DISZ 5
  GLAS N-BK7 0 0 1.5168 64.17
  DIAM 8
SURF 2
  STOP
  TYPE STANDARD
  CURV -0.02
  DISZ 60
  DIAM 8
SURF 3
  TYPE STANDARD
  CURV 0
  DISZ 0
"""

CODE_V = """RDM;LEN
EPD 8
DIM {unit}
SO 0.0 0.1E14
S {radius} 5.0 NBK7_SCHOTT
  {commands}
S -50 60
  STO
  CIR 8
SI 0.0 0.0
GO
"""
