//! The planned path, and its mean over the window.

/// Slices in a window.
pub(crate) const SLICES: usize = 16;

/// Parts of a half unit in which the made path is counted. The mean over 16 slices of a path that
/// is a parabola in each slice is a multiple of this.
pub(crate) const PARTS: u32 = 48;

/// The path in one slice of the window. With `x` from 0 to 1 over the slice, the path since its
/// start is
///
/// ```text
/// speed x + bend x^2 + twist x^3
/// ```
///
/// in units of which [`JerkWindow::units_per_nm`](crate::JerkWindow::units_per_nm) are a nanometre.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Slice {
    /// Speed at the start, in units per slice.
    pub speed: u64,
    /// Half the acceleration at the start.
    pub bend: i64,
    /// A sixth of the jerk, which is constant in the slice.
    pub twist: i32,
}

impl Slice {
    /// Path of the whole slice.
    pub fn length(&self) -> u64 {
        // Below 2^38, and never negative.
        self.speed
            .wrapping_add_signed(self.bend)
            .wrapping_add_signed(self.twist.into())
    }

    /// Speed at the end, in units per slice.
    pub fn end_speed(&self) -> u64 {
        self.speed
            .wrapping_add_signed(self.bend.wrapping_mul(2))
            .wrapping_add_signed(i64::from(self.twist).wrapping_mul(3))
    }
}

/// A point of the planned path.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Point {
    /// Position in half units; wraps.
    pub(crate) at: u64,
    /// Units per slice.
    pub(crate) speed: u32,
}

impl Point {
    /// Passes a slice in which the speed changes by `step`.
    fn pass(&mut self, step: i32) {
        let end = self.speed.saturating_add_signed(step);
        self.at = self
            .at
            .wrapping_add(self.speed.into())
            .wrapping_add(end.into());
        self.speed = end;
    }
}

/// The slices left until all rises of the speed have left the window.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Wait {
    /// Slices in which full braking is allowed, before the first level one.
    pub(crate) free: u32,
    /// Slices in which the speed has to stay level.
    pub(crate) level: u32,
}

impl Wait {
    fn of(rises: u16) -> Wait {
        Wait {
            free: rises.trailing_zeros(),
            level: rises.count_ones(),
        }
    }
}

/// The last 16 slices of the planned path. Made is the mean of the planned position over them.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    /// Changes of the speed; the oldest one is at `oldest`.
    steps: [i32; SLICES],
    oldest: u8,
    /// One bit for each step above 0, the oldest in bit 0.
    rises: u16,
    /// The planned path, and the same one window earlier.
    pub(crate) lead: Point,
    trail: Point,
}

impl Filter {
    pub(crate) const fn at_rest(at: u64) -> Filter {
        let point = Point { at, speed: 0 };
        Filter {
            steps: [0; SLICES],
            oldest: 0,
            rises: 0,
            lead: point,
            trail: point,
        }
    }

    /// The step that leaves the window in the next slice.
    fn leaving(&self) -> i32 {
        self.steps
            .get(usize::from(self.oldest))
            .copied()
            .unwrap_or(0)
    }

    /// Lowest and highest change of the speed in the next slice. It is never opposite to the one
    /// that leaves the window, so the mean acceleration changes by at most `most` in a slice.
    pub(crate) fn steps(&self, most: u32) -> [i32; 2] {
        // Below 2^25.
        let [most, leaving] = [most as i32, self.leaving()];
        [
            leaving.max(0).wrapping_sub(most),
            leaving.min(0).wrapping_add(most),
        ]
    }

    /// How long braking has to wait now.
    pub(crate) fn wait(&self) -> Wait {
        Wait::of(self.rises)
    }

    /// How long braking has to wait after the next slice.
    pub(crate) fn wait_after(&self, is_rise: bool) -> Wait {
        Wait::of(self.rises_after(is_rise))
    }

    fn rises_after(&self, is_rise: bool) -> u16 {
        (self.rises >> 1) | (u16::from(is_rise) << 15)
    }

    /// Whether planned and made path stand still.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.lead.speed == 0 && self.lead.at == self.trail.at
    }

    /// Highest planned speed in the window.
    pub(crate) fn highest(&self) -> u32 {
        let mut speed = self.trail.speed;
        let mut highest = speed;
        let (newer, older) = self
            .steps
            .split_at_checked(usize::from(self.oldest))
            .unwrap_or_default();
        for step in older.iter().chain(newer) {
            speed = speed.saturating_add_signed(*step);
            highest = highest.max(speed);
        }
        highest
    }

    /// Passes a slice in which the planned speed changes by `step`.
    pub(crate) fn pass(&mut self, step: i32) -> Slice {
        let leaving = self.leaving();
        // Below 2^35 and 2^30.
        let ahead = self.lead.at.wrapping_sub(self.trail.at);
        let faster = i64::from(self.lead.speed).wrapping_sub(self.trail.speed.into());
        let slice = Slice {
            speed: ahead.wrapping_mul(3),
            bend: faster.wrapping_mul(3),
            twist: step.wrapping_sub(leaving),
        };
        self.rises = self.rises_after(step > 0);
        if let Some(oldest) = self.steps.get_mut(usize::from(self.oldest)) {
            *oldest = step;
        }
        self.oldest = self.oldest.wrapping_add(1) & (SLICES as u8).wrapping_sub(1);
        self.lead.pass(step);
        self.trail.pass(leaving);
        slice
    }
}
