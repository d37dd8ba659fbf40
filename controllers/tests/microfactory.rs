//! Tests of the desktop microfactory with a small model of its mechanics: screws with backlash,
//! switches and a work piece.

use husillo_controllers::{
    Controller, MICROFACTORY_MOTORS, Microfactory, MicrofactoryConfig, MicrofactoryEvent,
    MicrofactoryInputs, MicrofactoryReport, MicrofactoryStation,
};
use husillo_machine::StepEvent;
use husillo_transports::microfactory::{ByteTable, Device, Order};
use proptest::prelude::*;

const SQUARE: [[i16; 2]; 5] = [[1000, 0], [0, 1000], [-1000, 0], [0, -1000], [1000, 1000]];

/// Motors, nuts on their screws, and switches that close at a position of the nut.
#[derive(Clone, Debug)]
struct Model {
    motor: [i32; MICROFACTORY_MOTORS],
    nut: [i32; 3],
    backlash: [i32; 3],
    switches: [i32; 3],
    /// Position in Y at which the work piece begins.
    face: i32,
    has_current: bool,
    time_ticks: u64,
    resets: u32,
}

impl Model {
    /// Creates a model with the nuts anywhere in their backlash and `from` motor steps from the
    /// switches.
    fn new(config: &MicrofactoryConfig, from: [i32; 3]) -> Self {
        Self {
            motor: [0; MICROFACTORY_MOTORS],
            nut: [0; 3],
            backlash: config.backlash_steps.map(i32::from),
            switches: from.map(|from| -from),
            face: i32::MAX,
            has_current: false,
            time_ticks: 0,
            resets: 0,
        }
    }

    fn inputs(&self) -> MicrofactoryInputs {
        let mut home = [false; 3];
        for (axis, closed) in home.iter_mut().enumerate() {
            *closed = self.nut[axis] <= self.switches[axis];
        }
        MicrofactoryInputs {
            home,
            contact: self.nut[1] >= self.face,
        }
    }

    fn apply(&mut self, step: StepEvent<MICROFACTORY_MOTORS>) {
        assert!(self.has_current, "a step without current");
        self.time_ticks += u64::from(step.wait_ticks);
        for axis in 0..MICROFACTORY_MOTORS {
            self.motor[axis] += i32::from(step.delta[axis]);
        }
        for axis in 0..3 {
            let motor = self.motor[axis];
            self.nut[axis] = self.nut[axis].clamp(motor - self.backlash[axis], motor);
        }
    }

    /// Runs the machine until it is idle. Returns its reports, and the positions of the nuts after
    /// every step.
    fn run<F: AsRef<[[i16; 2]]>>(
        &mut self,
        machine: &mut Microfactory<F>,
    ) -> (Vec<MicrofactoryReport>, Vec<[i32; 3]>) {
        let (mut reports, mut path) = (Vec::new(), Vec::new());
        for _ in 0..1_000_000 {
            match machine.next_event(&self.inputs()) {
                MicrofactoryEvent::Step(step) => {
                    self.apply(step);
                    path.push(self.nut);
                }
                MicrofactoryEvent::Dwell { wait_ticks } => self.time_ticks += u64::from(wait_ticks),
                MicrofactoryEvent::Enable(on) => self.has_current = on,
                MicrofactoryEvent::Reset { ticks } => {
                    self.resets += 1;
                    self.time_ticks += u64::from(ticks);
                }
                MicrofactoryEvent::Report(report) => reports.push(report),
                MicrofactoryEvent::Idle => return (reports, path),
            }
        }
        panic!("no end");
    }
}

fn homed() -> (Microfactory<Vec<[i16; 2]>>, Model) {
    let config = MicrofactoryConfig::ORIGINAL;
    let mut machine = Microfactory::new(config, SQUARE.to_vec());
    let mut model = Model::new(&config, [700, 300, 1500]);
    assert!(machine.command(Order::Home));
    assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::Homed]);
    (machine, model)
}

#[test]
fn homing_frees_every_switch_by_its_back_off() {
    let (machine, model) = homed();
    assert!(machine.is_homed());
    assert_eq!(machine.position_steps(), [0; MICROFACTORY_MOTORS]);
    for axis in 0..3 {
        assert_eq!(model.nut[axis] - model.switches[axis], 200, "axis {axis}");
    }
    assert!(!model.has_current);
    assert_eq!(model.resets, 1);
}

