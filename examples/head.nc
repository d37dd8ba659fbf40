(A head of 0.97 x 0.99 mm, the same on both sides: forehead, ears, cheeks, chin. husillo run examples/head.nc --worn --symmetry 5 --order mirrored)
G21 G90 G17 G94 F0.9
M3 S6000
G0 Z0.098
G0 X5 Y2.2
G1 Z-0.049
G2 X5.18 Y2.17 R0.6
G1 X5.25 Y2.21
G2 X5.38 Y2.03 R0.2
G2 X5.485 Y1.78 R0.4
G2 X5.36 Y1.49 R0.5
G1 X5.21 Y1.3
G2 X5 Y1.22 R0.35
G2 X4.79 Y1.3 R0.35
G1 X4.64 Y1.49
G2 X4.515 Y1.78 R0.5
G2 X4.62 Y2.03 R0.4
G2 X4.75 Y2.21 R0.2
G1 X4.82 Y2.17
G2 X5 Y2.2 R0.6
G0 Z0.098
M5
G0 X0 Y0
M30
