//! Jogs: the head follows the joystick of a page while the page renews its lease.

use super::{Driver, Job, Purpose, STOPPING};
use crate::serve::axes::Axes;
use crate::serve::reply::Reply;
use husillo_metrology::heads::Deflection;
use std::time::Instant;

/// A jog that begins when the axes have braked after the one before.
#[derive(Debug)]
pub(super) struct NextJog {
    client: u64,
    number: u64,
    joystick: [Deflection; 3],
    reply: Reply,
}

impl NextJog {
    /// It does not begin.
    pub(super) fn refuse(self, why: &str) {
        self.reply.error(why);
    }
}

impl Driver<'_> {
    /// Begins a jog, or changes the deflection of the one that runs. While the axes still brake, it
    /// waits for them.
    pub(super) fn jog(&mut self, client: u64, number: u64, axes: &Axes, reply: Reply) {
        let joystick = match self.joystick(axes) {
            Ok(joystick) => joystick,
            Err(why) => return self.refuse_jog(client, number, reply, &why),
        };
        match &mut self.current {
            Some((
                Purpose::Jog {
                    client: of,
                    number: old,
                },
                _,
            )) if self.hands.joystick().is_some() => {
                (*of, *old) = (client, number);
                self.hands.steer(Some(joystick));
                reply.ok();
            }
            Some((Purpose::Jog { .. }, _)) => {
                let next = NextJog {
                    client,
                    number,
                    joystick,
                    reply,
                };
                // The one before was let go already.
                if let Some(before) = self.next_jog.replace(next) {
                    before.reply.ok();
                }
            }
            _ => match self.is_free() {
                Ok(()) => {
                    reply.ok();
                    self.start_jog(client, number, joystick);
                }
                Err(why) => self.refuse_jog(client, number, reply, &why),
            },
        }
    }

    fn start_jog(&mut self, client: u64, number: u64, joystick: [Deflection; 3]) {
        self.hands.steer(Some(joystick));
        self.start(Job::Steer, Purpose::Jog { client, number }, "Jog");
    }

    fn refuse_jog(&self, client: u64, number: u64, reply: Reply, why: &str) {
        self.machine.lease.release(client, number);
        reply.error(why);
    }

    /// The deflections of the axes.
    ///
    /// # Errors
    ///
    /// A sentence: none is deflected, or the machine does not have one of them.
    fn joystick(&self, axes: &Axes) -> Result<[Deflection; 3], String> {
        let mut joystick = [Deflection::Centre; 3];
        for (axis, part) in self.checked(axes)? {
            if let Some(deflection) = joystick.get_mut(axis) {
                *deflection = Deflection::of(part);
            }
        }
        match joystick == [Deflection::Centre; 3] {
            true => Err("a jog needs a direction".into()),
            false => Ok(joystick),
        }
    }

    /// Lets the joystick of a jog go because its lease is over.
    pub(super) fn follow_jog(&mut self) {
        let Some((Purpose::Jog { client, number }, _)) = self.current else {
            return;
        };
        let (lease, now) = (&self.machine.lease, Instant::now());
        if self.hands.joystick().is_some() && !lease.holds(client, number, now) {
            if lease.has_run_out(client, number, now) {
                self.tell(&format!("jog {number}: the page did not renew it"));
            }
            self.hands.steer(None);
        }
    }

    /// The axes of a jog stand, or it has failed. The jog that has waited begins.
    pub(super) fn jog_ended(
        &mut self,
        client: u64,
        number: u64,
        result: &Result<(), String>,
        is_stopped: bool,
    ) {
        self.machine.lease.release(client, number);
        let why = result
            .as_ref()
            .map_or_else(String::as_str, |()| "the axes stand");
        self.tell(&format!("jog {number} ends: {why}"));
        let Some(next) = self.next_jog.take() else {
            return;
        };
        let (client, number) = (next.client, next.number);
        let why_not = match result {
            _ if is_stopped => STOPPING,
            Err(why) => why.as_str(),
            // The page must not hold a jog that does not begin.
            Ok(())
                if self
                    .machine
                    .lease
                    .has_run_out(client, number, Instant::now()) =>
            {
                "the page did not renew the jog before the axes stood"
            }
            Ok(()) => {
                next.reply.ok();
                match self.machine.lease.holds(client, number, Instant::now()) {
                    true => self.start_jog(client, number, next.joystick),
                    false => self.tell(&format!(
                        "jog {number} ends: it was let go before the axes stood"
                    )),
                }
                return;
            }
        };
        self.refuse_jog(client, number, next.reply, why_not);
    }
}
