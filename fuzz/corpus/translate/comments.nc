%
O1234
(tool (flat) 3 mm)
N10 G0 X1 ; (x)
N20 G1 Y1 F9 (y (z)
#1=[2*3]
G0 X#1
M30
%
