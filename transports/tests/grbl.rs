//! Everything that a Grbl controller writes is parsed back; no bytes disturb either end.

use husillo_transports::grbl::{
    Accessories, Adjust, Alarm, ErrorCode, Feedback, LINE_CHARACTERS, Line, LineReader, Message,
    ModalState, Parameter, Pins, Place, Position, Realtime, Receiver, SETTINGS, Settings, State,
    Status, Units, Window, decimal, key_and_value,
};
use proptest::prelude::*;
use std::collections::VecDeque;

fn units() -> impl Strategy<Value = Units> {
    prop_oneof![Just(Units::Millimetres), Just(Units::Inches)]
}

/// Lengths that the unit can print, nm.
fn place(units: Units) -> impl Strategy<Value = Place> {
    let last = if units == Units::Inches { 2540 } else { 1000 };
    prop::collection::vec(-9_000_000_i64..9_000_000, 3..=6).prop_map(move |places| {
        Place::new(&places.iter().map(|place| place * last).collect::<Vec<_>>())
    })
}

fn status(units: Units) -> impl Strategy<Value = Status> {
    let feed_unit = if units == Units::Inches {
        2_540_000
    } else {
        1_000_000
    };
    let fields = (
        // Newer controllers have longer queues and buffers than Grbl.
        prop::option::of((0_u16..1024, 0_u16..4096)),
        prop::option::of(0_u32..10_000_000),
        0_u64..100_000,
        0_u32..100_000,
        0_u16..1 << 11,
        0_u8..16,
    );
    let places = (place(units), any::<bool>(), prop::option::of(place(units)));
    let overrides = prop::option::of(any::<[u8; 3]>());
    (0..State::ALL.len(), places, fields, overrides).prop_map(
        move |(state, (at, is_work, work_zero), (free, line, feed, rpm, pins, runs), overrides)| {
            let position = if is_work {
                Position::Work(at)
            } else {
                Position::Machine(at)
            };
            Status {
                free,
                line,
                feed_nm_per_min: feed * feed_unit,
                rpm,
                pins: Pins(pins),
                work_zero,
                overrides,
                accessories: Accessories(runs),
                ..Status::new(State::ALL[state], position)
            }
        },
    )
}

fn is_back(message: Message, units: Units) -> Result<(), TestCaseError> {
    let text = message.write(units);
    prop_assert_eq!(Message::parse(text.bytes()), Some(message));
    Ok(())
}

