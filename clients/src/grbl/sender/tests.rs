//! Programs to the simulated controller, with faults and interventions while they run.

use super::*;
use crate::grbl::{BAUD, open};
use husillo_transports::grbl::{Adjust, Position};
use std::collections::VecDeque;

/// An operator who sends each command when this many lines are answered.
#[derive(Default)]
struct Script {
    at: Vec<(usize, Realtime)>,
    due: VecDeque<Realtime>,
    states: Vec<State>,
    texts: Vec<String>,
    stop: Option<(usize, StopRequests)>,
    /// Whether the operator resumes the program after a hold.
    resumes: bool,
    agreed: usize,
}

impl Operator for Script {
    fn hear(&mut self, heard: &Heard) {
        match heard {
            Heard::Status(status) => {
                self.states.push(status.state);
                if self.resumes && status.state == State::Hold(false) {
                    self.due.push_back(Realtime::Resume);
                }
            }
            Heard::Text(text) => self.texts.push(text.clone()),
            _ => {}
        }
    }

    fn progress(&mut self, lines: usize) {
        let due = self.at.iter().filter(|(at, _)| *at == lines);
        self.due.extend(due.map(|(_, command)| *command));
        if let Some((at, stop)) = &self.stop
            && *at == lines
        {
            stop.request();
        }
    }

    fn command(&mut self) -> Option<Realtime> {
        self.due.pop_front()
    }

    fn agrees(&mut self, _line: &str) -> Option<bool> {
        self.agreed = self.agreed.saturating_sub(1);
        Some(self.agreed > 0)
    }
}

fn sender(pacing: Pacing, stop: StopRequests) -> Sender {
    Sender::new(open("sim", BAUD).unwrap(), pacing, stop).unwrap()
}

/// Short moves along a line that ends at X 4.
fn short_moves() -> Vec<(usize, String)> {
    let first = ["G21 G90 G94".to_owned(), "F300".to_owned()];
    let moves = (1..=40).map(|number| format!("G1 X{:.1}", f64::from(number) / 10.0));
    (1..).zip(first.into_iter().chain(moves)).collect()
}

/// Position of X, mm.
fn x(status: &Status) -> f64 {
    let Position::Machine(at) = status.position else {
        panic!("machine position");
    };
    at.nm()[0] as f64 / 1e6
}

#[test]
fn every_pacing_makes_the_whole_program() {
    for pacing in [Pacing::Counted, Pacing::Answered, Pacing::SingleBlock] {
        let mut sender = sender(pacing, StopRequests::default());
        let mut script = Script {
            agreed: 100,
            ..Script::default()
        };
        let sent = sender.send(&short_moves(), &mut script).unwrap();
        assert_eq!((sent.lines, x(&sent.status)), (42, 4.0), "{pacing:?}");
    }
}

/// The bytes that wait in the controller never exceed its receive buffer. While lines are left,
/// some bytes always wait. A move of 0.1 mm at 300 mm/min takes 20 ms, and no move waits for the
/// host.
#[test]
fn counted_lines_take_no_longer_than_their_moves() {
    let mut sender = sender(Pacing::Counted, StopRequests::default());
    let before = sender.session().elapsed();
    sender.send(&short_moves(), &mut Script::default()).unwrap();
    let seconds = (sender.session().elapsed() - before).as_secs_f64();
    // 40 moves of 20 ms, a ramp of 10 mm/s^2 at each end, and the reports at the end.
    assert!(seconds < 0.8 + 1.0 + 0.5, "{seconds} s");
}

#[test]
fn a_refused_line_stops_the_machine_and_is_named() {
    let mut sender = sender(Pacing::Counted, StopRequests::default());
    let mut lines = short_moves();
    lines[20].1 = "G1 X9 X9".into();
    let why = sender.send(&lines, &mut Script::default()).unwrap_err();
    assert!(why.starts_with("line 21, G1 X9 X9: error 25: "), "{why}");
    assert!(why.contains("the controller has stopped; "), "{why}");
    let status = sender.session().fresh_status().unwrap();
    assert_eq!(status.state, State::Idle);
    // None of the lines behind it is carried out.
    assert!(x(&status) <= 1.9, "{why}");
}

#[test]
fn a_stop_brakes_and_keeps_the_position() {
    let stop = StopRequests::default();
    let mut sender = sender(Pacing::Counted, stop.clone());
    let mut script = Script {
        stop: Some((20, stop.clone())),
        ..Script::default()
    };
    let why = sender.send(&short_moves(), &mut script).unwrap_err();
    assert!(
        why.starts_with("interrupted: the controller has stopped; "),
        "{why}"
    );
    let status = sender.session().fresh_status().unwrap();
    assert_eq!(status.state, State::Idle, "no alarm: the position is valid");
    let open = sender.first_open();
    assert!((4..=20).contains(&open), "index {open}");
    // The first line that is not carried out is `first_open` or a later one.
    assert!(
        x(&status) >= (open as f64 - 3.0) / 10.0,
        "{why}, line {open}"
    );
    let steps = sender.session().device().rig(0).unwrap().steps()[0];
    assert_eq!(steps as f64 / 250.0, x(&status));
}

