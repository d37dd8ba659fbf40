(The bore and the boss of examples/piece.toml, as a G-code program.)
(husillo measure -m cmm3 --piece examples/piece.toml --ball 1 --pretravel "8 um" run FILE)
G21 G90 G94 F24
G0 Z-10
G0 X16 Y16
G38.2 Z-24 (touch the top, then leave it slowly)
G38.4 Z-18 F5 (#5063 is the centre of the ball, 1 mm above)
#<top> = [#5063 - 1]
G10 L2 P1 Z#<top> (from here on Z0 is the top)
G0 Z10
o<bore> call [30] [30] [-4] [16] [8]
G0 Z10
(in the drawing the boss is 14 mm from the bore in both axes)
o<boss> call [#<_bore_x> + 14] [#<_bore_y> + 14] [3] [6]
G0 Z10
o1 if [ABS[#<_boss_diameter> - 6] GT 0.02]
  M0 (out of tolerance)
o1 endif
M2
