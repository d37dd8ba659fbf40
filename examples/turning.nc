(A stepped shaft with a fillet and a rounded shoulder, from a 40 mm bar; for -m lathe)
G21 G90 G18 G7 G94
T1 M3 S1200
G0 X42 Z2
(cuts of 1.5 mm, retract 0.5 mm; allowance 0.4 mm on the diameter and 0.1 mm in Z)
G71 U1.5 R0.5
G71 P100 Q190 U0.4 W0.1 F400
N100 G0 X10
N110 G1 Z0 F120
N120 X12 Z-1
N130 Z-12
N140 G2 X18 Z-15 R3
N150 G1 X24
N160 G3 X30 Z-18 R3
N170 G1 Z-28
N180 X36 Z-33
N190 X42
G70 P100 Q190
M5
M30
