//! Where a verdict turns: arcs and inputs just inside of what is taken, and just outside.

use husillo_gcode::{Block, Dialect, ErrorKind, Modal};

/// What a line is refused for, from zero in millimetres.
fn verdict(line: &str) -> Option<ErrorKind> {
    let modal = Modal::<3>::new(Dialect::RS274);
    Block::parse(line.as_bytes(), &Dialect::RS274)
        .and_then(|block| modal.plan(&block).map(|_| ()))
        .err()
        .map(|error| error.kind)
}

/// The end of an arc may be off its circle by 5 um, by more up to 0.1 % of the radius, and never by more than 0.5 mm.
#[test]
fn ends_off_the_arc() {
    for (line, is_taken) in [
        ("G2 X2.005 I1 F1", true),
        ("G2 X2.006 I1 F1", false),
        ("G2 X20.009 I10 F1", true),
        ("G2 X20.012 I10 F1", false),
        ("G2 X20.1 I10 F1", false),
        ("G2 X2000.5 I1000 F1", true),
        ("G2 X2000.501 I1000 F1", false),
        ("G2 X2001 I1000 F1", false),
    ] {
        let verdict = verdict(line);
        assert_eq!(verdict.is_none(), is_taken, "{line}");
        assert!(verdict.is_none_or(|kind| matches!(kind, ErrorKind::EndOffArc(_))));
    }
}

/// A radius may be short of half the chord by 5 um and by 1 % of itself.
#[test]
fn radii_shorter_than_half_the_chord() {
    for (line, is_taken) in [
        ("G2 X2 R1 F1", true),
        ("G2 X2 R.995 F1", true),
        ("G2 X2 R.994999 F1", false),
        ("G2 X.808 R.4 F1", true),
        ("G2 X.80802 R.4 F1", false),
        ("G2 X.81 R.4 F1", false),
    ] {
        let verdict = verdict(line);
        assert_eq!(verdict.is_none(), is_taken, "{line}");
        assert!(verdict.is_none_or(|kind| matches!(kind, ErrorKind::RadiusTooSmall(_))));
    }
}

/// Digital inputs can be waited for in four ways, analogue ones are read at once.
#[test]
#[cfg(feature = "extended")]
fn inputs_to_wait_for() {
    for mode in 0..=5 {
        let digital = verdict(&format!("M66 P0 L{mode} Q1"));
        let analog = verdict(&format!("M66 E0 L{mode} Q1"));
        let refused = Some(ErrorKind::OutOfRange(b'L'));
        assert_eq!(digital, refused.filter(|_| mode > 4), "L{mode}");
        assert_eq!(analog, refused.filter(|_| mode > 0), "L{mode}");
    }
}
