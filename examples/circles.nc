(Circles of 3, 2 and 1 mm radius, in the middle of a 10 x 7 mm work area; for -m micromill.)
(Millimetres, absolute, mm/min: about the highest feed of the micro mill's 140 nm steps.)
N010 G21 G90 G17 G94
N020 M3 S6000
N030 G0 X8 Y3.5          (start of the largest circle)
N040 G1 Z-0.049 F1.2      (cut)
N050 G3 X8 Y3.5 I-3 J0   (a full circle ends where it starts)
N060 G0 Z0.098
N070 G0 X7 Y3.5
N080 G1 Z-0.049
N090 G3 X7 Y3.5 I-2 J0
N100 G0 Z0.098
N110 G0 X6 Y3.5
N120 G1 Z-0.049
N130 G3 X6 Y3.5 I-1 J0
N140 G0 Z0.098
N150 M5
N160 G0 X0 Y0
N170 M30