#[test]
fn homing_without_a_switch_ends() {
    let config = MicrofactoryConfig::ORIGINAL;
    let mut machine = Microfactory::new(config, SQUARE);
    let mut model = Model::new(&config, [100, 1_000_000, 100]);
    machine.command(Order::Home);
    let (reports, _) = model.run(&mut machine);
    assert_eq!(reports, [MicrofactoryReport::NoSwitch { axis: 1 }]);
    assert!(!machine.is_homed());
}

/// After a failed homing the machine is not homed, even if it was homed before.
#[test]
fn a_homing_that_fails_leaves_it_not_homed() {
    let (mut machine, mut model) = homed();
    model.switches[1] = i32::MIN;
    assert!(machine.command(Order::Home));
    assert!(
        !machine.is_homed(),
        "not homed from the first step of homing"
    );
    assert_eq!(
        model.run(&mut machine).0,
        [MicrofactoryReport::NoSwitch { axis: 1 }]
    );
    assert!(!machine.status().is_homed);
}

/// A switch that stays closed while the axis leaves it before the search.
#[test]
fn a_switch_that_never_opens_ends_homing() {
    let config = MicrofactoryConfig::ORIGINAL;
    let mut machine = Microfactory::new(config, SQUARE);
    let mut model = Model::new(&config, [100, -5000, 100]);
    machine.command(Order::Home);
    let (reports, path) = model.run(&mut machine);
    assert_eq!(reports, [MicrofactoryReport::StillClosed { axis: 1 }]);
    let highest = path.iter().map(|nut| nut[1]).max();
    assert_eq!(
        highest,
        Some(200),
        "it moves off the switch by the back-off and no farther"
    );
    assert!(!machine.is_homed());
}

/// After a stop during the back-off, the reported end of the jog is still the switch.
#[test]
fn a_stop_on_the_way_back_does_not_hide_the_switch() {
    let (mut machine, mut model) = homed();
    machine.command(Order::Jog {
        motor: 0,
        forward: false,
    });
    for _ in 0..450 {
        match machine.next_event(&model.inputs()) {
            MicrofactoryEvent::Step(step) => model.apply(step),
            MicrofactoryEvent::Enable(on) => model.has_current = on,
            _ => {}
        }
    }
    assert_eq!(
        machine.status().report,
        Some(MicrofactoryReport::Switch { axis: 0 })
    );
    assert!(machine.is_moving() && machine.command(Order::Stop));
    assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::Stopped]);
    assert_eq!(
        machine.status().report,
        Some(MicrofactoryReport::Switch { axis: 0 })
    );
}

/// RESET sets the phases to a known state. One RESET after power-on is enough, homed or not.
#[test]
fn it_is_reset_once_after_power_came_on() {
    let config = MicrofactoryConfig::ORIGINAL;
    let mut machine = Microfactory::new(config, SQUARE);
    let mut model = Model::new(&config, [10_000; 3]);
    let steps = Order::Steps {
        motor: 0,
        forward: true,
        count: 1,
    };
    for round in 0..3 {
        machine.command(steps);
        model.run(&mut machine);
        assert_eq!(model.resets, 1, "{round}");
    }
    machine.reset();
    machine.command(steps);
    model.run(&mut machine);
    assert_eq!(model.resets, 2);
}

#[test]
fn counted_steps_move_the_load_by_their_number_whatever_the_backlash() {
    let (mut machine, mut model) = homed();
    let from = model.nut;
    for (forward, count) in [(true, 255), (false, 40), (true, 1), (false, 216)] {
        machine.command(Order::Steps {
            motor: 2,
            forward,
            count,
        });
        model.run(&mut machine);
    }
    assert_eq!(model.nut, from);
    assert_eq!(machine.position_steps()[2], 0);
}

#[test]
fn a_switch_that_closes_stops_the_axis_and_it_goes_back() {
    let (mut machine, mut model) = homed();
    machine.command(Order::Jog {
        motor: 0,
        forward: false,
    });
    let (reports, path) = model.run(&mut machine);
    assert_eq!(
        reports,
        [
            MicrofactoryReport::Switch { axis: 0 },
            MicrofactoryReport::Done
        ]
    );
    let lowest = path.iter().map(|nut| nut[0]).min().unwrap();
    assert_eq!(lowest, model.switches[0], "no step beyond the switch");
    assert_eq!(machine.position_steps()[0], 0);
}

