//! Records of the drill: every example of its protocol, every record both ways, any bytes at all.

use husillo_transports::drill::{
    END_OF_PROGRAM, OffTable, Record, RecordError, RecordErrorKind, STEPS_PER_MM, Table,
    record_bytes, records,
};
use proptest::prelude::*;

fn millimetres(x: i64, y: i64) -> [i64; 2] {
    [x * 1_000_000, y * 1_000_000]
}

fn read(bytes: &[u8]) -> Result<Vec<Record>, RecordError> {
    records(bytes).collect()
}

fn fault(bytes: &[u8]) -> (RecordErrorKind, usize, usize) {
    let error = read(bytes).unwrap_err();
    (error.kind, error.at, error.end)
}

#[test]
fn the_examples_of_the_protocol() {
    // A hole at 10 mm, 5 mm, and the byte that ends the download.
    let hole = Table::DRILL.hole(millimetres(10, 5)).unwrap();
    let file: Vec<u8> = record_bytes(hole).collect();
    assert_eq!(
        file,
        [0x58, 0x2e, 0x04, 0x59, 0x17, 0x02, 0x5a, 0x00, 0x00, 0x66]
    );
    assert_eq!(read(&file), Ok(hole.to_vec()));
    // 1070 steps are the 10 mm that homing backs off a switch.
    assert_eq!(Table::DRILL.move_x(10_000_000), Ok(Record::X(1070)));
    // A step is 0.009346 mm.
    assert_eq!(Table::DRILL.move_y(9_346), Ok(Record::Y(1)));
    // The buffer: 8192 = 3 * 2730 + 2, so a record straddles its end.
    let full: Vec<u8> = record_bytes([Record::Drill(0); 2731]).collect();
    assert_eq!((full.len() - 1, full[8190], full[8192]), (8193, b'Z', 0));
}

#[test]
fn every_record_comes_back() {
    for steps in 0..=u16::MAX {
        for record in [Record::X(steps), Record::Y(steps)] {
            let [letter, low, high] = record.to_bytes();
            assert_eq!(u16::from(low) + 256 * u16::from(high), steps);
            assert_eq!(Record::from_bytes([letter, low, high]), Some(record));
        }
        // The controller does not look at the number of a drilling.
        let [low, high] = steps.to_le_bytes();
        let steps = u16::from_le_bytes([low, high]);
        assert_eq!(
            Record::from_bytes([b'Z', low, high]),
            Some(Record::Drill(steps))
        );
    }
    for letter in 0..=u8::MAX {
        let known = matches!(letter, b'X' | b'Y' | b'Z');
        assert_eq!(Record::from_bytes([letter, 1, 2]).is_some(), known);
    }
}

#[test]
fn every_place_of_the_table_is_its_nearest_step() {
    for steps in 0..=i64::from(u16::MAX) {
        // The lowest and the highest nanometre that belong to the step: halves go up.
        let lowest = (2 * steps - 1) * 1_000_000;
        let lowest = lowest.div_euclid(214) + i64::from(lowest.rem_euclid(214) != 0);
        let next = (2 * steps + 1) * 1_000_000;
        let highest = next.div_euclid(214) + i64::from(next.rem_euclid(214) != 0) - 1;
        for nm in [lowest.max(-4_672), highest] {
            let record = Table::UNBOUNDED.move_x(nm);
            assert_eq!(record, Ok(Record::X(steps as u16)), "{nm} nm");
            let off_by = (nm * i64::from(STEPS_PER_MM) - steps * 1_000_000).abs();
            assert!(2 * off_by <= 1_000_000);
        }
    }
}

#[test]
fn the_table_ends_where_it_ends() {
    let table = Table::DRILL;
    assert_eq!(
        table.hole(millimetres(220, 45)),
        Ok([Record::X(23_540), Record::Y(4_815), Record::Drill(0)])
    );
    let off = |letter, at_nm: i64, last| {
        Err(OffTable {
            letter,
            at_nm,
            last,
        })
    };
    let at = 220_004_673;
    assert_eq!(table.move_x(220_004_672), Ok(Record::X(23_540)));
    assert_eq!(table.move_x(at), off(b'X', at, 23_540));
    assert_eq!(
        table.hole([at, -1_000_000]).unwrap_err().to_string(),
        "X220.004673 is off the table, 0 to 220 mm"
    );
    assert_eq!(
        table.hole(millimetres(1, 46)).unwrap_err().to_string(),
        "Y46 is off the table, 0 to 45 mm"
    );
    assert_eq!(table.move_y(-4_672), Ok(Record::Y(0)));
    assert_eq!(table.move_y(-4_673), off(b'Y', -4_673, 4_815));
    assert_eq!(Table::UNBOUNDED.move_x(612_481_307), Ok(Record::X(65_535)));
    assert_eq!(
        Table::UNBOUNDED
            .move_x(612_481_309)
            .unwrap_err()
            .to_string(),
        "X612.481309 is off the table, 0 to 612.476 mm"
    );
    for nm in [i64::MIN, i64::MAX, 1 << 50] {
        assert!(Table::UNBOUNDED.move_y(nm).is_err());
    }
}

