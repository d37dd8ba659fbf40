;FLAVOR:Marlin
;TIME:46
;Filament used: 0.0213m
;Layer height: 0.2
;MINX:95
;MINY:95
;MINZ:0.2
;MAXX:115
;MAXY:115
;MAXZ:0.4
;a frame in the style of Cura; -m printer
M140 S60
M105
M190 S60
M104 S200
M105
M109 S200
M82 ;absolute extrusion mode
M201 X500.00 Y500.00 Z100.00 E5000.00 ;Setup machine max acceleration
M203 X500.00 Y500.00 Z10.00 E50.00 ;Setup machine max feedrate
M204 P500.00 R1000.00 T500.00 ;Setup Print/Retract/Travel acceleration
M205 X8.00 Y8.00 Z0.40 E5.00 ;Setup Jerk
M220 S100 ;Reset Feedrate
M221 S100 ;Reset Flowrate
G28 ;Home
G92 E0 ;Reset Extruder
G1 Z2.0 F3000 ;Move Z Axis up
G1 X10.1 Y20 Z0.28 F5000.0 ;Move to start position
G1 X10.1 Y60.0 Z0.28 F1500.0 E4 ;Draw the first line
G1 X10.4 Y60.0 Z0.28 F5000.0 ;Move to side a little
G1 X10.4 Y20 Z0.28 F1500.0 E8 ;Draw the second line
G92 E0 ;Reset Extruder
G1 Z2.0 F3000 ;Move Z Axis up
G92 E0
G92 E0
G1 F2700 E-5
;LAYER_COUNT:2
;LAYER:0
M107
;MESH:frame.stl
G0 F6000 X95 Y95 Z0.2
;TYPE:WALL-OUTER
G1 F2700 E0
G1 F1200 X115 Y95 E0.66516
G1 X115 Y115 E1.33032
G1 X95 Y115 E1.99548
G1 X95 Y95 E2.66064
G0 F6000 X97 Y97
;TYPE:SKIN
G1 F1200 X113 Y113 E3.41318
;TIME_ELAPSED:12.480000
;LAYER:1
M106 S85
G0 F6000 X113.2 Y95.6 Z0.4
G1 F1800 X95.4 Y95.6 E4.00517
G1 X95.4 Y114.4 E4.63042
G1 X114.6 Y114.4 E5.26897
G1 X114.6 Y95.6 E5.89422
M106 S170.5
;TIME_ELAPSED:24.100000
G1 F2700 E0.89422
M140 S0
M107
G91 ;Relative positioning
G1 E-2 F2700 ;Retract a bit
G1 E-2 Z0.2 F2400 ;Retract and raise Z
G1 X5 Y5 F3000 ;Wipe out
G1 Z10 ;Raise Z more
G90 ;Absolute positioning
G1 X0 Y220 ;Present print
M106 S0 ;Turn-off fan
M104 S0 ;Turn-off hotend
M140 S0 ;Turn-off bed
M84 X Y E ;Disable all steppers but Z
M82 ;absolute extrusion mode
M104 S0
;End of Gcode
