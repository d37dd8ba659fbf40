(lying rectangle of 1000 by 500 steps with its diagonal)
G21 G91 G1 F10
X1.87
Z0.935
X-1.87
Z-0.935
X1.87 Z0.935
M2
