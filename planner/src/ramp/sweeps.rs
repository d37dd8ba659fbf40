//! Events of different sweep, timed directly by the cubic.

use crate::quotient::quotient;
use crate::ramp::{
    piece::Shape,
    root::Root,
    slowness::{Slowness, part},
};

/// The present part of a move with events of different sweep: an arc, a helix or an ellipse.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Span {
    /// Sweep of the part, and the sweep that has passed.
    pub(crate) sweep: u64,
    pub(crate) passed: u64,
    /// Time of the part, and the time that was given, in the units of `Slowness`.
    pub(crate) time: u64,
    pub(crate) given: u64,
    pub(crate) law: Law,
    /// Change of the squared speed over the part.
    pub(crate) gain: u64,
    /// Leading zeros of the sweep, and 2^63 divided by its 32 highest bits.
    zeros: u8,
    inverse: u32,
}

/// Time as a function of the sweep within a part.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) enum Law {
    /// Proportional to the sweep.
    #[default]
    Even,
    /// t = x (linear -+ x (square -+ x cube)), with minus if the speed rises.
    Cubic {
        linear: u64,
        square: u64,
        cube: u64,
        is_rising: bool,
    },
    /// By the square root, for the first and the last grains of a ramp.
    Exact {
        /// Squared speed at the start.
        from: u64,
        speed: u32,
        is_rising: bool,
    },
    /// By the timer of the top speed.
    Level,
}

impl Law {
    pub(crate) fn cubic(time: u64, shape: &Shape) -> Law {
        let (bow, skew) = (part(time, shape.bow), part(time, shape.skew));
        let (double, triple) = (skew.wrapping_mul(2), skew.wrapping_mul(3));
        let (linear, square) = if shape.is_rising {
            (
                time.wrapping_add(bow).wrapping_add(skew),
                bow.wrapping_add(triple),
            )
        } else {
            (
                time.wrapping_sub(bow).wrapping_add(skew),
                bow.saturating_sub(triple),
            )
        };
        Law::Cubic {
            linear,
            square,
            cube: double,
            is_rising: shape.is_rising,
        }
    }
}

impl Span {
    pub(crate) fn new(sweep: u64, time: u64, gain: u64, law: Law) -> Span {
        let sweep = sweep.max(1);
        let zeros = sweep.leading_zeros();
        let divisor = (sweep.wrapping_shl(zeros) >> 32) as u32;
        Span {
            sweep,
            passed: 0,
            time,
            given: 0,
            law,
            gain,
            zeros: zeros as u8,
            inverse: quotient(1 << 63, divisor).min(u32::MAX.into()) as u32,
        }
    }

    /// Passes `sweep` more, within the part. Returns its time.
    pub(crate) fn pass(&mut self, sweep: u64, slowness: &Slowness) -> u64 {
        self.passed = self.passed.wrapping_add(sweep);
        let time = self.time_at(slowness).min(self.time).max(self.given);
        let wait = time.wrapping_sub(self.given);
        self.given = time;
        wait
    }

    /// Returns the part of the sweep that has passed, in units of 2^-32; below 2^32.
    pub(crate) fn share(&self) -> u32 {
        let passed = self.passed.wrapping_shl(self.zeros.into()) >> 32;
        // passed < 2^64 / inverse 2^31.
        (passed.wrapping_mul(self.inverse.into()) >> 31).min(u32::MAX.into()) as u32
    }

    fn time_at(&self, slowness: &Slowness) -> u64 {
        let x = self.share();
        match self.law {
            Law::Even | Law::Level => part(self.time, x),
            Law::Cubic {
                linear,
                square,
                cube,
                is_rising: true,
            } => {
                let inner = square.saturating_sub(part(cube, x));
                part(linear.saturating_sub(part(inner, x)), x)
            }
            Law::Cubic {
                linear,
                square,
                cube,
                ..
            } => part(
                linear.wrapping_add(part(square.wrapping_add(part(cube, x)), x)),
                x,
            ),
            Law::Exact {
                from,
                speed,
                is_rising,
            } => {
                let gain = part(self.gain, x);
                let square = if is_rising {
                    from.saturating_add(gain)
                } else {
                    from.saturating_sub(gain)
                };
                slowness.time(Root::of(square).speed.abs_diff(speed))
            }
        }
    }
}
