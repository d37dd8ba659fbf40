(Two sides of a square, and a quarter of a circle.)
G21 G90 G17 G94 F2400
G0 X10 Y10
G1 X25
G1 Y25
G3 X15 Y35 I-10 J0
G1 X10
M2
