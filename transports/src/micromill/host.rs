//! The host's end of the line.

use super::{Answer, Axis, Order, Text};

/// Waits in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HostTiming {
    /// The longest time from a byte to its echo.
    pub echo_us: u32,
    /// The longest time from the last echo to the answer of an order without motion. Also the time
    /// in which a string whose `;` was not echoed must have an effect.
    pub answer_us: u32,
    /// The longest time from the last echo to the answer of a motion, below 2^31.
    pub motion_us: u32,
    /// How often a string is sent until its echo is right, at least once.
    pub tries: u8,
    /// Silence before the `;`. An additional echo in this time means that the controller received
    /// an additional byte.
    pub guard_us: u32,
    /// Number of bytes that may wait for their echo: the size of the controller's receive buffer.
    pub window: u8,
}

impl HostTiming {
    /// Returns the timing for a line at this rate in baud. An echo may take two characters and 200
    /// ms. An answer may take 500 ms more, and a move may take half an hour. The guard is three
    /// characters of silence.
    pub const fn of(bits_per_s: u32) -> HostTiming {
        let character_us = match 10_000_000_u32.checked_div(bits_per_s) {
            Some(us) => us,
            None => 0,
        };
        let echo_us = character_us.saturating_mul(2).saturating_add(200_000);
        HostTiming {
            echo_us,
            answer_us: echo_us.saturating_add(500_000),
            motion_us: 1_800_000_000,
            tries: 3,
            guard_us: character_us.saturating_mul(3),
            window: 8,
        }
    }
}

/// The outcome of a string.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// The string was executed. A streamed line is in the queue.
    Done,
    /// The motion was stopped before its end.
    Stopped,
    /// The string cannot be executed now. Nothing has changed.
    Refused,
    /// The controller knows no such string. Nothing has changed.
    Wrong,
    /// Homing found no switch.
    NoSwitch,
    /// Its echo was wrong several times. The string was not executed.
    Garbled,
    /// No answer arrived in time. It is not known whether the string was executed.
    Silent,
    /// The controller was reset.
    Restarted,
}

/// What the controller reports in addition to the outcome of a string.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// A motor step. With [`Order::Every`] it stands for the set number of steps and is the last of
    /// them.
    Step {
        /// The axis.
        axis: Axis,
        /// Away from machine zero.
        forward: bool,
    },
    /// A streamed line was made.
    LineDone,
    /// A motion ended before it was done. The queue is dropped.
    Stopped,
    /// The controller was reset. The mill is not homed, and the queue is empty.
    Restarted,
    /// A digit of the state that [`Order::Report`] asks for.
    Digit(u8),
    /// A byte without a meaning, or one that arrived although nothing was sent.
    Noise(u8),
}

/// The progress of the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// There is no string.
    Idle,
    /// A byte waits to be sent.
    Sending,
    /// The host waits for a byte. After this time the caller polls again.
    Waiting {
        /// Microseconds.
        us: u32,
    },
    /// The string has ended. This is returned once.
    Over(Outcome),
}

/// The host's end of the mill's line. It sends one string at a time. While a string that moves the
/// machine waits for its answer, two kinds of orders are possible: [`Order::Stop`] in its place,
/// and [`Order::Faster`], [`Order::Slower`] and [`Order::Renew`] in addition.
///
/// | when | call |
/// | --- | --- |
/// | a string is to be sent | [`start`](Host::start) |
/// | the port takes bytes | [`transmit`](Host::transmit) |
/// | a byte arrives | [`push`](Host::push) |
/// | after each of these, and after the time that it returns | [`poll`](Host::poll) |
///
/// The host sends `;` only if the echo of all characters before it was right. Otherwise it makes
/// the string invalid with a `!`, which no string contains, and sends the string again. So a wrong
/// bit never causes a wrong motion, unless a second wrong bit hides it in the echo. `now_us` wraps.
/// Calls may be up to 2^31 us apart.
#[derive(Debug, Clone)]
pub struct Host {
    timing: HostTiming,
    order: Option<Order>,
    text: Text,
    /// Number of bytes sent, and of bytes echoed.
    sent: u8,
    echoed: u8,
    phase: Phase,
    /// The answer to the order of the present or the last string.
    answer: Option<Outcome>,
    tries: u8,
    /// Whether the string is sent in addition to the order and not for it.
    is_aside: bool,
    is_streaming: bool,
    /// Number of bytes that have extended [`Phase::Quiet`]. It is limited, because a controller may
    /// report steps without a pause.
    heard: u8,
    /// Number of streamed lines that are in the queue and not made yet.
    lines: u32,
    since_us: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// The host sends the string and waits for its answer.
    String,
    /// The echo of the `;` was wrong or is missing. The string may have been executed.
    Unsure,
    /// The host sends `!;` and waits for the answer that there is no such string.
    Spoil,
    /// This answer was received. If `!;` was sent more than once, further answers may follow.
    /// Therefore nothing is sent until the line is silent.
    Quiet,
}

