//! Sessions over the simulated line in virtual time, on good lines and bad ones.

use super::action::Action;
use super::client::{Client, Motion};
use super::figure::Figure;
use super::settings::Settings;
use crate::{StopRequests, Wire};
use husillo_sim::Random;
use husillo_sim::device::Emulation;
use husillo_sim::device::LineFault as Fault;
use husillo_sim::device::microfactory::Device;
use husillo_transports::microfactory::{Report, Status};
use std::time::Duration;

/// A quick machine: short distances to its switches, little backlash.
fn settings() -> Settings {
    let mut settings = Settings::ORIGINAL;
    settings.config.axis_rate_hz = 4000;
    settings.pull_out_ticks = 0; // its motors follow
    settings.config.spindle_rate_hz = 2560;
    settings.config.backlash_steps = [20, 0, 20];
    settings.config.back_off_steps = 20;
    settings
}

fn client() -> Client {
    client_of(0)
}

/// A client of a machine alone on its controller, or of the second one of two.
fn client_of(machine: u8) -> Client {
    let settings = settings();
    let device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[500, 500]],
        true,
        9600,
        machine + 1,
    )
    .unwrap();
    let stop = StopRequests::default();
    Client::new(Wire::simulated(device), settings.table, true, stop).of_machine(machine)
}

/// A figure that contains bytes of commands.
fn session() -> Vec<Action> {
    let figure = Figure {
        name: "test".into(),
        moves: vec![[0x41, 0], [-2, 0x3F], [-0x3F, -0x21]],
    };
    let steps = |motor, steps| Action::Steps { motor, steps };
    let jog = Action::Jog {
        motor: 1,
        forward: true,
        time: Duration::from_millis(230),
    };
    vec![
        Action::Home,
        Action::Load(figure),
        steps(0, 63),
        steps(2, -7),
        jog,
        Action::Figure,
    ]
}

/// Carries out the actions of a session. The error is the number of the first failed action, and
/// the reason.
fn run(client: &mut Client) -> Result<(), (usize, String)> {
    for (place, action) in session().iter().enumerate() {
        client.carry_out(action).map_err(|error| (place, error))?;
    }
    Ok(())
}

/// Position of the tool in X and Z from its position after homing, and number of figures begun.
fn outcome(client: &mut Client, zero: [i32; 2]) -> ([i32; 2], usize) {
    outcome_of(client, 0, zero)
}

/// The outcome of another machine: its tool position and its number of figures.
fn outcome_of(client: &mut Client, machine: u8, zero: [i32; 2]) -> ([i32; 2], usize) {
    let device = client.device();
    let [x, _, z, _] = device.rig(machine).unwrap().tool();
    let told = device.take_reports();
    let figures = told.iter().filter(|line| line.contains("the tool touches"));
    ([x - zero[0], z - zero[1]], figures.count())
}

/// In X the rig begins 420 steps above the switch, and in Z 900 steps. Homing backs off each switch
/// by 20 steps.
const ZERO: [i32; 2] = [20 - 420, 20 - 900];
const GOOD: ([i32; 2], usize) = ([63, -7 + 0x3F - 0x21], 1);

#[test]
fn a_session_is_as_it_was_asked_for() {
    let mut client = client();
    assert_eq!(run(&mut client), Ok(()));
    assert_eq!(outcome(&mut client, ZERO), GOOD);
    assert_eq!(client.device().rig(0).unwrap().lost_steps(), [0; 4]);
}

fn faults() -> impl Iterator<Item = Fault> {
    (0..8).map(Fault::Flipped).chain([
        Fault::Lost,
        Fault::Doubled,
        Fault::Late(30_000),
        Fault::Late(300_000),
        Fault::Unplugged,
        Fault::Reset,
    ])
}

