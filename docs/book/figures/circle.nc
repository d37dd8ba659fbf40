(A circle of 2 mm radius.)
G21 G90 G17 G94 F60
G0 X3 Y1
G3 X3 Y1 I0 J2
M2
