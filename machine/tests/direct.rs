//! Moves that a controller appends itself, without lines.

mod common;

use common::config;
use husillo_gcode::{Command, Feed, Nm};
use husillo_machine::{AxisRamp, Event, Machine, Refused};

type ThreeAxes = Machine<3>;

fn with_ramps() -> ThreeAxes {
    let mut config = config();
    for axis in &mut config.axes {
        axis.backlash_steps = 0;
        axis.ramp = Some(AxisRamp {
            acceleration_hz_per_s: 400,
            start_rate_hz: 0,
            jerk_hz_per_s2: None,
            junction_hz: None,
        });
    }
    Machine::new(config)
}

fn events(mill: &mut ThreeAxes) -> Vec<Event<3>> {
    std::iter::from_fn(|| mill.next_event()).collect()
}

const FEED: Feed = Feed::PerMinute(Nm(600_000));

/// Moves that are appended give the events of the same moves as lines.
#[test]
fn appended_moves_are_those_of_lines() {
    let (mut lines, mut direct) = (with_ramps(), with_ramps());
    lines.line(b"G64 G1 X0.02 F0.6").unwrap();
    lines.line(b"Y0.01").unwrap();
    lines.line(b"G0 X0 Y0").unwrap();
    for (tag, command) in [
        Command::Linear {
            to: [20_000, 0, 0].map(Nm),
            feed: FEED,
        },
        Command::Linear {
            to: [20_000, 10_000, 0].map(Nm),
            feed: FEED,
        },
        Command::Rapid { to: [Nm(0); 3] },
    ]
    .into_iter()
    .enumerate()
    {
        direct.check([command]).unwrap();
        direct.push(command, tag as u32).unwrap();
    }
    assert_eq!((direct.queued(), direct.executing_tag()), (3, Some(0)));
    let (wanted, got) = (events(&mut lines), events(&mut direct));
    assert!(wanted.len() > 300);
    assert_eq!(wanted, got);
    assert_eq!(direct.executing_tag(), None);
}

/// A full queue refuses a move and stays as it is. The tag follows the executing move.
#[test]
fn a_full_queue_is_busy() {
    let mut mill = with_ramps();
    let to = |step: i64| Command::Linear {
        to: [step * 1400, 0, 0].map(Nm),
        feed: FEED,
    };
    for step in 1..=16 {
        assert!(mill.can_push());
        mill.push(to(step), step as u32).unwrap();
    }
    assert_eq!(mill.push(to(17), 17), Err(Refused::Busy));
    assert_eq!(mill.end_position()[0], Nm(16 * 1400));
    let mut tags = Vec::new();
    while mill.next_event().is_some() {
        tags.extend(mill.executing_tag().filter(|tag| tags.last() != Some(tag)));
    }
    assert!(tags.iter().copied().eq(1..=16), "{tags:?}");
    assert_eq!(mill.position_steps(), [160, 0, 0]);
}

/// A rapid at 25 percent takes longer, and a feed move does not.
#[test]
fn the_rapid_override_slows_rapids_only() {
    let duration = |line: &[u8], percent: u8| -> u64 {
        let mut mill = with_ramps();
        mill.line(line).unwrap();
        mill.set_rapid_override(percent);
        let waits = events(&mut mill).into_iter().map(|event| match event {
            Event::Step(step) => u64::from(step.wait_ticks),
            _ => 0,
        });
        waits.sum()
    };
    // 1000 steps at 170 steps/s, and at a quarter of it.
    let (full, quarter) = (duration(b"G0 X0.14", 100), duration(b"G0 X0.14", 25));
    assert!((5_800_000..6_400_000).contains(&full), "{full}");
    assert!((23_400_000..23_800_000).contains(&quarter), "{quarter}");
    let feed = b"G1 X0.14 F1";
    assert_eq!(duration(feed, 100), duration(feed, 25));
}