/// Runs the whole session with a fault. If nothing is reported, everything is done as requested. If
/// a failure is reported, nothing turns any more, except the action in progress after a pulled
/// cable. The operator then plugs the cable in, resets the device, homes it and continues. Returns
/// whether a failure was reported.
fn survives(machine: u8, place: u64, fault: Fault) -> bool {
    let context = format!("{fault:?} at byte {place} to machine {machine}");
    let mut client = client_of(machine);
    client.device().line().fault = Some((place, fault));
    let result = run(&mut client);
    let Err((_, error)) = result else {
        assert_eq!(outcome_of(&mut client, machine, ZERO), GOOD, "{context}");
        if machine > 0 {
            assert_eq!(client.device().rig(0).unwrap().tool(), [0; 4], "{context}");
        }
        return false;
    };
    let device = client.device();
    let tools = |device: &Device| match machine {
        0 => [device.rig(0).unwrap().tool(); 2],
        _ => [device.rig(0).unwrap().tool(), device.rig(1).unwrap().tool()],
    };
    if fault != Fault::Unplugged {
        let before = tools(device);
        for _ in 0..500 {
            device.tick();
        }
        assert_eq!(tools(device), before, "{context}: {error}, and it moves");
    }
    device.control("plug");
    device.control("reset");
    device.take_reports();
    let first = device.rig(0).unwrap().tool();
    client = Client::new(
        client.into_wire(),
        settings().table,
        true,
        StopRequests::default(),
    )
    .of_machine(machine);
    let again = run(&mut client);
    assert_eq!(again, Ok(()), "{context}: {error}");
    if machine > 0 {
        assert_eq!(client.device().rig(0).unwrap().tool(), first, "{context}");
    }
    let outcome = outcome_of(&mut client, machine, ZERO);
    assert_eq!(outcome, GOOD, "{context}: {error}");
    true
}

/// Every fault at every byte of a session, in both directions, with a single machine on its
/// controller and with the second one of two.
#[test]
fn any_fault_at_any_byte_is_survived_or_reported() {
    for machine in [0, 1] {
        let mut good = client_of(machine);
        assert_eq!(run(&mut good), Ok(()));
        let carried = good.device().line().carried;
        let (mut reported, mut unharmed) = (0, 0);
        for place in 0..carried {
            for fault in faults() {
                if survives(machine, place, fault) {
                    reported += 1;
                } else {
                    unharmed += 1;
                }
            }
        }
        println!("{carried} bytes: {reported} reported, {unharmed} without harm");
        assert!(reported > 500 && unharmed > 500, "{reported}, {unharmed}");
    }
}

/// Random faults in a long session: a figure of 400 moves, and long counted steps.
#[test]
fn faults_in_long_sessions_are_survived_or_reported() {
    let (mut numbers, mut reported) = (Random::new(11), 0);
    let mut random = |below: u64| numbers.below(below);
    let moves: Vec<[i16; 2]> = (0..400)
        .map(|_| [0; 2].map(|_| random(9) as i16 - 3))
        .collect();
    let sum = |axis: usize| {
        moves
            .iter()
            .map(|delta| i32::from(delta[axis]))
            .sum::<i32>()
    };
    let expected = ([900 + sum(0), 700 + sum(1)], 1);
    let figure = Figure {
        name: "long".into(),
        moves: moves.clone(),
    };
    let session = [
        Action::Home,
        Action::Steps {
            motor: 0,
            steps: 900,
        },
        Action::Load(figure),
        Action::Steps {
            motor: 2,
            steps: 700,
        },
        Action::Figure,
    ];
    let faults: Vec<_> = faults().collect();
    for _ in 0..60 {
        let mut client = client();
        let fault = faults[random(faults.len() as u64) as usize];
        let place = random(6500);
        client.device().line().fault = Some((place, fault));
        let all: Result<Vec<_>, _> = session
            .iter()
            .map(|action| client.carry_out(action))
            .collect();
        match all {
            Ok(_) => assert_eq!(outcome(&mut client, ZERO), expected, "{fault:?} at {place}"),
            Err(_) => reported += 1,
        }
    }
    assert!((3..50).contains(&reported), "{reported}");
}

/// A figure that was received with an error is sent again; nothing has moved.
#[test]
fn a_figure_survives_a_bad_moment() {
    let mut client = client();
    client.carry_out(&Action::Home).unwrap();
    let at = client.device().line().carried + 12;
    client.device().line().fault = Some((at, Fault::Flipped(3)));
    let Action::Load(figure) = &session()[1] else {
        panic!()
    };
    let how = client.carry_out(&Action::Load(figure.clone())).unwrap();
    assert!(how.starts_with("3 moves, 2 times"), "{how}");
}

#[test]
fn a_table_of_its_own_is_used_at_both_ends() {
    let mut settings = settings();
    settings.table.home = b'k';
    settings.table.ask = 0xF0;
    let device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[5, 5]],
        true,
        9600,
        1,
    )
    .unwrap();
    let stop = StopRequests::default();
    let mut client = Client::new(Wire::simulated(device), settings.table, true, stop);
    assert_eq!(client.carry_out(&Action::Home), Ok("homed".into()));
}