impl Host {
    /// Creates a host at rest. The controller may be in any state, so the first order should be
    /// [`Order::Stop`].
    pub fn new(timing: HostTiming) -> Host {
        Host {
            timing,
            order: None,
            text: Text::new(),
            sent: 0,
            echoed: 0,
            phase: Phase::String,
            answer: None,
            tries: 0,
            is_aside: false,
            is_streaming: false,
            heard: 0,
            lines: 0,
            since_us: 0,
        }
    }

    /// Begins to send a string. Returns `false` if the previous one has not ended.
    pub fn start(&mut self, order: Order, now_us: u32) -> bool {
        let is_free = match self.order {
            None => true,
            Some(_) => self.phase == Phase::String && self.is_echoed() && self.answer.is_none(),
        };
        let is_beside = self.order.is_some();
        if !is_free || (is_beside && order.is_answered() && order != Order::Stop) {
            return false;
        }
        self.phase = Phase::String;
        self.is_aside = is_beside && order != Order::Stop;
        if !self.is_aside {
            self.order = Some(order);
            self.answer = None;
        }
        self.tries = self.timing.tries;
        self.load(order.text(), now_us);
        true
    }

    /// Returns the next byte for the line, if one may be sent.
    pub fn transmit(&mut self, now_us: u32) -> Option<u8> {
        self.order?;
        let byte = self.text.bytes().get(usize::from(self.sent)).copied()?;
        let open = self.sent.wrapping_sub(self.echoed); // never more echoed than sent
        // The last byte waits until all other echoes were right. A string that was made invalid
        // does not wait for echoes.
        let may_go = match byte {
            b';' if self.phase == Phase::String => {
                open == 0 && now_us.wrapping_sub(self.since_us) >= self.timing.guard_us
            }
            b';' => true,
            _ => open < self.timing.window.max(1),
        };
        if !may_go {
            return None;
        }
        if open == 0 {
            self.since_us = now_us;
        }
        self.sent = self.sent.wrapping_add(1); // 64 at most
        Some(byte)
    }

