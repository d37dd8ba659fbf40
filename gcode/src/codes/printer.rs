//! The codes of 3D printers.

use crate::codes::code::Code;

/// What a printer does with the rest of a line whose words are not those of other machines.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Rest {
    /// The whole line has no effect here: a setting, a report, a message, a levelled bed.
    Ignored,
    /// G28: letters of axes, with or without values.
    Home,
    /// M84 and M18, for all axes.
    MotorsOff,
    /// M600: the filament is changed by the operator.
    Pause,
}

/// M codes without an effect on the motion: progress, reports and messages, limits and other
/// settings of the firmware, the identity of the printer.
const IGNORED: [u16; 49] = [
    20, 21, 31, 73, 75, 76, 77, 78, 105, 108, 110, 111, 113, 114, 115, 117, 118, 119, 150, 155,
    201, 203, 204, 205, 207, 208, 209, 211, 220, 221, 300, 301, 302, 304, 355, 400, 412, 413, 420,
    486, 500, 501, 503, 555, 569, 572, 593, 862, 900,
];

/// The code of a letter (`G` or `M`) and a number in tenths that a printer reads differently.
pub(crate) const fn of_printer(letter: u8, tenths: u16) -> Option<Code> {
    Some(match (letter, tenths) {
        (b'G', 100) => Code::Retract,
        (b'G', 110) => Code::Unretract,
        // Read with the rest of their lines.
        (b'G', 280) | (b'M', 180 | 730) => Code::Foreign,
        (b'M', 820) => Code::ExtruderAbsolute,
        (b'M', 830) => Code::ExtruderRelative,
        (b'M', 1040) => Code::HeatExtruder,
        (b'M', 1060) => Code::Fan,
        (b'M', 1070) => Code::FanOff,
        (b'M', 1090) => Code::HeatExtruderAndWait,
        (b'M', 1400) => Code::HeatBed,
        (b'M', 1410) => Code::HeatChamber,
        (b'M', 1900) => Code::HeatBedAndWait,
        (b'M', 1910) => Code::HeatChamberAndWait,
        _ => return None,
    })
}

/// What is done with the rest of the line after this code; `None` for a code that is none of a
/// printer.
pub(crate) fn rest(letter: u8, number: u16) -> Option<Rest> {
    Some(match (letter, number) {
        (b'G', 28) => Rest::Home,
        // Levelling, cleaning and parking.
        (b'G', 12 | 26 | 27 | 29 | 34) => Rest::Ignored,
        (b'M', 18 | 84) => Rest::MotorsOff,
        (b'M', 600) => Rest::Pause,
        (b'M', number) if IGNORED.binary_search(&number).is_ok() => Rest::Ignored,
        _ => return None,
    })
}

/// The letter and the whole number of the code at the start of a text, without digits after a
/// blank: `M117 100 %` is M117. Blanks before the number do not count, as in Marlin. `None` for a
/// number with a point, except those of M862.
pub(crate) fn code_at(text: &[u8]) -> Option<(u8, u16)> {
    let (letter, rest) = text.split_first()?;
    let rest = rest.trim_ascii_start();
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit());
    // Zeros may precede the number. One above 16 bits is no code.
    let number = digits.fold(0_u16, |number, digit| {
        let digit = u16::from(digit.wrapping_sub(b'0'));
        number.saturating_mul(10).saturating_add(digit)
    });
    let mut behind = rest.iter().skip_while(|byte| byte.is_ascii_digit());
    let has_point = behind.next() == Some(&b'.');
    let is_whole = !has_point || matches!(behind.next(), Some(b'0'));
    (is_whole || number == 862).then_some((letter.to_ascii_uppercase(), number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_printers_are_known_by_their_code() {
        assert!(IGNORED.is_sorted());
        for (text, known) in [
            ("M117 100 % done", Some(Rest::Ignored)),
            ("m862.3 P \"MK3S\"", Some(Rest::Ignored)),
            ("G28 W", Some(Rest::Home)),
            ("G 29 V4", Some(Rest::Ignored)),
            ("M84 X Y E", Some(Rest::MotorsOff)),
            ("M600", Some(Rest::Pause)),
            ("M1170", None),
            ("M00117 done", Some(Rest::Ignored)),
            ("M00200", None),
            ("M655560117", None),
            ("G12.1 X1", None),
            ("G29.0", Some(Rest::Ignored)),
            ("M3", None),
            ("", None),
        ] {
            let code = code_at(text.as_bytes());
            assert_eq!(
                code.and_then(|(letter, number)| rest(letter, number)),
                known,
                "{text}"
            );
        }
    }
}
