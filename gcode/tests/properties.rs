//! Properties of all programs.
#![cfg(feature = "extended")]

mod in_place;

use fixed::types::{I16F16, I40F24};
use husillo_gcode::{Block, Command, Decimal, Dialect, Error, Modal, Nm, words};
use proptest::prelude::*;

/// Digits of one number as written in a program.
fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        "[+-]?[0-9]{1,6}(\\.[0-9]{0,6})?",
        "[+-]?[0-9]{0,25}\\.[0-9]{1,35}",
        "[-+.0-9 ]{0,6}",
        Just(String::new()),
    ]
}

/// Text that looks like G-code, right or wrong.
fn program_line() -> impl Strategy<Value = String> {
    let code = prop::sample::select(vec![
        "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G28", "G28.1", "G53",
        "G54", "G55", "G61", "G64", "G80", "G90", "G91", "G90.1", "G91.1", "G92", "G92.1", "G93",
        "G94", "M0", "M2", "M3", "M5", "M6", "M8", "M30", "G43", "(c)", "/", "%", ";", "[", "\t",
        "G5", "G5.1", "G7", "G8", "G10 L2", "G10 L20", "G10 L1", "G30", "G30.1", "G33", "G38.2",
        "G38.5", "G40", "G41", "G42.1", "G43.1", "G49", "G59.3", "G73", "G74", "G76", "G77", "G78",
        "G79", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89", "G92.2", "G92.3",
        "G95", "G96", "G97", "G98", "G99", "M4", "M19", "M48", "M53", "M60", "M61", "M62", "M66",
        "M68",
    ]);
    let letter = prop::sample::select(b"XYZABCIJKRPFSTNxyzijrfHQDELOUW".to_vec());
    let word =
        (letter, number()).prop_map(|(letter, number)| format!("{}{number}", char::from(letter)));
    prop::collection::vec(prop_oneof![code.prop_map(str::to_owned), word], 0..8)
        .prop_map(|parts| parts.join(" "))
}

/// Runs lines; asserts that each error is inside its text and leaves the state unchanged.
fn run(dialect: Dialect, lines: &[Vec<u8>]) -> (Modal<3>, Vec<Command<3>>) {
    let mut modal = Modal::<3>::new(dialect);
    let mut made = Vec::new();
    for line in lines {
        for (offset, text) in dialect.blocks(line) {
            assert!(offset + text.len() <= line.len());
            let before = modal.clone();
            match Block::parse(text, &dialect).and_then(|block| in_place::plan(&modal, &block)) {
                Ok((next, commands)) => {
                    let least = commands.size_hint().0;
                    let commands: Vec<_> = commands.collect();
                    assert!(commands.len() >= least);
                    assert!(
                        commands
                            .iter()
                            .all(|command| !command.to_string().contains('\n'))
                    );
                    modal = next;
                    made.extend(commands);
                }
                Err(Error { kind, at, end }) => {
                    assert!(
                        at <= end && end <= text.len(),
                        "{kind:?} {at}..{end} of {}",
                        text.len()
                    );
                    assert!(kind.code() > 100 && !kind.to_string().is_empty());
                    assert_eq!(before, modal);
                }
            }
        }
    }
    (modal, made)
}

fn plan(lines: &[String]) -> (Modal<3>, Vec<Command<3>>) {
    run(
        Dialect::RS274,
        &lines
            .iter()
            .map(|line| line.clone().into_bytes())
            .collect::<Vec<_>>(),
    )
}

fn value(text: &str) -> Option<Decimal> {
    words(format!("X{text}").as_bytes())
        .next()?
        .ok()
        .map(|word| word.value)
}