    /// Takes a byte from the line.
    pub fn push(&mut self, byte: u8, now_us: u32) -> Option<Report> {
        if self.phase == Phase::Quiet && self.heard < u8::MAX {
            self.heard = self.heard.wrapping_add(1); // below its most
            self.since_us = now_us;
        }
        if byte < 0x80 {
            return self.echo(byte, now_us);
        }
        match Answer::of(byte) {
            None => Some(Report::Noise(byte)),
            Some(Answer::Step { axis, forward }) => {
                if self.phase == Phase::Unsure {
                    self.is_obeyed(now_us);
                }
                Some(Report::Step { axis, forward })
            }
            Some(Answer::Digit(digit)) => {
                if self.order != Some(Order::Report) {
                    return Some(Report::Noise(byte));
                }
                if self.phase == Phase::Unsure {
                    self.is_obeyed(now_us);
                }
                Some(Report::Digit(digit))
            }
            Some(Answer::Ready) => {
                self.is_streaming = false;
                self.lines = 0;
                self.settle(Outcome::Restarted);
                self.load(Text::new(), now_us);
                self.phase = Phase::String;
                Some(Report::Restarted)
            }
            Some(Answer::Done) if self.lines > 0 => {
                self.lines = self.lines.wrapping_sub(1);
                Some(Report::LineDone)
            }
            Some(Answer::Stopped) => {
                self.lines = 0;
                if self.order != Some(Order::Stop) && !self.is_queueing() {
                    self.obeyed(Outcome::Stopped, now_us);
                }
                Some(Report::Stopped)
            }
            Some(Answer::Wrong) if self.phase == Phase::Spoil => {
                self.load(Text::new(), now_us);
                self.phase = Phase::Quiet;
                self.heard = 0;
                None
            }
            Some(Answer::Wrong) if self.phase == Phase::Quiet => None,
            Some(answer) => {
                let outcome = match answer {
                    Answer::Refused => Outcome::Refused,
                    Answer::Wrong => Outcome::Wrong,
                    Answer::NoSwitch => Outcome::NoSwitch,
                    _ => Outcome::Done,
                };
                // A string that is answered was sent completely, but its echo may be lost.
                let is_sent = self.text.bytes().len() == usize::from(self.sent);
                let is_open = self.phase == Phase::String && !self.is_aside && !is_sent;
                if self.order.is_none() || is_open {
                    return Some(Report::Noise(byte));
                }
                if outcome == Outcome::Done {
                    match self.order {
                        Some(Order::Stream(on)) => self.is_streaming = on,
                        Some(Order::Line(_)) if self.is_streaming => {
                            self.lines = self.lines.saturating_add(1);
                        }
                        _ => {}
                    }
                }
                self.obeyed(outcome, now_us);
                None
            }
        }
    }

    /// Returns the progress of the string.
    pub fn poll(&mut self, now_us: u32) -> Progress {
        let Some(order) = self.order else {
            return Progress::Idle;
        };
        if self.is_echoed() && self.phase == Phase::String {
            self.is_aside = false;
            if let Some(outcome) = self.answer {
                self.order = None;
                return Progress::Over(outcome);
            }
            if !order.is_answered() {
                self.order = None;
                return Progress::Over(Outcome::Done);
            }
        }
        let open = self.sent.wrapping_sub(self.echoed);
        let is_sent = self.text.bytes().len() == usize::from(self.sent);
        let wait_us = match self.phase {
            Phase::Quiet => self.timing.guard_us,
            Phase::Spoil | Phase::Unsure if is_sent => self.timing.answer_us,
            _ if open > 0 => self.timing.echo_us,
            _ if !is_sent => self.timing.guard_us,
            _ if self.waits_for_motion() => self.timing.motion_us,
            _ => self.timing.answer_us,
        };
        let past_us = now_us.wrapping_sub(self.since_us);
        if past_us < wait_us {
            // Further bytes may be sent while the host waits for echoes.
            let may_go = !is_sent && open < self.timing.window.max(1);
            let next = self.text.bytes().get(usize::from(self.sent));
            if may_go && (next != Some(&b';') || self.phase == Phase::Spoil) {
                return Progress::Sending;
            }
            return Progress::Waiting {
                us: wait_us.wrapping_sub(past_us),
            };
        }
        self.late(is_sent, open, now_us)
    }

    /// Whether lines are streamed.
    pub const fn is_streaming(&self) -> bool {
        self.is_streaming
    }

    /// Returns the number of streamed lines in the queue that are not made yet.
    pub const fn lines(&self) -> u32 {
        self.lines
    }