#[test]
fn behind_ctrl_c_nothing_begins() {
    let settings = settings();
    let device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[5, 5]],
        true,
        9600,
        1,
    )
    .unwrap();
    let stop = StopRequests::default();
    stop.request();
    let mut client = Client::new(Wire::simulated(device), settings.table, true, stop);
    assert!(
        client
            .carry_out(&Action::Home)
            .unwrap_err()
            .contains("stopped")
    );
}

fn jog(motor: u8, forward: bool, seconds: u64) -> Action {
    Action::Jog {
        motor,
        forward,
        time: Duration::from_secs(seconds),
    }
}

/// Number of times that a switch stopped a motion.
fn switch_reports(client: &mut Client) -> usize {
    let told = client.device().take_reports();
    let hits = told
        .iter()
        .filter(|line| line.contains("closed: backing off"));
    hits.count()
}

/// A jog that ends at a switch is reported and not begun again, whatever its time is. The axis
/// backs off the switch completely.
#[test]
fn a_jog_into_a_switch_is_reported_and_ends() {
    let mut client = client();
    client.carry_out(&Action::Home).unwrap();
    let error = client.carry_out(&jog(0, false, 60)).unwrap_err();
    assert!(error.contains("home switch x closed"), "{error}");
    assert_eq!(switch_reports(&mut client), 1);
    assert_eq!(
        client.device().rig(0).unwrap().tool()[0],
        ZERO[0],
        "back off it"
    );
    assert!(client.elapsed() < Duration::from_secs(20));
}

/// Counted steps that end at a switch are reported and end. The host sends them in portions of at
/// most 255.
#[test]
fn steps_into_a_switch_are_reported_and_end() {
    let mut client = client();
    client.carry_out(&Action::Home).unwrap();
    let steps = Action::Steps {
        motor: 2,
        steps: -2000,
    };
    let error = client.carry_out(&steps).unwrap_err();
    assert!(error.contains("home switch z closed"), "{error}");
    assert_eq!(switch_reports(&mut client), 1);
    assert_eq!(
        client.device().rig(0).unwrap().tool()[2],
        ZERO[1],
        "back off it"
    );
}

/// The answer to a letter that the controller does not carry out, for example while it backs off a
/// switch.
#[test]
fn what_is_refused_is_not_acknowledged() {
    let settings = settings();
    let mut device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[5, 5]],
        true,
        9600,
        1,
    )
    .unwrap();
    let say = |device: &mut Device, byte: u8| {
        device.send(byte);
        std::iter::from_fn(|| Some(device.tick()))
            .take(50)
            .flatten()
            .collect::<Vec<_>>()
    };
    assert_eq!(say(&mut device, b'J'), b"J");
    device.control("close x");
    assert_eq!(
        say(&mut device, b'x'),
        b"x",
        "it begins, and goes back at once"
    );
    assert_eq!(say(&mut device, b'x'), b"?");
    // No figure is stored after `<`.
    device.control("reset");
    assert_eq!(say(&mut device, b'<'), b"<");
    assert_eq!(say(&mut device, b'G'), b"?");
}

/// A controller of two machines: bytes for one do not move the other, and each has its own figure
/// and position.
#[test]
fn two_machines_of_one_controller() {
    let settings = settings();
    let device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[5, 5]],
        true,
        9600,
        2,
    )
    .unwrap();
    let mut wire = Wire::simulated(device);
    let stop = StopRequests::default();
    let on =
        |wire, machine| Client::new(wire, settings.table, true, stop.clone()).of_machine(machine);
    let figure = |moves: &[[i16; 2]]| {
        Action::Load(Figure {
            name: "test".into(),
            moves: moves.to_vec(),
        })
    };
    for (machine, moves) in [(1, [[30, -7]]), (0, [[-20, 50]])] {
        let mut client = on(wire, machine);
        client.carry_out(&Action::Home).unwrap();
        client.carry_out(&figure(&moves)).unwrap();
        wire = client.into_wire();
    }
    // The second one's figure is not the one that was loaded last.
    let mut second = on(wire, 1);
    second.carry_out(&Action::Figure).unwrap();
    let places = |client: &mut Client| {
        [0, 1].map(|machine| {
            let [x, _, z, _] = client.device().rig(machine).unwrap().tool();
            [x - ZERO[0], z - ZERO[1]]
        })
    };
    assert_eq!(places(&mut second), [[0, 0], [30, -7]]);
    let mut first = on(second.into_wire(), 0);
    first.carry_out(&Action::Figure).unwrap();
    assert_eq!(places(&mut first), [[-20, 50], [30, -7]]);
    // An emergency stop applies to both.
    first.carry_out(&Action::Emergency).unwrap();
    let mut second = on(first.into_wire(), 1);
    let error = second.carry_out(&jog(0, true, 1)).unwrap_err();
    assert!(error.contains("emergency stop"), "{error}");
}

