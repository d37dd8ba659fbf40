(A thread of 1.5 mm lead, three passes; for the machine lathe)
G21 G90 G18 G94 G8
M3 S600
G0 X10 Z5
G4 P1
X9.7
G33 Z-20 K1.5
G0 X12
Z5
X9.4
G33 Z-20 K1.5
G0 X12
Z5
X9.2
G33 Z-20 K1.5
G0 X12
Z5
G95 G1 X9 F0.1
G94 M5
M30
