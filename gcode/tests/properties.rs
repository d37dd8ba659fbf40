//! Properties, each in words.

use fixed::types::{I16F16, I40F24};
use husillo_gcode::{Block, Command, Decimal, Dialect, Error, Modal, Nm, words};
use proptest::prelude::*;

/// Digits of one number as a program writes it.
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
    ]);
    let letter = prop::sample::select(b"XYZABCIJKRPFSTNxyzijrfHQ".to_vec());
    let word =
        (letter, number()).prop_map(|(letter, number)| format!("{}{number}", char::from(letter)));
    prop::collection::vec(prop_oneof![code.prop_map(str::to_owned), word], 0..8)
        .prop_map(|parts| parts.join(" "))
}

/// Runs lines; asserts that each error lies inside its text and leaves the state as it was.
fn run(dialect: Dialect, lines: &[Vec<u8>]) -> (Modal<3>, Vec<Command<3>>) {
    let mut modal = Modal::<3>::new(dialect);
    let mut made = Vec::new();
    for line in lines {
        for (offset, text) in dialect.blocks(line) {
            assert!(offset + text.len() <= line.len());
            let before = modal.clone();
            match Block::parse(text, &dialect).and_then(|block| modal.plan(&block)) {
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
fn scaled_wide(digits: i64, places: u8, factor: i64, exponent: u8) -> i128 {
    let top = i128::from(digits) * i128::from(factor) * 10i128.pow(u32::from(exponent));
    let bottom = 10i128.pow(u32::from(places));
    let half = if top < 0 { -bottom / 2 } else { bottom / 2 };
    (top + half) / bottom
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// No bytes make it panic; every error lies inside its block; an error changes nothing.
    #[test]
    fn any_bytes_are_read_or_refused(lines in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..60), 0..4)) {
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
    }

    /// The programmed position is where the last move ended.
    #[test]
    fn position_is_the_end_of_the_last_move(lines in prop::collection::vec(program_line(), 0..20)) {
        let (modal, commands) = plan(&lines);
        let last = commands.iter().rev().find_map(|command| match command {
            Command::Rapid { to } | Command::Linear { to, .. } => Some(*to),
            Command::Arc { arc, .. } => Some(arc.to),
            _ => None,
        });
        prop_assert_eq!(modal.position(), last.unwrap_or_default());
    }

    /// A number printed and read again is the same number, places included.
    #[test]
    fn numbers_print_and_read_back(digits in -i64::MAX..=i64::MAX, shift in 0u32..63, places in 0u8..=30) {
        let number = Decimal::new(digits >> shift, places).unwrap();
        prop_assert_eq!(value(&number.to_string()), Some(number));
    }

    /// Blanks, tabs and case change nothing.
    #[test]
    fn blanks_are_ignored(text in "[+-]?[0-9]{1,6}\\.[0-9]{1,6}", gaps in prop::collection::vec(0usize..3, 16)) {
        let spaced: String = text.chars().zip(&gaps).map(|(c, &gap)| format!("{c}{}", &" \t "[..gap])).collect();
        prop_assert_eq!(value(&text), value(&spaced));
    }

    /// Scaling rounds once, halves away from zero, and gives up only where the result does not fit.
    #[test]
    fn scaling_is_exact(digits in any::<i64>(), shift in 0u32..63, places in 0u8..=22, inch in any::<bool>()) {
        let digits = (digits >> shift).max(-i64::MAX);
        let (factor, exponent) = if inch { (254, 5) } else { (1, 6) };
        let wide = scaled_wide(digits, places, factor, exponent);
        let expected = i64::try_from(wide).ok();
        prop_assert_eq!(Decimal::new(digits, places).unwrap().scaled(factor, exponent), expected);
    }

    /// A conversion to a `fixed` type is within half a unit of the exact value.
    #[test]
    fn fixed_types_round_once(digits in -3_000_000_000i64..3_000_000_000, places in 5u8..15) {
        let number = Decimal::new(digits, places).unwrap();
        let power = 10i128.pow(u32::from(places));
        let near = number.to_fixed::<I16F16>().unwrap();
        prop_assert!((i128::from(near.to_bits()) * power - i128::from(digits) * (1 << 16)).abs() * 2 <= power);
        let near = number.to_fixed::<I40F24>().unwrap();
        prop_assert!((i128::from(near.to_bits()) * power - i128::from(digits) * (1 << 24)).abs() * 2 <= power);
    }

    /// G91 adds the rounded words: n moves of x end at exactly n times the nanometres of x.
    #[test]
    fn increments_add_exactly(digits in -1_000_000i64..1_000_000, places in 0u8..9, count in 1usize..40, inch in any::<bool>()) {
        let number = Decimal::new(digits, places).unwrap();
        let (units, step) = if inch { ("G20", number.scaled(254, 5)) } else { ("G21", number.scaled(1, 6)) };
        let mut lines = vec![format!("{units} G91 G0")];
        lines.extend(vec![format!("X{number}"); count]);
        let (modal, commands) = plan(&lines);
        prop_assert_eq!(commands.len(), count);
        prop_assert_eq!(modal.position(), [Nm(step.unwrap() * count as i64), Nm(0), Nm(0)]);
    }

    /// G92 moves no axis, and afterwards the programmed coordinates are those it gave.
    #[test]
    fn shifts_rename_the_position(x in -9_999i64..9_999, shift in -9_999i64..9_999, to in -9_999i64..9_999) {
        let line = format!("G1 X{to}");
        let (modal, _) = plan(&[format!("G21 G0 X{x}"), format!("G92 X{shift} F1"), line]);
        prop_assert_eq!(modal.position()[0], Nm((x - shift + to) * 1_000_000));
        prop_assert_eq!(modal.work_offset()[0], Nm((x - shift) * 1_000_000));
    }

    /// The mismatch of an accepted arc is the difference of its radii to the nearest nanometre.
    #[test]
    fn mismatch_is_the_difference_of_radii(
        i in -50_000_000i64..50_000_000, j in -50_000_000i64..50_000_000, angle in 0.0f64..6.25, off in -5_000.0f64..5_000.0
    ) {
        let radius = ((i as f64).hypot(j as f64) + off).max(1.0);
        let (x, y) = ((radius * angle.cos()) as i64 + i, (radius * angle.sin()) as i64 + j);
        let (_, commands) = plan(&[format!("G21 G2 X{} Y{} I{} J{} F1", Nm(x), Nm(y), Nm(i), Nm(j))]);
        if let Some(Command::Arc { arc, .. }) = commands.first() {
            let exact = ((i as f64).hypot(j as f64) - ((x - i) as f64).hypot((y - j) as f64)).abs();
            prop_assert!((arc.mismatch.0 as f64 - exact).abs() <= 0.5001, "{} for {}", arc.mismatch, exact);
            prop_assert_eq!(arc.centre, [Nm(i), Nm(j), Nm(0)]);
        } else {
            prop_assert!(off.abs() > 4_990.0 || (i, j) == (0, 0));
        }
    }

    /// The centre of an R arc is one radius from both ends to the rounding of its coordinates, on the right side.
    #[test]
    fn radius_arcs_have_their_centre(
        x in -90_000_000i64..90_000_000, y in -90_000_000i64..90_000_000, more in 0i64..1_000_000_000, long in any::<bool>(), left in any::<bool>()
    ) {
        prop_assume!((x, y) != (0, 0));
        let radius = ((x as f64).hypot(y as f64) / 2.0).ceil() as i64 + more;
        let (sign, code) = (if long { "-" } else { "" }, if left { "G3" } else { "G2" });
        let (_, commands) = plan(&[format!("G21 {code} X{} Y{} R{sign}{} F1", Nm(x), Nm(y), Nm(radius))]);
        let Some(Command::Arc { arc, .. }) = commands.first() else { panic!("no arc") };
        prop_assert_eq!(arc.radius, Some(Nm(radius)));
        let (cx, cy) = (arc.centre[0].0, arc.centre[1].0);
        for (dx, dy) in [(cx, cy), (cx - x, cy - y)] {
            prop_assert!(((dx as f64).hypot(dy as f64) - radius as f64).abs() <= 0.75);
        }
        let cross = i128::from(x) * i128::from(cy) - i128::from(y) * i128::from(cx);
        let on_the_left = left != long;
        // Half a nanometre of rounding across the chord.
        let slack = i128::from(x.abs().max(y.abs()));
        let right_side = if on_the_left { cross >= -slack } else { cross <= slack };
        prop_assert!(right_side);
        prop_assert!(arc.mismatch.0 <= 1);
    }

    /// Arcs of any size and place, up to the largest coordinate, are planned or refused without overflow.
    #[test]
    fn huge_arcs_do_not_overflow(
        at in prop::array::uniform3(any::<i64>()), words in prop::array::uniform4((-999_999_999i64..999_999_999, 0u8..9)), code in 0usize..4
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
}
