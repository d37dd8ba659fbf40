(square of 1000 steps with its diagonal)
G21 G91 G1 F10
X1.87
Z1.87
X-1.87
Z-1.87
X1.87 Z1.87
M2
