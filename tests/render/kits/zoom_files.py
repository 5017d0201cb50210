"""Optical Bench files of a zoom and of a lens with floating focus, by the numbers of their patents.

The clear diameters of the zoom are estimates; its patent has none.
"""

from __future__ import annotations

TELE_ZOOM_TXT = """\
[descriptive data]
title\tUS 5,537,259 Example 1
[constants]
[variable distances]
Focal Length\t72.1\t135\t194.01
F-Number\t2.8\t2.8\t2.8
Magnification\t0\t0\t0
d0\tInfinity\tInfinity\tInfinity
d6\t8.78\t26.15\t32.85
d10\t1.64\t12.89\t17.23
d17\t30.32\t15.72\t1.32
d22\t14.7\t0.69\t4.05
Bf\t52.49\t52.49\t52.49
[lens data]
1\t311.919\t2.8\t1.7495\t73\t35
2\t118.63\t0.42\t\t70.4
3\t128.135\t8.68\t1.497\t70.4\t81.6
4\t-263.46\t0.1\t\t70.4
5\t79.501\t5.72\t1.497\t70\t81.6
6\t203.191\td6\t\t70
7\t54.391\t2.2\t1.84666\t56\t23.8
8\t45.859\t1.13\t\t52.44
9\t51.927\t8.55\t1.48749\t52.44\t70.2
10\t5099.3\td10\t\t56
11\t-488.6\t1.4\t1.804\t36\t46.6
12\t35.39\t5.88\t\t33.08
13\t-78.125\t1.4\t1.48749\t33.08\t70.2
14\t38.137\t4.97\t1.84666\t36\t23.9
15\t417.478\t2.65\t\t34.64
16\t-66.802\t1.4\t1.72916\t34.64\t54.7
17\t-3363\td17\t\t36
18\t247.12\t3.49\t1.6968\t38\t55.5
19\t-99.902\t0.15\t\t38
20\t-189.99\t4.77\t1.497\t38\t81.6
21\t-40.553\t1.45\t1.834\t38\t37.2
22\t-76.277\td22\t\t38
23\t58.421\t3.53\t1.804\t42\t46.6
24\t133.262\t3\t\t42
25\tAS\t0.24
26\t34.132\t6.35\t1.497\t39.88\t81.6
27\t2256.763\t3.72\t1.62004\t39.88\t36.3
28\t31.519\t28.17\t\t42
29\t132.947\t5.9\t1.51742\t42\t52.4
30\t-77.546\t13.94\t\t42
31\t-39.485\t1.8\t1.834\t42\t37.2
32\t-95.683\t0.15\t\t42
33\t147.644\t3.62\t1.7432\t42\t49.3
34\t-205.76\tBf\t\t42
"""

FLOATING_TXT = """\
[descriptive data]
title\tUS 2007/0236805 Example 4
[constants]
[variable distances]
Focal Length\t99.80\tundefined
F-Number\t1.24\tundefined
Magnification\t0\t-0.112
d0\tInfinity\t803.34
d8\t14.959\t1.10
d12\t16.343\t10.843
d21\t1.00\t20.359
Bf\t40.123\t40.123
[lens data]
1\t-1883.6\t4.7\t1.54075\t89.06\t47.23
2\t101.45\t3.14\t\t83.94
3\t127.72\t15.68\t1.61803\t88.56\t63.33
4\t-281.84\t0.2\t\t88.56
5\t66.355\t14.78\t1.43876\t84.46\t94.99
6\t202.42\t0.1\t\t77.98
7\t113.83\t4.85\t1.80527\t79.16\t25.42
8\t89.125\td8\t\t72.83
9\t52.33\t14.19\t1.75704\t65.12\t47.82
10\t381.29\t7.54\t\t61.13
11\t-230.02127\t2.8\t1.61344\t53.56\t44.29
12\t29.64\td12\t\t42.3
13\tAS\t18.938
14\t-27.582\t2.97\t1.61344\t39.42\t44.29
15\t285.92\t12.52\t1.69104\t48.44\t54.82
16\t-41.867\t0.55\t\t50.48
17\t188.36\t8.18\t1.69104\t50.48\t54.82
18\t-76.076\t0.1\t\t50.48
19\t110.6\t10.69\t1.60303\t46.52\t65.44
20\t-46.305\t2.8\t1.65416\t45.3\t39.63
21\t153.99\td21\t\t48.74
22\t73.918\t4.22\t1.49702\t39.96\t81.54
23\t158.49\tBf\t\t39.96
[aspherical data]
11\t-230.02127\t0\t8.669E-07\t9.230E-11\t2.783E-14\t-9.209E-16\t1.576E-18\t-8.587E-22
"""
