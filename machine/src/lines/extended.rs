//! A machine that runs all commands its equipment allows.

use husillo_gcode::{Block, Command, Compensated, Compensation, Error, Modal, Nm};
use husillo_probe::{Tip, UnitVector};

use crate::Segment;
use crate::lines::extension::{Extension, Parts};
use crate::lines::state::State;

/// The [`Extension`] of a machine that runs curves, probing moves, synchronised outputs, waits for
/// inputs and constant surface speed, each as far as [`Config::equipment`](crate::Config) has it,
/// and cutter compensation.
#[derive(Clone, Debug)]
pub struct Extended<const N: usize> {
    compensation: Compensation<N>,
    /// Radius and pre-travel of the probe, the latter in both directions of X, Y and Z.
    pub(crate) tip: Option<Tip<6>>,
    /// Last answer to a wait for an input, millionths.
    pub(crate) input_micro: i64,
    pub(crate) state: State<N>,
}

impl<const N: usize> Extension<N> for Extended<N> {}

impl<const N: usize> Parts<N> for Extended<N> {
    type Commands = Compensated<N>;
    type Stage = Compensation<N>;
    type Kept = Segment<N>;
    const IS_EXTENDED: bool = true;

    fn new() -> Self {
        Extended {
            compensation: Compensation::new([Nm(0); N]),
            tip: None,
            input_micro: 0,
            state: State::new(),
        }
    }

    fn nothing() -> Compensated<N> {
        Compensated::new()
    }

    fn apply(
        &self,
        block: &Block,
        modal: &mut Modal<N>,
        to: &mut Compensated<N>,
    ) -> Result<Self::Stage, Error> {
        modal.apply(block, to.commands())?;
        let mut stage = self.compensation.clone();
        match stage.apply(to) {
            Ok(()) => Ok(stage),
            Err(kind) => {
                modal.revert(to.commands());
                Err(Error {
                    kind,
                    at: 0,
                    end: 0,
                })
            }
        }
    }

    fn revert(_: Self::Stage, modal: &mut Modal<N>, commands: &mut Compensated<N>) {
        modal.revert(commands.commands());
        commands.clear();
    }

    fn pending(commands: &Compensated<N>) -> impl Iterator<Item = Command<N>> {
        commands.clone()
    }

    fn set_stage(&mut self, stage: Self::Stage) {
        self.compensation = stage;
    }

    fn restart(&mut self, at: [Nm; N]) {
        self.compensation = Compensation::new(at);
    }

    fn finish(&mut self) -> Option<Compensated<N>> {
        if !self.compensation.is_active() {
            return None;
        }
        let at = self.compensation.clone().finish().last();
        let rest = self.compensation.clone().finish();
        if let Some(at) = at.as_ref().and_then(Command::end) {
            self.restart(at);
        }
        Some(rest)
    }

    fn touched(&self, [from, to]: [&[Nm; N]; 2], mut at: [Nm; N]) -> [Nm; N] {
        let mut way = in_space(to);
        for (way, from) in way.iter_mut().zip(in_space(from)) {
            *way = way.saturating_sub(from);
        }
        if let (Some(tip), Some(travel)) = (&self.tip, UnitVector::new(way)) {
            let surface = tip.surface_nm(in_space(&at), &travel, &travel.reversed());
            for (at, surface) in at.iter_mut().zip(surface) {
                *at = Nm(surface);
            }
        }
        at
    }

    fn state(&self) -> Option<&State<N>> {
        Some(&self.state)
    }

    fn state_mut(&mut self) -> Option<&mut State<N>> {
        Some(&mut self.state)
    }
}

/// The first three coordinates.
fn in_space<const N: usize>(at: &[Nm; N]) -> [i64; 3] {
    let mut point = [0; 3];
    for (point, at) in point.iter_mut().zip(at) {
        *point = at.0;
    }
    point
}
