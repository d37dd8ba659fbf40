(1001)
(A plate with a pocket, in the style of Fusion's posts for small mills)
(T1  D=6. CR=0. - ZMIN=-2. - flat end mill)
G90 G94
G17
G21
G28 G91 Z0.
G90

(2D Contour1)
T1 M6
S12000 M3
G54
M8
G0 X-17. Y-3.6
G0 Z15.
G0 Z5.
G1 Z1. F333.3
G1 Z-1.4
G18 G3 X-16.4 Z-2. I0.6 K0. F800.
G1 X-15.8
G17 G3 X-15.2 Y-3. I0. J0.6
G1 Y12.
G2 X-12.2 Y15. I3. J0.
G1 X12.2
G2 X15.2 Y12. I0. J-3.
G1 Y-12.
G2 X12.2 Y-15. I-3. J0.
G1 X-12.2
G2 X-15.2 Y-12. I0. J3.
G1 Y-3.
G3 X-15.8 Y-2.4 I-0.6 J0.
G1 X-16.4
G18 G2 X-17. Z-1.4 I0. K0.6
G17
G0 Z15.

(Bore1)
G0 X2. Y0.
G0 Z5.
G1 Z0.2 F333.3
G3 X-2. Y0. Z-0.5 I-2. J0. F500.
G3 X2. Y0. Z-1.2 I2. J0.
G3 X-2. Y0. Z-1.9 I-2. J0.
G3 X2. Y0. Z-2. I2. J0.
G3 X-2. Y0. I-2. J0.
G3 X2. Y0. I2. J0.
G1 X0.
G0 Z15.

M9
M5
G28 G91 Z0.
G90
M30
