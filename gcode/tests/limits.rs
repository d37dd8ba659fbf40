//! Numbers at the limits of their range, each case compared with 128-bit arithmetic.

use fixed::traits::Fixed;
use fixed::types::{I0F32, I16F16, I40F24, I64F64, U32F32};
use husillo_gcode::{Decimal, Error, ErrorKind, Token, Word, WordReader, tokens, words};

const DIGITS: [i64; 12] = [
    0,
    1,
    -1,
    7,
    -25,
    2_147,
    99_999,
    2_147_483_647,
    -2_147_483_648,
    2_147_483_648,
    i64::MAX,
    -i64::MAX,
];

/// `number * factor * 10^power`, to the nearest, halves away from zero; `None` beyond 63 bits.
fn scaled(digits: i64, factor: i64, power: i32) -> Option<i64> {
    let product = i128::from(digits) * i128::from(factor);
    let ten = 10i128.checked_pow(power.unsigned_abs());
    let result = match (ten, power < 0) {
        _ if product == 0 => 0,
        (Some(ten), false) => product.checked_mul(ten)?,
        (Some(ten), true) => (product + product.signum() * (ten / 2)) / ten,
        (None, below) => {
            assert!(!below, "at most 30 places");
            return None;
        }
    };
    i64::try_from(result)
        .ok()
        .filter(|result| *result != i64::MIN)
}

/// Every power of ten, including those that no integer of 32 or 64 bits holds, on every path
/// through the arithmetic.
#[test]
fn numbers_are_scaled_by_every_power() {
    for digits in DIGITS {
        for places in 0..=Decimal::MAX_PLACES {
            let number = Decimal::new(digits, places).expect("within range");
            for exponent in 0..=40 {
                for factor in [1, 5, 127, 254, 2_147, 2_148, 1 << 30, i32::MAX] {
                    for factor in [factor, -factor] {
                        let power = i32::from(exponent) - i32::from(places);
                        assert_eq!(
                            number.scaled(factor, exponent),
                            scaled(digits, i64::from(factor), power),
                            "{number} * {factor} * 10^{exponent}"
                        );
                    }
                }
            }
        }
    }
}

/// A number is whole when only zeros follow its point, however many.
#[test]
fn whole_numbers_are_distinguished_from_others() {
    for digits in [0, 10, -10, 1_000_000, 10_i64.pow(18), 5, -105]
        .into_iter()
        .chain(DIGITS)
    {
        for places in 0..=Decimal::MAX_PLACES {
            let number = Decimal::new(digits, places).expect("within range");
            let ten = 10i128.pow(u32::from(places));
            let whole = (i128::from(digits) % ten == 0).then(|| (i128::from(digits) / ten) as i64);
            assert_eq!(number.whole(), whole, "{number}");
        }
    }
}

/// The nearest value of a binary type, halves away from zero; `None` outside its range.
fn nearest<F: Fixed>(digits: i64, places: u8) -> Option<F>
where
    F::Bits: TryFrom<i128>,
{
    // 2^63 * 2^64 is the most that 128 bits hold.
    let ten = 10u128.pow(u32::from(places));
    let magnitude = u128::from(digits.unsigned_abs()) << F::FRAC_NBITS;
    let (bits, rest) = (magnitude / ten, magnitude % ten);
    let bits = i128::try_from(bits + u128::from(rest >= ten - rest)).ok()?;
    let bits = if digits < 0 { -bits } else { bits };
    F::Bits::try_from(bits).ok().map(F::from_bits)
}

/// Conversions to binary types round once and fail outside the range of the type.
#[test]
fn fixed_types_end_where_they_end() {
    let ends = [
        (1 << 15, 0),
        (327_675, 1),
        (-32_768, 0),
        (499_999, 6),
        (5, 1),
        (-5, 1),
    ];
    for (digits, places) in DIGITS
        .into_iter()
        .flat_map(|digits| (0..=Decimal::MAX_PLACES).map(move |places| (digits, places)))
        .chain(ends)
    {
        let number = Decimal::new(digits, places).expect("within range");
        assert_eq!(
            number.to_fixed(),
            nearest::<I16F16>(digits, places),
            "{number}"
        );
        assert_eq!(
            number.to_fixed(),
            nearest::<I40F24>(digits, places),
            "{number}"
        );
        assert_eq!(
            number.to_fixed(),
            nearest::<I0F32>(digits, places),
            "{number}"
        );
        assert_eq!(
            number.to_fixed(),
            nearest::<U32F32>(digits, places),
            "{number}"
        );
        assert_eq!(
            number.to_fixed(),
            nearest::<I64F64>(digits, places),
            "{number}"
        );
    }
}

