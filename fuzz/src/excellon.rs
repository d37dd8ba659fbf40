//! Any drill file.

use husillo_excellon::{
    Digits, Feature, Hole, Inference, LIMIT_NM, Overrides, Pattern, Profile, Reader, Slot, Units,
    Zeros, lines,
};

/// Room for tools: small, so that it is used up.
type Small = Reader<4>;

/// Both passes over any text, with settings inferred and given. The lines are those of the text,
/// and every error or warning has its columns inside its line. A refused line changes nothing. Each
/// line makes as many features as it reports, all within the limit and with a tool. Nothing follows
/// the end. The kind of line end does not matter.
pub fn excellon(data: &[u8]) {
    // The first byte chooses the given settings.
    let (chosen, text) = data
        .split_first()
        .map_or((0, data), |(first, rest)| (*first, rest));
    let overrides = Overrides {
        units: (chosen & 1 != 0).then_some(if chosen & 2 == 0 {
            Units::Inches
        } else {
            Units::Millimetres
        }),
        zeros: (chosen & 4 != 0).then_some(if chosen & 8 == 0 {
            Zeros::Leading
        } else {
            Zeros::Trailing
        }),
        digits: Digits::new(chosen >> 4 & 7, 4).filter(|_| chosen & 128 != 0),
        profile: if chosen & 16 == 0 {
            Profile::Excellon
        } else {
            Profile::Tango
        },
    };
    check_lines(text);
    let patterns = chosen & 64 != 0;
    let features = read(text, &overrides, patterns);
    // CR LF for LF, if there is no CR yet.
    if !text.contains(&b'\r') {
        let mut other = Vec::with_capacity(text.len());
        for byte in text {
            other.extend((*byte == b'\n').then_some(b'\r'));
            other.push(*byte);
        }
        assert_eq!(
            read(&other, &overrides, patterns),
            features,
            "line ends do not matter"
        );
    }
}

fn check_lines(text: &[u8]) {
    let mut length = 0;
    for (number, (counted, line)) in (1..).zip(lines(text)) {
        assert_eq!(number, counted, "lines are counted");
        assert!(
            !line.contains(&b'\n') && !line.contains(&b'\r'),
            "no end inside a line"
        );
        length += line.len();
    }
    let ends = text
        .iter()
        .filter(|byte| matches!(byte, b'\n' | b'\r'))
        .count();
    assert_eq!(
        length + ends,
        text.len(),
        "every byte is in a line or ends one"
    );
}

fn read(text: &[u8], overrides: &Overrides, patterns: bool) -> Vec<Feature> {
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    let settings = inference.settle(overrides);
    let mut reader = Small::new(&settings);
    if patterns {
        reader = reader.with_patterns();
    }
    let mut features = Vec::new();
    for (_, line) in lines(text) {
        let before = reader.clone();
        match reader.read(line) {
            Ok(made) => {
                assert!(
                    made.len() == 0 || !before.is_ended(),
                    "nothing behind the end"
                );
                let promised = made.len();
                let mut count = 0;
                for feature in made {
                    count += 1;
                    check_feature(&feature);
                    // Repeats make many features; a part of them is enough to compare.
                    if features.len() < 10_000 {
                        features.push(feature);
                    }
                }
                assert_eq!(count, promised, "as many as promised");
            }
            Err(error) => {
                assert!(
                    error.at <= error.end && error.end <= line.len(),
                    "{error:?}"
                );
                assert!(!error.to_string().is_empty());
                assert_eq!(reader.pattern(), None);
                assert_same(&before, &reader);
            }
        }
        if let Some(Pattern::Repeat(repeat)) = reader.pattern() {
            assert!(patterns && repeat.count > 0);
            let first = features.iter().take(100);
            let copies = first.filter_map(|feature| repeat.copy(feature, repeat.step_nm));
            copies.for_each(|copy| check_feature(&copy));
        }
        if let Some(warning) = reader.warning() {
            assert!(
                warning.at <= warning.end && warning.end <= line.len(),
                "{warning:?}"
            );
            assert!(!warning.to_string().is_empty());
        }
    }
    features
}

fn check_feature(feature: &Feature) {
    let (points, tool) = match *feature {
        Feature::Hole(Hole { at_nm, tool }) => ([at_nm, at_nm], tool),
        Feature::Slot(Slot {
            from_nm,
            to_nm,
            tool,
            ..
        }) => ([from_nm, to_nm], tool),
    };
    for nm in points.iter().flatten() {
        assert!((-LIMIT_NM..=LIMIT_NM).contains(nm), "{feature:?}");
    }
    assert!(tool.diameter_nm.is_none_or(|nm| nm > 0), "{feature:?}");
}

/// Compares the states of two readers, without their warnings, by the result of the same lines.
fn assert_same(before: &Small, after: &Small) {
    let tools = |reader: &Small| reader.tools().iter().copied().collect::<Vec<_>>();
    assert_eq!(
        tools(before),
        tools(after),
        "a refused line changes no tool"
    );
    assert_eq!(
        before.format(),
        after.format(),
        "a refused line changes no format"
    );
    assert_eq!(before.is_ended(), after.is_ended());
    for line in [
        &b"X1Y"[..],
        b"X1.0",
        b"X1.0G85Y2.0",
        b"R2X1",
        b"T1C.2",
        b"T1",
        b"G91Y1.0",
    ] {
        let (mut before, mut after) = (before.clone(), after.clone());
        for line in [line, b"X1.0"] {
            let made = [&mut before, &mut after].map(|reader| {
                reader
                    .read(line)
                    .map(|features| features.take(3).collect::<Vec<_>>())
            });
            assert_eq!(made[0], made[1], "a refused line changes nothing");
        }
    }
}
