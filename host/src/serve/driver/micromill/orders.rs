//! The orders on the link: one is carried out, others wait.

use super::{Driver, From};
use crate::serve::reply::Reply;
use crate::serve::tool_path::Motion;
use husillo_clients::micromill::why;
use husillo_transports::micromill::{Line, Order, Outcome};

/// Orders that wait at most.
const WAITING: usize = 64;

/// For whom an order is carried out.
#[derive(Debug)]
pub(super) enum Purpose {
    /// A page: it is answered when the order is done.
    Asked(Reply),
    /// A page, with further orders after this one.
    Part,
    /// A jog.
    Jog,
    /// The program.
    Program,
    /// A stop that somebody has requested.
    Halt,
}

/// An order.
#[derive(Debug)]
pub(super) struct Sent {
    pub(super) order: Order,
    pub(super) purpose: Purpose,
    /// Whether its string is on the link.
    is_started: bool,
}

impl Sent {
    pub(super) const fn new(order: Order, purpose: Purpose) -> Self {
        Self {
            order,
            purpose,
            is_started: false,
        }
    }

    /// An order whose string is on the link.
    pub(super) const fn started(order: Order, purpose: Purpose) -> Self {
        Self {
            order,
            purpose,
            is_started: true,
        }
    }
}

impl Driver<'_> {
    /// Whether an order by hand may be sent.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn is_free(&self) -> Result<(), String> {
        if self.running.course.is_active() {
            return Err("a program runs".into());
        }
        if self.jogging.is_active() {
            return Err("the machine jogs".into());
        }
        match self.is_busy() {
            true => Err("the machine moves".into()),
            false => Ok(()),
        }
    }

    /// Whether the string of an order is on the link.
    pub(super) fn is_sent(&self) -> bool {
        self.current.as_ref().is_some_and(|sent| sent.is_started)
    }

    /// Sends orders for a page, one after the other.
    pub(super) fn by_hand(&mut self, orders: Vec<Order>, reply: Reply) {
        if let Err(why) = self.is_free() {
            return reply.error(why);
        }
        let Some((last, parts)) = orders.split_last() else {
            return reply.ok();
        };
        if parts.len() >= WAITING {
            return reply.error("this takes too many strings");
        }
        let parts = parts.iter().map(|order| Sent::new(*order, Purpose::Part));
        self.waiting.extend(parts);
        self.waiting
            .push_back(Sent::new(*last, Purpose::Asked(reply)));
    }

    /// Begins to send the next order, if the link is free.
    pub(super) fn start_next(&mut self) {
        if self.current.is_none() {
            self.current = self.waiting.pop_front();
        }
        let Some(sent) = self.current.as_mut().filter(|sent| !sent.is_started) else {
            return;
        };
        sent.is_started = self.session.start(sent.order);
        if sent.is_started {
            let order = sent.order;
            self.place.begin(order, self.session.now());
            self.tell_sent(order);
        }
    }

    /// Shows the string that is sent.
    pub(super) fn tell_sent(&mut self, order: Order) {
        let text = text(order);
        self.machine.tell(From::Host, text.as_str());
        if let Some(mill) = &mut self.state.mill {
            (mill.sent, mill.echo) = (text, String::new());
            mill.outcome = Some("moving");
        }
    }

    /// Follows the reported steps, and draws the path of the tool.
    pub(super) fn follow(&mut self) {
        let steps = std::mem::take(&mut self.session.steps);
        let motion = self.current.as_ref().map(|sent| motion(sent.order));
        let mut is_drawn = false;
        for (axis, forward) in &steps {
            self.place.step(usize::from(*axis), *forward);
            let at = self.place.at_nm();
            is_drawn |= self.machine.path.to(motion.unwrap_or(Motion::Jog), at);
        }
        self.place
            .passed(self.session.now(), self.current.is_some());
        if is_drawn {
            self.machine.drawn();
        }
    }

    /// The path of the tool begins where it is.
    pub(super) fn begin_path(&self) {
        self.machine.path.to(Motion::Begin, self.place.at_nm());
        self.machine.drawn();
    }

    /// The string on the link has ended.
    ///
    /// # Errors
    ///
    /// The controller does not answer: a sentence.
    pub(super) fn ended(&mut self, outcome: Outcome) -> Result<(), String> {
        let is_answer = self.is_sent();
        let Some(sent) = self.current.take_if(|_| is_answer) else {
            // A string that shows that this program is there.
            return match outcome {
                Outcome::Done => Ok(()),
                outcome => Err(why(outcome).into()),
            };
        };
        let result = match outcome {
            Outcome::Done => Ok(()),
            Outcome::Silent | Outcome::Restarted => return Err(why(outcome).into()),
            outcome => Err(why(outcome)),
        };
        self.confirm(result.err().unwrap_or("done"));
        match sent.purpose {
            Purpose::Halt => return self.halted(outcome),
            Purpose::Program => self.program_answered(result)?,
            Purpose::Jog => {
                self.jog_ended(result);
                // The next jog does not wait for the report.
                if !self.jogging.has_next() {
                    self.ask_place(sent.order)?;
                }
            }
            Purpose::Part => match result {
                Ok(()) => {}
                Err(why) => {
                    self.drop_orders(why);
                    self.ask_place(sent.order)?;
                }
            },
            Purpose::Asked(reply) => {
                let asked = self.ask_place(sent.order);
                reply.with(result);
                asked?;
            }
        }
        Ok(())
    }

    /// Shows the echo of the last string, and its result.
    fn confirm(&mut self, outcome: &'static str) {
        self.show_order();
        let Some(mill) = &mut self.state.mill else {
            return;
        };
        mill.outcome = Some(outcome);
        let text = format!("{} {outcome}", mill.echo);
        self.machine.tell(From::Controller, text);
    }

    /// Shows the echo of the string on the link.
    pub(super) fn show_order(&mut self) {
        let is_sent = self.is_sent();
        let Some(mill) = self.state.mill.as_mut().filter(|_| is_sent) else {
            return;
        };
        // The echoes of strings that keep a motion going follow.
        let echo = self.session.echo();
        let first = echo.split_inclusive(';').next().unwrap_or_default();
        if mill.echo != first {
            first.clone_into(&mut mill.echo);
        }
    }

    /// Asks the controller at rest where it is, and compares that with the reported steps.
    ///
    /// # Errors
    ///
    /// The controller does not answer: a sentence.
    pub(super) fn ask_place(&mut self, order: Order) -> Result<(), String> {
        let reported = self.session.state()?;
        self.follow();
        let is_homed = matches!(order, Order::Home) && reported.is_some_and(|now| now.is_homed);
        if is_homed && !self.place.was_homed() {
            // What was drawn before gets its place.
            let [x, y, z] = self.place.at_nm();
            self.machine.path.shift([-x, -y, -z]);
        }
        let apart = self.place.report(reported, order);
        if let Some(apart) = &apart {
            self.machine.tell(From::Server, apart.as_str());
        }
        self.state.why = apart;
        if is_homed {
            self.begin_path();
        }
        Ok(())
    }

    /// Drops all orders. Those who asked get the reason.
    pub(super) fn drop_orders(&mut self, why: &str) {
        let all = self
            .current
            .take()
            .into_iter()
            .chain(self.waiting.drain(..));
        for sent in all {
            if let Purpose::Asked(reply) = sent.purpose {
                reply.error(why);
            }
        }
        self.jogging = super::Jogging::default();
    }
}

/// The string of an order.
pub(super) fn text(order: Order) -> String {
    String::from_utf8_lossy(order.text().bytes()).into_owned()
}

const fn motion(order: Order) -> Motion {
    match order {
        Order::Home | Order::Line(Line::Rapid(_) | Line::MachineZero { .. }) => Motion::Rapid,
        Order::Line(_) => Motion::Feed,
        _ => Motion::Jog,
    }
}
