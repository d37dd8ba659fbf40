(Exported by FreeCAD, a disc in the style of its post for Grbl)
(Post Processor: grbl_post)
(Output Time:2026-11-25 04:00:00)
(Begin preamble)
G17 G90
G21
(Begin operation: Fixture)
(Path: Fixture)
G54
(Finish operation: Fixture)
(Begin operation: TC: 3mm)
(Path: TC: 3mm)
M6 T1
M3 S12000
(Finish operation: TC: 3mm)
(Begin operation: Profile)
(Path: Profile)
(Compensated Tool Path. Diameter: 3.0)
G0 Z5.000
G0 X11.500 Y0.000
G0 Z3.000
G1 X11.500 Y0.000 Z-1.000 F180.000
G2 X0.000 Y-11.500 Z-1.000 I-11.500 J0.000 K0.000 F600.000
G2 X-11.500 Y0.000 Z-1.000 I0.000 J11.500 K0.000 F600.000
G2 X0.000 Y11.500 Z-1.000 I11.500 J0.000 K0.000 F600.000
G2 X11.500 Y0.000 Z-1.000 I0.000 J-11.500 K0.000 F600.000
G0 Z5.000
(Finish operation: Profile)
(Begin postamble)
M5
G17 G90
M2