#[test]
fn faults_have_their_place() {
    assert_eq!(fault(b""), (RecordErrorKind::NoEnd, 0, 0));
    assert_eq!(fault(b"f"), (RecordErrorKind::Empty, 0, 1));
    assert_eq!(fault(b"fXX"), (RecordErrorKind::Empty, 0, 1));
    assert_eq!(fault(b"X\x01\x00"), (RecordErrorKind::NoEnd, 3, 3));
    assert_eq!(fault(b"X\x01\x00Y\x01"), (RecordErrorKind::CutOff, 3, 5));
    assert_eq!(fault(b"Z"), (RecordErrorKind::CutOff, 0, 1));
    assert_eq!(
        fault(b"Z\0\0x\0\0f"),
        (RecordErrorKind::UnknownAxis(b'x'), 3, 4)
    );
    assert_eq!(fault(b"Z\0\0x"), (RecordErrorKind::UnknownAxis(b'x'), 3, 4));
    assert_eq!(fault(b"Z\0\0ff\n"), (RecordErrorKind::AfterEnd, 4, 6));
    // Inside of a record `f` is a number.
    assert_eq!(
        read(b"XffYffZfff"),
        Ok(vec![
            Record::X(0x6666),
            Record::Y(0x6666),
            Record::Drill(0x6666)
        ])
    );
    let messages: Vec<_> = [&b"Z\0\0\x07\0\0f"[..], b"Z\0", b"Z\0\0", b"f", b"Z\0\0f\0"]
        .iter()
        .map(|bytes| read(bytes).unwrap_err().to_string())
        .collect();
    assert_eq!(
        messages,
        [
            "record of unknown axis 0x07",
            "record cut off",
            "program without an end",
            "program without a record",
            "bytes after the end"
        ]
    );
}

fn record() -> impl Strategy<Value = Record> {
    prop_oneof![
        any::<u16>().prop_map(Record::X),
        any::<u16>().prop_map(Record::Y),
        any::<u16>().prop_map(Record::Drill)
    ]
}

/// Bytes that are often those of records.
fn anything() -> impl Strategy<Value = Vec<u8>> {
    let byte = prop_oneof![
        3 => prop::sample::select(b"XYZf".to_vec()),
        1 => any::<u8>(),
    ];
    prop::collection::vec(byte, 0..40)
}

proptest! {
    /// What is written is read back, and takes three bytes a record and one.
    #[test]
    fn programs_come_back(program in prop::collection::vec(record(), 1..200)) {
        let file: Vec<u8> = record_bytes(program.iter().copied()).collect();
        prop_assert_eq!(file.len(), 3 * program.len() + 1);
        prop_assert_eq!(read(&file), Ok(program));
    }

    /// Any bytes are read as records, or refused with a position inside. What is read is written
    /// back unchanged, except for the numbers after Z.
    #[test]
    fn any_bytes_are_read_or_refused(file in anything()) {
        let mut iterator = records(&file);
        let taken: Vec<_> = iterator.by_ref().take_while(Result::is_ok).flatten().collect();
        prop_assert!(iterator.next().is_none());
        let whole = match read(&file) {
            Ok(program) => {
                prop_assert_eq!(&program, &taken);
                3 * taken.len() + 1
            }
            Err(error) => {
                prop_assert!(error.at <= error.end && error.end <= file.len());
                prop_assert!(3 * taken.len() <= error.at);
                3 * taken.len()
            }
        };
        let written: Vec<u8> = record_bytes(taken.iter().copied()).collect();
        prop_assert_eq!(written.last(), Some(&END_OF_PROGRAM));
        for (at, (byte, original)) in written.iter().zip(&file).take(whole).enumerate() {
            let behind_z = at % 3 > 0 && file[at / 3 * 3] == b'Z';
            prop_assert!(byte == original || behind_z);
        }
    }

    /// A place on the table is off by at most half a step, and holes are independent of each other.
    #[test]
    fn places_are_off_by_half_a_step(x in -4_672_i64..=220_004_672, y in -4_672_i64..=45_004_672) {
        let hole = Table::DRILL.hole([x, y]).unwrap();
        let [Record::X(x_steps), Record::Y(y_steps), Record::Drill(0)] = hole else {
            panic!("{hole:?}")
        };
        for (nm, steps) in [(x, x_steps), (y, y_steps)] {
            let off_by = nm * 107 - i64::from(steps) * 1_000_000;
            prop_assert!(off_by.abs() <= 500_000);
        }
    }
}

/// A position in steps equals that of the record of a hole there. A record is printed with its kind
/// and its steps.
#[test]
fn places_in_steps() {
    let table = Table::DRILL;
    assert_eq!(table.steps(millimetres(10, 5)), Ok([1070, 535]));
    let off = table
        .steps(millimetres(-10, 500))
        .expect_err("off the table");
    assert_eq!((off.letter, off.at_nm), (b'X', -10_000_000));
    let off = table
        .steps(millimetres(10, 500))
        .expect_err("off the table");
    assert_eq!((off.letter, off.at_nm), (b'Y', 500_000_000));
    // Far beyond all coordinates: its steps would come round to the table again.
    let at = -172_399_477_324_388_332;
    assert!(table.move_x(at).is_err());
    assert_ne!(Record::X(1).to_string(), Record::Y(1).to_string());
    assert!(Record::X(1070).to_string().contains("1070"));
}