#[test]
fn holds_and_overrides_act_while_lines_are_sent() {
    let mut sender = sender(Pacing::Counted, StopRequests::default());
    let mut script = Script {
        at: vec![(10, Realtime::Feed(Adjust::By(10))), (20, Realtime::Hold)],
        resumes: true,
        ..Script::default()
    };
    let sent = sender.send(&short_moves(), &mut script).unwrap();
    assert_eq!(x(&sent.status), 4.0);
    assert!(
        script.states.contains(&State::Hold(false)),
        "{:?}",
        script.states
    );
}

/// M0 waits for the operator.
#[test]
fn a_program_that_pauses_goes_on() {
    let mut sender = sender(Pacing::Counted, StopRequests::default());
    let mut lines = short_moves();
    lines.insert(20, (20, "M0".into()));
    let mut script = Script {
        resumes: true,
        ..Script::default()
    };
    let sent = sender.send(&lines, &mut script).unwrap();
    assert_eq!(x(&sent.status), 4.0);
}

#[test]
fn a_reset_and_a_switch_end_the_program() {
    for (panel, part) in [
        ("reset", "the controller was reset; "),
        ("unplug", "does not answer any more"),
    ] {
        let mut sender = sender(Pacing::Counted, StopRequests::default());
        sender.session().device().schedule(400_000, panel);
        let why = sender
            .send(&short_moves(), &mut Script::default())
            .unwrap_err();
        assert!(why.contains(part), "{panel}: {why}");
    }
}

#[test]
fn a_single_block_may_end_the_program() {
    let mut sender = sender(Pacing::SingleBlock, StopRequests::default());
    let mut script = Script {
        agreed: 5,
        ..Script::default()
    };
    let why = sender.send(&short_moves(), &mut script).unwrap_err();
    assert!(why.starts_with("line 5: stopped before G1 X0.3"), "{why}");
}

/// A held controller answers no line. The session detects the hold, and a stop ends it.
#[test]
fn a_held_controller_is_named() {
    let mut sender = sender(Pacing::Counted, StopRequests::default());
    let session = sender.session();
    session.put(b"G91 G1 X5 F600\n").unwrap();
    for _ in 0..20 {
        session.turn().unwrap();
    }
    session.put(b"!").unwrap();
    while session.fresh_status().unwrap().state != State::Hold(false) {}
    assert_eq!(session.begin(), Ok(()), "it does not wait for an answer");
    assert_eq!(session.state(), Some(State::Hold(false)));
    assert_eq!(session.stand(), Ok(()));
    assert_eq!(session.state(), Some(State::Idle));
}

/// A killed program leaves part of a line, or lines that are being carried out.
#[test]
fn a_session_begins_after_a_killed_program() {
    for (left, is_in_motion) in [("G1 X", false), ("$J=G91X5F600\n", true)] {
        let mut wire = open("sim", BAUD).unwrap();
        let _ = wire.receive_all(std::time::Duration::from_millis(100));
        wire.send_all(left.as_bytes()).unwrap();
        let sender = Sender::new(wire, Pacing::Counted, StopRequests::default());
        match sender {
            Ok(mut sender) => {
                let sent = sender.send(&short_moves(), &mut Script::default());
                assert_eq!(x(&sent.unwrap().status), 4.0);
                assert!(!is_in_motion);
            }
            Err(why) => assert!(is_in_motion && why.contains("moves for another"), "{why}"),
        }
    }
}

/// A switch that ends a jog is an alarm, not a success.
#[test]
fn a_jog_into_a_switch_fails() {
    use crate::ByHand as _;
    use crate::grbl::{Action, Hand};
    let mut hand = Hand::new(open("sim", BAUD).unwrap(), StopRequests::default()).unwrap();
    for (number, value) in [(21, "1"), (110, "2000")] {
        hand.carry_out(&Action::Set(number, value.into())).unwrap();
    }
    let why = hand.carry_out(&Action::By("X30".into())).unwrap_err();
    assert!(why.starts_with("alarm 1: "), "{why}");
}

/// The moves of an answered line are part of the program.
#[test]
fn a_program_ends_where_its_last_move_ends() {
    let mut sender = sender(Pacing::Counted, StopRequests::default());
    let lines = [(1, "G21 G91 G1 X2 F600".to_owned())];
    let sent = sender.send(&lines, &mut Script::default()).unwrap();
    assert_eq!((x(&sent.status), sent.status.state), (2.0, State::Idle));
}

#[test]
fn the_queue_has_the_size_that_the_controller_reports() {
    let lines = ["[VER:1.1f.20230107:]", "[OPT:VNMSL,35,1024,3,0]"].map(str::to_owned);
    assert_eq!(queue(&lines), Ok(35));
    assert!(queue(&lines[..1]).is_err());
    assert_eq!(sender(Pacing::Counted, StopRequests::default()).queue(), 15);
}

/// The first open line is that of the oldest move in the queue, with checked lines as well.
#[test]
fn lines_without_motion_do_not_count_as_moves() {
    let lines: Vec<_> = (1..=60)
        .flat_map(|number| [format!("G1X{number}F6000"), "F6000".to_owned()])
        .zip(1..)
        .map(|(line, number)| (number, line))
        .collect();
    for is_checked in [false, true] {
        let mut sender = sender(Pacing::Counted, StopRequests::default());
        let mut script = Script::default();
        match is_checked {
            true => sender.send_checked(&lines, &mut script).unwrap(),
            false => sender.send(&lines, &mut script).unwrap(),
        };
        // 16 moves of two lines each may be open: the queue of 15 and the one that is made.
        assert_eq!(sender.first_open(), 120 - 2 * 16, "checked: {is_checked}");
    }
}
