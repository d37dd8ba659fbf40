//! The controller of the microfactory with its mechanics, including chips and coils.

use husillo_controllers::{
    Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryReport,
};
use husillo_machine::StepEvent;
use husillo_sim::MicrofactoryRig;
use husillo_transports::microfactory::{ByteTable, Device, Order};
use proptest::prelude::*;

/// The figure of the original: right-angled, with a slope of two.
const TRIANGLE: [[i16; 2]; 3] = [[1000, 500], [0, -500], [-1000, 0]];
/// 525 Hz: at 524.8 Hz of CLOCK no step is lost.
const PULL_OUT_TICKS: u32 = 1904;

/// Sends bytes to the link and runs events until none is left; returns the reports.
fn send(
    link: &mut Device,
    machine: &mut Microfactory<[[i16; 2]; 3]>,
    rig: &mut MicrofactoryRig,
    bytes: &[u8],
) -> Vec<MicrofactoryReport> {
    for byte in bytes {
        if let Some(command) = link.receive(*byte, machine.is_moving()).command {
            assert!(machine.command(command), "{command:?}");
        }
    }
    let mut reports = Vec::new();
    for _ in 0..1_000_000 {
        let event = machine.next_event(&rig.inputs());
        rig.apply(&event);
        match event {
            MicrofactoryEvent::Report(report) => reports.push(report),
            MicrofactoryEvent::Idle => return reports,
            _ => {}
        }
    }
    panic!("no end");
}

fn run(config: MicrofactoryConfig) -> (MicrofactoryRig, [i32; 4]) {
    let mut link = Device::new(ByteTable::DEFAULT);
    let mut machine = Microfactory::new(config, TRIANGLE);
    let mut rig = MicrofactoryRig::new(&config, [420, 380, 900], 1200, PULL_OUT_TICKS);
    let (link, cell_, rig_) = (&mut link, &mut machine, &mut rig);
    assert_eq!(send(link, cell_, rig_, b"H"), [MicrofactoryReport::Homed]);
    let zero = rig_.tool();
    assert_eq!(
        send(link, cell_, rig_, b"NX\xc8E"),
        [MicrofactoryReport::Done]
    );
    assert_eq!(
        send(link, cell_, rig_, b"Nz\x05E"),
        [MicrofactoryReport::Done]
    );
    assert_eq!(
        send(link, cell_, rig_, b"NX\xc8E"),
        [MicrofactoryReport::Done]
    );
    assert_eq!(
        send(link, cell_, rig_, b"G"),
        [MicrofactoryReport::Contact, MicrofactoryReport::Done]
    );
    let tool = rig.tool();
    let moved = std::array::from_fn(|axis| tool[axis] - zero[axis]);
    (rig, moved)
}

/// Every step arrives: X by 400, Z back by 5, a closed triangle, Y to the work piece; no step is
/// lost.
#[test]
fn a_session_on_the_bytes() {
    let (rig, [x, y, z, spindle]) = run(MicrofactoryConfig::ORIGINAL);
    assert_eq!(rig.lost_steps(), [0; 4]);
    assert_eq!([x, z], [400, -5]);
    // Home of Y is 180 below the start, where the work piece is 1200 above it.
    assert_eq!(y, 1380);
    assert!(spindle > 256 * 5);
}

/// RESET before every move, as in the original: motors that are not in state 1 jump there, so the
/// tool is off its commanded position.
#[test]
fn the_originals_reset_costs_steps() {
    let (_, [x, _, z, _]) = run(MicrofactoryConfig {
        resets_before_moves: true,
        ..MicrofactoryConfig::ORIGINAL
    });
    assert_ne!([x, z], [400, -5]);
    assert!((x - 400).abs() <= 8 && (z + 5).abs() <= 8, "{x} {z}");
}

/// Runs all consequences of a command; returns the reports.
fn carry_out(
    machine: &mut Microfactory<[[i16; 2]; 3]>,
    rig: &mut MicrofactoryRig,
    command: Order,
) -> Vec<MicrofactoryReport> {
    assert!(machine.command(command), "{command:?}");
    send(&mut Device::new(ByteTable::DEFAULT), machine, rig, &[])
}

