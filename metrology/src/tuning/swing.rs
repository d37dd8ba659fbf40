//! Detection of an oscillation of an axis.

use super::stand::Trace;
use husillo_pid::tuning::{Oscillation, oscillation};

/// Period at which traces are sampled, s: a servo period.
pub const PERIOD_S: f64 = 512e-6;

/// Smallest amplitude of a real oscillation, counts. At an amplitude of one or two counts, the
/// steps of the encoder alone raise the effective gain by up to 4/pi.
const LEAST_COUNTS: f64 = 3.0;

/// Motion of an axis some time after a step.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    /// Half of the range of the positions in the last third, counts.
    pub amplitude: f64,
    /// Half of the range of the positions in the third before it, counts.
    pub amplitude_before: f64,
    /// Oscillation in the last third, if there is one.
    pub oscillation: Option<Oscillation>,
}

impl Swing {
    /// Evaluates positions every [`PERIOD_S`].
    pub fn of(positions: &[f64]) -> Self {
        let third = positions.len() / 3;
        let (rest, late) = positions.split_at(positions.len() - third);
        let (_, early) = rest.split_at(rest.len() - third);
        let middle = late.iter().sum::<f64>() / late.len().max(1) as f64;
        Self {
            amplitude: half_way(late),
            amplitude_before: half_way(early),
            oscillation: oscillation(late, PERIOD_S, middle),
        }
    }

    /// Evaluates a trace.
    pub fn of_trace(trace: &Trace) -> Self {
        Self::of(&trace.positions(PERIOD_S))
    }

    /// Whether the oscillation is sustained: larger than the effect of single counts, without
    /// decay, and at least three periods long.
    pub fn is_sustained(&self) -> bool {
        self.amplitude >= LEAST_COUNTS
            && self.amplitude >= 0.95 * self.amplitude_before
            && self.oscillation.is_some_and(|found| found.periods >= 3)
    }
}

fn half_way(positions: &[f64]) -> f64 {
    let low = positions.iter().copied().fold(f64::INFINITY, f64::min);
    let high = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high >= low { (high - low) / 2.0 } else { 0.0 }
}

/// Number of periods of a Fourier coefficient. It is small, because the periods of a relay vary
/// over a line.
const TOGETHER: f64 = 4.0;

/// Amplitude of the part of `positions` that oscillates with `period_s`: the mean of its first
/// Fourier coefficients over a few periods each. The steps of the encoder hardly disturb them.
pub fn fundamental(positions: &[f64], period_s: f64) -> f64 {
    let length = (TOGETHER * period_s / PERIOD_S).round().max(1.0) as usize;
    let omega = std::f64::consts::TAU / period_s;
    let (mut sum, mut parts) = (0.0, 0.0);
    for part in positions.chunks_exact(length) {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (number, position) in part.iter().enumerate() {
            let angle = omega * PERIOD_S * number as f64;
            sine += position * angle.sin();
            cosine += position * angle.cos();
        }
        sum += 2.0 * f64::hypot(sine, cosine) / length as f64;
        parts += 1.0;
    }
    sum / f64::max(parts, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(amplitude: f64, decay: f64) -> Vec<f64> {
        let at = |number: i32| {
            let time = f64::from(number) * PERIOD_S;
            (amplitude * (-decay * time).exp() * (time * 200.0).sin()).floor() + 7.0
        };
        (0..3000).map(at).collect()
    }

    #[test]
    fn a_decaying_oscillation_is_not_sustained() {
        assert!(Swing::of(&wave(5.0, 0.0)).is_sustained());
        assert!(!Swing::of(&wave(2.2, 0.0)).is_sustained());
        assert!(!Swing::of(&wave(50.0, 2.0)).is_sustained());
        assert!(!Swing::of(&[0.0; 3000]).is_sustained());
        assert!(!Swing::of(&[]).is_sustained());
    }

    #[test]
    fn the_fundamental_of_whole_counts() {
        let period_s = std::f64::consts::TAU / 200.0;
        let about_zero: Vec<f64> = wave(5.0, 0.0).iter().map(|x| x - 6.5).collect();
        let found = fundamental(&about_zero, period_s);
        assert!((found - 5.0).abs() < 0.2, "{found}");
    }
}