#[test]
fn a_switch_that_closes_on_the_way_from_it_stops_the_axis_too() {
    let jog = Order::Jog {
        motor: 2,
        forward: true,
    };
    let steps = Order::Steps {
        motor: 2,
        forward: true,
        count: 255,
    };
    for (command, events) in [(jog, 90), (steps, 90), (Order::Figure, 7000)] {
        let (mut machine, mut model) = homed();
        model.face = model.nut[1] + 10;
        assert!(machine.command(command));
        for _ in 0..events {
            match machine.next_event(&model.inputs()) {
                MicrofactoryEvent::Step(step) => model.apply(step),
                MicrofactoryEvent::Enable(on) => model.has_current = on,
                _ => {}
            }
        }
        // The switch closes for one check only.
        let from = model.nut[2];
        let mut inputs = model.inputs();
        inputs.home[2] = true;
        while let MicrofactoryEvent::Step(step) = machine.next_event(&inputs) {
            model.apply(step);
        }
        let (reports, _) = model.run(&mut machine);
        assert_eq!(reports, [MicrofactoryReport::Done], "{command:?}");
        let status = machine.status();
        assert_eq!(status.report, Some(MicrofactoryReport::Switch { axis: 2 }));
        assert!(!status.is_moving && status.is_homed);
        // A step that was already decided is made.
        assert!((200..=201).contains(&(model.nut[2] - from)), "{command:?}");
    }
}

#[test]
fn away_from_a_closed_switch_it_may_go() {
    let (mut machine, mut model) = homed();
    model.switches[0] = model.nut[0] + 20;
    machine.command(Order::Steps {
        motor: 0,
        forward: true,
        count: 50,
    });
    assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::Done]);
    assert_eq!(machine.position_steps()[0], 50);
}

/// Emergency stop during a back-off, in homing and after a jog.
#[test]
fn an_emergency_stop_ends_going_back() {
    let config = MicrofactoryConfig::ORIGINAL;
    let jog = Order::Jog {
        motor: 0,
        forward: false,
    };
    for command in [Order::Home, jog] {
        let mut machine = Microfactory::new(config, SQUARE);
        let mut model = Model::new(&config, [30, 30, 30]);
        machine.command(command);
        // 30 steps and the backlash to the switch, then part of the back-off of 200 and the
        // backlash.
        for _ in 0..330 {
            match machine.next_event(&model.inputs()) {
                MicrofactoryEvent::Step(step) => model.apply(step),
                MicrofactoryEvent::Enable(on) => model.has_current = on,
                _ => {}
            }
        }
        assert!(machine.command(Order::Emergency));
        let motors = model.motor;
        assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::Emergency]);
        assert_eq!(model.motor, motors);
        assert!(!model.has_current && !machine.status().is_homed);
        assert!(!machine.command(Order::Home));
    }
}

#[test]
fn without_a_figure_none_is_cut() {
    let (mut machine, mut model) = homed();
    machine.figure_mut().unwrap().clear();
    assert!(!machine.command(Order::Figure));
    assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::NoFigure]);
    machine.figure_mut().unwrap().push([5, 0]);
    model.face = model.nut[1];
    assert!(machine.command(Order::Figure));
    assert!(machine.figure_mut().is_none());
    assert_eq!(
        model.run(&mut machine).0,
        [MicrofactoryReport::Contact, MicrofactoryReport::Done]
    );
    assert_eq!(machine.status().position_steps[0], 5);
}

#[test]
fn a_figure_begins_at_contact_and_follows_its_lines() {
    let (mut machine, mut model) = homed();
    let [x, y, z] = model.nut;
    model.face = y + 321;
    machine.command(Order::Figure);
    let before = model.time_ticks;
    let (reports, path) = model.run(&mut machine);
    assert_eq!(
        reports,
        [MicrofactoryReport::Contact, MicrofactoryReport::Done]
    );
    assert_eq!(model.nut, [x + 1000, y + 321, z + 1000]);
    // Along the diagonal the axes agree within a step.
    for [now_x, _, now_z] in path.iter().rev().take(1000) {
        assert!((now_x - x).abs_diff(now_z - z) <= 1, "{now_x} {now_z}");
    }
    // 321 + 4000 steps and a diagonal of 1414 at 400 per second. The take-ups are X once and Z
    // twice: for -X, for -Z, and for both before the diagonal, where one time serves both.
    let steps = 321.0 + 4000.0 + 1000.0 * 2.0_f64.sqrt() + 600.0;
    let seconds = (model.time_ticks - before) as f64 / 1e6;
    assert!((seconds - steps / 400.0 - 0.010).abs() < 0.05, "{seconds}");
    // The spindle turned at 256 steps per second during the figure.
    let turned = machine.position_steps()[3];
    assert!(
        (f64::from(turned) - seconds * 256.0).abs() < 4.0,
        "{turned}"
    );
}

