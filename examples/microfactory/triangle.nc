(right-angled triangle: X +1000 with Z +500, Z -500, X -1000 steps)
G21 G91 G1 F10
X1.87 Z0.935
Z-0.935
X-1.87
M2