/// Both move at once: a jog of one continues while the other gets commands.
#[test]
fn two_machines_move_at_once() {
    let settings = settings();
    let mut device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[5, 5]],
        true,
        9600,
        2,
    )
    .unwrap();
    let said: Vec<u8> = b"JYtJX"
        .iter()
        .flat_map(|byte| {
            device.send(*byte);
            (0..5).flat_map(|_| device.tick()).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(said, b"JYtJX");
    for _ in 0..200 {
        device.tick();
    }
    let (first, second) = (device.rig(0).unwrap().tool(), device.rig(1).unwrap().tool());
    assert!(first[1] > 100 && first[0] == 0, "{first:?}");
    assert!(second[0] > 100 && second[1] == 0, "{second:?}");
    // Nothing repeats the jogs, so both machines stop after their dead-man's time.
    for _ in 0..1000 {
        device.tick();
    }
    assert!(
        device
            .take_reports()
            .iter()
            .filter(|line| line.contains("the host was silent"))
            .count()
            == 2
    );
}

/// After a reset a controller of two machines has selected the first one. Commands for the second
/// one do not move the first.
#[test]
fn a_reset_does_not_exchange_the_machines() {
    let settings = settings();
    let device = Device::new(
        settings.config,
        settings.table,
        settings.pull_out_ticks,
        &[[5, 5]],
        true,
        9600,
        2,
    )
    .unwrap();
    let stop = StopRequests::default();
    let wire = Wire::simulated(device);
    let mut client = Client::new(wire, settings.table, true, stop).of_machine(1);
    let steps = |steps| Action::Steps { motor: 1, steps };
    // Whole electrical cycles, so that RESET turns no rotor.
    client.carry_out(&steps(8)).unwrap();
    client.device().control("reset");
    client.carry_out(&steps(4)).unwrap();
    let y = [0, 1].map(|machine| client.device().rig(machine).unwrap().tool()[1]);
    assert_eq!(y, [0, 12]);
}

#[test]
fn a_controller_of_one_machine_has_no_second() {
    let mut client = client().of_machine(1);
    let error = client.carry_out(&Action::Home).unwrap_err();
    assert!(error.contains("no second one"), "{error}");
}

/// With a lease every motion ends when the host is silent, and the position is still right. Without
/// a lease, homing, counted steps and figures continue to their ends, as on the original.
#[test]
fn every_motion_has_a_lease() {
    const LEASE_MS: usize = 250;
    let mut settings = Settings::ORIGINAL;
    settings.config.backlash_steps = [0; 3]; // the tool follows each step
    for (order, lease) in [
        (&b"H"[..], 25),
        (b"G", 25),
        (b"NX\xffE", 25),
        (b"JX", 25),
        (b"H", 0),
        (b"G", 0),
        (b"NX\xffE", 0),
    ] {
        let context = format!("{} with {lease}", order.escape_ascii());
        let figure = &[[500, 500]];
        let (config, table) = (settings.config, settings.table);
        let mut device = Device::new(config, table, 0, figure, true, 9600, 1).unwrap();
        let tool = |device: &Device| device.rig(0).unwrap().tool();
        let pass = |device: &mut Device, ms: usize| (0..ms).for_each(|_| drop(device.tick()));
        for byte in [b'l', lease].iter().chain(order) {
            device.send(*byte);
            pass(&mut device, 5);
        }
        // Queries renew it.
        for _ in 0..6 {
            device.send(b'5');
            pass(&mut device, 50);
        }
        let renewed = tool(&device);
        pass(&mut device, LEASE_MS - 60);
        assert_ne!(tool(&device), renewed, "{context}: it stands too early");
        pass(&mut device, 70);
        let ended = tool(&device);
        pass(&mut device, 1000);
        assert_eq!(tool(&device) == ended, lease > 0, "{context}");
        let reports = device.take_reports();
        let is_reported = reports
            .iter()
            .any(|line| line.contains("the host was silent"));
        assert_eq!(is_reported, lease > 0, "{context}: {reports:?}");
    }
}

/// A device that does not know the query about its switches homes as before.
#[test]
fn a_device_that_does_not_compare_its_switches_homes() {
    let mut settings = settings();
    settings.table.switches = b'V'; // not that of the device
    let config = settings.config;
    let table = Settings::ORIGINAL.table;
    let device = Device::new(config, table, 0, &[[500, 500]], true, 9600, 1).unwrap();
    let stop = StopRequests::default();
    let mut client = Client::new(Wire::simulated(device), settings.table, true, stop);
    for _ in 0..2 {
        assert_eq!(client.carry_out(&Action::Home), Ok("homed".into()));
        client.device().control("block x");
        let steps = Action::Steps {
            motor: 0,
            steps: 40,
        };
        client.carry_out(&steps).unwrap();
        client.device().control("unblock x");
    }
}

/// A device without a lease is refused, unless the user accepts that.
#[test]
fn a_device_without_a_lease_is_not_trusted() {
    let mut settings = settings();
    settings.table.lease = b'W'; // not that of the device
    for (lease, is_taken) in [(25, false), (0, true)] {
        let config = settings.config;
        let table = Settings::ORIGINAL.table;
        let device = Device::new(config, table, 0, &[[500, 500]], true, 9600, 1).unwrap();
        let stop = StopRequests::default();
        let wire = Wire::simulated(device);
        let mut client = Client::new(wire, settings.table, true, stop).with_lease(lease);
        match client.carry_out(&Action::Home) {
            Ok(_) => assert!(is_taken),
            Err(why) => assert!(!is_taken && why.contains("no lease"), "{why}"),
        }
    }
}

/// Asks until nothing moves.
fn followed(client: &mut Client) -> Status {
    loop {
        client.wait(Duration::from_millis(30)).unwrap();
        let status = client.status().unwrap();
        if !status.is_moving {
            return status;
        }
    }
}

#[test]
fn a_panel_drives_the_device_in_parts() {
    let mut client = client();
    assert!(!client.bring_to_rest().unwrap().is_homed);
    client.begin(Motion::Home).unwrap();
    assert!(
        client.begin(Motion::Figure).is_err(),
        "one motion at a time"
    );
    let status = followed(&mut client);
    assert_eq!(
        (status.report, status.is_homed),
        (Some(Report::Homed), true)
    );
    assert_eq!(client.lost_steps(), Ok(None));
    let steps = Motion::Steps {
        motor: 2,
        forward: true,
        count: 255,
    };
    client.begin(steps).unwrap();
    assert_eq!(followed(&mut client).position_steps, [0, 0, 255, 0]);
    // A jog lasts while it is repeated, and a halt ends it at once.
    let (motor, forward) = (1, true);
    client.begin(Motion::Jog { motor, forward }).unwrap();
    for _ in 0..20 {
        client.wait(Duration::from_millis(100)).unwrap();
        assert_eq!(client.repeat_jog(motor, forward), Ok(true));
    }
    let halted = client.halt().unwrap();
    assert_eq!(halted.report, Some(Report::Stopped));
    assert!(halted.position_steps[1] > 4000, "{halted:?}");
    client.wait(Duration::from_millis(500)).unwrap();
    assert_eq!(client.status(), Ok(halted));
    // Without a question the lease ends a motion.
    client.begin(Motion::Home).unwrap();
    client.wait(Duration::from_millis(400)).unwrap();
    assert_eq!(client.status().unwrap().report, Some(Report::DeadMan));
    client.begin(Motion::Home).unwrap();
    followed(&mut client);
    // A figure, of which one move arrives twice: it is not kept.
    let moves = [[30, 60], [30, -60]];
    client.clear_figure().unwrap();
    for delta in [moves[0], moves[0], moves[1]] {
        client.store_move(delta).unwrap();
    }
    assert!(client.keep_figure(&moves).is_err());
    client.halt().unwrap();
    client.clear_figure().unwrap();
    for delta in moves {
        client.store_move(delta).unwrap();
    }
    client.keep_figure(&moves).unwrap();
    client.begin(Motion::Figure).unwrap();
    let status = followed(&mut client);
    let [x, _, z, _] = status.position_steps;
    assert_eq!((status.report, [x, z]), (Some(Report::Done), [60, 0]));
    // An emergency stop holds until the reset.
    client.begin(Motion::Home).unwrap();
    client.stop_for_good().unwrap();
    assert!(client.begin(Motion::Home).is_err());
    assert_eq!(
        client.bring_to_rest().unwrap().report,
        Some(Report::Emergency)
    );
    assert!(client.press_reset());
    assert_eq!(client.bring_to_rest().unwrap().report, None);
    client.begin(Motion::Home).unwrap();
    assert_eq!(followed(&mut client).report, Some(Report::Homed));
}
