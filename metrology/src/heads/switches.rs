//! The contacts of a probe.

use husillo_transports::nmc::{Homing, Reply, Status};

/// The contacts of a probe, at the limit inputs of the modules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switches {
    /// One contact, at limit 1 of every module.
    #[default]
    One,
    /// One contact for each direction of the only axis, as on the prototype. A touch in the
    /// positive direction closes limit 1. A touch in the negative direction closes limit 2.
    PerSense,
}

impl Switches {
    /// The events of a module that report a change of a contact.
    #[must_use]
    pub const fn events(self) -> Homing {
        match self {
            Self::One => Homing::LIMIT_1,
            Self::PerSense => Homing::LIMIT_1.with(Homing::LIMIT_2),
        }
    }

    /// Whether a contact is closed.
    #[must_use]
    pub const fn is_closed(self, reply: &Reply) -> bool {
        self.are_closed(reply)[0] || self.are_closed(reply)[1]
    }

    /// Whether the contact for touches in the positive direction is closed, and whether the contact
    /// for touches in the negative direction is closed.
    #[must_use]
    pub const fn are_closed(self, reply: &Reply) -> [bool; 2] {
        let one = reply.status.contains(Status::LIMIT_1);
        match self {
            Self::One => [one; 2],
            Self::PerSense => [one, reply.status.contains(Status::LIMIT_2)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Switches;
    use crate::error::Error;
    use crate::heads::head::Head;
    use crate::heads::line::Line;
    use crate::simulated::{SimulatedNetwork, SimulatedPort, one_axis};
    use husillo_probe::UnitVector;

    /// A head of one axis between two faces, whose contacts are wired as `wired`.
    fn head(switches: Switches, wired: Switches) -> Head<SimulatedPort> {
        let mut machine = one_axis();
        machine.probe.switches = switches;
        let faces = ["1:900", "1:..-700"].map(|face| face.parse().unwrap());
        let network = SimulatedNetwork::of_machine(&machine, &faces, None).unwrap();
        let port = SimulatedPort::new(network.with_switches(wired));
        Head::start(Line::new(port), &machine, 1).unwrap()
    }

    /// The counts at which the faces are touched, in positive and in negative direction.
    fn touched(head: &mut Head<SimulatedPort>) -> [i64; 2] {
        let directions = [UnitVector::X, UnitVector::X.reversed()];
        directions.map(|direction| {
            let counts = head.touch(&direction, 3000).unwrap().touch.position[0];
            head.go_to([0; 3]).unwrap();
            counts
        })
    }

    #[test]
    fn a_contact_for_each_sense_measures_as_a_single_one_does() {
        for switches in [Switches::One, Switches::PerSense] {
            assert_eq!(
                touched(&mut head(switches, switches)),
                [900, -700],
                "{switches:?}"
            );
        }
    }

    #[test]
    fn a_collision_closes_either_contact() {
        for goal in [1500, -1500] {
            let mut head = head(Switches::PerSense, Switches::PerSense);
            let hit = head.go_to([goal, 0, 0]);
            assert!(matches!(hit, Err(Error::Collision { .. })), "{hit:?}");
        }
    }

    /// With a single contact at limit 1, a touch in the negative direction closes the contact for
    /// the positive direction.
    #[test]
    fn the_contact_of_the_other_sense_is_refused() {
        let mut head = head(Switches::PerSense, Switches::One);
        assert!(head.touch(&UnitVector::X, 3000).is_ok());
        head.go_to([0; 3]).unwrap();
        let touch = head.touch(&UnitVector::X.reversed(), 3000);
        assert!(matches!(touch, Err(Error::OtherSense { .. })), "{touch:?}");
    }

    /// The input of a second contact that the machine does not have is ignored.
    #[test]
    fn a_single_contact_is_at_limit_1() {
        let mut head = head(Switches::One, Switches::PerSense);
        assert!(head.touch(&UnitVector::X, 3000).is_ok());
        head.go_to([0; 3]).unwrap();
        let touch = head.touch(&UnitVector::X.reversed(), 3000);
        assert!(matches!(touch, Err(Error::NoContact { .. })), "{touch:?}");
    }
}
