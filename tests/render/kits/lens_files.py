"""One lens in each format that lenses come in, as programs write them."""

from __future__ import annotations

# An achromat that is sold: Edmund Optics 32-327, 25 mm across, of 100 mm focal length.
ACHROMAT_SEQ = """\
RDM;LEN       "VERSION: 11.2 SR1       LENS VERSION: 84       Creation Date: 01-May-2019"
TITLE '32327 Achromatic Lens'
EPD   25.0
DIM   M
WL    587.6
REF   1
XAN   0.0
YAN   0.0
SO    0.0 0.1e14
S     61.46999999999995 6.0 NBK7_SCHOTT
  STO
  SLB "32327"
  CIR 12.0
S     -44.63999999999994 2.5 NSF5_SCHOTT
S     -129.9400000000001 95.95194415183156
  CIR 12.0
  PIM
SI    0.0 0.0
GO
"""

# CODE V's own example: a double Gauss of 100 mm, f/2, by curvatures.
DOUBLE_GAUSS_SEQ = """\
RDM N;LEN      "VERSION: 10.7       LENS VERSION: 80       Creation Date: 16-Jul-2015"
TITLE 'Double Gauss F/2 -  Available Glasses'
EPD   50.0
DIM   M
WL    656.3 587.6 486.1
YAN   0.0 10.0000000023 14.0000000032
SO    0.0 993938392063.0
S     0.01779284094091543 8.75 NSSK2_SCHOTT
  CCY 0
S     0.006566600536925569 0.5
S     0.02653743294670983 12.5 NSK2_SCHOTT
S     0.0 3.8 F5_SCHOTT
S     0.04126892878570084 16.36944492653564
  CCY 0; THC 0
S     0.0 13.74795696388906
  STO
S     -0.03523942654429074 3.8 F5_SCHOTT
S     0.0 11.0 NSK16_SCHOTT
S     -0.02636750828657709 0.5
S     0.005636604951748545 7.0 NSK16_SCHOTT
S     -0.0125926458590576 61.4875364179821
  PIM
SI    0.0 -0.4002686453541377
GO
"""

# A triplet with one aspheric surface, 50 mm, f/3.5: thicknesses and radii in millimetres.
TRIPLET_ZMX = """\
VERS 140730 73 26155
MODE SEQ
NAME A triplet
UNIT MM X W X CM MR CPMM
ENPD 14.2857
GCAT SCHOTT
WAVM 1 4.861327E-1 1
SURF 0
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ INFINITY
  DIAM 0 0 0 0 1 ""
SURF 1
  TYPE STANDARD
  CURV 5.0E-002 0 0 0 0 ""
  DISZ 4.0
  GLAS N-SK16 0 0 1.5 4.0E+1 0 0 0 0 0 0
  DIAM 9 1 0 0 1 ""
SURF 2
  TYPE STANDARD
  CURV -1.0E-003 0 0 0 0 ""
  DISZ 5.2
  DIAM 9 1 0 0 1 ""
SURF 3
  TYPE STANDARD
  CURV -4.4E-002 0 0 0 0 ""
  DISZ 1.2
  GLAS ___BLANK 1 0 1.62004 36.37 0 0 0 0 0 0
  DIAM 6 0 0 0 1 ""
SURF 4
  STOP
  TYPE EVENASPH
  CURV 5.1E-002 0 0 0 0 ""
  PARM 1 0
  PARM 2 1.5E-5
  PARM 3 2.5E-8
  DISZ 5.0
  CONI -0.5
  DIAM 5.5 0 0 0 1 ""
SURF 5
  TYPE STANDARD
  CURV 1.0E-002 0 0 0 0 ""
  DISZ 4.0
  GLAS 620603 0 0 1.5 4.0E+1 0 0 0 0 0 0
  DIAM 8 1 0 0 1 ""
SURF 6
  TYPE STANDARD
  CURV -5.0E-002 0 0 0 0 ""
  DISZ 41.0
  DIAM 8 1 0 0 1 ""
SURF 7
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 0
  DIAM 21.6 0 0 0 1 ""
MNUM 1 1
"""

ZOOM_TXT = """\
[descriptive data]
title\tAn example
[constants]
[variable distances]
Focal Length\t48\t70\t48\t70
F-Number\t2.8\t2.9\tundefined\tundefined
Magnification\t0\t0\t-0.05\t-0.07
d0\tInfinity\tInfinity\t900\t900
d2\t3.5\t1.5\t3.5\t1.5
d5\t9.20\t5.2\t8.15\t4.1
d7\t0.60\t2.6\t1.65\t3.7
Bf\t38.1\t40\t38.1\t40
[lens data]
1\t60\t5.0\t1.713\t30\t53.9\tN-LAK8
2\t400\td2\t\t30
3\t-50\t1.2\t1.6727\t20\t32.2
4\t40\t2.0\t\t18
5\tAS\td5\t\t16
6\t45\t4.0\t1.618\t19\t63.3
7\t-45\td7\t\t19
8\t80\t4.0\t1.713\t20\t53.9
9\t-60\tBf\t\t20
[aspherical data]
6\t45\t-0.5\t1.5E-06\t-2.0E-09
[notes]
nothing
"""

DOUBLE_GAUSS_DAT = """\
# Double Gauss 50 mm
# US 2,673,491
# radius\tthickness\tn\taperture
29.475\t3.76\t1.67\t25.2
84.83\t0.12\t1\t25.2
19.275\t4.025\t1.67\t23
40.77\t3.275\t1.699\t23
12.75\t5.705\t1\t18
0\t4.5\t0\t17.1
-14.495\t1.18\t1.603\t17
40.77\t6.065\t1.658\t20
-20.385\t0.19\t1\t20
437.065\t3.22\t1.717\t20
-39.73\t72.2\t1\t20
"""

# One glass in Zemax's format of catalogues, by Schott's data sheet.
BK7_AGF = """\
NM N-BK7 2 517642 1.5168 64.17 0 1
CD 1.03961212 6.00069867E-3 2.31792344E-1 2.00179144E-2 1.01046945 1.03560653E+2
LD 0.31 2.5
"""

FILES = {
    "double gauss.dat": DOUBLE_GAUSS_DAT,
    "triplet.zmx": TRIPLET_ZMX,
    "achromat.seq": ACHROMAT_SEQ,
    "double gauss.seq": DOUBLE_GAUSS_SEQ,
    "zoom.txt": ZOOM_TXT,
}