proptest! {
    #[test]
    fn status_reports_are_parsed_back(
        (units, status) in units().prop_flat_map(|units| (Just(units), status(units)))
    ) {
        is_back(Message::Status(status), units)?;
    }

    #[test]
    fn coordinates_are_parsed_back(
        (units, place) in units().prop_flat_map(|units| (Just(units), place(units))),
        contact: bool,
    ) {
        for parameter in Parameter::ALL {
            is_back(Message::Parameter(parameter, place), units)?;
        }
        is_back(Message::Probe(place, contact), units)?;
        is_back(Message::ToolLength(place.nm()[0]), units)?;
    }

    #[test]
    fn modal_states_are_parsed_back(
        motion in prop::sample::select(vec![0, 10, 20, 30, 382, 383, 384, 385, 800_u16]),
        frame in 54_u16..60,
        plane in 17_u16..20,
        switches: [bool; 5],
        program in prop::option::of(prop::sample::select(vec![0_u16, 20, 300])),
        spindle in 3_u16..6,
        tool: u8,
        feed in 0_u64..100_000,
        rpm in 0_u64..100_000,
        units in units(),
    ) {
        let [in_inches, is_incremental, is_inverse, mist, flood] = switches;
        let feed_unit = if units == Units::Inches { 2_540_000 } else { 1_000_000 };
        let state = ModalState {
            motion,
            frame: frame * 10,
            plane: plane * 10,
            units: if in_inches { 200 } else { 210 },
            distance: if is_incremental { 910 } else { 900 },
            feed_mode: if is_inverse { 930 } else { 940 },
            program,
            spindle: spindle * 10,
            mist,
            flood,
            tool,
            feed_nm_per_min: feed * feed_unit,
            milli_rpm: rpm * 1000,
        };
        is_back(Message::Modal(state), units)?;
    }

    /// One wrong byte in an answer to a checked line does not give another answer.
    #[test]
    fn a_changed_answer_is_none(number: u32, at: prop::sample::Index, byte: u8, refused: bool) {
        let message = match refused {
            true => Message::Answer(number, Some(ErrorCode::NoFeed)),
            false => Message::Resend(number),
        };
        let mut line = message.write(Units::Millimetres).bytes().to_vec();
        let at = at.index(line.len());
        line[at] = byte;
        let read = Message::parse(&line);
        let is_answer = matches!(read, Some(Message::Answer(..) | Message::Resend(_)));
        prop_assert!(!is_answer || read == Some(message), "{:?}", read);
    }

    /// Any line is a message that is written as it was read, or none.
    #[test]
    fn any_line_is_safe(line in prop::collection::vec(any::<u8>(), 0..100)) {
        if let Some(message) = Message::parse(&line) {
            let again = message.write(Units::Millimetres);
            prop_assert!(Message::parse(again.bytes()).is_some());
        }
    }

    #[test]
    fn settings_are_read_as_they_are_printed(
        index in 0..SETTINGS.len(),
        value in 0_u32..5_000_000,
        point in any::<bool>(),
    ) {
        let mut settings = Settings::DEFAULT;
        prop_assert_eq!(settings.write(22, b"1"), Ok(()));
        let text = if point {
            format!("{}.{:03}", value / 1000, value % 1000)
        } else {
            format!("{}", value / 1000)
        };
        let before = settings;
        let number = SETTINGS[index].number;
        match settings.write(number, text.as_bytes()) {
            Err(_) => prop_assert_eq!(settings, before),
            Ok(()) => {
                let (_, printed) = settings.text(index).unwrap();
                let mut again = settings;
                prop_assert_eq!(again.write(number, printed.bytes()), Ok(()));
                let (_, reprinted) = again.text(index).unwrap();
                prop_assert_eq!(printed.bytes(), reprinted.bytes());
            }
        }
        prop_assert_eq!(Settings::from_bytes(&settings.to_bytes()), settings);
    }

    /// A decimal number equals its value, whatever the places that are asked for.
    #[test]
    fn decimals_are_rounded_to_nearest(
        value in -1_000_000_000_i64..1_000_000_000,
        places in 0_u8..6,
    ) {
        let sign = if value < 0 { "-" } else { "" };
        let size = value.unsigned_abs();
        let text = format!("{sign}{}.{:06}X", size / 1_000_000, size % 1_000_000);
        let unit = 10_u64.pow(6 - u32::from(places));
        let nearest = (size + unit / 2) / unit;
        let nearest = if value < 0 { -(nearest as i64) } else { nearest as i64 };
        prop_assert_eq!(decimal(text.as_bytes(), places), Some((nearest, &b"X"[..])));
    }

    /// Lines come out as if the comments, blanks and slashes had never been there, and never longer
    /// than 79 characters. Real-time bytes do not belong to any line.
    #[test]
    fn lines_are_filtered(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let mut receiver = Receiver::<256>::new();
        let mut reader = LineReader::new();
        let (mut lines, mut ends) = (0, 0);
        for byte in bytes {
            ends += i32::from(matches!(byte, b'\r' | b'\n'));
            let realtime = receiver.push(byte);
            prop_assert_eq!(realtime, Realtime::of(byte));
            while let Some(byte) = receiver.take() {
                if let Some(line) = reader.push(byte) {
                    lines += 1;
                    if let Line::Text(text) = line {
                        prop_assert!(text.len() <= LINE_CHARACTERS);
                        let is_plain = |byte: &u8| {
                            (b'!'..0x80).contains(byte)
                                && !byte.is_ascii_lowercase()
                                && !b"/;(".contains(byte)
                        };
                        prop_assert!(text.iter().all(is_plain), "{text:?}");
                    }
                }
            }
        }
        prop_assert_eq!(lines, ends);
    }

    /// The window counts as an unbounded queue of lengths would.
    #[test]
    fn the_window_counts_bytes(
        orders in prop::collection::vec((any::<bool>(), 1_u8..100), 0..400),
    ) {
        let mut window = Window::new(128);
        let mut model = VecDeque::new();
        for (is_sent, length) in orders {
            let bytes: u16 = model.iter().map(|length| u16::from(*length)).sum();
            prop_assert_eq!((window.bytes(), window.lines()), (bytes, model.len()));
            if is_sent {
                let fits = bytes + u16::from(length) <= 128 || model.is_empty();
                prop_assert_eq!(window.send(length), fits);
                if fits {
                    model.push_back(length);
                }
            } else {
                prop_assert_eq!(window.answered(), model.pop_front());
            }
        }
    }
}

#[test]
fn real_time_bytes_are_their_own_inverse() {
    for byte in 0..=255 {
        if let Some(realtime) = Realtime::of(byte) {
            assert_eq!(realtime.byte(), byte);
        }
    }
    assert_eq!(Realtime::of(0x92), Some(Realtime::Feed(Adjust::By(-10))));
    assert_eq!(Adjust::By(10).apply(195), 200);
    assert_eq!(Adjust::By(-10).apply(15), 10);
    assert_eq!(Adjust::Reset.apply(15), 100);
}

