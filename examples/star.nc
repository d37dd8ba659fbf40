(A star of eight points whose sides are slow, hollow arcs, given by their radius.)
G21 G90 G17 G94 F0.6
M3 S6000
G0 X5 Y6.3
G1 Z-0.049
G2 X3.02 Y5.48 R2.4
G2 X2.2 Y3.5 R2.4
G2 X3.02 Y1.52 R2.4
G2 X5 Y0.7 R2.4
G2 X6.98 Y1.52 R2.4
G2 X7.8 Y3.5 R2.4
G2 X6.98 Y5.48 R2.4
G2 X5 Y6.3 R2.4
G0 Z0.098
M5
G0 X0 Y0
M30