#[test]
fn no_contact_no_figure() {
    let (mut machine, mut model) = homed();
    let from = model.nut;
    machine.command(Order::Figure);
    assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::NoContact]);
    assert_eq!([model.nut[0], model.nut[2]], [from[0], from[2]]);
}

#[test]
fn a_jog_ends_without_its_dead_man() {
    let config = MicrofactoryConfig {
        dead_man_ticks: Some(250_000),
        ..MicrofactoryConfig::ORIGINAL
    };
    let mut machine = Microfactory::new(config, SQUARE);
    let mut model = Model::new(&config, [10_000; 3]);
    let jog = Order::Jog {
        motor: 1,
        forward: true,
    };
    machine.command(jog);
    for _ in 0..20 {
        machine.next_event(&model.inputs());
    }
    let before = machine.position_steps()[1];
    assert!(machine.command(jog), "a repeated jog");
    model.has_current = true;
    assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::DeadMan]);
    assert_eq!(machine.position_steps()[1] - before, 100);
}

#[test]
fn the_originals_reset_before_every_move() {
    let config = MicrofactoryConfig {
        resets_before_moves: true,
        ..MicrofactoryConfig::ORIGINAL
    };
    let mut machine = Microfactory::new(config, SQUARE);
    let mut model = Model::new(&config, [10_000; 3]);
    for _ in 0..3 {
        machine.command(Order::Steps {
            motor: 0,
            forward: true,
            count: 1,
        });
        model.run(&mut machine);
    }
    assert_eq!(model.resets, 3);
    assert_eq!(model.time_ticks, 3 * (1_000 + 10_000 + 2_500));
}

