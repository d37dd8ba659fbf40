//! Programs in the styles of CAM systems and controllers that are not in `examples/cam`, with no
//! option but the machine: each runs, or one sentence says what to do.

mod common;

use common::{husillo, scratch};

/// The answer to a program.
enum Answer {
    Runs,
    /// It is refused. The text says what to do, and there are so many errors.
    Says(&'static str, u64),
    /// It is no G-code.
    Foreign(&'static str),
}
use Answer::{Foreign, Runs, Says};

const STYLES: [(&str, &str, Answer); 26] = [
    (
        "sheetcam.tap",
        "(Filename: bracket.tap)\nN0030 G21 (Units: Metric)\nN0040 G53 G90 G40\nN0050 F1\n\
         N0060 S500\nN0090 M06 T1 F500.0  (Mill, 6 mm)\nN0100 G00 Z20.0000\n\
         N0110 X-3.0000 Y10.0000\nN0130 M03 S12000\nN0140 G01 Z-2.0000 F100.0\n\
         N0150 Y50.0000 F500.0\nN0160 G02 X0.0000 Y53.0000 I3.0000 J0.0000\nN0250 M05 M30\n",
        Runs,
    ),
    (
        "cambam.nc",
        "( Made using CamBam )\n( T0 : 3.175 )\nG21 G90 G91.1 G64 G40\nG0 Z3.0\nT0 M6\nG17\n\
         M3 S1000\nG0 X10.0 Y10.0\nG98\nG81 X10.0 Y10.0 Z-5.0 R1.0 F100.0\nX20.0\nY20.0\nG80\n\
         G0 X30.0 Y30.0\nG1 F300.0 Z-1.0\nG3 X20.0 Y30.0 I-5.0 J0.0 F800.0\nG0 Z3.0\nM5\nM30\n",
        Runs,
    ),
    // No blanks, CRLF.
    (
        "artcam.tap",
        "T1M6\r\nG0Z5.000\r\nG0X0.000Y0.000S15000M3\r\nG0X12.500Y-3.250Z5.000\r\n\
         G1Z-0.500F500.0\r\nX32.125Y1.5\r\nG2X35.000Y4.375I0.000J2.875\r\nG0Z5.000\r\nM30\r\n",
        Runs,
    ),
    // Lower case, and blanks within numbers.
    (
        "dxf2gcode.ngc",
        "; made by dxf2gcode\ng21 (mm)\ng90\nm3 s8000\ng0 z 3.000\ng0 x 10.000 y 5.000\nm8\n\
         f 150\ng1 z -1.5\nf400\ng1 x 2 0.5 y - 3\ng2 x 25 y 1.5 i 0 j 4.5\ng0 z3\nm9 m5\nm2\n",
        Runs,
    ),
    // Parameters, comments with other marks.
    (
        "fengrave.ngc",
        "(=====)\n(fengrave_set show_axis  1 )\n#1 = 6.35  ( Safe Z )\n#2 = -0.125\nG90\n\
         G64 P0.0250\nG21\nM3 S3000\nG0 Z#1\nF125\nG0 X0.5000 Y2.5000\nG1 Z#2\n\
         G1 X5.5000 Y2.5000\nG2 X6.5 Y3.5 I0 J1\nG0 Z#1\nM5\nM2\n",
        Runs,
    ),
    // Bytes that are no UTF-8.
    (
        "latin1.nc",
        "(Fr\u{e4}ser \u{d8} 6 \u{b5}m \"x\" <a&b> [;] \\ )\nG21\nG0 Z5\nG1 X5 Y5 F100 (\u{b0})\n\
         M30\n",
        Runs,
    ),
    // CR alone.
    ("cr.nc", "%\rO1\rG21\rG0 Z5\rG1 X5 F100\rM30\r%\r", Runs),
    // A mark of UTF-8, and the end of a file of DOS.
    (
        "dos.nc",
        "\u{feff}(caf\u{e9})\r\nG21\r\nG0 Z5\r\nG1 X5 F100\r\nM30\r\n\u{1a}",
        Runs,
    ),
    (
        "jscut.gcode",
        "G20         ; Set units to inches\nG90\nG1 Z0.5 F40      ; Move to clearance level\n\n;\n\
         ; Operation:    0\nG1 X0.5000 Y-0.5000 F60\nG1 Z-0.1250 F5\nG1 X1.5000 Y-1.5000 F40\nM2\n",
        Runs,
    ),
    // Subprograms in one file, a contour beside the zero, work frames.
    (
        "fanuc.nc",
        "%\nO1000(PLATE)\nN1G21G17G40G49G80G90\nN2T1M6\nG10L1P1R3.\nN3G54G0X0Y0S3000M3\n\
         N4G43H1Z30.M8\nN5Z5.\nN6M98P2000L3\nN7G55X0Y0\nN8M98P2000\nN9G0Z30.M9\nN12M30\n\
         O2000(POCKET)\nN1G91G1Z-1.F100\nN2G90G41D1X10.Y0F300\nN3G1Y20.\nN4X30.\nN5Y5.\nN6X0.\n\
         N7G40X0Y-10.\nN8M99\n%\n",
        Runs,
    ),
    // The error is the tool; the part would be placed.
    (
        "camworks.nc",
        "%\nO0001\nN1 G20\nN5 S5000 M03\nN7 G90 G54 G00 X.5 Y-.25\nN8 G43 Z1. H01 M08\n\
         N9 G01 Z-.125 F15.\nN10 G42 D21 X1. Y0. F20.\nN11 X3.\nN14 G40 X4.\nN18 M30\n%\n",
        Says("set its radius first: `G10 L1 P<tool> R<radius>`", 1),
    ),
    (
        "haas.nc",
        "%\nO00123 (REV-B  \"6061\" 25.4\u{b0} \u{d8} 3/8)\nN20 G20 G90\nN40 S5000 M3\nG0 Z1.\n\
         N160 G98 G83 X0.5 Y0.5 Z-0.4 R0.1 Q0.1 F8.\nN165 X1.\nN170 G99 X1. Y1.\nN175 G80\n\
         N190 Z0.6\nN215 M30\n%\n",
        Says("write G0 or G1 before the axis words", 1),
    ),
    (
        "esprit.nc",
        "%\n:0001 (ESPRIT)\nN5 G21 G90 G17\nN10 G59\n/N20 M8\nN25 G00 X0. Y0. S2000 M03\nG0 Z25.\n\
         N35 G73 G99 X10. Y10. Z-12. R3. Q2. F120.\nN40 G98 X20.\nN50 G80 M30\n%\n",
        Says("write `O` in place of `:`", 1),
    ),
    (
        "meshcam.nc",
        "N100 G90 G80 G40 G54 G20 G17 G50 G94 G64 (SAFETY BLOCK)\nN120 M3 S18000\nN130 G0 Z0.25\n\
         N150 G1 Z-.05 F10.\nN210 M30\n",
        Says(
            "leave the code out: it ends a mode that no program here has",
            1,
        ),
    ),
    // The fix would change the number by 15 decades, so there is none.
    (
        "script.nc",
        "G21\nG90\nG0 Z5\nG1 Z-1 F100\nG1 X1.2246e-15 Y10\nM2\n",
        Says("write the number with all its digits, as in `0.000012`", 1),
    ),
    (
        "macros.nc",
        "%\nO0005\n#102=0\nG21 G90 G17 G54\n#102=#102+1\nM30\n%\n",
        Says("write `#102=[#102+1]`", 1),
    ),
    (
        "loop.nc",
        "O0005\n#1=0\nWHILE [#1 LT 6] DO1\nEND1\nM30\n",
        Says("write O-words instead: `o1 while [#1 LT 6]`", 2),
    ),
    (
        "deskproto.nc",
        "%\n(4-axis)\nG21\nG90\nG0 Z30.000\nG0 A0.000\nG1 Z10.000 F500\nA5.000\nM30\n%\n",
        Says("router4 accepts this program: -m router4", 2),
    ),
    (
        "heidenhain.h",
        "0 BEGIN PGM 14 MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n3 L Z+100 R0 FMAX M3\n6 END PGM 14 MM\n",
        Foreign("this is a Heidenhain program, no plain G-code: choose a post-processor"),
    ),
    (
        "haas.nc",
        "%\nO00012 (HAAS VF2)\nG21\nG187 P2\nG00 X10. Y10. S5000 M03\nG01 Z-1. F300.\nM30\n%\n",
        Says("leave the code out: speed is always planned ahead here", 1),
    ),
    (
        "lookahead.nc",
        "%\nG21 G90\nG05.1 Q1\nG00 X10. Y10. S5000 M03\nG01 Z-1. F300.\nM30\n%\n",
        Says("leave the line out: speed is always planned ahead here", 1),
    ),
    (
        "duet.gcode",
        "; Duet CNC\nG21\nG90\nM3 S10000\nG0 X10 Y10\nG1 Z-1 F200\nM5\nM400\nM0\n",
        Says(
            "leave the code out: each command waits for those before it",
            1,
        ),
    ),
    (
        "heidenhain.i",
        "%PART1 G71 *\nN10 G30 G17 X+0 Y+0 Z-20*\nN30 T1 G17 S4000*\nN60 G01 Z-5 F200*\n\
         N99999 %PART1 G71 *\n",
        Foreign("this is a Heidenhain program, no plain G-code: choose a post-processor"),
    ),
    (
        "sinumerik.mpf",
        "%_N_PLATE_MPF\nN10 G17 G54 G71 G90\nN20 T=\"MILL10\" D1\nN60 MSG(\"ROUGHING\")\nN80 M30\n",
        Foreign("this is a Sinumerik program, no plain G-code: choose a post-processor"),
    ),
    (
        "part.sbp",
        "'SHOPBOT FILE\nSA\nMS,2,1\nJZ,0.5\nM3,1,1,-0.1\nEND\n",
        Foreign("this is a ShopBot program, no plain G-code: choose a post-processor"),
    ),
    (
        "part.plt",
        "IN;SP1;PU0,0;PD100,100;PU;SP0;\n",
        Foreign("this is a plotter file (HPGL), no plain G-code: let a CAM system read it"),
    ),
];

#[test]
fn programs_of_other_cam_systems_run_or_one_sentence_says_what_to_do() {
    let folder = scratch("styles");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    for (name, text, answer) in STYLES {
        let bytes = match name {
            "latin1.nc" => text.chars().map(|one| one as u8).collect(),
            _ => text.as_bytes().to_vec(),
        };
        std::fs::write(folder.join(name), bytes).unwrap();
        let output = husillo()
            .current_dir(&folder)
            .args([
                "run",
                "-m",
                "router",
                "--format",
                "json",
                "-o",
                "page.html",
                name,
            ])
            .output()
            .unwrap();
        let [out, errors] =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        let told = format!("{name}: {out}{errors}");
        let status = output.status.code();
        let found: serde_json::Value = serde_json::from_str(&out).unwrap_or_default();
        match answer {
            Runs => {
                assert_eq!(status, Some(0), "{told}");
                assert!(found["events"].as_u64().unwrap() > 1000, "{told}");
            }
            Says(sentence, count) => {
                assert_eq!(status, Some(1), "{told}");
                assert!(told.contains(sentence), "{told}");
                assert_eq!(found["errors"], count, "{told}");
                assert!(!told.contains("1.2246Y10"), "{told}");
            }
            Foreign(sentence) => {
                assert_eq!(status, Some(2), "{told}");
                assert!(told.contains(sentence), "{told}");
            }
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