    /// Acts when an expected byte has not arrived in time.
    fn late(&mut self, is_sent: bool, open: u8, now_us: u32) -> Progress {
        match self.phase {
            Phase::Quiet => {
                self.respoilt(now_us);
                return Progress::Sending;
            }
            Phase::Spoil | Phase::Unsure => self.spoil(now_us),
            _ if open > 0 && is_sent => {
                self.phase = Phase::Unsure;
                self.since_us = now_us;
            }
            _ if open > 0 => self.spoil(now_us),
            // The guard has passed.
            _ if !is_sent => return Progress::Sending,
            _ => {
                self.order = None;
                return Progress::Over(Outcome::Silent);
            }
        }
        match self.order {
            // `spoil` has stopped trying.
            Some(_) if self.tries == 0 => {
                self.order = None;
                Progress::Over(Outcome::Silent)
            }
            _ => Progress::Sending,
        }
    }

    fn echo(&mut self, byte: u8, now_us: u32) -> Option<Report> {
        if self.order.is_none() || (self.is_echoed() && self.phase != Phase::Quiet) {
            return Some(Report::Noise(byte));
        }
        if self.sent == self.echoed && self.phase == Phase::String {
            // There is one echo more than bytes sent, so the controller may have an additional
            // byte.
            self.spoil(now_us);
            return None;
        }
        let expected = self.text.bytes().get(usize::from(self.echoed)).copied();
        match self.phase {
            // In these phases any byte may be a late echo.
            Phase::Spoil | Phase::Quiet => None,
            Phase::Unsure => {
                if expected == Some(byte) {
                    self.is_obeyed(now_us);
                }
                None
            }
            _ if expected == Some(byte) => {
                self.echoed = self.echoed.wrapping_add(1); // below `sent`
                self.since_us = now_us;
                None
            }
            _ if expected == Some(b';') => {
                self.phase = Phase::Unsure;
                self.since_us = now_us;
                None
            }
            _ => {
                self.spoil(now_us);
                None
            }
        }
    }

    /// Makes the string unknown to the controller. After the last try the order ends, whatever
    /// arrived. Otherwise an order would never end on a line that answers every byte with noise.
    fn spoil(&mut self, now_us: u32) {
        if self.tries == 0 {
            self.load(Text::new(), now_us);
            self.phase = Phase::String;
            self.answer = Some(Outcome::Silent);
            return;
        }
        self.tries = self.tries.saturating_sub(1);
        let mut text = Text::new();
        text.push(b'!');
        text.push(b';');
        self.load(text, now_us);
        self.phase = Phase::Spoil;
    }

    /// Acts after the invalid string was refused: sends the order again, or gives up.
    fn respoilt(&mut self, now_us: u32) {
        self.phase = Phase::String;
        match self.order {
            // The order is not sent again if an additional string has stopped it, or if it was
            // answered and therefore received.
            Some(order) if self.tries > 0 && !self.is_aside && self.answer.is_none() => {
                self.load(order.text(), now_us);
            }
            _ => {
                self.load(Text::new(), now_us);
                self.settle(Outcome::Garbled);
            }
        }
    }

    /// Takes an answer that proves that the string was received.
    fn obeyed(&mut self, outcome: Outcome, now_us: u32) {
        if self.phase == Phase::Unsure || (!self.is_aside && !self.is_echoed()) {
            self.is_obeyed(now_us);
        }
        self.settle(outcome);
    }

    fn is_obeyed(&mut self, now_us: u32) {
        self.echoed = self.sent;
        self.phase = Phase::String;
        self.since_us = now_us;
    }

    fn settle(&mut self, outcome: Outcome) {
        if self.order.is_some() && self.answer.is_none() {
            self.answer = Some(outcome);
        }
    }

    fn load(&mut self, text: Text, now_us: u32) {
        self.text = text;
        (self.sent, self.echoed) = (0, 0);
        self.since_us = now_us;
    }

    /// Whether the string has been sent and echoed.
    fn is_echoed(&self) -> bool {
        self.text.bytes().len() == usize::from(self.echoed)
    }

    /// Whether a line waits for its slot in the queue.
    fn is_queueing(&self) -> bool {
        self.is_streaming && matches!(self.order, Some(Order::Line(_)))
    }

    fn waits_for_motion(&self) -> bool {
        matches!(
            self.order,
            Some(Order::Jog(_) | Order::Steps(..) | Order::Run(..) | Order::Home | Order::Line(_))
        )
    }
}
