//! The reaction of a move outside of a search to an unexpected contact.

use super::head::Head;
use super::port::Port;
use husillo_planner::Tangent;

/// The reaction of a move outside of a search to a contact. In both cases the contact is a
/// collision, and all axes stop. Each module stops its own axis without the host.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Approach {
    /// The move has its full speed. The axes stop abruptly.
    #[default]
    Rapid,
    /// The axes stop gently, with the deceleration of a search. The move is so slow that its
    /// braking distance, v^2 / 2a, is at most half of the over-travel of the probe. The other half
    /// is for the lag of the servo and for the reaction time of its module, which is one servo
    /// period.
    Guarded,
}

impl<P: Port> Head<P> {
    /// The highest speed of a guarded move along the line to a goal, counts/s.
    pub(super) fn guarded_rate(&self, goal: &[i32]) -> u32 {
        let (mut distances, mut accelerations) = ([0; 3], [u64::MAX; 3]);
        for (axis, goal) in self.axes.iter().zip(goal) {
            let coordinate = axis.settings.coordinate();
            distances[coordinate] = goal.saturating_sub(axis.held);
            accelerations[coordinate] = axis.settings.acceleration.into();
        }
        let Some(direction) = Tangent::new(distances.map(i64::from)) else {
            // Nothing moves.
            return u32::MAX;
        };
        let acceleration = direction.acceleration_limit(&accelerations);
        // v^2 = 2 a s, where s is half of the over-travel. A saturated product is faster than any
        // axis.
        let square = acceleration.saturating_mul(self.probe.over_travel.into());
        u32::try_from(square.isqrt()).unwrap_or(u32::MAX).max(1)
    }
}

#[cfg(test)]
mod tests {
    use crate::error::Error;
    use crate::heads::{Head, Line, Port, Prober};
    use crate::simulated::{SimulatedNetwork, SimulatedPort, three_axes};
    use husillo_transports::nmc::{Baud, Timing};
    use std::cell::Cell;
    use std::io;
    use std::rc::Rc;

    const MM: i64 = 1_000_000;
    /// The face of the tests, counts of X.
    const FACE: i32 = 2000;

    /// A port that records the farthest position of X.
    struct Noting {
        port: SimulatedPort,
        farthest: Rc<Cell<i64>>,
    }

    impl Port for Noting {
        fn timing(&self, baud: Baud) -> Timing {
            self.port.timing(baud)
        }

        fn elapsed_us(&self) -> u64 {
            self.port.elapsed_us()
        }

        fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
            self.port.set_baud(baud)
        }

        fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
            self.port.send(bytes)
        }

        fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
            let end_us = self.elapsed_us() + u64::from(wait_us.max(1));
            while self.elapsed_us() < end_us {
                let bytes = self.port.receive(1)?;
                let counts = self
                    .port
                    .network
                    .servo_network()
                    .motor(0)
                    .map(|motor| motor.counts());
                let farthest = self.farthest.get().max(counts.unwrap_or_default());
                self.farthest.set(farthest);
                if !bytes.is_empty() {
                    return Ok(bytes);
                }
            }
            Ok(Vec::new())
        }
    }

    /// The machine of three axes before the face, with its home at its present position, and the
    /// farthest position of X.
    fn head(over_travel: u32, acceleration: u32) -> (Head<Noting>, Rc<Cell<i64>>) {
        let mut machine = three_axes();
        machine.probe.over_travel = over_travel;
        for axis in &mut machine.axes {
            axis.acceleration = acceleration;
        }
        let face = format!("1:{FACE}").parse().unwrap();
        let network = SimulatedNetwork::of_machine(&machine, &[face], None).unwrap();
        let farthest = Rc::new(Cell::new(0));
        let port = Noting {
            port: SimulatedPort::new(network),
            farthest: farthest.clone(),
        };
        let mut head = Head::start(Line::new(port), &machine, 1).unwrap();
        head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
        (head, farthest)
    }

    /// Wherever a guarded move begins, the motor stays within the over-travel while it brakes. It
    /// brakes with the deceleration of a search. If the move had room to reach its speed, the
    /// braking distance is half of the over-travel.
    #[test]
    fn a_guarded_move_stops_within_the_over_travel() {
        let moves = [[0, 0], [MM, 3 * MM], [2 * MM, -MM], [2_500_000, 700_000]];
        for (over_travel, acceleration) in [(40, 6000), (100, 3000), (100, 9000), (200, 6000)] {
            for [from, across] in moves {
                let (mut head, farthest) = head(over_travel, acceleration);
                head.go_to([from, 0, 0]).unwrap();
                let met = head.guarded_to([9 * MM, across, 0]);
                let context = format!("{over_travel} {acceleration} from {from}: {met:?}");
                let Err(Error::Collision {
                    axes,
                    at,
                    speed: Some(_),
                    beyond: Some(beyond),
                }) = met
                else {
                    panic!("{context}")
                };
                assert!(
                    axes.starts_with('X') && at.starts_with("X 4.00"),
                    "{context}"
                );
                let pressed = farthest.get() - i64::from(FACE);
                assert!(
                    (1..=i64::from(over_travel)).contains(&pressed),
                    "{context}: {pressed} counts"
                );
                let beyond: f64 = beyond.trim_end_matches(" mm").parse().unwrap();
                // Counts are 2 um. The path is oblique where Y moves, too.
                let half = f64::from(over_travel) / 2.0 * 2e-3;
                assert!(beyond >= half * 0.9, "{context}");
                assert!(head.has_collided());
            }
        }
    }

    /// The same move without the guard is faster, and ends abruptly.
    #[test]
    fn a_rapid_move_is_faster_and_stops_abruptly() {
        let met = |guarded: bool| {
            let (mut head, _) = head(100, 6000);
            let goal = [9 * MM, 0, 0];
            let met = if guarded {
                head.guarded_to(goal)
            } else {
                head.go_to(goal)
            };
            let Err(Error::Collision {
                speed: Some(speed),
                beyond: Some(beyond),
                ..
            }) = met
            else {
                panic!("{met:?}")
            };
            let number = |text: String| -> f64 { text.split(' ').next().unwrap().parse().unwrap() };
            (number(speed), number(beyond))
        };
        let ((guarded, gently), (rapid, abruptly)) = (met(true), met(false));
        // v^2 = a s: 775 counts/s.
        assert!((1.45..1.6).contains(&guarded), "{guarded} mm/s");
        assert!((2.3..2.5).contains(&rapid), "{rapid} mm/s");
        assert!((0.1..0.15).contains(&gently), "{gently} mm");
        assert!(abruptly < 0.06, "{abruptly} mm");
    }

    /// After the collision the probe leaves the face at the speed of a search, and the next guarded
    /// move continues at its own.
    #[test]
    fn a_guarded_move_is_left_slowly() {
        let (mut head, _) = head(100, 6000);
        head.guarded_to([9 * MM, 0, 0]).unwrap_err();
        let before = head.line.elapsed_us();
        // 0.32 mm at 0.4 mm/s, and the rest of 4 mm at 1.55 mm/s.
        head.guarded_to([0; 3]).unwrap();
        let seconds = (head.line.elapsed_us() - before) as f64 / 1e6;
        assert!((3.0..4.2).contains(&seconds), "{seconds} s");
        // In the next move towards the face the contact is watched again.
        let again = head.guarded_to([9 * MM, 0, 0]);
        assert!(matches!(again, Err(Error::Collision { .. })), "{again:?}");
    }

    /// A guarded move without a contact ends at its goal, as any other move does.
    #[test]
    fn a_guarded_move_without_a_contact_ends_at_its_goal() {
        let (mut head, _) = head(100, 6000);
        let goal = [3 * MM, -2 * MM, MM];
        let there = head.guarded_to(goal).unwrap();
        assert!(
            (0..3).all(|axis| there[axis].abs_diff(goal[axis]) <= 2000),
            "{there:?}"
        );
        assert!(!head.has_collided() && head.position().is_ok());
    }
}