fn command() -> impl Strategy<Value = Order> {
    prop_oneof![
        Just(Order::Home),
        Just(Order::Figure),
        (0..4_u8, any::<bool>()).prop_map(|(motor, forward)| Order::Jog { motor, forward }),
        (0..4_u8, any::<bool>(), 1..=255_u8).prop_map(|(motor, forward, count)| {
            Order::Steps {
                motor,
                forward,
                count,
            }
        }),
        Just(Order::Stop),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// For any commands and stops: while the machine is homed, its position is that of the load,
    /// and no axis moves beyond its switch.
    #[test]
    fn positions_are_the_loads(
        commands in prop::collection::vec((command(), 0..3000_usize), 0..12),
        face in 0..400,
    ) {
        let (mut machine, mut model) = homed();
        let zero = model.nut;
        model.face = zero[1] + face;
        for (command, events) in commands {
            machine.command(command);
            for _ in 0..events {
                match machine.next_event(&model.inputs()) {
                    MicrofactoryEvent::Step(step) => model.apply(step),
                    MicrofactoryEvent::Enable(on) => model.has_current = on,
                    _ => {}
                }
                for axis in 0..3 {
                    prop_assert!(model.nut[axis] >= model.switches[axis]);
                }
            }
            machine.command(Order::Stop);
            let loads: [i32; 3] = std::array::from_fn(|axis| model.nut[axis] - zero[axis]);
            // An interrupted homing leaves the machine not homed, with unknown flanks.
            if machine.is_homed() {
                prop_assert_eq!(&machine.position_steps()[..3], &loads);
            }
        }
    }

    /// Each of two machines of one controller behaves as it does alone, for any order of their
    /// events. An emergency stop applies to both.
    #[test]
    fn a_pair_is_two_machines(
        commands in [command(), command()],
        turns in prop::collection::vec(any::<bool>(), 0..3000),
    ) {
        let config = MicrofactoryConfig::ORIGINAL;
        let link = Device::new(ByteTable::DEFAULT).of_two_machines();
        let mut pair = MicrofactoryStation::<5, 2>::new(link, config);
        prop_assert!(pair.store(0, &SQUARE) && pair.store(1, &SQUARE) && !pair.store(2, &SQUARE));
        let mut alone = [Microfactory::new(config, SQUARE), Microfactory::new(config, SQUARE)];
        let mut model = Model::new(&config, [400, 300, 200]);
        model.face = 100;
        let mut models = [model.clone(), model];
        for (machine, command) in (0..).zip(commands) {
            let taken = pair.command(machine, command);
            prop_assert_eq!(taken, alone[usize::from(machine)].command(command));
        }
        for turn in turns {
            let machine = usize::from(turn);
            let inputs = models[machine].inputs();
            let event = pair.next_event(machine as u8, &inputs);
            prop_assert_eq!(
                event.unwrap_or(MicrofactoryEvent::Idle),
                alone[machine].next_event(&inputs),
            );
            match event.unwrap_or(MicrofactoryEvent::Idle) {
                MicrofactoryEvent::Step(step) => models[machine].apply(step),
                MicrofactoryEvent::Enable(on) => models[machine].has_current = on,
                _ => {}
            }
        }
        prop_assert!(pair.command(0, Order::Emergency));
        prop_assert!(!pair.is_moving(0) && !pair.is_moving(1));
        prop_assert!(!pair.command(1, Order::Home));
        pair.reset();
        prop_assert!(pair.command(1, Order::Home) && !pair.is_moving(0));
        prop_assert!(pair.machine(2).is_none() && !pair.command(2, Order::Home));
    }

    /// A move of any slope: every step is within half a step of the line. All steps share the time
    /// for the length at the rate of an axis. The move ends at its target. The original has only
    /// whole slopes, each slower than the last.
    #[test]
    fn a_line_of_any_slope_is_straight_and_at_one_speed(x in any::<i16>(), z in any::<i16>()) {
        prop_assume!((x, z) != (0, 0));
        let config = MicrofactoryConfig {
            backlash_steps: [0; 3],
            spindle_turns_in_figures: false,
            ..MicrofactoryConfig::ORIGINAL
        };
        let mut machine = Microfactory::new(config, [[x, z]]);
        let mut model = Model::new(&config, [40_000; 3]);
        model.face = 0;
        prop_assert!(machine.command(Order::Figure));
        let (x, z) = (f64::from(x), f64::from(z));
        let (mut begins, mut steps) = (None, 0_u32);
        let length = x.hypot(z);
        let events = x.abs().max(z.abs());
        loop {
            match machine.next_event(&model.inputs()) {
                MicrofactoryEvent::Idle => break,
                MicrofactoryEvent::Enable(on) => model.has_current = on,
                MicrofactoryEvent::Step(step) => {
                    let begins = *begins.get_or_insert(model.time_ticks);
                    model.apply(step);
                    steps += 1;
                    let [at_x, _, at_z] = model.nut.map(f64::from);
                    let share = f64::from(steps) / events;
                    let beside = (at_x - share * x).abs().max((at_z - share * z).abs());
                    prop_assert!(beside < 0.5 + 1e-9, "{beside}");
                    let ticks = (model.time_ticks - begins) as f64;
                    let expected = share * length / 400.0 * 1e6;
                    // Tolerance: 1/256 step in the length, rounded once for all events, and a tick.
                    prop_assert!(
                        (ticks - expected).abs() <= 1.0 + share * (10.0 + events / 256.0),
                        "{ticks} {expected}",
                    );
                }
                _ => {}
            }
        }
        prop_assert_eq!(f64::from(steps), events);
        let [at_x, _, at_z] = model.nut.map(f64::from);
        prop_assert_eq!([at_x, at_z], [x, z]);
    }

    /// An emergency stop acts on the next event, in every task, and holds until a reset.
    #[test]
    fn an_emergency_stop_is_for_good(
        first in command(),
        events in 0..2000_usize,
        then in command(),
    ) {
        let (mut machine, mut model) = homed();
        model.face = model.nut[1] + 50;
        machine.command(first);
        for _ in 0..events {
            match machine.next_event(&model.inputs()) {
                MicrofactoryEvent::Step(step) => model.apply(step),
                MicrofactoryEvent::Enable(on) => model.has_current = on,
                _ => {}
            }
        }
        prop_assert!(machine.command(Order::Emergency));
        let motors = model.motor;
        let (reports, path) = model.run(&mut machine);
        prop_assert_eq!(reports, [MicrofactoryReport::Emergency]);
        prop_assert!(path.is_empty() && model.motor == motors && !model.has_current);
        prop_assert!(!machine.command(then));
        prop_assert_eq!(machine.next_event(&model.inputs()), MicrofactoryEvent::Idle);
        machine.reset();
        prop_assert!(machine.command(Order::Home));
        prop_assert_eq!(model.run(&mut machine).0, [MicrofactoryReport::Homed]);
    }
}
