//! Threading in passes (G76): the depth of each pass, and its moves.

use crate::command::Command;
use crate::values::nm::Nm;

/// Most passes of one cycle.
pub(crate) const MOST_PASSES: u32 = 1 << 16;

/// 2^(1/2), 2^(1/4), 2^(1/8), ... in 2^-31.
const ROOTS: [u32; 31] = [
    0xb504f334, 0x9837f052, 0x8b95c1e4, 0x85aac368, 0x82cd8699, 0x8164d1f4, 0x80b1ed50, 0x8058d7d3,
    0x802c6437, 0x8016302f, 0x800b179d, 0x80058baf, 0x8002c5d0, 0x800162e6, 0x8000b173, 0x800058b9,
    0x80002c5d, 0x8000162e, 0x80000b17, 0x8000058c, 0x800002c6, 0x80000163, 0x800000b1, 0x80000059,
    0x8000002c, 0x80000016, 0x8000000b, 0x80000006, 0x80000003, 0x80000001, 0x80000001,
];

/// `n^(1/degression)` in 2^-31, accurate to 3 * 10^-8 of the value. `degression` is in millionths
/// and at least 1; n is in 1..=2^16.
///
/// log2 by repeated squaring, 31 bits; 2^x by a product of roots.
fn power(n: u32, degression_micro: u64) -> u64 {
    let whole = n.max(1).ilog2(); // at most 16
    let mut mantissa = u64::from(n.max(1)).wrapping_shl(31u32.wrapping_sub(whole));
    let mut logarithm = u64::from(whole);
    for _ in 0..31 {
        // mantissa in [1, 2) * 2^31, so its square is below 2^64.
        let square = mantissa.wrapping_mul(mantissa);
        let carry = square >> 63;
        mantissa = square.wrapping_shr(31u32.wrapping_add(carry as u32));
        logarithm = (logarithm << 1) | carry;
    }
    // logarithm <= 2^36, times 10^6 < 2^20: below 2^56.
    let exponent = logarithm
        .wrapping_mul(1_000_000)
        .checked_div(degression_micro.max(1_000_000))
        .unwrap_or(0);
    let mut product = 1u64 << 31;
    for (bit, root) in (0..31u32).zip(ROOTS) {
        if exponent.wrapping_shr(30u32.wrapping_sub(bit)) & 1 == 1 {
            // Both below 2^32.
            product = product.wrapping_mul(u64::from(root)) >> 31;
        }
    }
    // The whole part is at most 16, so the result is below 2^49.
    product.wrapping_shl((exponent >> 31) as u32)
}

/// The tangent of an angle in millionths of a degree, below 89 degrees, in 2^-30. Accurate to 10^-8
/// up to 45 degrees.
pub(crate) fn tangent(micro_degrees: u64) -> i64 {
    const ONE: i64 = 1 << 30;
    // pi / 180 in 2^-55, over 10^6 and shifted down to 2^-30 at the end: 89e6 * 6.3e8 < 2^56.
    const RADIAN: u64 = 628_821_134; // pi / 180 / 10^6 * 2^55
    let x = (micro_degrees.min(89_000_000).wrapping_mul(RADIAN) >> 25) as i64;
    let (mut sine, mut cosine, mut term) = (0i64, 0i64, ONE);
    for k in 0..10i64 {
        // Terms of the series, all below 2 * 2^30.
        cosine = cosine.wrapping_add(term);
        term = (term.wrapping_mul(x) >> 30).wrapping_div(k.wrapping_mul(2).wrapping_add(1));
        sine = sine.wrapping_add(term);
        term = (term.wrapping_mul(x) >> 30)
            .wrapping_div(k.wrapping_mul(2).wrapping_add(2))
            .wrapping_neg();
    }
    sine.wrapping_shl(30)
        .checked_div(cosine.max(1))
        .unwrap_or(0)
}

/// A threading cycle: X is depth, Z the direction of the cut.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Passes<const N: usize> {
    /// Start of the cycle. Its X is the drive line, to which the cycle returns.
    pub(crate) start: [Nm; N],
    /// The Z of the end.
    pub(crate) end_z: Nm,
    pub(crate) lead: Nm,
    /// Distance from the drive line to the crest of the thread. The sign is the direction of the
    /// infeed.
    pub(crate) peak: Nm,
    /// Depth of the first pass, above zero.
    pub(crate) first: Nm,
    /// Depth of the thread, above zero.
    pub(crate) full: Nm,
    pub(crate) degression_micro: u64,
    /// Tangent of the compound angle in 2^-30, with the sign of the cut along Z.
    pub(crate) slope: i64,
    /// Passes at full depth still to make, the last cut included.
    pub(crate) springs: u32,
    /// Length of the tapers at the ends, and a mask of the ends: 1 entry, 2 exit.
    pub(crate) taper: Nm,
    pub(crate) taper_ends: u8,
    pub(crate) pass: u32,
    pub(crate) at: [Nm; N],
    pub(crate) state: u8,
}