/// Sign, zero and places of numbers that are zero, negative and positive.
#[test]
fn signs_and_places_are_reported() {
    for (digits, sign) in [(0, 0), (3, 1), (-3, -1)] {
        for places in [0, 1, 18, 19, 20, 30] {
            let number = Decimal::new(digits, places).expect("within range");
            assert_eq!(
                (number.is_zero(), number.is_negative()),
                (sign == 0, sign < 0)
            );
            assert_eq!(
                number.last_place(),
                Decimal::new(1, places).expect("within range")
            );
        }
    }
    assert_eq!(Decimal::new(i64::MIN, 0), None);
    assert_eq!(Decimal::new(1, 31), None);
}

/// The only word of a line, read from the line and byte by byte.
fn number(text: &str) -> Result<Decimal, ErrorKind> {
    let line = format!("X{text}");
    let read = words(line.as_bytes()).next().expect("a word");
    let mut reader = WordReader::new();
    let mut pushed: Vec<_> = line.bytes().filter_map(|byte| reader.push(byte)).collect();
    pushed.extend(reader.finish());
    assert_eq!(pushed, [read], "{text}");
    read.map(|word| word.value).map_err(|error| error.kind)
}

/// Digits and places end at their limits; only zeros may follow the last place, and they are
/// dropped.
#[test]
fn written_numbers_end_where_they_end() {
    let number_of = |digits, places| Ok(Decimal::new(digits, places).expect("within range"));
    let zeros = |count| "0".repeat(count);
    assert_eq!(number("9223372036854775807"), number_of(i64::MAX, 0));
    assert_eq!(number("-9223372036854775807"), number_of(-i64::MAX, 0));
    assert_eq!(
        number("9223372036854775808"),
        Err(ErrorKind::NumberTooLarge)
    );
    assert_eq!(number("9.223372036854775807"), number_of(i64::MAX, 18));
    assert_eq!(
        number("9.223372036854775808"),
        Err(ErrorKind::TooManyDigits)
    );
    assert_eq!(
        number(&format!("1.{}", zeros(40))),
        number_of(10_i64.pow(18), 18)
    );
    assert_eq!(number(&format!("0.{}7", zeros(29))), number_of(7, 30));
    assert_eq!(number(&format!("0.{}70", zeros(29))), number_of(7, 30));
    assert_eq!(
        number(&format!("0.{}7", zeros(30))),
        Err(ErrorKind::TooManyDigits)
    );
    assert_eq!(number(&format!("0.{}", zeros(30))), number_of(0, 30));
    assert_eq!(number(&format!("0.{}", zeros(31))), number_of(0, 30));
    // After dropped zeros only zeros may follow.
    assert_eq!(
        number(&format!("1.{}1", zeros(40))),
        Err(ErrorKind::TooManyDigits)
    );
}

type Found = Vec<Result<(u8, Decimal, usize), ErrorKind>>;

fn found(words: impl Iterator<Item = Result<Word, Error>>) -> Found {
    words
        .map(|word| {
            word.map(|word| (word.letter, word.value, word.at))
                .map_err(|error| error.kind)
        })
        .collect()
}

fn check_ways(line: &[u8]) {
    let shown = String::from_utf8_lossy(line);
    let expected = found(words(line));
    let mut reader = WordReader::new();
    let mut pushed: Vec<_> = line.iter().filter_map(|&byte| reader.push(byte)).collect();
    pushed.extend(reader.finish());
    assert_eq!(found(pushed.into_iter()), expected, "{shown}");
    assert_eq!(reader.is_deleted(), is_deleted(line), "{shown}");
    for behind in [&[b' '; 20], b"\n;                  "] {
        let long = [line, behind].concat();
        let whole = tokens(&long).filter_map(|token| match token {
            Ok(Token::Word(word)) => Some(Ok(word)),
            Ok(Token::EndOfLine) => None,
            Err(error) => Some(Err(error)),
        });
        assert_eq!(found(whole), expected, "{shown} in a text");
        if behind[0] == b' ' {
            assert_eq!(found(words(&long)), expected, "{shown} and blanks");
        }
    }
}

fn is_deleted(line: &[u8]) -> bool {
    let mut words = words(line);
    words.by_ref().for_each(drop);
    words.is_deleted()
}

/// All lines of up to five relevant bytes read the same by all code paths: near the end of the text
/// and far from it, alone and in a text, as a whole and byte by byte.
#[test]
fn every_short_line_is_read_the_same_in_every_way() {
    if cfg!(miri) {
        return;
    }
    const BYTES: &[u8] = b"Xn1. -,(/%#";
    for length in 0..=5 {
        for mut index in 0..BYTES.len().pow(length) {
            let line: Vec<u8> = (0..length)
                .map(|_| {
                    let byte = BYTES[index % BYTES.len()];
                    index /= BYTES.len();
                    byte
                })
                .collect();
            check_ways(&line);
        }
    }
}
