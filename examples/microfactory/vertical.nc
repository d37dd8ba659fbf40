(upright rectangle of 500 by 1000 steps with its diagonal)
G21 G91 G1 F10
X0.935
Z1.87
X-0.935
Z-1.87
X0.935 Z1.87
M2