#[test]
fn answers_to_checked_lines_have_a_checksum() {
    let written = |message: Message| message.write(Units::Millimetres).bytes().to_vec();
    assert_eq!(written(Message::Answer(12, None)), b"ok N12*105");
    let error = Some(ErrorCode::Unsupported);
    assert_eq!(written(Message::Answer(12, error)), b"error:20 N12*45");
    assert_eq!(written(Message::Resend(12)), b"resend N12*102");
}

#[test]
fn fixed_messages_are_parsed_back() {
    let mut messages = vec![
        Message::Ok,
        Message::Blank,
        Message::Answer(12, None),
        Message::Answer(u32::MAX, Some(ErrorCode::NoFeed)),
        Message::Resend(7),
        Message::NextLine(1),
        Message::Banner(b"Grbl 1.1h"),
        Message::Setting(110, b"500.000"),
        Message::Stored(1, b"G21G90"),
        Message::Stored(0, b""),
        Message::Executed(b"G21", None),
        Message::Executed(b"G1X5", Some(ErrorCode::NoFeed)),
        Message::Executed(b"", Some(ErrorCode::StoreRead)),
        Message::Version(b"1.1h.20190830", b"MINE"),
        Message::Options(b"V", 15, 128),
        Message::Help(b"$$ $# ~ ! ? ctrl-x"),
        Message::Feedback(Feedback::Unlock),
        Message::Feedback(Feedback::Other(b"hello")),
    ];
    messages.extend(ErrorCode::ALL.map(Message::Error));
    messages.extend(Alarm::ALL.map(Message::Alarm));
    for message in messages {
        let text = message.write(Units::Millimetres);
        assert_eq!(Message::parse(text.bytes()), Some(message));
        let is_answer = matches!(message, Message::Ok | Message::Error(_));
        assert_eq!(message.is_answer(), is_answer);
    }
}

/// The list of settings and its defaults as Grbl 1.1h prints them.
#[test]
fn defaults_are_those_of_the_generic_machine() {
    let printed: Vec<_> = (0..SETTINGS.len())
        .filter_map(|index| Settings::DEFAULT.text(index))
        .map(|(setting, value)| {
            let text = Message::Setting(setting.number, value.bytes()).write(Units::Millimetres);
            String::from_utf8(text.bytes().to_vec()).unwrap()
        })
        .collect();
    assert_eq!(
        printed.join(" "),
        "$0=10 $1=25 $2=0 $3=0 $4=0 $5=0 $6=0 $10=1 $11=0.010 $12=0.002 $13=0 $20=0 $21=0 $22=0 \
         $23=0 $24=25.000 $25=500.000 $26=250 $27=1.000 $30=1000 $31=0 $32=0 $100=250.000 \
         $101=250.000 $102=250.000 $110=500.000 $111=500.000 $112=500.000 $120=10.000 \
         $121=10.000 $122=10.000 $130=200.000 $131=200.000 $132=200.000"
    );
}

#[test]
fn refused_settings_have_the_errors_of_grbl() {
    let mut settings = Settings::DEFAULT;
    for (line, error) in [
        ("0=2", ErrorCode::StepPulse),
        ("100=-1", ErrorCode::Negative),
        ("5", ErrorCode::InvalidStatement),
        ("5=", ErrorCode::BadNumber),
        ("=5", ErrorCode::BadNumber),
        ("ABC", ErrorCode::BadNumber),
        ("99=1", ErrorCode::InvalidStatement),
        ("256=1", ErrorCode::InvalidStatement),
        ("20=1", ErrorCode::SoftLimitsNeedHoming),
        ("10=1X", ErrorCode::InvalidStatement),
        ("110=1E3", ErrorCode::InvalidStatement),
    ] {
        let written = key_and_value(line.as_bytes())
            .and_then(|(number, value)| settings.write(number, value));
        assert_eq!(written, Err(error), "{line}");
    }
    assert_eq!(settings, Settings::DEFAULT);
    assert_eq!(settings.write(22, b"1"), Ok(()));
    assert_eq!(settings.write(20, b"1"), Ok(()));
    assert_eq!(settings.write(22, b"0"), Ok(()));
    assert!(!settings.is_set(20), "soft limits end with homing");
}

/// A full buffer loses further bytes, one by one. Real-time bytes still act.
#[test]
fn a_full_buffer_loses_bytes() {
    let mut receiver = Receiver::<128>::new();
    for _ in 0..130 {
        assert_eq!(receiver.push(b'X'), None);
    }
    assert_eq!((receiver.free(), receiver.lost()), (0, 2));
    assert_eq!(receiver.push(b'?'), Some(Realtime::Status));
    assert_eq!(std::iter::from_fn(|| receiver.take()).count(), 128);
}
