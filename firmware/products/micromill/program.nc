(The program of the check: a small circle, an arc and a slope, all within the backlash.)
G21 G90 G17
M3 S800
G0 X0.5 Y0.3
G1 Z-0.02 F1
G2 I-0.05 J0 F1.2
G3 X0.4 Y0.4 I-0.1 J0
G1 X0.42 Y0.25 F0.8
G0 Z0.05
G4 P1
M5
G0 X0 Y0
M30
