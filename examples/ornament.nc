(A rosette of scallops and teeth: an axis reverses and takes up its backlash 45 times.)
G21 G90 G17 G94 F1.2
M3 S6000
G0 X2 Y2
G1 Z-0.049
(lower edge: six scallops to the right)
G2 X3 Y2 I0.5 J0
G2 X4 Y2 I0.5 J0
G2 X5 Y2 I0.5 J0
G2 X6 Y2 I0.5 J0
G2 X7 Y2 I0.5 J0
G2 X8 Y2 I0.5 J0
(right edge: four teeth up)
G1 X8.5 Y2.375
G1 X8 Y2.75
G1 X8.5 Y3.125
G1 X8 Y3.5
G1 X8.5 Y3.875
G1 X8 Y4.25
G1 X8.5 Y4.625
G1 X8 Y5
(upper edge: six scallops to the left)
G2 X7 Y5 I-0.5 J0
G2 X6 Y5 I-0.5 J0
G2 X5 Y5 I-0.5 J0
G2 X4 Y5 I-0.5 J0
G2 X3 Y5 I-0.5 J0
G2 X2 Y5 I-0.5 J0
(left edge: four teeth down)
G1 X1.5 Y4.625
G1 X2 Y4.25
G1 X1.5 Y3.875
G1 X2 Y3.5
G1 X1.5 Y3.125
G1 X2 Y2.75
G1 X1.5 Y2.375
G1 X2 Y2
G0 Z0.098
(a zigzag in the middle)
G0 X3.5 Y3
G1 Z-0.049
G1 X4 Y4
G1 X4.5 Y3
G1 X5 Y4
G1 X5.5 Y3
G1 X6 Y4
G1 X6.5 Y3
G0 Z0.098
M5
(away to the right: X does not reverse any more)
G0 X10 Y0
M30
