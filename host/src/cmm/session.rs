//! `husillo measure`: actions on one axis, and what they give.

use super::action::Action;
use super::axis::Axis;
use super::contact::Contact;
use super::emulated::Emulated;
use super::file::CmmFile;
use super::line::Line;
use super::port::Port;
use super::result_row::{ResultRow, TouchFigures};
use super::scale::Scale;
use super::trouble::Trouble;
use crate::cli::Measure;
use husillo_probe::{Measurement, PreTravel, Tip, UnitVector};
use husillo_transports::nmc::Status;

/// All that `husillo measure` was asked for.
pub struct Session {
    /// The unit of the machine.
    pub scale: Scale,
    actions: Vec<Action>,
    letter: char,
    touches: u8,
    /// Positive and negative, amounts of the scale.
    pre_travel: [i64; 2],
    ball_radius: i64,
    reference: Option<i64>,
}

impl Session {
    /// Reads the arguments.
    ///
    /// # Errors
    ///
    /// A sentence about them.
    pub fn new(args: &Measure, machine: &CmmFile) -> Result<Self, String> {
        let scale = machine.scale;
        let actions = Action::parse(&args.actions, scale)?;
        let amount = |option: &str, text: &Option<String>| match text {
            Some(text) => match scale.parse(text).map(|length| scale.amount(length)) {
                Ok(Some(amount)) => Ok(Some(amount)),
                Ok(None) => Err(format!(
                    "{option} {text}: lengths of this machine are in {}",
                    scale.unit()
                )),
                Err(why) => Err(format!("{option}: {why}")),
            },
            None => Ok(None),
        };
        let reference = amount("--reference", &args.reference)?;
        let calibrates = |action: &Action| matches!(action, Action::Calibrate { .. });
        if reference.is_none() && actions.iter().any(calibrates) {
            return Err("`calibrate` needs --reference, the place of the face".into());
        }
        Ok(Self {
            scale,
            actions,
            letter: args.axis.to_ascii_uppercase(),
            touches: args.repeat,
            pre_travel: match amount("--pretravel", &args.pretravel)? {
                Some(amount) => [amount; 2],
                None => machine.probe.pre_travel,
            },
            ball_radius: machine.probe.ball_radius,
            reference,
        })
    }

    /// Does everything in turn; each result goes to `tell`.
    ///
    /// # Errors
    ///
    /// The first action that fails ends it.
    pub fn run(
        &mut self,
        axis: &mut Axis,
        mut tell: impl FnMut(&ResultRow),
    ) -> Result<(), Trouble> {
        for action in self.actions.clone() {
            let mut row = ResultRow {
                axis: self.letter,
                unit: self.scale.unit(),
                ..ResultRow::default()
            };
            match action {
                Action::GoTo(goal) => {
                    row.action = "goto";
                    axis.go_to(goal)?;
                }
                Action::Zero => {
                    row.action = "zero";
                    axis.set_zero()?;
                }
                Action::Touch { is_positive } => {
                    row.action = "touch";
                    let measurement = axis.touch(is_positive, self.touches)?;
                    row.touch = Some(self.figures(&measurement, is_positive));
                }
                Action::Calibrate { is_positive } => {
                    row.action = "calibrate";
                    let measurement = axis.touch(is_positive, self.touches)?;
                    self.calibrate(&measurement, is_positive);
                    row.touch = Some(self.figures(&measurement, is_positive));
                }
                Action::Status => row.action = "status",
            }
            let reply = axis.status()?;
            row.position = self.number(reply.readings.position.into());
            if action == Action::Status {
                row.bits = Some(names(reply.status));
                row.version = Some(reply.readings.version);
            }
            tell(&row);
        }
        Ok(())
    }

    /// The pre-travel that makes of this touch the reference.
    fn calibrate(&mut self, measurement: &Measurement, is_positive: bool) {
        let index = usize::from(!is_positive);
        let uncorrected = self.corrected(measurement, [0; 2]);
        let Some(reference) = self.reference else {
            return;
        };
        if let Some(place) = self.pre_travel.get_mut(index) {
            let beyond = uncorrected.saturating_sub(reference);
            *place = if is_positive {
                beyond
            } else {
                beyond.saturating_neg()
            };
        }
    }

    /// The face, as an amount of the scale: `p - ed d - r n`.
    fn corrected(&self, measurement: &Measurement, pre_travel: [i64; 2]) -> i64 {
        // 2^31 nm are 2.1 m: no probe.
        let short = |amount: i64| i32::try_from(amount).unwrap_or_default();
        let [positive, negative] = pre_travel.map(short);
        let tip = Tip {
            radius_nm: short(self.ball_radius),
            pre_travel: PreTravel::new([
                (UnitVector::X, positive),
                (UnitVector::X.reversed(), negative),
            ]),
        };
        let touch = &measurement.touch;
        let at = touch.position.map(|counts| self.scale.of_counts(counts));
        let [face, ..] = tip.surface_nm(at, &touch.direction, &touch.direction.reversed());
        face
    }

    fn figures(&self, measurement: &Measurement, is_positive: bool) -> TouchFigures {
        let [positive, negative] = self.pre_travel;
        let pre_travel = if is_positive { positive } else { negative };
        let [trigger, ..] = measurement.touch.position;
        let corrected = self.corrected(measurement, self.pre_travel);
        TouchFigures {
            direction: if is_positive { '+' } else { '-' },
            trigger: self.number(trigger),
            corrected: self.scale.number(corrected),
            pre_travel: self.scale.number(pre_travel),
            touches: measurement.touches,
            spread: self.number(measurement.spread),
            over_travel: self.number(measurement.over_travel),
        }
    }

    fn number(&self, counts: i64) -> f64 {
        self.scale.number(self.scale.of_counts(counts))
    }
}

/// Opens the port of the arguments.
///
/// # Errors
///
/// A sentence about it.
pub fn open(args: &Measure, machine: &CmmFile) -> Result<Line, String> {
    let contacts: &[Contact] = &args.contact;
    let port = if args.port == "sim" {
        let versions = vec![4; usize::from(machine.modules())];
        Port::Simulated(Box::new(Emulated::new(&versions, contacts)?), 0)
    } else if contacts.is_empty() {
        Port::open(&args.port).map_err(|error| format!("{}: {error}", args.port))?
    } else {
        return Err("--contact is for --port sim; `husillo emulate` has one of its own".into());
    };
    Ok(Line::new(port, args.raw))
}

/// The bits of a status that are set.
fn names(status: Status) -> Vec<&'static str> {
    let names = [
        (Status::MOVE_DONE, "move done"),
        (Status::OVERCURRENT, "over-current"),
        (Status::POWER_ON, "power on"),
        (Status::POSITION_ERROR, "position error"),
        (Status::LIMIT_1, "limit 1"),
        (Status::LIMIT_2, "limit 2"),
        (Status::HOME_IN_PROGRESS, "homing"),
    ];
    let set = names.into_iter().filter(|(bit, _)| status.contains(*bit));
    set.map(|(_, name)| name).collect()
}