/// `digits * factor * 10^exponent / 10^places` to the nearest, halves away from zero, in 128 bits.
fn scaled_wide(digits: i64, places: u8, factor: i32, exponent: u8) -> i128 {
    let top = i128::from(digits) * i128::from(factor) * 10i128.pow(u32::from(exponent));
    let bottom = 10i128.pow(u32::from(places));
    let half = if top < 0 { -bottom / 2 } else { bottom / 2 };
    (top + half) / bottom
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 512 }))]

    /// No input panics; every error is inside its block; an error changes nothing.
    #[test]
    fn any_bytes_are_read_or_refused(
        lines in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..60), 0..4),
    ) {
        run(Dialect::RS274, &lines);
        run(Dialect::MICROMILL, &lines);
    }

    /// The same for text that gets further: words and codes in any combination.
    #[test]
    fn any_words_are_read_or_refused(lines in prop::collection::vec(program_line(), 0..12)) {
        let bytes: Vec<_> = lines.iter().map(|line| line.clone().into_bytes()).collect();
        run(Dialect::RS274, &bytes);
        run(Dialect::MICROMILL, &bytes);
        run(Dialect::RS274.with_block_delete(false), &bytes);
        for dialect in Dialect::ALL {
            run(dialect, &bytes);
        }
    }

    /// The programmed position is the end of the last move.
    #[test]
    fn position_is_the_end_of_the_last_move(lines in prop::collection::vec(program_line(), 0..20)) {
        let bytes: Vec<_> = lines.iter().map(|line| line.clone().into_bytes()).collect();
        for dialect in Dialect::ALL {
            let (modal, commands) = run(dialect, &bytes);
            let last = commands.iter().rev().find_map(Command::end);
            prop_assert_eq!(modal.position(), last.unwrap_or_default());
        }
    }

    /// A number printed and read again is the same number, places included.
    #[test]
    fn numbers_print_and_read_back(
        digits in -i64::MAX..=i64::MAX,
        shift in 0u32..63,
        places in 0u8..=30,
    ) {
        let number = Decimal::new(digits >> shift, places).unwrap();
        prop_assert_eq!(value(&number.to_string()), Some(number));
    }

    /// Blanks, tabs and case change nothing.
    #[test]
    fn blanks_are_ignored(
        text in "[+-]?[0-9]{1,6}\\.[0-9]{1,6}",
        gaps in prop::collection::vec(0usize..3, 16),
    ) {
        let spaced: String = text
            .chars()
            .zip(&gaps)
            .map(|(c, &gap)| format!("{c}{}", &" \t "[..gap]))
            .collect();
        prop_assert_eq!(value(&text), value(&spaced));
    }

    /// Scaling rounds once, halves away from zero, and fails only where the result does not fit.
    #[test]
    fn scaling_is_exact(
        digits in any::<i64>(),
        shift in 0u32..63,
        places in 0u8..=22,
        inch in any::<bool>(),
    ) {
        let digits = (digits >> shift).max(-i64::MAX);
        let (factor, exponent) = if inch { (254, 5) } else { (1, 6) };
        let wide = scaled_wide(digits, places, factor, exponent);
        let expected = i64::try_from(wide).ok();
        prop_assert_eq!(
            Decimal::new(digits, places)
                .unwrap()
                .scaled(factor, exponent),
            expected
        );
    }

    /// A conversion to a `fixed` type is within half a unit of the exact value.
    #[test]
    fn fixed_types_round_once(digits in -3_000_000_000i64..3_000_000_000, places in 5u8..15) {
        let number = Decimal::new(digits, places).unwrap();
        let power = 10i128.pow(u32::from(places));
        let near = number.to_fixed::<I16F16>().unwrap();
        prop_assert!(
            (i128::from(near.to_bits()) * power - i128::from(digits) * (1 << 16)).abs() * 2
                <= power
        );
        let near = number.to_fixed::<I40F24>().unwrap();
        prop_assert!(
            (i128::from(near.to_bits()) * power - i128::from(digits) * (1 << 24)).abs() * 2
                <= power
        );
    }

    /// G91 adds the rounded words: n moves of x end at exactly n times the nanometres of x.
    #[test]
    fn increments_add_exactly(
        digits in -1_000_000i64..1_000_000,
        places in 0u8..9,
        count in 1usize..40,
        inch in any::<bool>(),
    ) {
        let number = Decimal::new(digits, places).unwrap();
        let (units, step) = if inch {
            ("G20", number.scaled(254, 5))
        } else {
            ("G21", number.scaled(1, 6))
        };
        let mut lines = vec![format!("{units} G91 G0")];
        lines.extend(vec![format!("X{number}"); count]);
        let (modal, commands) = plan(&lines);
        prop_assert_eq!(commands.len(), count);
        prop_assert_eq!(
            modal.position(),
            [Nm(step.unwrap() * count as i64), Nm(0), Nm(0)]
        );
    }

    /// G92 moves no axis, and the programmed coordinates are then those of its words.
    #[test]
    fn shifts_rename_the_position(
        x in -9_999i64..9_999,
        shift in -9_999i64..9_999,
        to in -9_999i64..9_999,
    ) {
        let line = format!("G1 X{to}");
        let (modal, _) = plan(&[format!("G21 G0 X{x}"), format!("G92 X{shift} F1"), line]);
        prop_assert_eq!(modal.position()[0], Nm((x - shift + to) * 1_000_000));
        prop_assert_eq!(modal.work_offset()[0], Nm((x - shift) * 1_000_000));
    }

    /// The mismatch of an accepted arc is the difference of its radii to the nearest nanometre.
    #[test]
    fn mismatch_is_the_difference_of_radii(
        i in -50_000_000i64..50_000_000,
        j in -50_000_000i64..50_000_000,
        angle in 0.0f64..6.25,
        off in -5_000.0f64..5_000.0,
    ) {
        let radius = ((i as f64).hypot(j as f64) + off).max(1.0);
        let (x, y) = (
            (radius * angle.cos()) as i64 + i,
            (radius * angle.sin()) as i64 + j,
        );
        let (_, commands) = plan(&[format!(
            "G21 G2 X{} Y{} I{} J{} F1",
            Nm(x),
            Nm(y),
            Nm(i),
            Nm(j)
        )]);
        if let Some(Command::Arc { arc, .. }) = commands.first() {
            let exact = ((i as f64).hypot(j as f64) - ((x - i) as f64).hypot((y - j) as f64)).abs();
            prop_assert!(
                (arc.mismatch.0 as f64 - exact).abs() <= 0.5021,
                "{} for {}",
                arc.mismatch,
                exact
            );
            prop_assert_eq!(arc.centre, [Nm(i), Nm(j), Nm(0)]);
        } else {
            prop_assert!(off.abs() > 4_990.0 || (i, j) == (0, 0));
        }
    }

    /// The centre of an R arc is one radius from both ends to the rounding of its coordinates, on
    /// the right side.
    #[test]
    fn radius_arcs_have_their_centre(
        x in -90_000_000i64..90_000_000,
        y in -90_000_000i64..90_000_000,
        more in 0i64..1_000_000_000,
        long in any::<bool>(),
        left in any::<bool>(),
    ) {
        prop_assume!((x, y) != (0, 0));
        let radius = ((x as f64).hypot(y as f64) / 2.0).ceil() as i64 + more;
        let (sign, code) = (if long { "-" } else { "" }, if left { "G3" } else { "G2" });
        let (_, commands) = plan(&[format!(
            "G21 {code} X{} Y{} R{sign}{} F1",
            Nm(x),
            Nm(y),
            Nm(radius)
        )]);
        let Some(Command::Arc { arc, .. }) = commands.first() else {
            panic!("no arc")
        };
        prop_assert_eq!(arc.radius, Some(Nm(radius)));
        let (cx, cy) = (arc.centre[0].0, arc.centre[1].0);
        for (dx, dy) in [(cx, cy), (cx - x, cy - y)] {
            prop_assert!(((dx as f64).hypot(dy as f64) - radius as f64).abs() <= 0.75);
        }
        let cross = i128::from(x) * i128::from(cy) - i128::from(y) * i128::from(cx);
        let on_the_left = left != long;
        // Half a nanometre of rounding across the chord.
        let slack = i128::from(x.abs().max(y.abs()));
        let right_side = if on_the_left {
            cross >= -slack
        } else {
            cross <= slack
        };
        prop_assert!(right_side);
        prop_assert!(arc.mismatch.0 <= 1);
    }

    /// Arcs of any size and place, up to the largest coordinate, are planned or refused without
    /// overflow.
    #[test]
    fn huge_arcs_do_not_overflow(
        at in prop::array::uniform3(any::<i64>()),
        words in prop::array::uniform4((-999_999_999i64..999_999_999, 0u8..9)),
        code in 0usize..4,
    ) {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        modal.set_position(at.map(Nm));
        let [x, y, i, j] = words.map(|(digits, places)| Decimal::new(digits, places).unwrap());
        let line = match code {
            0 => format!("G2 X{x} Y{y} I{i} J{j} F1"),
            1 => format!("G3 X{x} Y{y} R{i} F1"),
            2 => format!("G90.1 G2 X{x} Y{y} I{i} J{j} F1"),
            _ => format!("G91 G18 G3 X{x} Z{y} R{i} P3 F1"),
        };
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).unwrap();
        if let Err(error) = modal.plan(&block) {
            prop_assert!(error.end <= line.len());
        }
    }

    /// A drilling cycle goes into new material only at the feed, goes in rapid only where it has
    /// been, and ends at its clear level.
    #[test]
    fn cycles_do_not_ram(
        code in prop::sample::select(vec!["G73", "G81", "G82", "G83", "G85", "G86", "G89"]),
        start in -20i64..20,
        retract in -20i64..20,
        depth in 0i64..40,
        peck in 1i64..15,
        repeats in 1u32..4,
        to_retract in any::<bool>(),
        incremental in any::<bool>(),
    ) {
        let level = if to_retract { "G99" } else { "G98" };
        let peck = if matches!(code, "G73" | "G83") {
            format!(" Q{peck}")
        } else {
            String::new()
        };
        let mode = if incremental { "G91" } else { "G90" };
        let (r, z) = if incremental {
            (retract - start, -depth)
        } else {
            (retract, retract - depth)
        };
        let cycle = format!("{mode} {level} {code} X1 Y2 R{r} Z{z} L{repeats}{peck}");
        let (modal, commands) = plan(&["G21 M3 S1 F100".into(), format!("G0 Z{start}"), cycle]);
        let bottom = Nm((retract - depth) * 1_000_000);
        let (mut floor, mut at, mut holes) =
            (Nm(i64::MAX), [Nm(0), Nm(0), Nm(start * 1_000_000)], 0);
        for command in commands.iter().skip(2) {
            match command {
                Command::Rapid { to } => {
                    if (to[0], to[1]) != (at[0], at[1]) {
                        prop_assert_eq!(to[2], at[2]);
                        floor = Nm(i64::MAX);
                    }
                    prop_assert!(to[2] >= floor || to[2] >= Nm(retract * 1_000_000));
                    at = *to;
                }
                Command::Linear { to, .. } => {
                    prop_assert_eq!((to[0], to[1]), (at[0], at[1]));
                    holes += u32::from(to[2] == bottom);
                    floor = floor.min(to[2]);
                    at = *to;
                }
                _ => {}
            }
        }
        prop_assert_eq!(holes >= repeats, true);
        let clear = if to_retract {
            retract
        } else {
            retract.max(start)
        };
        prop_assert_eq!(modal.position()[2], Nm(clear * 1_000_000));
        let count = if incremental { i64::from(repeats) } else { 1 };
        prop_assert_eq!(modal.position()[0], Nm(count * 1_000_000));
    }

    /// L repeats under G91 equal the same number of blocks of the same cycle.
    #[test]
    fn repeats_are_blocks(
        x in -9i64..9,
        y in -9i64..9,
        repeats in 1usize..5,
        level in prop::sample::select(vec!["G98", "G99"]),
    ) {
        let start = || {
            vec![
                "G21 F100".to_owned(),
                "G0 Z5".to_owned(),
                format!("G91 {level} G81 X{x} Y{y} R-2 Z-3"),
            ]
        };
        let mut once = start();
        once.push(format!("X{x} Y{y} L{repeats}"));
        let mut often = start();
        often.extend(vec![format!("X{x} Y{y}"); repeats]);
        prop_assert_eq!(plan(&once).1, plan(&often).1);
    }

    /// After G10 L20 and after G92 the position reads the given values, in any frame, shift and
    /// tool length.
    #[test]
    fn frames_read_what_they_were_told(
        x in -999i64..999,
        zero in -999i64..999,
        shift in -99i64..99,
        length in -99i64..99,
        wanted in -999i64..999,
        telling in prop::sample::select(vec!["G10 L20 P1", "G92"]),
    ) {
        let (modal, _) = plan(&[
            format!("G21 G0 X{x}"),
            format!("G10 L2 P1 X{zero}"),
            format!("G92 X{shift}"),
            format!("G43.1 X{length}"),
            format!("{telling} X{wanted}"),
        ]);
        let reads = modal.position()[0].0 - modal.work_offset()[0].0 - modal.tool_length()[0].0;
        prop_assert_eq!(reads, wanted * 1_000_000);
        prop_assert_eq!(modal.position()[0], Nm(x * 1_000_000));
    }

    /// The raised control points of a quadratic curve are within a third of a nanometre of the
    /// exact ones.
    #[test]
    fn raised_curves_are_exact(
        i in -9_999_999i64..9_999_999,
        j in 1i64..9_999_999,
        x in -9_999_999i64..9_999_999,
    ) {
        let (_, commands) = plan(&[format!("G21 F1 G5.1 X{} Y0 I{} J{}", Nm(x), Nm(i), Nm(j))]);
        let Some(Command::Spline { spline, .. }) = commands.first() else {
            panic!("no spline")
        };
        for (point, end) in [(spline.points[1], [0, 0]), (spline.points[2], [x, 0])] {
            for (axis, control) in [(0, i), (1, j)] {
                prop_assert!((3 * point[axis].0 - (end[axis] + 2 * control)).abs() <= 1);
            }
        }
    }

    /// A diameter is twice a radius, rounded once.
    #[test]
    fn diameters_are_halved_once(
        digits in -1_000_000i64..1_000_000,
        places in 0u8..9,
        inch in any::<bool>(),
    ) {
        let number = Decimal::new(digits, places).unwrap();
        let (units, half) = if inch {
            ("G20", number.scaled(127, 5))
        } else {
            ("G21", number.scaled(5, 5))
        };
        let (modal, _) = plan(&[format!("{units} G7 G0 X{number}")]);
        prop_assert_eq!(modal.position()[0], Nm(half.unwrap()));
    }

    /// A threading cycle never cuts deeper than its K, never shallower than the pass before, and
    /// ends at the drive line.
    #[test]
    fn threads_deepen(
        first in 100i64..500,
        full in 500i64..2_000,
        degression in 10u32..30,
        springs in 0usize..3,
        angle in 0u32..60,
    ) {
        let (modal, commands) = plan(&[
            "G21 G18 M3 S100 G0 X20 Z5".into(),
            format!(
                "G76 P1 Z-10 I-1 J{} K{} R{}.{} Q{angle} H{springs}",
                Nm(first * 1_000),
                Nm(full * 1_000),
                degression / 10,
                degression % 10
            ),
        ]);
        let depths: Vec<_> = commands
            .iter()
            .filter_map(|command| match command {
                Command::Thread { to, .. } => Some(19_000_000 - to[0].0),
                _ => None,
            })
            .collect();
        prop_assert!(depths.is_sorted());
        prop_assert_eq!(depths.first().copied(), Some(first * 1_000));
        let last = depths
            .iter()
            .filter(|&&depth| depth == full * 1_000)
            .count();
        prop_assert_eq!(last, springs + 1);
        prop_assert_eq!(modal.position(), [Nm(20_000_000), Nm(0), Nm(-10_000_000)]);
    }
}