impl<const N: usize> Passes<N> {
    /// The depth below the crest of pass n, from 1.
    pub(crate) fn depth(&self, n: u32) -> Nm {
        let factor = power(n, self.degression_micro);
        // first <= 2^50 and factor < 2^49 do not fit in 64 bits; in 128 bits this is only a
        // multiplication.
        let deep = u128::from(self.first.0.unsigned_abs()).wrapping_mul(u128::from(factor)) >> 31;
        let deep = i64::try_from(deep).unwrap_or(i64::MAX);
        // The power is accurate to 3e-8, so a depth that close to the full depth is the full depth.
        let slack = deep.wrapping_shr(24).saturating_add(1);
        if deep.saturating_add(slack) >= self.full.0 {
            self.full
        } else {
            Nm(deep)
        }
    }

    fn go(&mut self, x: Nm, z: Nm) -> [Nm; N] {
        if let Some(entry) = self.at.get_mut(0) {
            *entry = x;
        }
        if let Some(entry) = self.at.get_mut(2) {
            *entry = z;
        }
        self.at
    }

    pub(crate) fn next(&mut self) -> Option<Command<N>> {
        let (start_x, start_z) = (self.start.first().copied()?, self.start.get(2).copied()?);
        let depth = self.depth(self.pass);
        // Everything within a few times 2^50.
        let inward = |deep: Nm| {
            let beyond = self.peak.0.saturating_abs().saturating_add(deep.0);
            let signed = if self.peak.0 < 0 {
                beyond.saturating_neg()
            } else {
                beyond
            };
            Nm(start_x.0.saturating_add(signed))
        };
        let (x, crest) = (inward(depth), inward(Nm(0)));
        let aside = (i128::from(depth.0).wrapping_mul(i128::from(self.slope)) >> 30) as i64;
        let begin_z = Nm(start_z.0.saturating_add(aside));
        let way = if self.end_z < start_z { -1i64 } else { 1 };
        let taper = self.taper.0.wrapping_mul(way);
        let (entry, exit) = (self.taper_ends & 1 != 0, self.taper_ends & 2 != 0);
        loop {
            let state = self.state;
            self.state = state.wrapping_add(1);
            let lead = self.lead;
            match state {
                // To the start of the pass.
                0 => {
                    let to = self.go(start_x, begin_z);
                    return Some(Command::Rapid { to });
                }
                1 if entry => {
                    let to = self.go(crest, begin_z);
                    return Some(Command::Rapid { to });
                }
                1 => {
                    let to = self.go(x, begin_z);
                    return Some(Command::Rapid { to });
                }
                2 if entry => {
                    let to = self.go(x, Nm(begin_z.0.saturating_add(taper)));
                    return Some(Command::Thread { to, lead });
                }
                3 => {
                    let z = if exit {
                        Nm(self.end_z.0.saturating_sub(taper))
                    } else {
                        self.end_z
                    };
                    let to = self.go(x, z);
                    return Some(Command::Thread { to, lead });
                }
                4 if exit => {
                    let to = self.go(crest, self.end_z);
                    return Some(Command::Thread { to, lead });
                }
                5 => {
                    let to = self.go(start_x, self.end_z);
                    return Some(Command::Rapid { to });
                }
                6 => {
                    let last = depth >= self.full;
                    if last {
                        self.springs = self.springs.saturating_sub(1);
                    } else {
                        self.pass = self.pass.saturating_add(1);
                    }
                    if last && self.springs == 0 {
                        self.state = 7;
                        continue;
                    }
                    self.state = 0;
                    return self.next();
                }
                7.. => {
                    self.state = 7;
                    return None;
                }
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn powers_and_tangents_are_good_enough() {
        for n in [1u32, 2, 3, 10, 100, 65_536] {
            for degression in [1.0, 1.5, 2.0, 3.25] {
                let ours = power(n, (degression * 1e6) as u64) as f64 / 2f64.powi(31);
                let exact = f64::from(n).powf(1.0 / degression);
                assert!(
                    (ours / exact - 1.0).abs() < 3e-8,
                    "{n} {degression}: {ours} {exact}"
                );
            }
        }
        for degrees in [0.0f64, 14.5, 29.5, 30.0, 45.0] {
            let ours = tangent((degrees * 1e6) as u64) as f64 / 2f64.powi(30);
            assert!(
                (ours - degrees.to_radians().tan()).abs() < 1e-8,
                "{degrees}: {ours}"
            );
        }
        let steep = tangent(80_000_000) as f64 / 2f64.powi(30);
        assert!((steep - 80f64.to_radians().tan()).abs() < 1e-6);
    }
}