/// Axes the given distance above their switches, then turned by hand forward and back: the nuts are
/// on either flank or between them.
fn stood_anywhere(
    config: &MicrofactoryConfig,
    above: [u16; 3],
    turns: [[i16; 3]; 2],
) -> MicrofactoryRig {
    let mut rig = MicrofactoryRig::new(config, above, 10_000, PULL_OUT_TICKS);
    rig.apply(&MicrofactoryEvent::Enable(true));
    for (axis, turn) in turns.iter().flat_map(|turns| turns.iter().enumerate()) {
        for _ in 0..turn.unsigned_abs() {
            let mut delta = [0; 4];
            delta[axis] = turn.signum() as i8;
            rig.apply(&MicrofactoryEvent::Step(StepEvent {
                wait_ticks: 10_000,
                delta,
            }));
        }
    }
    rig.apply(&MicrofactoryEvent::Enable(false));
    rig
}

/// An axis makes a full step with each pulse of CLOCK, up to 524.8 per second; faster ones are
/// lost.
#[test]
fn a_pulse_of_clock_is_a_full_step_up_to_where_it_was_measured() {
    for (axis_rate_hz, is_lost) in [(400, false), (524, false), (530, true)] {
        let config = MicrofactoryConfig {
            axis_rate_hz,
            ..MicrofactoryConfig::ORIGINAL
        };
        let mut rig = MicrofactoryRig::new(&config, [10_000; 3], 10_000, PULL_OUT_TICKS);
        let mut machine = Microfactory::new(config, TRIANGLE);
        let (from, begin) = (rig.tool(), rig.ticks());
        let steps = Order::Steps {
            motor: 0,
            forward: true,
            count: 250,
        };
        carry_out(&mut machine, &mut rig, steps);
        assert_eq!(rig.lost_steps()[0] > 0, is_lost, "{axis_rate_hz}");
        if !is_lost {
            assert_eq!(rig.tool()[0] - from[0], 250);
            // RESET and settling take 11 ms; the current is switched at once.
            let ticks = rig.ticks() - begin - 11_000;
            assert_eq!(ticks, 250 * (1_000_000 / u64::from(axis_rate_hz)));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// From any flank, at any distance, with the switches closed or open: home is the same
    /// position, and from there the load moves as commanded.
    #[test]
    fn home_is_the_same_place_from_anywhere(
        above in [0..450_u16, 0..450_u16, 0..450_u16],
        there in [-350..350_i16, -350..350_i16, -350..350_i16],
        back in [-350..350_i16, -350..350_i16, -350..350_i16],
    ) {
        let config = MicrofactoryConfig::ORIGINAL;
        let mut rig = stood_anywhere(&config, above, [there, back]);
        let place = |rig: &MicrofactoryRig| -> [i32; 3] {
            let [x, y, z, _] = rig.tool();
            let [over_x, over_y, over_z] = above.map(i32::from);
            [x + over_x, y + over_y, z + over_z]
        };
        // An axis farther behind a switch than the back-off distance is left to the operator.
        prop_assume!(place(&rig).iter().all(|place| *place > -190));
        let mut machine = Microfactory::new(config, TRIANGLE);
        let reports = carry_out(&mut machine, &mut rig, Order::Home);
        prop_assert_eq!(reports, [MicrofactoryReport::Homed]);
        prop_assert_eq!(place(&rig), [200; 3]);
        let moves = [(0, true, 9), (2, false, 30), (0, false, 40), (1, false, 7), (2, true, 3)];
        for (motor, forward, count) in moves {
            carry_out(&mut machine, &mut rig, Order::Steps { motor, forward, count });
        }
        prop_assert_eq!(place(&rig), [169, 193, 173]);
        prop_assert_eq!(&machine.position_steps()[..3], &[-31, -7, -27]);
    }
}
